//! The check of a map: what would spoil its labeling, and what to do about it.
//!
//! Cost: a few passes over the cells. The rules are ours; their limits are constants with a reason each, and
//! `tests/formats/import_check.rs` counts how often they are right on real maps and on spoiled copies of them.

use std::f64::consts::TAU;
use std::fmt;

use serde::Serialize;

use super::finding::Finding;
use super::shape::{clearance_cells, for_each_area};
use super::{Gray205, LoadedMap};
use crate::grid::{Cell, Grid, Occupancy, OccupancyGrid};

/// Share of the cells in each state, in 0..=1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Shares {
    /// Free cells.
    pub free: f64,
    /// Occupied cells.
    pub occupied: f64,
    /// Unknown cells.
    pub unknown: f64,
}

/// The result of [`check`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MapCheck {
    /// Shares of the three states.
    pub shares: Shares,
    /// Number of free areas of at least 0.25 m² that no free cells join, not even by a corner.
    pub n_parts: u64,
    /// What was found, worst first.
    pub findings: Vec<Finding>,
}

/// A free place is wider than a robot: cells within this distance of another state count as thin.
const ROBOT_RADIUS_M: f64 = 0.25;
/// Free areas below the footprint of a robot are no places.
pub(super) const ISLAND_M2: f64 = 0.25;
/// Fewer islands than these are not worth a line.
const MIN_ISLANDS: u64 = 10;
/// In an inverted map the "free" cells are walls: nearly all of them are thin.
const MAX_WIDE_FREE_IF_INVERTED: f64 = 1.0 / 3.0;
/// No building is smaller in both directions.
const MIN_EXTENT_M: f64 = 2.0;
/// No building is larger in one.
pub(super) const MAX_EXTENT_M: f64 = 2000.0;
/// In a passage 0.6 m wide, half of the cells are farther than this from its walls.
const MIN_MEDIAN_CLEARANCE_M: f64 = 0.1;
/// In a square room of 20 m by 20 m, half of the cells are farther than this from its walls.
pub(super) const MAX_MEDIAN_CLEARANCE_M: f64 = 3.0;
/// The middle of a hall 50 m wide.
pub(super) const MAX_CLEARANCE_M: f64 = 25.0;
/// Less than a small room that is not seen is furniture.
const MIN_UNEXPLORED_M2: f64 = 4.0;
/// A core of a building has walls around. Around what is out of a lidar's reach 0.96 to 1 of the sides are open, around a yard that
/// beams through windows enclose 0.8.
const MIN_OPEN_SHARE: f64 = 0.9;
/// Of 170 real maps, one has more than a twentieth of its free area enclosed and unexplored: 0.35, a part of Willow Garage.
const MIN_UNEXPLORED_SHARE: f64 = 0.2;

/// Checks a map.
pub fn check(map: &LoadedMap) -> MapCheck {
    let n_cells = map.grid.cells.values().len() as f64;
    let share = |state| map.grid.count(state) as f64 / n_cells;
    let shares = Shares {
        free: share(Occupancy::Free),
        occupied: share(Occupancy::Occupied),
        unknown: share(Occupancy::Unknown),
    };
    let mut findings = reading(map);
    let mut note = |condition: bool, finding| {
        if condition {
            findings.push(finding);
        }
    };
    note(shares.free == 0.0, Finding::NoFreeCell);
    note(shares.occupied == 0.0, Finding::NoOccupiedCell);
    note(shares.unknown == 0.0, Finding::NoUnknownCell);
    let (of_shape, n_parts) = shape(&map.grid);
    findings.extend(of_shape);
    findings.sort_by_key(|finding| std::cmp::Reverse(finding.severity()));
    MapCheck { shares, n_parts, findings }
}

/// Findings about how the map was read.
fn reading(map: &LoadedMap) -> Vec<Finding> {
    let free_thresh = map.source.interpretation.free_thresh;
    let mut findings = Vec::new();
    findings.extend(map.source.replaced_image.clone().map(Finding::ReplacedImage));
    let yaw_rad = map.grid.frame.map_from_grid().yaw_rad;
    if yaw_rad.abs() > TAU {
        findings.push(Finding::YawInDegrees { yaw_rad });
    }
    let n_cells = map.source.gray_205_cells;
    let share_of = |n: u64| n as f64 / map.grid.cells.values().len() as f64;
    let share = share_of(n_cells);
    match map.source.gray_205 {
        _ if n_cells == 0 => {}
        Gray205::Unknown => findings.push(Finding::Gray205Unknown { n_cells, share, free_thresh }),
        Gray205::AsFile => findings.push(Finding::Gray205Free { n_cells, share, free_thresh }),
    }
    let n_cells = map.source.blended_cells;
    if n_cells > 0 {
        findings.push(Finding::Smoothed { n_cells, share: share_of(n_cells) });
    }
    if map.source.transparent_cells > 0 {
        findings.push(Finding::Transparent { n_cells: map.source.transparent_cells });
    }
    findings
}

/// Findings about the shape of the free and the occupied areas, and the number of parts of the free space.
fn shape(map: &OccupancyGrid) -> (Vec<Finding>, u64) {
    let mut findings = Vec::new();
    let resolution_m = map.frame.resolution_m();
    let free = clearance_cells(&map.cells, Occupancy::Free);
    let wide_free = wide_share(&free, resolution_m);
    if wide_free < MAX_WIDE_FREE_IF_INVERTED {
        let wide_occupied = wide_share(&clearance_cells(&map.cells, Occupancy::Occupied), resolution_m);
        if wide_free < wide_occupied {
            findings.push(Finding::Inverted { wide_free, wide_occupied });
        }
    }
    let cell_area_m2 = map.frame.cell_area_m2();
    let areas = FreeAreas::new(&map.cells, &free, ISLAND_M2 / cell_area_m2);
    findings.extend(implausible_resolution(areas.largest, resolution_m));
    let (right, top) = (free.width() - 1, free.height() - 1);
    let on_border = |cell: &Cell| cell.x == 0 || cell.y == 0 || cell.x == right || cell.y == top;
    let n_border = free.cells().filter(on_border).filter(|&cell| free[cell] > 0).count();
    if n_border > 0 {
        findings.push(Finding::OpenToBorder { n_cells: n_border as u64 });
    }
    if areas.n_islands >= MIN_ISLANDS {
        let area_m2 = areas.n_island_cells as f64 * cell_area_m2;
        findings.push(Finding::Islands { n_islands: areas.n_islands, area_m2 });
    }
    let unexplored = Unexplored::new(&map.cells, MIN_UNEXPLORED_M2 / cell_area_m2);
    let n_free = map.count(Occupancy::Free) as f64;
    if unexplored.n_cells as f64 > MIN_UNEXPLORED_SHARE * n_free {
        findings.push(Finding::Unexplored {
            n_areas: unexplored.n_areas,
            area_m2: unexplored.n_cells as f64 * cell_area_m2,
            free_m2: n_free * cell_area_m2,
        });
    }
    (findings, areas.n_parts)
}

/// Unknown areas that free cells enclose, with hardly a wall between: nothing has been seen of what stands there.
#[derive(Default)]
struct Unexplored {
    n_areas: u64,
    n_cells: u64,
}

/// An area of unknown cells that touch, at corners too.
#[derive(Default)]
struct UnknownArea {
    n_cells: u64,
    /// How many sides of its cells lie at the border of the map, at free and at occupied cells.
    sides: Sides,
}

#[derive(Default)]
struct Sides {
    border: u64,
    free: u64,
    occupied: u64,
}

impl Unexplored {
    fn new(cells: &Grid<Occupancy>, min_cells: f64) -> Self {
        let (width, height) = (cells.width() as usize, cells.height() as usize);
        let visit = |area: &mut UnknownArea, index: usize| {
            area.n_cells += 1;
            let (x, y) = (index % width, index / width);
            let is_inside = [x > 0, x + 1 < width, y > 0, y + 1 < height];
            for (is_inside, step) in is_inside.into_iter().zip([-1, 1, -(width as isize), width as isize]) {
                match is_inside.then(|| cells.values()[index.wrapping_add_signed(step)]) {
                    None => area.sides.border += 1,
                    Some(Occupancy::Free) => area.sides.free += 1,
                    Some(Occupancy::Occupied) => area.sides.occupied += 1,
                    Some(Occupancy::Unknown) => {}
                }
            }
        };
        let mut found = Self::default();
        for_each_area(cells, Occupancy::Unknown, visit, |area| {
            let Sides { border, free, occupied } = area.sides;
            let open_share = free as f64 / (free + occupied).max(1) as f64;
            if border == 0 && area.n_cells as f64 >= min_cells && open_share > MIN_OPEN_SHARE {
                found.n_areas += 1;
                found.n_cells += area.n_cells;
            }
        });
        found
    }
}

/// The areas of free cells that touch, at corners too.
struct FreeAreas {
    /// Those smaller than a robot.
    n_islands: u64,
    /// Cells in them.
    n_island_cells: u64,
    /// The others.
    n_parts: u64,
    largest: LargestArea,
}

/// The area of most cells.
#[derive(Default)]
struct LargestArea {
    /// Its clearances in cells, in no order.
    distances: Vec<u16>,
    /// Columns and rows of its bounding box.
    extent_cells: [u32; 2],
}

impl FreeAreas {
    fn new(cells: &Grid<Occupancy>, clearance: &Grid<u16>, min_cells: f64) -> Self {
        let mut found = Self { n_islands: 0, n_island_cells: 0, n_parts: 0, largest: LargestArea::default() };
        // Cells of a map are fewer than 2^32.
        let push = |area: &mut Vec<u32>, index: usize| area.push(index as u32);
        for_each_area(cells, Occupancy::Free, push, |area| {
            if (area.len() as f64) < min_cells {
                found.n_islands += 1;
                found.n_island_cells += area.len() as u64;
            } else {
                found.n_parts += 1;
            }
            if area.len() > found.largest.distances.len() {
                found.largest = LargestArea {
                    distances: area.iter().map(|&index| clearance.values()[index as usize]).collect(),
                    extent_cells: extent_cells(&area, cells.width()),
                };
            }
        });
        found
    }
}

/// Columns and rows of the bounding box of `area`, row-major indices of a grid with this many columns.
fn extent_cells(area: &[u32], width: u32) -> [u32; 2] {
    let span = |position: &dyn Fn(u32) -> u32| {
        let positions = || area.iter().map(|&index| position(index));
        positions().max().unwrap_or(0) + 1 - positions().min().unwrap_or(0)
    };
    [span(&|index| index % width), span(&|index| index / width)]
}

/// Share of the cells of a state that are farther than a robot's radius, and than one cell, from all others.
fn wide_share(clearance: &Grid<u16>, resolution_m: f64) -> f64 {
    let limit = (ROBOT_RADIUS_M / resolution_m).round().max(1.0);
    let n_cells = clearance.values().iter().filter(|&&d| d > 0).count();
    let n_wide = clearance.values().iter().filter(|&&d| f64::from(d) > limit).count();
    if n_cells == 0 { 0.0 } else { n_wide as f64 / n_cells as f64 }
}

/// Judged by the largest area alone: islands around a map say nothing of its scale.
fn implausible_resolution(area: LargestArea, resolution_m: f64) -> Option<Finding> {
    let LargestArea { mut distances, extent_cells } = area;
    let largest = f64::from(*distances.iter().max()?);
    let middle = distances.len() / 2;
    let median = f64::from(*distances.select_nth_unstable(middle).1);
    let extent_m = extent_cells.map(|cells| f64::from(cells) * resolution_m);
    let (median_clearance_m, largest_clearance_m) = (median * resolution_m, largest * resolution_m);
    let extent = extent_m[0].max(extent_m[1]);
    let too_small = extent < MIN_EXTENT_M || median_clearance_m < MIN_MEDIAN_CLEARANCE_M;
    let too_large = extent > MAX_EXTENT_M
        || median_clearance_m > MAX_MEDIAN_CLEARANCE_M
        || largest_clearance_m > MAX_CLEARANCE_M;
    (too_small || too_large).then_some(Finding::Resolution {
        resolution_m,
        extent_m,
        median_clearance_m,
        largest_clearance_m,
    })
}

impl fmt::Display for Shares {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [free, occupied, unknown] = [self.free, self.occupied, self.unknown].map(|share| 100.0 * share);
        write!(f, "free {free:.1} %, occupied {occupied:.1} %, unknown {unknown:.1} %")
    }
}

impl fmt::Display for MapCheck {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.shares)?;
        self.findings.iter().try_for_each(|finding| write!(f, "\n{}: {finding}", finding.severity()))
    }
}
