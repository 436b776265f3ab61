//! Which way the walls around a gate run.
//!
//! The shortest line between two ragged jambs is a few degrees off the line of the wall, and more where one jamb
//! stands back. Most walls of a building run in two directions at right angles, so the walls around a gate tell how
//! it lies.

use rayon::prelude::*;

use super::WallConfig;
use super::gate::{Narrow, center_of};
use crate::geom::{Point2, Vec2};
use crate::grid::{Cell, CellGraph};

/// Steps of a sum per unit.
const STEPS: f64 = (1u64 << 40) as f64;

/// `gate` turned about its center into the direction of the walls around it, where they agree on one.
pub(super) fn aligned(
    directions: &Directions,
    resolution_m: f64,
    config: &WallConfig,
    gate: Narrow,
) -> Narrow {
    let Some(turn_rad) = turn(directions, resolution_m, config, &gate) else { return gate };
    if turn_rad.abs() > config.max_turn_deg * std::f64::consts::PI / 180.0 {
        return gate;
    }
    let (sin, cos) = turn_rad.sin_cos();
    let Vec2 { x, y } = gate.across;
    Narrow { across: Vec2::new(cos * x - sin * y, sin * x + cos * y), width: gate.width * cos, ..gate }
}

/// The angle from `gate` to the nearest direction of the walls around it, where they agree on one.
pub(super) fn turn(
    directions: &Directions,
    resolution_m: f64,
    config: &WallConfig,
    gate: &Narrow,
) -> Option<f64> {
    let walls = directions.around(gate.center, config.radius_m / resolution_m, config.min_agreement)?;
    // The turn to the nearest of the four directions at right angles, from the gate's own: in a map that is turned by
    // a quarter it is the same to the last bit.
    let own = fourth_power(gate.across);
    Some(own.cross(walls).atan2(own.dot(walls)) / 4.0)
}

/// The square of the square of a vector as a complex number: its angle four times, the same for all four directions
/// at right angles.
fn fourth_power(v: Vec2) -> Vec2 {
    let square = |v: Vec2| Vec2::new(v.x * v.x - v.y * v.y, 2.0 * v.x * v.y);
    square(square(v))
}

/// The directions of all walls: g⁴ over the unit gradients g of the clearance near them, as complex numbers.
pub(super) struct Directions {
    /// Where the cells of a row begin; one more entry than rows.
    row_starts: Vec<usize>,
    /// The columns of the cells near a wall, row by row.
    columns: Vec<u32>,
    /// Sums over all such cells before, in whole steps: they do not depend on the order of the cells. They may wrap: what counts are
    /// differences over a few of them.
    sums: Vec<[i64; 2]>,
}

impl Directions {
    pub(super) fn of(graph: &CellGraph, clearance: &[u32], config: &WallConfig) -> Self {
        let [near, far] = config.from_wall_cells;
        let height = |node: usize| (clearance[node] as f64).sqrt();
        let gradient = |cell: Cell| {
            let at = |step| graph.node_beside(cell, step).map(height);
            Some(Vec2::new(at((1, 0))? - at((-1, 0))?, at((0, 1))? - at((0, -1))?))
        };
        let step_of = |(node, cell): (usize, Cell)| {
            if !(near..=far).contains(&height(node)) {
                return None;
            }
            let gradient = gradient(cell).filter(|g| g.length() > 0.0)?;
            let power = fourth_power(gradient * (1.0 / gradient.length()));
            Some((cell.x, [(power.x * STEPS).round() as i64, (power.y * STEPS).round() as i64]))
        };
        let of_row = |y: u32| -> Vec<(u32, [i64; 2])> {
            graph.nodes_in_rows(y..y + 1).zip(graph.cells_in_rows(y..y + 1)).filter_map(step_of).collect()
        };
        let rows: Vec<_> = (0..graph.height()).into_par_iter().map(of_row).collect();
        let n = rows.iter().map(Vec::len).sum();
        let mut directions = Self {
            row_starts: Vec::with_capacity(rows.len() + 1),
            columns: Vec::with_capacity(n),
            sums: Vec::with_capacity(n + 1),
        };
        let mut sum = [0i64; 2];
        for row in rows {
            directions.row_starts.push(directions.columns.len());
            for (x, step) in row {
                directions.columns.push(x);
                directions.sums.push(sum);
                sum = [sum[0].wrapping_add(step[0]), sum[1].wrapping_add(step[1])];
            }
        }
        directions.row_starts.push(directions.columns.len());
        directions.sums.push(sum);
        directions
    }

    /// The direction of the walls within `radius` cells of `center`, as the mean of g⁴. `None` if they do not agree.
    fn around(&self, center: Point2, radius: f64, min_agreement: f64) -> Option<Vec2> {
        let n_rows = self.row_starts.len() - 1;
        let rows =
            (center.y - radius).max(0.0) as usize..((center.y + radius).max(0.0) as usize + 1).min(n_rows);
        let (mut sum, mut n) = ([0i64; 2], 0usize);
        for y in rows {
            let start = self.row_starts[y];
            let columns = &self.columns[start..self.row_starts[y + 1]];
            let is_far = |x: u32| center_of(Cell::new(x, y as u32)).distance(center) > radius;
            // From the left, columns are too far, near enough, and too far again.
            let is_left = |x: u32| (x as f64 + 0.5) < center.x;
            let first = columns.partition_point(|&x| is_left(x) && is_far(x));
            let end = columns.partition_point(|&x| is_left(x) || !is_far(x)).max(first);
            for (sum, k) in sum.iter_mut().zip(0..) {
                *sum += self.sums[start + end][k].wrapping_sub(self.sums[start + first][k]);
            }
            n += end - first;
        }
        let mean = |sum: i64| sum as f64 / (n as f64 * STEPS);
        let mean = (n > 0).then(|| Vec2::new(mean(sum[0]), mean(sum[1])))?;
        (mean.length() >= min_agreement).then_some(mean)
    }
}

#[cfg(test)]
mod tests {
    use super::super::saddles::squared_clearance;
    use super::*;
    use crate::grid::{Grid, Occupancy};

    /// Free cells of 0.1 m where `is_free` says so, inside a border.
    fn map(side: u32, is_free: impl Fn(f64, f64) -> bool) -> CellGraph {
        let mut cells = Grid::filled(side, side, Occupancy::Occupied);
        for cell in cells.cells().collect::<Vec<_>>() {
            let is_border = cell.x == 0 || cell.y == 0 || cell.x + 1 == side || cell.y + 1 == side;
            if !is_border && is_free(cell.x as f64 + 0.5, cell.y as f64 + 0.5) {
                cells[cell] = Occupancy::Free;
            }
        }
        CellGraph::new(&cells)
    }

    fn turned(graph: &CellGraph, angle_rad: f64) -> Narrow {
        let across = Vec2::new(angle_rad.cos(), angle_rad.sin());
        let gate = Narrow { center: Point2::new(40.0, 40.0), across, width: 10.0, depth: 2.0 };
        let config = WallConfig::default();
        aligned(&Directions::of(graph, &squared_clearance(graph), &config), 0.1, &config, gate)
    }

    #[test]
    fn a_gate_turns_into_the_line_of_its_wall() {
        // A wall of 0.2 m along x = 40, open over 1 m in the middle.
        let graph = map(80, |x, y| (x - 40.0).abs() > 1.0 || (y - 40.0).abs() < 5.0);
        for off_degrees in [-20.0f64, -7.0, 0.0, 12.0] {
            let gate = turned(&graph, (90.0 + off_degrees).to_radians());
            assert!(gate.across.x.abs() < 0.02 && gate.across.y > 0.99, "{off_degrees}: {gate:?}");
            let width = 10.0 * off_degrees.to_radians().cos();
            assert!((gate.width - width).abs() < 0.1, "{off_degrees}: {gate:?}");
        }
    }

    #[test]
    fn a_gate_that_lies_far_askew_stays() {
        let graph = map(80, |x, y| (x - 40.0).abs() > 1.0 || (y - 40.0).abs() < 5.0);
        let askew = 40.0_f64.to_radians();
        let gate = turned(&graph, askew);
        assert!((gate.across.x - askew.cos()).abs() < 1e-12 && (gate.width - 10.0).abs() < 1e-12);
    }

    #[test]
    fn the_direction_is_the_mean_over_the_cells_within_the_radius() {
        let graph = map(60, |x, y| (x * 0.37 + y * 0.11).sin() + (y * 0.23 - x * 0.05).cos() < 0.9);
        let clearance = squared_clearance(&graph);
        let config = WallConfig::default();
        let directions = Directions::of(&graph, &clearance, &config);
        let [near, far] = config.from_wall_cells;
        let height = |node: usize| (clearance[node] as f64).sqrt();
        let mut n_compared = 0;
        for (x, y, radius) in (0..200).map(|i| (i * 7 % 61, i * 13 % 59, i % 24)) {
            let (center, radius) = (Point2::new(x as f64 + 0.5, y as f64), radius as f64 + 0.25);
            let (mut sum, mut n) = (Vec2::new(0.0, 0.0), 0);
            for (node, &cell) in graph.cells().iter().enumerate() {
                let beside = |step| graph.node_beside(cell, step).map(height);
                let [Some(left), Some(right)] = [(-1, 0), (1, 0)].map(beside) else { continue };
                let [Some(below), Some(above)] = [(0, -1), (0, 1)].map(beside) else { continue };
                let gradient = Vec2::new(right - left, above - below);
                let is_near =
                    center_of(cell).distance(center) <= radius && (near..=far).contains(&height(node));
                if is_near && gradient.length() > 0.0 {
                    let power = fourth_power(gradient * (1.0 / gradient.length()));
                    (sum, n) = (Vec2::new(sum.x + power.x, sum.y + power.y), n + 1);
                }
            }
            let found = directions.around(center, radius, 0.0);
            assert_eq!(found.is_some(), n > 0, "{center:?}, {radius}");
            if let Some(found) = found {
                let mean = sum * (1.0 / n as f64);
                assert!((found.x - mean.x).hypot(found.y - mean.y) < 1e-9, "{found:?}, not {mean:?}");
                n_compared += 1;
            }
        }
        assert!(n_compared > 100, "{n_compared}");
    }

    #[test]
    fn round_walls_have_no_direction() {
        let graph = map(80, |x, y| (x - 40.0).hypot(y - 40.0) < 18.0);
        let gate = turned(&graph, 0.3);
        assert!((gate.across.y - 0.3_f64.sin()).abs() < 1e-12);
    }
}
