//! How wide the areas of a map are: what the check measures.

use crate::grid::{Cell, CellGraph, Connectivity, Grid, Occupancy};

/// Distance of every cell of state `of` to the nearest cell of another state or outside the map, in cells
/// (`max(|dx|, |dy|)`, so a cell beside a wall has 1); 0 for the other cells. Cost: two passes.
pub(super) fn clearance_cells(cells: &Grid<Occupancy>, of: Occupancy) -> Grid<u16> {
    let mut distance = cells.map(|&state| if state == of { u16::MAX } else { 0 });
    let forward = Connectivity::Eight.steps_back();
    let backward: Vec<(i32, i32)> = forward.iter().map(|(dx, dy)| (-dx, -dy)).collect();
    let mut relax = |cell: Cell, steps: &[(i32, i32)]| {
        if distance[cell] > 0 {
            let nearest = |step: &(i32, i32)| distance.offset(cell, *step).map_or(0, |next| distance[next]);
            let least = steps.iter().map(nearest).min().unwrap_or(0);
            distance[cell] = distance[cell].min(least.saturating_add(1));
        }
    };
    for index in 0..cells.values().len() {
        relax(cells.cell(index), forward);
    }
    for index in (0..cells.values().len()).rev() {
        relax(cells.cell(index), &backward);
    }
    distance
}

/// Number and total of cells of the 8-connected free areas with fewer than `min_cells` cells.
pub(super) fn specks(cells: &Grid<Occupancy>, min_cells: f64) -> (u64, u64) {
    let graph = CellGraph::new(cells);
    let mut seen = vec![false; graph.n_nodes()];
    let (mut n_specks, mut n_speck_cells) = (0, 0);
    for start in 0..graph.n_nodes() {
        if seen[start] {
            continue;
        }
        seen[start] = true;
        let mut n_cells = 0;
        let mut open = vec![start];
        while let Some(node) = open.pop() {
            n_cells += 1;
            for next in graph.neighbors(node, Connectivity::Eight) {
                if !seen[next] {
                    seen[next] = true;
                    open.push(next);
                }
            }
        }
        if (n_cells as f64) < min_cells {
            n_specks += 1;
            n_speck_cells += n_cells;
        }
    }
    (n_specks, n_speck_cells)
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
