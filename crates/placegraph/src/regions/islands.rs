//! Islands: small areas of free space that no robot can reach or stand in.
//!
//! Ragged walls, gaps between boxes and stray beams leave a few free cells that no step leads to. They are too
//! small to be places, and a scan from inside one tells nothing but its own walls: an island takes the label of
//! the free cell nearest to it. With [`Thresholds::min_island_m2`](super::Thresholds) of 0 there are none.
//!
//! **Deviation.** The chapter keeps such regions as they are.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use super::{RegionId, RegionMap, contacts};
use crate::grid::{Cell, CellGraph, FreeSpace};
use crate::labels::Label;

/// Regions up to which a map may consist of islands alone: more of them are a pattern, and no places.
const MAX_ISLANDS_ALONE: usize = 10_000;

/// The regions without neighbors that are smaller than `min_m2`, but none if all regions are and at most 10 000. Cost: that of
/// [`contacts`].
pub fn islands(space: &FreeSpace, regions: &RegionMap, min_m2: f64) -> Vec<RegionId> {
    let mut is_alone = vec![true; regions.regions.len()];
    for contact in contacts(&space.graph, regions) {
        is_alone[contact.a.index()] = false;
        is_alone[contact.b.index()] = false;
    }
    let resolution_m = space.resolution_m();
    let is_small = |n_cells: u32| n_cells as f64 * resolution_m * resolution_m < min_m2;
    let found: Vec<RegionId> = (0..regions.regions.len())
        .filter(|&id| is_alone[id] && is_small(regions.regions[id].n_cells))
        .map(|id| RegionId(id as u32))
        .collect();
    let is_all = found.len() == regions.regions.len() && found.len() <= MAX_ISLANDS_ALONE;
    if is_all { Vec::new() } else { found }
}

/// `regions` where every one of `islands` has the label of the nearest nodes of other regions that are none, by the larger
/// coordinate; of several labels the one of most of them (ties: the lower label).
///
/// # Examples
/// ```
/// use placegraph::grid::{FreeSpace, OccupancyGrid};
/// use placegraph::labels::Label;
/// use placegraph::regions::{DiagonalSteps, connected, islands, label_islands};
///
/// // One free cell in the wall to the right of a room, itself labeled corridor.
/// let space = FreeSpace::of(&OccupancyGrid::from_ascii(0.25, "...##\n...#.\n...##"));
/// let labels: Vec<Label> = space.graph.cells().iter().map(|cell| Label(u8::from(cell.x < 3))).collect();
/// let regions = connected(&space.graph, &labels, DiagonalSteps::default());
/// let found = islands(&space, &regions, 0.25);
/// let labels = label_islands(&space.graph, regions, &found).labeling();
/// let drawn = space.graph.to_ascii(|node| ['c', 'r'][labels[node].index()]);
/// assert_eq!(drawn, "rrr##\nrrr#r\nrrr##\n");
/// ```
///
/// Cost: for every cell of an island the square of cells around it that reaches so far.
pub fn label_islands(graph: &CellGraph, mut regions: RegionMap, islands: &[RegionId]) -> RegionMap {
    if islands.len() == regions.regions.len() {
        return regions;
    }
    let mut cells_of = vec![None; regions.regions.len()];
    for id in islands {
        cells_of[id.index()] = Some(Vec::new());
    }
    for (cell, id) in graph.cells_in_rows(0..graph.height()).zip(&regions.region_of) {
        if let Some(cells) = &mut cells_of[id.index()] {
            cells.push(cell);
        }
    }
    let of_mainland = |cell: Cell| {
        let region = regions.region_of[graph.node_at(cell)?];
        cells_of[region.index()].is_none().then(|| regions.regions[region.index()].label)
    };
    let label_of = |cells: &Option<Vec<Cell>>| nearest_label(graph, cells.as_ref()?, of_mainland);
    let labels: Vec<Option<Label>> = cells_of.iter().map(label_of).collect();
    for (region, label) in regions.regions.iter_mut().zip(labels) {
        region.label = label.unwrap_or(region.label);
    }
    regions
}

/// The label that `label_at` knows most often on the smallest squares around `cells` on which it knows any.
fn nearest_label(
    graph: &CellGraph,
    cells: &[Cell],
    label_at: impl Fn(Cell) -> Option<Label>,
) -> Option<Label> {
    (1..graph.width().max(graph.height())).find_map(|radius| {
        let mut n_found = BTreeMap::new();
        for &cell in cells {
            for label in square(graph, cell, radius).filter_map(&label_at) {
                *n_found.entry(label).or_insert(0) += 1;
            }
        }
        n_found.into_iter().max_by_key(|&(label, n)| (n, Reverse(label))).map(|(label, _)| label)
    })
}

/// The cells of the map that are `radius` away from `cell` by the larger coordinate.
fn square(graph: &CellGraph, cell: Cell, radius: u32) -> impl Iterator<Item = Cell> {
    let range = |middle: u32, side: u32| {
        middle.saturating_sub(radius)..=(middle.saturating_add(radius)).min(side - 1)
    };
    let columns = range(cell.x, graph.width());
    range(cell.y, graph.height()).flat_map(move |y| {
        let is_edge = y.abs_diff(cell.y) == radius;
        let inner = columns.clone().filter(move |x| is_edge || x.abs_diff(cell.x) == radius);
        inner.map(move |x| Cell::new(x, y))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::OccupancyGrid;
    use crate::regions::{DiagonalSteps, connected};

    /// A corridor on the left, a room on the right, two islands in the wall between them and one beyond the room.
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
        let space = FreeSpace::of(&OccupancyGrid::from_ascii(0.5, MAP));
        let regions = regions(&space.graph);
        let of = |x, y| regions.region_of[space.graph.node_at(Cell::new(x, y)).unwrap()];
        // Areas: 0.5 m² in column 3, 0.25 m² in column 5 and in the corner.
        assert_eq!(islands(&space, &regions, 0.3), [of(5, 1), of(11, 3)]);
        assert_eq!(islands(&space, &regions, 0.6), [of(3, 1), of(5, 1), of(11, 3)]);
        assert_eq!(islands(&space, &regions, 0.0), []);
        assert_eq!(islands(&space, &regions, 100.0), [], "a map of islands alone keeps them");
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
