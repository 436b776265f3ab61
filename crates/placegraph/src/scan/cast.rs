//! A single scan, for examples and pictures; many cells go through [`RayCaster`](super::RayCaster).

use std::collections::BTreeSet;

use super::obstacles::specks;
use super::path::{Octant, octant_path};
use super::{N_BEAMS, RangeScan, ScanConfig, UnknownCells};
use crate::grid::{Cell, Occupancy, OccupancyGrid};

/// The scan of a robot in the center of `cell`, aligned with the axes of the grid.
///
/// A beam ends where it enters the first cell that stops it ([`ScanConfig`]), or at the maximal range. What
/// `cell` itself holds does not matter. Cost: O(width + height) per beam, and a pass over the map where specks are not seen.
///
/// # Examples
/// ```
/// use placegraph::grid::{Cell, OccupancyGrid};
/// use placegraph::scan::{self, ScanConfig};
///
/// let map = OccupancyGrid::from_ascii(0.1, "#######\n#.....#\n#######");
/// let scan = scan::cast(&map, Cell::new(1, 1), &ScanConfig::default());
/// assert!((scan.ranges_m()[0] - 0.45).abs() < 1e-12);
/// assert!((scan.ranges_m()[180] - 0.05).abs() < 1e-12);
/// ```
pub fn cast(grid: &OccupancyGrid, cell: Cell, config: &ScanConfig) -> RangeScan {
    let range_max_cells = config.range_max_m / grid.frame.resolution_m();
    let n_max = grid.cells.width() as usize + grid.cells.height() as usize;
    let specks: BTreeSet<Cell> = specks(grid, config).into_iter().collect();
    let stops = |x: i32, y: i32| match grid.cells.offset(cell, (x, y)) {
        Some(at) if specks.contains(&at) => false,
        Some(at) => match grid.cells[at] {
            Occupancy::Free => false,
            Occupancy::Unknown => config.unknown == UnknownCells::Stop,
            Occupancy::Occupied => true,
        },
        None => true,
    };
    let ranges = (0..N_BEAMS).map(|beam| {
        let octant = Octant::of(beam);
        let (right, up) = octant.back(1, 1);
        let end = octant_path(octant.beam, range_max_cells, n_max).into_iter().find(|step| {
            let (x, y) = octant.back(step.x, step.y);
            stops(x, y) || octant.is_diagonal() && stops(x - right, y) && stops(x, y - up)
        });
        end.map_or(config.range_max_m, |step| range_m(step.entry_cells, grid, config)) * config.range_scale
    });
    RangeScan::new(ranges.collect())
}

/// A distance in cells as a range before scaling.
pub(super) fn range_m(entry_cells: f64, grid: &OccupancyGrid, config: &ScanConfig) -> f64 {
    (entry_cells * grid.frame.resolution_m()).min(config.range_max_m)
}
