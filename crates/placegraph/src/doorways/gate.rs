//! Gates: pairs of opposite walls at the width of a door.

use std::cmp::Ordering;

use rayon::prelude::*;

use super::DoorwayConfig;
use super::saddles::saddles;
use crate::geom::{Point2, Vec2};
use crate::grid::{Cell, CellGraph};

/// The rectangle between two jambs, from face to face of the wall. In cells from the lower left corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Narrow {
    pub(super) center: Point2,
    /// Unit vector from one jamb to the other.
    pub(super) across: Vec2,
    /// Distance between the centers of the cells that are the jambs.
    pub(super) width: f64,
    /// Length of the narrow part in the direction of passage.
    pub(super) depth: f64,
}

impl Narrow {
    /// Unit vector in the direction of passage.
    pub(super) fn along(&self) -> Vec2 {
        Vec2::new(-self.across.y, self.across.x)
    }

    /// The same with the cells of both jambs.
    pub(super) fn with_jambs(&self) -> Self {
        Self { width: self.width + 2.0, ..*self }
    }

    /// Coordinates of `point` across the gate and along the passage, from the center.
    pub(super) fn local(&self, point: Point2) -> (f64, f64) {
        let from_center = point - self.center;
        (from_center.dot(self.across), self.across.cross(from_center))
    }
}

/// All gates of the map that could be doorways by their own measures, narrowest first, of these the deepest first. Gates
/// that are equal in both stand together: which of them comes first says nothing.
pub(super) fn candidates(
    graph: &CellGraph,
    clearance: &[u32],
    resolution_m: f64,
    config: &DoorwayConfig,
) -> Vec<Narrow> {
    let cells_of = |meters: f64| meters / resolution_m;
    let (narrowest, widest) = (cells_of(config.min_width_m), cells_of(config.max_width_m));
    // Clearance is measured between centers: a free width w has walls w / 2 + 1 / 2 away, and opposite walls are at most
    // twice the reach apart in which they are looked for.
    let is_door_sized = |squared: u32| {
        (squared as f64).sqrt() <= widest / 2.0 + 1.0 && 2.0 * reach_of(squared) >= narrowest + 1.0
    };
    let mut found: Vec<Narrow> = saddles(graph, clearance, is_door_sized)
        .into_par_iter()
        .flat_map_iter(|node| opposite_walls(graph, node, clearance[node]))
        .filter(|gate| (narrowest..=widest).contains(&(gate.width - 1.0)))
        .filter_map(|gate| with_depth(graph, gate, cells_of(config.max_depth_m)))
        .collect();
    sort(&mut found);
    found
}

/// Sorts `gates`, narrowest first, of these the deepest first, and drops those that are there twice.
fn sort(gates: &mut Vec<Narrow>) {
    let place = |gate: &Narrow| [gate.center.x, gate.center.y, gate.across.x, gate.across.y];
    let by_place = |a: &Narrow, b: &Narrow| {
        place(a).iter().zip(place(b)).map(|(a, b)| a.total_cmp(&b)).find(|order| order.is_ne())
    };
    gates.sort_by(|a, b| {
        let by_size = a.width.total_cmp(&b.width).then(b.depth.total_cmp(&a.depth));
        by_size.then(by_place(a, b).unwrap_or(Ordering::Equal))
    });
    gates.dedup();
}

/// Whether the strip of `gate`, with `margin` cells on both sides, begins in that of `other`.
pub(super) fn begins_in(gate: &Narrow, other: &Narrow, margin: f64) -> bool {
    let (across, along) = other.local(gate.center);
    across.abs() <= other.width / 2.0 && along.abs() <= f64::midpoint(other.depth, gate.depth) + 2.0 * margin
}

/// `gates` and both ends of those that are deeper than `deep`, as gates of their own.
pub(super) fn with_ends(graph: &CellGraph, gates: &[Narrow], deep: f64) -> Vec<Narrow> {
    let mut all = gates.to_vec();
    for gate in gates.iter().filter(|gate| gate.depth > deep) {
        let along = Vec2::new(-gate.across.y, gate.across.x);
        for end in [1.0, -1.0] {
            let center = gate.center + along * (end * (gate.depth / 2.0 - 0.5));
            if is_free(graph, center) {
                all.push(Narrow { center, depth: 1.0, ..*gate });
            }
        }
    }
    sort(&mut all);
    all
}

/// `gates`, in order, without those that lie within `near` cells of an earlier one, as wide within a quarter and in the
/// same direction within 25 degrees. Of gates that are equally wide and deep none is earlier.
pub(super) fn merged(gates: &[Narrow], near: f64) -> Vec<Narrow> {
    let mut merged: Vec<Narrow> = Vec::new();
    let is_same = |gate: &Narrow, other: &Narrow| {
        let (across, along) = other.local(gate.center);
        across.abs() <= 0.3 * other.width
            && along.abs() <= near
            && gate.width <= 1.25 * other.width
            && gate.across.dot(other.across).abs() >= 0.9
    };
    #[expect(clippy::float_cmp, reason = "the same shape has the same width and depth, to the last bit")]
    for equal in gates.chunk_by(|a, b| a.width == b.width && a.depth == b.depth) {
        let new = equal.iter().filter(|gate| !merged.iter().any(|other| is_same(gate, other)));
        let new: Vec<Narrow> = new.copied().collect();
        merged.extend(new);
    }
    merged
}

pub(super) fn center_of(cell: Cell) -> Point2 {
    Point2::new(cell.x as f64 + 0.5, cell.y as f64 + 0.5)
}

/// Whether all cells that `point` lies in, or on the border of, are free.
pub(super) fn is_free(graph: &CellGraph, point: Point2) -> bool {
    let touched = |v: f64| [v.floor(), v.ceil() - 1.0];
    let inside = |v: f64, side: u32| (0.0..side as f64).contains(&v);
    touched(point.y).iter().all(|&y| {
        touched(point.x).iter().all(|&x| {
            inside(x, graph.width())
                && inside(y, graph.height())
                && graph.node_at(Cell::new(x as u32, y as u32)).is_some()
        })
    })
}

/// How far from a node its two walls are looked for. Where they are equally near in truth, the centers of their cells differ
/// by up to a diagonal.
fn reach_of(squared_clearance: u32) -> f64 {
    (squared_clearance as f64).sqrt() + 1.5
}

/// Whether two directions are 120 degrees apart or more: a · b <= −|a| |b| / 2.
fn is_opposite(a: (i32, i32), b: (i32, i32)) -> bool {
    let square = |(x, y): (i32, i32)| i64::from(x * x + y * y);
    let dot = i64::from(a.0 * b.0 + a.1 * b.1);
    dot < 0 && 4 * dot * dot >= square(a) * square(b)
}

/// The shortest lines through the neighborhood of `node` between two cells that are not free, about as near
/// to it as the nearest, and more than 120 degrees apart as seen from it; of these the ones with their middle nearest to it.
fn opposite_walls(graph: &CellGraph, node: usize, squared_clearance: u32) -> Vec<Narrow> {
    let here = center_of(graph.cell(node));
    let reach = reach_of(squared_clearance);
    let steps = reach.floor() as i32;
    let walls: Vec<(i32, i32)> = (-steps..=steps)
        .flat_map(|y| (-steps..=steps).map(move |x| (x, y)))
        .filter(|&(x, y)| x * x + y * y >= squared_clearance as i32)
        .filter(|&(x, y)| f64::from(x * x + y * y) <= reach * reach)
        .filter(|&(x, y)| !is_free(graph, here + Vec2::new(x.into(), y.into())))
        .collect();
    let square = |(x, y): (i32, i32)| x * x + y * y;
    // Squares of the width and of twice the way from here to its middle: whole numbers, so that equal is equal.
    let mut shortest = (i32::MAX, i32::MAX);
    let mut gates = Vec::new();
    for (index, &a) in walls.iter().enumerate() {
        for &b in &walls[index + 1..] {
            let across = (b.0 - a.0, b.1 - a.1);
            let middle = (a.0 + b.0, a.1 + b.1);
            let length = (square(across), square(middle));
            if length > shortest || !is_opposite(a, b) {
                continue;
            }
            if length < shortest {
                shortest = length;
                gates.clear();
            }
            let width = f64::from(length.0).sqrt();
            let center = here + Vec2::new(middle.0.into(), middle.1.into()) * 0.5;
            let across = Vec2::new(across.0.into(), across.1.into()) * (1.0 / width);
            gates.push(Narrow { center, across, width, depth: 0.0 });
        }
    }
    gates
}

/// The gate with its depth: how far the passage stays as narrow, at most `max_depth` cells in all. `center`
/// moves to the middle of the narrow part.
pub(super) fn with_depth(graph: &CellGraph, gate: Narrow, max_depth: f64) -> Option<Narrow> {
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
    (depth <= max_depth).then(|| Narrow {
        center: gate.center + along * ((ahead - behind) / 2.0),
        depth,
        ..gate
    })
}
