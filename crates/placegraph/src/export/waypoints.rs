//! Routes as graphs of straight legs, for consumers that drive straight from node to node.

use std::collections::BTreeMap;

use crate::geom::Point2;
use crate::topology::{Connection, Place, PlaceId, TopologicalMap};

/// A node: a place's station, or a bend of a route.
pub(super) struct Waypoint<'a> {
    pub(super) at: Point2,
    /// The place that it lies in.
    pub(super) place: &'a Place,
    pub(super) kind: WaypointKind,
}

/// What a waypoint is for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum WaypointKind {
    /// Where the routes of its place begin.
    Station,
    /// Where a route changes direction.
    Bend,
}

/// A straight piece of a route, free of obstacles in both directions.
pub(super) struct Leg<'a> {
    pub(super) from: usize,
    pub(super) to: usize,
    pub(super) connection: &'a Connection,
}

/// Stations of all places in their order, then the bends, and the legs between them.
pub(super) fn waypoints(map: &TopologicalMap) -> (Vec<Waypoint<'_>>, Vec<Leg<'_>>) {
    let mut nodes: Vec<Waypoint<'_>> = map
        .places
        .iter()
        .map(|place| Waypoint { at: map.station(place), place, kind: WaypointKind::Station })
        .collect();
    let station_of: BTreeMap<PlaceId, usize> =
        map.places.iter().enumerate().map(|(i, place)| (place.id, i)).collect();
    let mut legs = Vec::new();
    for connection in &map.connections {
        let Some(route) = &connection.route else { continue };
        let ends = [connection.a, connection.b].map(|id| station_of.get(&id).copied());
        let [Some(a), Some(b)] = ends else { continue };
        let mut last = a;
        for &bend in &route.line[1..route.line.len().max(2) - 1] {
            let place = if contains(nodes[b].place, bend) { nodes[b].place } else { nodes[a].place };
            nodes.push(Waypoint { at: bend, place, kind: WaypointKind::Bend });
            legs.push(Leg { from: last, to: nodes.len() - 1, connection });
            last = nodes.len() - 1;
        }
        legs.push(Leg { from: last, to: b, connection });
    }
    (nodes, legs)
}

/// Whether `point` lies inside of the outline of `place` (even–odd rule).
fn contains(place: &Place, point: Point2) -> bool {
    let mut inside = false;
    for ring in place.rings() {
        for (index, &a) in ring.iter().enumerate() {
            let b = ring[(index + 1) % ring.len()];
            if (a.y > point.y) != (b.y > point.y) {
                let x = a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x);
                inside ^= x > point.x;
            }
        }
    }
    inside
}
