//! Islands: small areas of free space that no robot can reach or stand in.
//!
//! Ragged walls, gaps between boxes and stray beams leave a few free cells that no step leads to. So do walls and tables
//! that are drawn as outlines: their insides are long, but no robot fits in. Neither are places, and a scan from inside one
//! says nothing but where its own walls are: an island takes the label of the free cell nearest to it. With [`Thresholds::min_island_m2`](super::Thresholds) of 0 there are none.
//!
//! **Deviation.** The chapter keeps such regions as they are.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use super::{RegionId, RegionMap, contacts};
use crate::grid::{Cell, CellGraph, DisjointSets, FreeSpace, Grid};
use crate::labels::Label;

/// Regions up to which a map may consist of islands alone: more of them are a pattern, and no places.
const MAX_ISLANDS_ALONE: usize = 10_000;

/// What the smallest robots need on all sides, in meters: half of the narrowest vacuum's width.
const MIN_CLEARANCE_M: f64 = 0.15;

/// The regions without neighbors that are smaller than `min_m2`, and all regions of parts of the free space that are nowhere 0.3 m
/// wide; but none if all regions are and at most 10 000, or if `min_m2` is 0. Cost: that of [`contacts`], and in narrow parts
/// the cells within 0.15 m of each.
pub fn islands(space: &FreeSpace, regions: &RegionMap, min_m2: f64) -> Vec<RegionId> {
    if min_m2 <= 0.0 {
        return Vec::new();
    }
    let mut is_alone = vec![true; regions.regions.len()];
    let mut parts = DisjointSets::new(regions.regions.len());
    for contact in contacts(&space.graph, regions) {
        is_alone[contact.a.index()] = false;
        is_alone[contact.b.index()] = false;
        parts.unite(contact.a.index(), contact.b.index());
    }
    let has_room = has_room(space, regions, &mut parts);
    let resolution_m = space.resolution_m();
    let is_small = |n_cells: u32| n_cells as f64 * resolution_m * resolution_m < min_m2;
    let found: Vec<RegionId> = (0..regions.regions.len())
        .filter(|&id| !has_room[parts.find(id)] || (is_alone[id] && is_small(regions.regions[id].n_cells)))
        .map(|id| RegionId(id as u32))
        .collect();
    let is_all = found.len() == regions.regions.len() && found.len() <= MAX_ISLANDS_ALONE;
    if is_all { Vec::new() } else { found }
}

/// For every part of the free space, by its representative: whether a robot can stand in it.
fn has_room(space: &FreeSpace, regions: &RegionMap, parts: &mut DisjointSets) -> Vec<bool> {
    let graph = &space.graph;
    // Half a cell less: in a part of an even number of cells the middle lies between two.
    let radius = (space.in_cells(MIN_CLEARANCE_M) - 0.5).max(0.0);
    // The cells that a disk around the center of one touches.
    let reach = (radius + 0.5).ceil() as i64 - 1;
    let gap = |v: i64| (v.abs() as f64 - 0.5).max(0.0);
    let disk: Vec<(i64, i64)> = (-reach..=reach)
        .flat_map(|y| (-reach..=reach).map(move |x| (x, y)))
        .filter(|&(x, y)| gap(x).powi(2) + gap(y).powi(2) < radius * radius - 1e-9)
        .collect();
    let is_free = |cell: Cell, (x, y): (i64, i64)| {
        let (x, y) = (i64::from(cell.x) + x, i64::from(cell.y) + y);
        let is_inside =
            (0..i64::from(graph.width())).contains(&x) && (0..i64::from(graph.height())).contains(&y);
        is_inside && graph.node_at(Cell::new(x as u32, y as u32)).is_some()
    };
    let mut has_room = vec![false; regions.regions.len()];
    for (cell, id) in graph.cells_in_rows(0..graph.height()).zip(&regions.region_of) {
        let part = parts.find(id.index());
        has_room[part] = has_room[part] || disk.iter().all(|&step| is_free(cell, step));
    }
    has_room
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
/// Cost: two passes over the map, and for every cell of an island the outline of the square around it that reaches so far.
pub fn label_islands(graph: &CellGraph, mut regions: RegionMap, islands: &[RegionId]) -> RegionMap {
    if islands.is_empty() || islands.len() == regions.regions.len() {
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
    let steps = steps_to(graph, |cell| of_mainland(cell).is_some());
    let label_of = |cells: &Option<Vec<Cell>>| nearest_label(graph, cells.as_ref()?, &steps, of_mainland);
    let labels: Vec<Option<Label>> = cells_of.iter().map(label_of).collect();
    for (region, label) in regions.regions.iter_mut().zip(labels) {
        region.label = label.unwrap_or(region.label);
    }
    regions
}

/// Steps of a king from every cell of the map to the nearest one that is a goal, of which there is one: two sweeps.
fn steps_to(graph: &CellGraph, is_goal: impl Fn(Cell) -> bool) -> Grid<u32> {
    let (width, height) = (graph.width(), graph.height());
    let mut steps = Grid::filled(width, height, u32::MAX);
    for cell in graph.cells_in_rows(0..height).filter(|&cell| is_goal(cell)) {
        steps[cell] = 0;
    }
    let mut relax = |cell: Cell, row_before: Option<u32>, beside: Option<u32>| {
        let columns = cell.x.saturating_sub(1)..=(cell.x + 1).min(width - 1);
        let around = row_before.into_iter().flat_map(|y| columns.clone().map(move |x| Cell::new(x, y)));
        let around = around.chain(beside.map(|x| Cell::new(x, cell.y)));
        let nearest = around.map(|other| steps[other]).min().unwrap_or(u32::MAX);
        steps[cell] = steps[cell].min(nearest.saturating_add(1));
    };
    for y in 0..height {
        for x in 0..width {
            relax(Cell::new(x, y), y.checked_sub(1), x.checked_sub(1));
        }
    }
    for y in (0..height).rev() {
        for x in (0..width).rev() {
            relax(Cell::new(x, y), Some(y + 1).filter(|&y| y < height), Some(x + 1).filter(|&x| x < width));
        }
    }
    steps
}

/// The label that `label_at` knows most often on the smallest squares around `cells` on which it knows any, of which the side is
/// told by `steps`.
fn nearest_label(
    graph: &CellGraph,
    cells: &[Cell],
    steps: &Grid<u32>,
    label_at: impl Fn(Cell) -> Option<Label>,
) -> Option<Label> {
    let radius = cells.iter().map(|&cell| steps[cell]).min()?;
    let mut n_found = BTreeMap::new();
    for &cell in cells {
        for label in square(graph, cell, radius).filter_map(&label_at) {
            *n_found.entry(label).or_insert(0) += 1;
        }
    }
    n_found.into_iter().max_by_key(|&(label, n)| (n, Reverse(label))).map(|(label, _)| label)
}

/// The cells of the map that are `radius` away from `cell` by the larger coordinate.
fn square(graph: &CellGraph, cell: Cell, radius: u32) -> impl Iterator<Item = Cell> {
    let range = |middle: u32, side: u32| {
        middle.saturating_sub(radius)..=(middle.saturating_add(radius)).min(side - 1)
    };
    let columns = range(cell.x, graph.width());
    let sides = [cell.x.checked_sub(radius), cell.x.checked_add(radius).filter(|&x| x < graph.width())];
    range(cell.y, graph.height()).flat_map(move |y| {
        let is_edge = y.abs_diff(cell.y) == radius;
        let row = columns.clone().filter(move |_| is_edge);
        let ends = sides.into_iter().flatten().filter(move |_| !is_edge);
        row.chain(ends).map(move |x| Cell::new(x, y))
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
    fn parts_in_which_no_robot_fits_are_islands_however_long() {
        // A room of 0.5 by 0.5 m, and the inside of a wall: 0.2 m wide and 1.2 m long, half of it labeled otherwise.
        let map = "
            .....#............#
            .....#............#
            .....##############
            .....##############
            .....##############
        ";
        let space = FreeSpace::of(&OccupancyGrid::from_ascii(0.1, map));
        let labels: Vec<Label> =
            space.graph.cells().iter().map(|cell| Label(u8::from(cell.x > 12))).collect();
        let regions = connected(&space.graph, &labels, DiagonalSteps::default());
        let of = |x, y| regions.region_of[space.graph.node_at(Cell::new(x, y)).unwrap()];
        assert_eq!(islands(&space, &regions, 0.01), [of(6, 4), of(13, 4)]);
        assert_eq!(islands(&space, &regions, 0.0), []);
        // Half of a robot's width is 5 cells of 3 cm: eight in a row are too narrow. It is round and needs no corners.
        let strip = "..........#........\n".repeat(14);
        let round = "
            ..........###########
            ..........##.......##
            ..........#.........#
            ..........#.........#
            ..........#.........#
            ..........#.........#
            ..........#.........#
            ..........#.........#
            ..........#.........#
            ..........##.......##
            ..........###########
        ";
        for (map, is_island) in [(strip.as_str(), true), (round, false)] {
            let space = FreeSpace::of(&OccupancyGrid::from_ascii(0.03, map));
            let labels = vec![Label(0); space.graph.n_nodes()];
            let parts = connected(&space.graph, &labels, DiagonalSteps::default());
            assert_eq!(parts.regions.len(), 2);
            assert_eq!(!islands(&space, &parts, 0.001).is_empty(), is_island, "{map}");
        }
        // 0.3 m wide, a robot fits in.
        let wider = FreeSpace::of(&OccupancyGrid::from_ascii(0.15, map));
        assert_eq!(islands(&wider, &regions, 0.01), []);
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
