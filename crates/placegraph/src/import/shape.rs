//! Widths of the areas of a map, for the check.

use std::collections::VecDeque;

use crate::grid::{Grid, Occupancy};

/// The cells of one state, marked in a frame of zeros around the map: no cell has to ask whether it is at the
/// border.
struct Framed {
    /// Columns of the map, plus 2.
    stride: usize,
    /// `u16::MAX` for cells of the state, else 0.
    marks: Vec<u16>,
}

impl Framed {
    fn new(cells: &Grid<Occupancy>, of: Occupancy) -> Self {
        let stride = cells.width() as usize + 2;
        let mut marks = vec![0; stride * (cells.height() as usize + 2)];
        for (row, states) in
            marks.chunks_exact_mut(stride).skip(1).zip(cells.values().chunks_exact(stride - 2))
        {
            for (mark, _) in row[1..].iter_mut().zip(states).filter(|(_, state)| **state == of) {
                *mark = u16::MAX;
            }
        }
        Self { stride, marks }
    }

    /// Steps in [`Framed::marks`] to the 4 neighbors that come later in it; the other 4 are the same steps back.
    fn steps(&self) -> [usize; 4] {
        [1, self.stride - 1, self.stride, self.stride + 1]
    }
}

/// Distance of every cell of state `of` to the nearest cell of another state or outside the map, in cells
/// (`max(|dx|, |dy|)`, so a cell next to a wall has 1); 0 for the other cells. Cost: two passes.
pub(super) fn clearance_cells(cells: &Grid<Occupancy>, of: Occupancy) -> Grid<u16> {
    let framed = Framed::new(cells, of);
    let steps = framed.steps();
    let Framed { stride, marks: mut distance } = framed;
    let farther = |nearest: [u16; 4]| nearest.into_iter().min().unwrap_or(0).saturating_add(1);
    let inside = stride + 1..distance.len() - stride - 1;
    for i in inside.clone() {
        if distance[i] > 0 {
            distance[i] = farther(steps.map(|step| distance[i - step]));
        }
    }
    for i in inside.rev() {
        if distance[i] > 0 {
            distance[i] = distance[i].min(farther(steps.map(|step| distance[i + step])));
        }
    }
    let rows = distance.chunks_exact(stride).skip(1).take(cells.height() as usize);
    let values = rows.flat_map(|row| &row[1..stride - 1]).copied().collect();
    Grid::from_rows(cells.width(), cells.height(), values)
}

/// Calls `visit` with every cell of state `of`, as a row-major index, and `end` after the last cell of every 8-connected area
/// of them, in the order of their first cells. Cost: a pass; memory for the rim of what is visited.
pub(super) fn for_each_area<T: Default>(
    cells: &Grid<Occupancy>,
    of: Occupancy,
    mut visit: impl FnMut(&mut T, usize),
    mut end: impl FnMut(T),
) {
    let mut framed = Framed::new(cells, of);
    let (steps, stride, width) = (framed.steps(), framed.stride, cells.width() as usize);
    let mut open = VecDeque::new();
    for start in 0..framed.marks.len() {
        take(&mut framed.marks, start, &mut open);
        if open.is_empty() {
            continue;
        }
        let mut area = T::default();
        while let Some(i) = open.pop_front() {
            visit(&mut area, (i / stride - 1) * width + i % stride - 1);
            for step in steps {
                take(&mut framed.marks, i - step, &mut open);
                take(&mut framed.marks, i + step, &mut open);
            }
        }
        end(area);
    }
}

/// Takes the mark from cell `i` and puts the cell on the list of those whose neighbors are to be visited.
fn take(marks: &mut [u16], i: usize, open: &mut VecDeque<usize>) {
    if marks[i] > 0 {
        marks[i] = 0;
        open.push_back(i);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::OccupancyGrid;

    #[test]
    fn clearance_counts_cells_to_the_nearest_other_one() {
        let map = OccupancyGrid::from_ascii(
            1.0,
            "
            .....
            .....
            .....
            ..#..
            ",
        );
        let distance = clearance_cells(&map.cells, Occupancy::Free);
        let rows: Vec<&[u16]> = (0..4).rev().map(|y| distance.row(y)).collect();
        assert_eq!(rows, [[1, 1, 1, 1, 1], [1, 2, 2, 2, 1], [1, 1, 1, 1, 1], [1, 1, 0, 1, 1]]);
    }

    #[test]
    fn areas_are_joined_by_corners() {
        let map = OccupancyGrid::from_ascii(
            1.0,
            "
            ...#.
            ...##
            ##.#.
            ####.
            ",
        );
        let mut areas = Vec::new();
        for_each_area(&map.cells, Occupancy::Free, Vec::push, |mut area| {
            area.sort_unstable();
            areas.push(area);
        });
        // Rows from the bottom, five cells each.
        assert_eq!(areas, [vec![4, 9], vec![7, 10, 11, 12, 15, 16, 17], vec![19]]);
    }
}
