//! How wide the areas of a map are: what the check measures.

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
/// (`max(|dx|, |dy|)`, so a cell beside a wall has 1); 0 for the other cells. Cost: two passes.
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

/// Number and total of cells of the 8-connected free areas with fewer than `min_cells` cells. Cost: a pass.
pub(super) fn specks(cells: &Grid<Occupancy>, min_cells: f64) -> (u64, u64) {
    let mut free = Framed::new(cells, Occupancy::Free);
    let steps = free.steps();
    let (mut n_specks, mut n_speck_cells) = (0, 0);
    let mut open = Vec::new();
    for start in 0..free.marks.len() {
        let mut n_cells = 0;
        visit(&mut free.marks, start, &mut open);
        while let Some(i) = open.pop() {
            n_cells += 1;
            for step in steps {
                visit(&mut free.marks, i - step, &mut open);
                visit(&mut free.marks, i + step, &mut open);
            }
        }
        if n_cells > 0 && (n_cells as f64) < min_cells {
            n_specks += 1;
            n_speck_cells += n_cells;
        }
    }
    (n_specks, n_speck_cells)
}

/// Takes the mark from cell `i` and puts the cell on the list of those whose neighbors are to be visited.
fn visit(marks: &mut [u16], i: usize, open: &mut Vec<usize>) {
    if marks[i] > 0 {
        marks[i] = 0;
        open.push(i);
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
    fn specks_are_small_areas() {
        let map = OccupancyGrid::from_ascii(
            1.0,
            "
            ...#.
            ...##
            ##.#.
            ####.
            ",
        );
        assert_eq!(specks(&map.cells, 3.0), (2, 3));
        assert_eq!(specks(&map.cells, 1.0), (0, 0));
    }
}
