//! The truth of a map: class and room of every free cell, and which rooms are connected.

use placegraph::geom::Point2;
use placegraph::grid::{Cell, Grid, MapFrame, Occupancy};
use serde::Serialize;

use crate::plan::{OpeningKind, Plan, SpaceClass};
use crate::scene::Scene;
use crate::shape::across;
use crate::warp::Warp;

/// Label of free cells that belong to no class: beyond windows, in passages too wide for a doorway.
pub const AMBIGUOUS: u8 = 255;
/// Labels of corridor, room and doorway cells.
pub const CORRIDOR: u8 = 1;
/// See [`CORRIDOR`].
pub const ROOM: u8 = 2;
/// See [`CORRIDOR`].
pub const DOORWAY: u8 = 3;

/// A free cell in a wall takes its label from a space at most this many cells away.
const NEAREST_CELLS: f64 = 2.5;

/// A room or a corridor as far as it was mapped.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Node {
    /// Its value in the room image.
    pub id: u16,
    /// Area of its cells.
    pub area_m2: f64,
    /// Centroid, in pixels from the left.
    pub cx: f64,
    /// Centroid, in pixels from the top.
    pub cy: f64,
    /// `corridor` or `room`; `ambiguous` in surveyed buildings.
    pub kind: &'static str,
}

/// An opening between two rooms that were both mapped.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Edge {
    /// One room.
    pub a: u16,
    /// The other room.
    pub b: u16,
    /// Middle of the opening, in pixels from the left.
    pub x: f64,
    /// Middle of the opening, in pixels from the top.
    pub y: f64,
    /// Clear width.
    pub width_m: f64,
    /// `doorway`, or `passage` for a wide opening without a frame.
    pub kind: &'static str,
}

/// Rooms and how they are connected, in the layout of `graph.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Graph {
    /// What the numbers are.
    pub note: &'static str,
    /// The mapped rooms and corridors.
    pub nodes: Vec<Node>,
    /// The open doors and passages between them.
    pub edges: Vec<Edge>,
}

/// Labels, rooms and graph of a map.
pub(crate) struct Truth {
    pub(crate) labels: Grid<u8>,
    pub(crate) rooms: Grid<u16>,
    pub(crate) graph: Graph,
}

/// Looks up every free cell of `map` in the scene.
pub(crate) fn look_up(
    plan: &Plan,
    warp: &Warp,
    scene: &Scene,
    map: &Grid<Occupancy>,
    frame: &MapFrame,
) -> Truth {
    let mut labels = map.map(|_| 0);
    let mut rooms = map.map(|_| 0);
    for (index, _) in map.values().iter().enumerate().filter(|(_, value)| **value == Occupancy::Free) {
        let point = frame.center(map.cell(index));
        let (label, room) = label_at(plan, warp, scene, point, frame.resolution_m());
        labels.values_mut()[index] = label;
        rooms.values_mut()[index] = room;
    }
    let graph = graph_of(plan, warp, &rooms, frame);
    Truth { labels, rooms, graph }
}

/// Label and room id at `point` of the world.
fn label_at(plan: &Plan, warp: &Warp, scene: &Scene, point: Point2, cell_m: f64) -> (u8, u16) {
    let opening = scene.cell_at(point).map_or(0, |cell| scene.opening[cell]);
    if opening > 0 && !plan.openings[opening as usize - 1].closed {
        let opening = &plan.openings[opening as usize - 1];
        let inside = opening.in_frame(warp.plan_from_world(point));
        let across_wall = match across(opening.wall) {
            crate::shape::Axis::X => inside.x,
            crate::shape::Axis::Y => inside.y,
        };
        let (from, to) = opening.gap.span(across(opening.wall));
        let beyond_middle = across_wall - from.midpoint(to);
        let room = if beyond_middle.abs() < 0.75 * cell_m {
            0
        } else {
            opening.spaces[usize::from(beyond_middle > 0.0)] as u16 + 1
        };
        let label = if opening.kind == OpeningKind::Doorway { DOORWAY } else { AMBIGUOUS };
        return (label, room);
    }
    match nearest_space(scene, point, NEAREST_CELLS * cell_m) {
        0 => (AMBIGUOUS, 0),
        space => match plan.spaces[space as usize - 1].class() {
            SpaceClass::Corridor => (CORRIDOR, space),
            SpaceClass::Room => (ROOM, space),
            SpaceClass::Ambiguous => (AMBIGUOUS, space),
        },
    }
}

/// The space at `point` or else the nearest one within `reach_m`, plus 1; 0 if there is none.
fn nearest_space(scene: &Scene, point: Point2, reach_m: f64) -> u16 {
    let Some(cell) = scene.cell_at(point) else { return 0 };
    if scene.space[cell] != 0 {
        return scene.space[cell];
    }
    let reach = (reach_m / scene.cell_m).round() as i32;
    let mut best = (i32::MAX, 0);
    for (dx, dy) in (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dx, dy))) {
        let distance = dx * dx + dy * dy;
        if distance < best.0 && distance <= reach * reach {
            let space = scene.space.offset(cell, (dx, dy)).map_or(0, |near| scene.space[near]);
            if space != 0 {
                best = (distance, space);
            }
        }
    }
    best.1
}

fn graph_of(plan: &Plan, warp: &Warp, rooms: &Grid<u16>, frame: &MapFrame) -> Graph {
    let mut sums = vec![(0_u64, 0_u64, 0_u64); plan.spaces.len() + 1];
    for (index, &room) in rooms.values().iter().enumerate() {
        let Cell { x, y } = rooms.cell(index);
        let sum = &mut sums[room as usize];
        *sum = (sum.0 + 1, sum.1 + u64::from(x), sum.2 + u64::from(rooms.height() - 1 - y));
    }
    let round = |value: f64, digits: f64| (value * digits).round() / digits;
    let nodes = sums.iter().enumerate().skip(1).filter(|(_, sum)| sum.0 > 0).map(|(id, &(n, x, y))| Node {
        id: id as u16,
        area_m2: round(n as f64 * frame.cell_area_m2(), 100.0),
        cx: round(x as f64 / n as f64, 10.0),
        cy: round(y as f64 / n as f64, 10.0),
        kind: plan.spaces[id - 1].class().name(),
    });
    let mapped = |space: usize| sums[space + 1].0 > 0;
    let edges =
        plan.openings.iter().filter(|opening| !opening.closed && opening.spaces.iter().all(|&s| mapped(s)));
    let edges = edges.map(|opening| {
        let middle = frame.cells_from_map(warp.world_from_plan(opening.gap.center()));
        Edge {
            a: opening.spaces[0] as u16 + 1,
            b: opening.spaces[1] as u16 + 1,
            x: round(middle.x - 0.5, 10.0),
            y: round(f64::from(rooms.height()) - middle.y - 0.5, 10.0),
            width_m: round(opening.width_m(), 100.0),
            kind: if opening.kind == OpeningKind::Doorway { "doorway" } else { "passage" },
        }
    });
    Graph {
        note: "generated; openings between rooms that are both mapped; px, y down",
        nodes: nodes.collect(),
        edges: edges.collect(),
    }
}
