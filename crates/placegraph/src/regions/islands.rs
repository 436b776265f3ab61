//! Islands: specks of free space that no robot can reach or stand in.
//!
//! Ragged walls, gaps between boxes and stray beams leave specks of free cells that no step leads to. They are too
//! small to be places, and a scan from inside one tells nothing but its own walls: an island takes the label of
//! the free cell nearest to it. With [`Thresholds::min_island_m2`](super::Thresholds) of 0 there are none.
//!
//! **Deviation.** The chapter keeps such regions as they are.

use super::{RegionId, RegionMap, contacts};
use crate::grid::{Cell, CellGraph};
use crate::labels::Label;

/// The regions without neighbors that are smaller than `min_m2`, but none if all regions are. `resolution_m` is the
/// side of a cell. Cost: that of [`contacts`].
pub fn islands(graph: &CellGraph, resolution_m: f64, regions: &RegionMap, min_m2: f64) -> Vec<RegionId> {
    let mut is_alone = vec![true; regions.regions.len()];
    for contact in contacts(graph, regions) {
        is_alone[contact.a.index()] = false;
        is_alone[contact.b.index()] = false;
    }
    let is_small = |n_cells: u32| n_cells as f64 * resolution_m * resolution_m < min_m2;
    let found: Vec<RegionId> = (0..regions.regions.len())
        .filter(|&id| is_alone[id] && is_small(regions.regions[id].n_cells))
        .map(|id| RegionId(id as u32))
        .collect();
    if found.len() == regions.regions.len() { Vec::new() } else { found }
}

/// `regions` where every one of `islands` has the label of the nearest node of another region that is none, by
/// the larger coordinate (ties: the lower row, then the lower column).
///
/// Cost: for every island the square of cells around it that reaches so far.
pub fn label_islands(graph: &CellGraph, regions: RegionMap, islands: &[RegionId]) -> RegionMap {
    let mut is_island = vec![false; regions.regions.len()];
    for id in islands {
        is_island[id.index()] = true;
    }
    let mut labels: Vec<(RegionId, Label)> = Vec::new();
    let mut is_done = vec![false; regions.regions.len()];
    for (node, id) in regions.region_of.iter().enumerate() {
        if !is_island[id.index()] || std::mem::replace(&mut is_done[id.index()], true) {
            continue;
        }
        // An island is smaller than what parts it from its surroundings is thick, so its first cell may stand for it.
        let of_mainland = |cell: Cell| {
            let region = regions.region_of[graph.node_at(cell)?];
            (!is_island[region.index()]).then(|| regions.regions[region.index()].label)
        };
        if let Some(label) = nearest(graph, graph.cell(node), of_mainland) {
            labels.push((*id, label));
        }
    }
    let mut labeled = regions;
    for (id, label) in labels {
        labeled.regions[id.index()].label = label;
    }
    labeled
}

/// What `find` finds first on growing squares around `cell`.
fn nearest(graph: &CellGraph, cell: Cell, find: impl Fn(Cell) -> Option<Label>) -> Option<Label> {
    let (width, height) = (graph.width(), graph.height());
    let range =
        |middle: u32, radius: u32, side: u32| middle.saturating_sub(radius)..=(middle + radius).min(side - 1);
    (1..width.max(height)).find_map(|radius| {
        range(cell.y, radius, height).find_map(|y| {
            let is_edge = y.abs_diff(cell.y) == radius;
            range(cell.x, radius, width)
                .filter(|x| is_edge || x.abs_diff(cell.x) == radius)
                .find_map(|x| find(Cell::new(x, y)))
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::OccupancyGrid;
    use crate::regions::{DiagonalSteps, connected};

    /// A corridor on the left, a room on the right, two specks in the wall between them and one beyond the room.
    const MAP: &str = "
        ..#####...#.
        ..#.###...##
        ..#.#.#...##
        ..#####...##
    ";

    fn regions(graph: &CellGraph) -> RegionMap {
        let labels: Vec<Label> = graph.cells().iter().map(|cell| Label(u8::from(cell.x > 4))).collect();
        connected(graph, &labels, DiagonalSteps::default())
    }

    #[test]
    fn small_regions_without_neighbors_are_islands() {
        let graph = CellGraph::new(&OccupancyGrid::from_ascii(0.5, MAP).cells);
        let regions = regions(&graph);
        let of = |x, y| regions.region_of[graph.node_at(Cell::new(x, y)).unwrap()];
        // Areas: 0.5 m² in column 3, 0.25 m² in column 5 and in the corner.
        assert_eq!(islands(&graph, 0.5, &regions, 0.3), [of(5, 1), of(11, 3)]);
        assert_eq!(islands(&graph, 0.5, &regions, 0.6), [of(3, 1), of(5, 1), of(11, 3)]);
        assert_eq!(islands(&graph, 0.5, &regions, 0.0), []);
        assert_eq!(islands(&graph, 0.5, &regions, 100.0), [], "a map of specks alone keeps them");
    }

    #[test]
    fn islands_take_the_label_of_the_nearest_cell() {
        let graph = CellGraph::new(&OccupancyGrid::from_ascii(0.5, MAP).cells);
        let mut regions = regions(&graph);
        let of = |x, y| regions.region_of[graph.node_at(Cell::new(x, y)).unwrap()];
        let (near_corridor, near_room, corner) = (of(3, 1), of(5, 1), of(11, 3));
        for id in [near_corridor, near_room, corner] {
            regions.regions[id.index()].label = Label(2);
        }
        let labeled = label_islands(&graph, regions.clone(), &[near_corridor, near_room, corner]);
        let label = |id: RegionId| labeled.regions[id.index()].label;
        assert_eq!([near_corridor, near_room, corner].map(label), [Label(0), Label(1), Label(1)]);
        assert_eq!(labeled.region_of, regions.region_of);
    }
}
