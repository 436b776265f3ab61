//! The places that a robot can reach, and how good the graph is for it.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use serde::{Deserialize, Serialize};

use super::query::{PlaceIndex, Whereabouts};
use super::{PlaceId, TopologicalMap};
use crate::geom::Point2;
use crate::grid::GridShape;

/// The robot that a result is for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Robot {
    /// The distance that its center needs on all sides, in meters; 0 for a point.
    pub radius_m: f64,
    /// Its position, in meters in the map frame: places that it cannot reach from there are cut off. Without it,
    /// routes start from the largest part.
    pub from: Option<Point2>,
}

/// Largest radius of a robot, in meters.
pub const MAX_RADIUS_M: f64 = 10.0;

/// How good a graph is for a robot.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GraphCheck {
    /// The radius that routes keep, in meters; 0 for a point.
    pub radius_m: f64,
    /// Least distance of a route to a cell that is not free, in meters; absent if no place has a route.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub least_clearance_m: Option<f64>,
    /// Area of the reachable places, divided by the area of all places, 0 to 1.
    pub reached_share: f64,
    /// Pairs of places that routes join, divided by all pairs, 0 to 1.
    pub joined_share: f64,
    /// Connections without a route although their places touch: too narrow for the robot.
    pub n_blocked: usize,
}

/// Marks the places of `map` that cannot be reached along routes from the place at `from`, or the nearest one; without a point,
/// from the part with the largest area (ties: the one with the lowest number).
pub fn mark_cut_off(map: &mut TopologicalMap, shape: GridShape, from: Option<Point2>) {
    let parts = parts(map);
    let area =
        |part: &BTreeSet<PlaceId>| part.iter().filter_map(|&id| Some(map.place(id)?.area_m2)).sum::<f64>();
    let largest = || {
        let mut best: Option<(f64, usize)> = None;
        for (index, part) in parts.iter().enumerate() {
            if best.is_none_or(|(most, _)| area(part) > most) {
                best = Some((area(part), index));
            }
        }
        best.map(|(_, index)| index)
    };
    let at = |point: Point2| {
        let place = match PlaceIndex::new(map, shape).locate(point)? {
            Whereabouts::Inside { place, .. } => place,
            Whereabouts::Outside { nearest, .. } => nearest,
        };
        parts.iter().position(|part| part.contains(&place))
    };
    let Some(reached) = from.and_then(at).or_else(largest) else { return };
    for place in &mut map.places {
        place.cut_off = !parts[reached].contains(&place.id);
    }
}

/// The places that routes join, by part; parts in the order of their lowest number.
fn parts(map: &TopologicalMap) -> Vec<BTreeSet<PlaceId>> {
    let mut beside: BTreeMap<PlaceId, Vec<PlaceId>> = BTreeMap::new();
    for connection in map.connections.iter().filter(|connection| connection.route.is_some()) {
        beside.entry(connection.a).or_default().push(connection.b);
        beside.entry(connection.b).or_default().push(connection.a);
    }
    let mut seen = BTreeSet::new();
    let mut parts = Vec::new();
    for start in map.places.iter().map(|place| place.id) {
        if !seen.insert(start) {
            continue;
        }
        let mut part = BTreeSet::from([start]);
        let mut open = vec![start];
        while let Some(place) = open.pop() {
            for &next in beside.get(&place).into_iter().flatten() {
                if part.insert(next) {
                    open.push(next);
                }
            }
        }
        seen.extend(&part);
        parts.push(part);
    }
    parts
}

impl fmt::Display for GraphCheck {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { radius_m, least_clearance_m, reached_share, joined_share, n_blocked } = *self;
        write!(
            f,
            "the graph reaches {:.0} % of the area and joins {:.0} % of all pairs of places",
            100.0 * reached_share,
            100.0 * joined_share
        )?;
        if let Some(clearance_m) = least_clearance_m {
            write!(f, "; its routes keep {clearance_m:.2} m from walls at least")?;
        }
        if radius_m > 0.0 {
            write!(f, "; for a robot of {radius_m:.2} m radius, {n_blocked} passages are too narrow")?;
        }
        Ok(())
    }
}

impl GraphCheck {
    /// Checks `map`, whose routes keep `radius_m`.
    pub fn of(map: &TopologicalMap, radius_m: f64) -> Self {
        let clearances =
            map.connections.iter().filter_map(|connection| connection.route.as_ref()?.clearance_m);
        let area_of = |is_wanted: &dyn Fn(bool) -> bool| -> f64 {
            map.places.iter().filter(|place| is_wanted(place.cut_off)).map(|place| place.area_m2).sum()
        };
        let share = |part: f64, all: f64| if all > 0.0 { part / all } else { 1.0 };
        let pairs = |n: usize| (n * n.saturating_sub(1) / 2) as f64;
        let joined: f64 = parts(map).iter().map(|part| pairs(part.len())).sum();
        let is_blocked =
            |connection: &&super::Connection| connection.contact_m > 0.0 && connection.route.is_none();
        Self {
            radius_m,
            least_clearance_m: clearances.min_by(f64::total_cmp),
            reached_share: share(area_of(&|cut_off| !cut_off), area_of(&|_| true)),
            joined_share: share(joined, pairs(map.places.len())),
            n_blocked: map.connections.iter().filter(is_blocked).count(),
        }
    }
}

/// Remarks on a map that a robot cannot reach as a whole, in plain words; empty if it can.
pub fn remarks(map: &TopologicalMap, robot: &Robot) -> Vec<String> {
    let mut remarks = Vec::new();
    let cut_off: Vec<_> = map.places.iter().filter(|place| place.cut_off).collect();
    if !cut_off.is_empty() {
        let mut n_of: BTreeMap<&str, usize> = BTreeMap::new();
        for place in &cut_off {
            *n_of.entry(place.class.as_str()).or_default() += 1;
        }
        let classes: Vec<String> =
            n_of.iter().map(|(class, n)| format!("{n} {class}{}", if *n == 1 { "" } else { "s" })).collect();
        let area_m2: f64 = cut_off.iter().map(|place| place.area_m2).sum();
        let digits = usize::from(area_m2 < 10.0);
        let names: Vec<String> = cut_off.iter().map(|place| place.name.clone()).collect();
        let why = if robot.radius_m > 0.0 {
            "are doors shut, or too narrow for the robot?"
        } else {
            "are doors shut?"
        };
        let from = if robot.from.is_some() { "from where the robot is" } else { "from the largest part" };
        remarks.push(format!(
            "{}, {area_m2:.digits$} m², cannot be reached {from}: {why} They are left out of route graphs and closed in \
             keep-out masks: {}",
            classes.join(", "),
            super::query::listed(&names)
        ));
    }
    if robot.radius_m > 0.0 {
        let name = |id: PlaceId| map.place(id).map_or_else(|| id.0.to_string(), |place| place.name.clone());
        let blocked: Vec<String> = map
            .connections
            .iter()
            .filter(|connection| connection.contact_m > 0.0 && connection.route.is_none())
            .map(|connection| {
                let width =
                    map.width_m(connection).map_or_else(String::new, |width| format!(" ({width:.2} m wide)"));
                format!("{} to {}{width}", name(connection.a), name(connection.b))
            })
            .collect();
        if !blocked.is_empty() {
            remarks.push(format!(
                "too narrow for a robot of {:.2} m radius: {}",
                robot.radius_m,
                super::query::listed(&blocked)
            ));
        }
    }
    remarks
}
