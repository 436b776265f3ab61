//! The check of a map that was read: what would spoil a labeling of it, in words that say what to do.
//!
//! Cost: a few passes over the cells. The rules are ours; their limits are constants with a reason each, and
//! `tests/formats/import_check.rs` counts how often they are right on real maps and on spoiled copies of them.

use std::fmt;

use serde::Serialize;

use super::finding::{Finding, Severity};
use super::shape::{clearance_cells, specks};
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
    /// What was found, worst first.
    pub findings: Vec<Finding>,
}

/// A free place is wider than a robot: cells within this distance of another state count as thin.
const ROBOT_RADIUS_M: f64 = 0.25;
/// Free areas below the footprint of a robot are no places.
pub(super) const SPECK_M2: f64 = 0.25;
/// Fewer specks than these are not worth a line.
const MIN_SPECKS: u64 = 10;
/// In an inverted map the "free" cells are walls: nearly all of them are thin.
const MAX_WIDE_FREE_IF_INVERTED: f64 = 1.0 / 3.0;
/// No building is smaller in both directions.
const MIN_EXTENT_M: f64 = 2.0;
/// No building is larger in one.
const MAX_EXTENT_M: f64 = 2000.0;
/// In a passage 0.6 m wide, half of the cells are farther than this from its walls.
const MIN_MEDIAN_CLEARANCE_M: f64 = 0.1;
/// In a square room of 20 m by 20 m, half of the cells are farther than this from its walls.
const MAX_MEDIAN_CLEARANCE_M: f64 = 3.0;
/// The middle of a hall 50 m wide.
const MAX_CLEARANCE_M: f64 = 25.0;

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
    findings.extend(shape(&map.grid));
    findings.sort_by_key(|finding| std::cmp::Reverse(finding.severity()));
    MapCheck { shares, findings }
}

/// What the way the map was read tells.
fn reading(map: &LoadedMap) -> Vec<Finding> {
    let how = &map.source.interpretation;
    let (occupied_thresh, free_thresh) = (how.occupied_thresh, how.free_thresh);
    let mut findings = Vec::new();
    let in_range = |threshold| (0.0..=1.0).contains(&threshold);
    if free_thresh >= occupied_thresh || !in_range(free_thresh) || !in_range(occupied_thresh) {
        findings.push(Finding::Thresholds { occupied_thresh, free_thresh });
    }
    let n_cells = map.source.gray_205_cells;
    let share = n_cells as f64 / map.grid.cells.values().len() as f64;
    match map.source.gray_205 {
        _ if n_cells == 0 => {}
        Gray205::Unknown => findings.push(Finding::Gray205Unknown { n_cells, share, free_thresh }),
        Gray205::AsFile => findings.push(Finding::Gray205Free { n_cells, share, free_thresh }),
    }
    if map.source.transparent_cells > 0 {
        findings.push(Finding::Transparent { n_cells: map.source.transparent_cells });
    }
    findings
}

/// What the shape of the free and the occupied areas tells.
fn shape(map: &OccupancyGrid) -> Vec<Finding> {
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
    findings.extend(implausible_resolution(&free, resolution_m));
    let (right, top) = (free.width() - 1, free.height() - 1);
    let on_border = |cell: &Cell| cell.x == 0 || cell.y == 0 || cell.x == right || cell.y == top;
    let n_border = free.cells().filter(on_border).filter(|&cell| free[cell] > 0).count();
    if n_border > 0 {
        findings.push(Finding::OpenToBorder { n_cells: n_border as u64 });
    }
    let cell_area_m2 = map.frame.cell_area_m2();
    let (n_specks, n_cells) = specks(&map.cells, SPECK_M2 / cell_area_m2);
    if n_specks >= MIN_SPECKS {
        findings.push(Finding::Specks { n_specks, area_m2: n_cells as f64 * cell_area_m2 });
    }
    findings
}

/// Share of the cells of a state that are farther than a robot's radius, and than one cell, from all others.
fn wide_share(clearance: &Grid<u16>, resolution_m: f64) -> f64 {
    let limit = (ROBOT_RADIUS_M / resolution_m).round().max(1.0);
    let n_cells = clearance.values().iter().filter(|&&d| d > 0).count();
    let n_wide = clearance.values().iter().filter(|&&d| f64::from(d) > limit).count();
    if n_cells == 0 { 0.0 } else { n_wide as f64 / n_cells as f64 }
}

fn implausible_resolution(clearance: &Grid<u16>, resolution_m: f64) -> Option<Finding> {
    let mut distances: Vec<u16> = clearance.values().iter().copied().filter(|&d| d > 0).collect();
    let largest = f64::from(*distances.iter().max()?);
    let middle = distances.len() / 2;
    let median = f64::from(*distances.select_nth_unstable(middle).1);
    let extent_m = extent_cells(clearance)?.map(|cells| f64::from(cells) * resolution_m);
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

/// Columns and rows from the first to the last cell above 0.
fn extent_cells(clearance: &Grid<u16>) -> Option<[u32; 2]> {
    let span = |positions: &mut dyn Iterator<Item = u32>| {
        let ends = positions.fold((u32::MAX, 0), |(low, high), at| (low.min(at), high.max(at)));
        (ends.1 + 1).checked_sub(ends.0)
    };
    let set = || clearance.cells().filter(|&cell| clearance[cell] > 0);
    Some([span(&mut set().map(|cell| cell.x))?, span(&mut set().map(|cell| cell.y))?])
}

impl fmt::Display for MapCheck {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Shares { free, occupied, unknown } = self.shares;
        write!(
            f,
            "free {:.1} %, occupied {:.1} %, unknown {:.1} %",
            100.0 * free,
            100.0 * occupied,
            100.0 * unknown
        )?;
        for finding in &self.findings {
            let severity = match finding.severity() {
                Severity::Info => "note",
                Severity::Warning => "warning",
                Severity::Error => "error",
            };
            write!(f, "\n{severity}: {finding}")?;
        }
        Ok(())
    }
}
