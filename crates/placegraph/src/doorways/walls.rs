//! Which way the walls around a gate run.
//!
//! The shortest line between two ragged jambs is a few degrees off the line of the wall, and more where one jamb
//! stands back. Most walls of a building run in two directions at right angles, so the walls around a gate tell how
//! it lies.

use super::gate::{Narrow, center_of};
use super::{WallConfig, paint};
use crate::geom::Vec2;
use crate::grid::{Cell, CellGraph};

/// Steps of a sum per unit.
const STEPS: f64 = (1u64 << 40) as f64;
/// `gate` turned about its center into the direction of the walls around it, where they agree on one.
pub(super) fn aligned(
    graph: &CellGraph,
    clearance: &[u32],
    resolution_m: f64,
    config: &WallConfig,
    gate: Narrow,
) -> Narrow {
    let Some(turn_rad) = turn(graph, clearance, resolution_m, config, &gate) else { return gate };
    if turn_rad.abs() > config.max_turn_deg * std::f64::consts::PI / 180.0 {
        return gate;
    }
    let (sin, cos) = turn_rad.sin_cos();
    let Vec2 { x, y } = gate.across;
    Narrow { across: Vec2::new(cos * x - sin * y, sin * x + cos * y), width: gate.width * cos, ..gate }
}

/// The angle from `gate` to the nearest direction of the walls around it, where they agree on one.
pub(super) fn turn(
    graph: &CellGraph,
    clearance: &[u32],
    resolution_m: f64,
    config: &WallConfig,
    gate: &Narrow,
) -> Option<f64> {
    let walls = direction(graph, clearance, gate, config, config.radius_m / resolution_m)?;
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

/// The direction of the walls within `radius` cells, as the mean of g⁴ over the unit gradients g of the clearance, as
/// complex numbers. `None` if they do not agree.
fn direction(
    graph: &CellGraph,
    clearance: &[u32],
    gate: &Narrow,
    config: &WallConfig,
    radius: f64,
) -> Option<Vec2> {
    let [near, far] = config.from_wall_cells;
    let height = |node: usize| (clearance[node] as f64).sqrt();
    let gradient = |cell: Cell| {
        let at = |step| graph.node_beside(cell, step).map(height);
        Some(Vec2::new(at((1, 0))? - at((-1, 0))?, at((0, 1))? - at((0, -1))?))
    };
    // Sums of whole steps do not depend on the order of the cells.
    let (mut sum, mut n) = ([0i64; 2], 0i64);
    for cell in paint::cells_within(graph, gate, radius) {
        let Some(node) = graph.node_at(cell) else { continue };
        if center_of(cell).distance(gate.center) > radius || !(near..=far).contains(&height(node)) {
            continue;
        }
        let Some(gradient) = gradient(cell).filter(|g| g.length() > 0.0) else { continue };
        let power = fourth_power(gradient * (1.0 / gradient.length()));
        sum = [sum[0] + (power.x * STEPS).round() as i64, sum[1] + (power.y * STEPS).round() as i64];
        n += 1;
    }
    let mean = |sum: i64| sum as f64 / (n as f64 * STEPS);
    let mean = (n > 0).then(|| Vec2::new(mean(sum[0]), mean(sum[1])))?;
    (mean.length() >= config.min_agreement).then_some(mean)
}

#[cfg(test)]
mod tests {
    use super::super::saddles::squared_clearance;
    use super::*;
    use crate::geom::Point2;
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
        aligned(graph, &squared_clearance(graph), 0.1, &WallConfig::default(), gate)
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
    fn round_walls_have_no_direction() {
        let graph = map(80, |x, y| (x - 40.0).hypot(y - 40.0) < 18.0);
        let gate = turned(&graph, 0.3);
        assert!((gate.across.y - 0.3_f64.sin()).abs() < 1e-12);
    }
}
