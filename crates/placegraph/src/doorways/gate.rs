//! Gates: pairs of opposite walls at the width of a door.

use super::DoorwayConfig;
use super::saddles::is_saddle;
use crate::geom::{Point2, Vec2};
use crate::grid::{Cell, CellGraph};

/// The rectangle between two jambs, from face to face of the wall. In cells from the lower left corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gate {
    pub(super) center: Point2,
    /// Unit vector from one jamb to the other.
    pub(super) across: Vec2,
    /// Distance between the centers of the cells that are the jambs.
    pub(super) width: f64,
    /// Length of the narrow part in the direction of passage.
    pub(super) depth: f64,
}

impl Gate {
    /// Coordinates of `point` across the gate and along the passage, from the center.
    pub(super) fn local(&self, point: Point2) -> (f64, f64) {
        let from_center = point - self.center;
        (from_center.dot(self.across), self.across.cross(from_center))
    }
}

/// All gates of the map that could be doorways by their own measures, narrowest first.
pub(super) fn candidates(
    graph: &CellGraph,
    clearance: &[i64],
    resolution_m: f64,
    config: &DoorwayConfig,
) -> Vec<Gate> {
    let cells_of = |meters: f64| meters / resolution_m;
    let (narrowest, widest) = (cells_of(config.min_width_m), cells_of(config.max_width_m));
    // Clearance is measured between centers: a free width w has walls w / 2 + 1 / 2 away.
    let is_door_sized = |squared: i64| (squared as f64).sqrt() <= widest / 2.0 + 1.0;
    let mut found: Vec<Gate> = graph
        .cells_in_rows(0..graph.height())
        .enumerate()
        .filter(|&(node, cell)| is_door_sized(clearance[node]) && is_saddle(graph, clearance, node, cell))
        .filter_map(|(node, _)| opposite_walls(graph, node, clearance[node]))
        .filter(|gate| (narrowest..=widest).contains(&(gate.width - 1.0)))
        .filter_map(|gate| with_depth(graph, gate, cells_of(config.max_depth_m)))
        .collect();
    found.sort_by(|a, b| a.width.total_cmp(&b.width));
    found.dedup();
    found
}

/// The gates among `candidates` that `is_doorway` accepts, but none whose strip, with `margin` cells on both sides, begins
/// in that of an earlier one: seen from aside, a door has a second shortest line.
pub(super) fn accepted(candidates: Vec<Gate>, margin: f64, is_doorway: impl Fn(&Gate) -> bool) -> Vec<Gate> {
    let mut accepted: Vec<Gate> = Vec::new();
    for gate in candidates {
        let lies_in = |other: &Gate| {
            let (across, along) = other.local(gate.center);
            across.abs() <= other.width / 2.0
                && along.abs() <= f64::midpoint(other.depth, gate.depth) + 2.0 * margin
        };
        if !accepted.iter().any(lies_in) && is_doorway(&gate) {
            accepted.push(gate);
        }
    }
    accepted
}

pub(super) fn center_of(cell: Cell) -> Point2 {
    Point2::new(cell.x as f64 + 0.5, cell.y as f64 + 0.5)
}

fn is_free(graph: &CellGraph, point: Point2) -> bool {
    let inside = |v: f64, side: u32| (0.0..side as f64).contains(&v);
    inside(point.x, graph.width())
        && inside(point.y, graph.height())
        && graph.node_at(Cell::new(point.x as u32, point.y as u32)).is_some()
}

/// The shortest line through the neighborhood of `node` between two cells that are not free, about as near
/// to it as the nearest, and more than 120 degrees apart as seen from it.
fn opposite_walls(graph: &CellGraph, node: usize, squared_clearance: i64) -> Option<Gate> {
    let here = center_of(graph.cell(node));
    // Where two walls are equally near in truth, the centers of their cells differ by up to a diagonal.
    let reach = (squared_clearance as f64).sqrt() + 1.5;
    let steps = reach.floor() as i32;
    let walls: Vec<Vec2> = (-steps..=steps)
        .flat_map(|dy| (-steps..=steps).map(move |dx| Vec2::new(dx as f64, dy as f64)))
        .filter(|step| step.length() <= reach && !is_free(graph, here + *step))
        .collect();
    let mut best: Option<(f64, f64, Gate)> = None;
    for (index, &a) in walls.iter().enumerate() {
        for &b in &walls[index + 1..] {
            let width = (b - a).length();
            if a.dot(b) > -0.5 * a.length() * b.length() {
                continue;
            }
            let center = here + (a + b) * 0.5;
            let off = center.distance(here);
            if best.is_none_or(|(w, o, _)| (width, off) < (w, o)) {
                best =
                    Some((width, off, Gate { center, across: (b - a) * (1.0 / width), width, depth: 0.0 }));
            }
        }
    }
    best.map(|(_, _, gate)| gate)
}

/// The gate with its depth: how far the passage stays as narrow, at most `max_depth` cells in all. `center`
/// moves to the middle of the narrow part.
pub(super) fn with_depth(graph: &CellGraph, gate: Gate, max_depth: f64) -> Option<Gate> {
    let along = Vec2::new(-gate.across.y, gate.across.x);
    // A step is half a cell, so that no cell is passed over.
    let is_wall = |side: f64, t: f64| {
        let jamb = gate.center + gate.across * (side * gate.width / 2.0) + along * t;
        (-2..=2).any(|beside| !is_free(graph, jamb + gate.across * (beside as f64 * 0.5)))
    };
    let extent = |direction: f64| {
        let mut t = 0.0;
        while t <= max_depth && is_wall(-1.0, direction * t) && is_wall(1.0, direction * t) {
            t += 0.5;
        }
        t
    };
    let (ahead, behind) = (extent(1.0), extent(-1.0));
    let depth = ahead + behind - 0.5;
    (depth <= max_depth).then(|| Gate {
        center: gate.center + along * ((ahead - behind) / 2.0),
        depth,
        ..gate
    })
}
