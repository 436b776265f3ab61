//! Two oracles of ray casting: grid traversal, and intersection with boxes in continuous space.

#![expect(clippy::float_cmp, reason = "a corner is where both sides are reached at once")]

use placegraph::grid::{Cell, Occupancy, OccupancyGrid};
use placegraph::scan::{N_BEAMS, ScanConfig, UnknownCells, beam_angle_rad, beam_direction};

fn stops(grid: &OccupancyGrid, x: i64, y: i64, config: &ScanConfig) -> bool {
    let inside = x >= 0 && y >= 0 && x < grid.cells.width().into() && y < grid.cells.height().into();
    !inside
        || match grid.cells[Cell::new(x as u32, y as u32)] {
            Occupancy::Free => false,
            Occupancy::Unknown => config.unknown == UnknownCells::Stop,
            Occupancy::Occupied => true,
        }
}

/// The scan of `cell` by the traversal of Amanatides and Woo (1987), beam by beam, in meters.
///
/// Through a corner of cells a beam goes on diagonally, unless both cells next to the corner stop it.
pub fn traverse(grid: &OccupancyGrid, cell: Cell, config: &ScanConfig) -> Vec<f64> {
    (0..N_BEAMS).map(|beam| traverse_beam(grid, cell, beam, config) * config.range_scale).collect()
}

fn traverse_beam(grid: &OccupancyGrid, cell: Cell, beam: usize, config: &ScanConfig) -> f64 {
    let along = beam_direction(beam);
    let step = |component: f64| if component < 0.0 { -1 } else { 1 };
    let (step_x, step_y) = (step(along.x), step(along.y));
    let range_max_cells = config.range_max_m / grid.frame.resolution_m();
    let (mut x, mut y) = (i64::from(cell.x), i64::from(cell.y));
    let (mut crossed_x, mut crossed_y) = (0.0, 0.0);
    loop {
        let next_x = (crossed_x + 0.5) / along.x.abs();
        let next_y = (crossed_y + 0.5) / along.y.abs();
        let distance = next_x.min(next_y);
        if distance >= range_max_cells {
            return config.range_max_m;
        }
        let mut ended = false;
        if next_x == next_y {
            ended = stops(grid, x + step_x, y, config) && stops(grid, x, y + step_y, config);
        }
        if next_x <= distance {
            (x, crossed_x) = (x + step_x, crossed_x + 1.0);
        }
        if next_y <= distance {
            (y, crossed_y) = (y + step_y, crossed_y + 1.0);
        }
        if ended || stops(grid, x, y, config) {
            return (distance * grid.frame.resolution_m()).min(config.range_max_m);
        }
    }
}

/// The range of `beam` from the center of `cell`, in meters, to the nearest obstacle as a square that
/// reaches `grow_cells` beyond its cell on all sides, by intersection of lines. Slow.
///
/// The map's border is a ring of obstacles.
pub fn nearest_box(
    grid: &OccupancyGrid,
    cell: Cell,
    beam: usize,
    grow_cells: f64,
    config: &ScanConfig,
) -> f64 {
    let (sin, cos) = beam_angle_rad(beam).sin_cos();
    let mut nearest = config.range_max_m / grid.frame.resolution_m();
    for y in -1..=i64::from(grid.cells.height()) {
        for x in -1..=i64::from(grid.cells.width()) {
            if !stops(grid, x, y, config) || (x, y) == (cell.x.into(), cell.y.into()) {
                continue;
            }
            let (dx, dy) = ((x - i64::from(cell.x)) as f64, (y - i64::from(cell.y)) as f64);
            let (in_x, out_x) = slab(dx, cos, grow_cells);
            let (in_y, out_y) = slab(dy, sin, grow_cells);
            let (enter, leave) = (in_x.max(in_y), out_x.min(out_y));
            if enter < leave && enter > 0.0 {
                nearest = nearest.min(enter);
            }
        }
    }
    nearest * grid.frame.resolution_m() * config.range_scale
}

/// Where a ray through 0 with this slope enters and leaves the slab of half width ½ + `grow` around `center`.
fn slab(center: f64, slope: f64, grow: f64) -> (f64, f64) {
    let half = 0.5 + grow;
    if slope.abs() < 1e-12 {
        return if center.abs() < half { (f64::NEG_INFINITY, f64::INFINITY) } else { (f64::INFINITY, 0.0) };
    }
    let (one, other) = ((center - half) / slope, (center + half) / slope);
    (one.min(other), one.max(other))
}
