//! Routes as graphs of straight legs, for consumers that drive straight from node to node.

use std::collections::BTreeMap;

use crate::geom::Point2;
use crate::topology::{Connection, Place, PlaceId, Route, Shortcut, TopologicalMap};

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
    pub(super) route: &'a Route,
    /// Width of the narrowest doorway that the route passes.
    pub(super) width_m: Option<f64>,
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
    let routes = map.connections.iter().filter_map(|connection| {
        let Connection { a, b, route, .. } = connection;
        Some((vec![*a, *b], map.width_m(connection), route.as_ref()?))
    });
    let shortcuts = map.shortcuts.iter().map(|Shortcut { within, a, b, route }| {
        let widths = [a, b].into_iter().filter_map(|&id| Some(map.place(id)?.doorway.as_ref()?.width_m));
        (vec![*a, *within, *b], widths.min_by(f64::total_cmp), route)
    });
    let mut legs = Vec::new();
    for (through, width_m, route) in routes.chain(shortcuts) {
        let Some(through) = through.iter().map(|id| station_of.get(id).copied()).collect::<Option<Vec<_>>>()
        else {
            continue;
        };
        let [from, .., to] = through[..] else { continue };
        let mut last = from;
        for &bend in &route.line[1..route.line.len().max(2) - 1] {
            let inside = through[1..].iter().rev().find(|&&station| contains(nodes[station].place, bend));
            let place = nodes[*inside.unwrap_or(&from)].place;
            nodes.push(Waypoint { at: bend, place, kind: WaypointKind::Bend });
            legs.push(Leg { from: last, to: nodes.len() - 1, route, width_m });
            last = nodes.len() - 1;
        }
        legs.push(Leg { from: last, to, route, width_m });
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
