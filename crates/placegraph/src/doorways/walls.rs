//! Which way the walls around a gate run.
//!
//! The shortest line between two ragged jambs is a few degrees off the line of the wall, and more where one jamb
//! stands back. Most walls of a building run in two directions at right angles, so the walls around a gate tell how
//! it lies.

use super::gate::{Gate, center_of};
use crate::geom::Vec2;
use crate::grid::{Cell, CellGraph};

/// The walls that are looked at reach this far from the center of a gate, in meters.
const RADIUS_M: f64 = 2.5;
/// The gradient of the clearance is taken from this far to that far from a wall, in cells: nearer it is ragged, farther
/// it belongs to what is beyond.
const FROM_WALL: std::ops::RangeInclusive<f64> = 1.5..=6.0;
/// Least agreement of the directions, 0 to 1: 0 for a round room, 1 for straight walls at right angles.
const MIN_AGREEMENT: f64 = 0.4;
/// A gate is turned by at most this angle: what lies more askew is a door in another wall.
const MAX_TURN_RAD: f64 = 25.0 * std::f64::consts::PI / 180.0;

/// `gate` turned about its center into the direction of the walls around it, where they agree on one.
pub(super) fn aligned(graph: &CellGraph, clearance: &[i64], resolution_m: f64, gate: Gate) -> Gate {
    let Some(wall_rad) = direction(graph, clearance, &gate, RADIUS_M / resolution_m) else { return gate };
    let gate_rad = gate.across.y.atan2(gate.across.x);
    let quarter = std::f64::consts::FRAC_PI_2;
    // The turn to the nearest of the four directions at right angles.
    let turn_rad = (wall_rad - gate_rad) - quarter * ((wall_rad - gate_rad) / quarter).round();
    if turn_rad.abs() > MAX_TURN_RAD {
        return gate;
    }
    let (sin, cos) = (gate_rad + turn_rad).sin_cos();
    Gate { across: Vec2::new(cos, sin), width: gate.width * turn_rad.cos(), ..gate }
}

/// The direction of the walls within `radius` cells, modulo a quarter turn: a fourth of the angle of the mean of g⁴
/// over the unit gradients g of the clearance, as complex numbers. `None` if they do not agree.
fn direction(graph: &CellGraph, clearance: &[i64], gate: &Gate, radius: f64) -> Option<f64> {
    let height = |node: usize| (clearance[node] as f64).sqrt();
    let gradient = |node: usize| {
        let at = |step| graph.node_at_step(node, step).map(height);
        Some(Vec2::new(at((1, 0))? - at((-1, 0))?, at((0, 1))? - at((0, -1))?))
    };
    let range = |middle: f64, side: u32| {
        ((middle - radius).max(0.0) as u32)..((middle + radius) as u32 + 1).min(side)
    };
    let (mut sum, mut n) = (Vec2::new(0.0, 0.0), 0.0);
    for y in range(gate.center.y, graph.height()) {
        for x in range(gate.center.x, graph.width()) {
            let cell = Cell::new(x, y);
            let Some(node) = graph.node_at(cell) else { continue };
            if center_of(cell).distance(gate.center) > radius || !FROM_WALL.contains(&height(node)) {
                continue;
            }
            let Some(gradient) = gradient(node).filter(|g| g.length() > 0.0) else { continue };
            let unit = gradient * (1.0 / gradient.length());
            let squared = Vec2::new(unit.x * unit.x - unit.y * unit.y, 2.0 * unit.x * unit.y);
            sum = sum + Vec2::new(squared.x * squared.x - squared.y * squared.y, 2.0 * squared.x * squared.y);
            n += 1.0;
        }
    }
    (n > 0.0 && sum.length() >= MIN_AGREEMENT * n).then(|| sum.y.atan2(sum.x) / 4.0)
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

    fn turned(graph: &CellGraph, angle_rad: f64) -> Gate {
        let across = Vec2::new(angle_rad.cos(), angle_rad.sin());
        let gate = Gate { center: Point2::new(40.0, 40.0), across, width: 10.0, depth: 2.0 };
        aligned(graph, &squared_clearance(graph), 0.1, gate)
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
