//! Vertices, lanes and doors, as the navigation graph and the building file have them.

use std::collections::{BTreeMap, BTreeSet};

use super::{RmfLevel, RmfLift, RmfStop};
use crate::geom::Point2;
use crate::topology::{Connection, Place, PlaceId, PlaceRaster, TopologicalMap, segments_cross};

/// How far before and behind the door its vertices stand, in meters: the first that a straight lane through
/// free cells joins.
const DOOR_STANDOFFS_M: [f64; 5] = [0.8, 0.6, 0.4, 0.25, 0.1];

pub(super) struct Vertex<'a> {
    pub(super) at: Point2,
    pub(super) name: String,
    /// The lift that it is in the cabin of.
    pub(super) lift: Option<&'a str>,
}

impl Vertex<'_> {
    fn new(at: Point2, name: String) -> Self {
        Self { at, name, lift: None }
    }
}

/// A straight way, to be driven in both directions.
pub(super) struct Lane {
    pub(super) from: usize,
    pub(super) to: usize,
}

pub(super) struct Graph<'a> {
    pub(super) vertices: Vec<Vertex<'a>>,
    pub(super) lanes: Vec<Lane>,
    /// Name and jambs of the doors.
    pub(super) doors: Vec<(&'a str, [Point2; 2])>,
}

impl<'a> Graph<'a> {
    pub(super) fn new(
        map: &'a TopologicalMap,
        level: &RmfLevel<'_>,
        stops: &[(&'a RmfLift, &RmfStop)],
    ) -> Self {
        let raster = PlaceRaster::new(map, level.shape);
        let mut graph = Self { vertices: Vec::new(), lanes: Vec::new(), doors: Vec::new() };
        // Vertex where a connection's line meets a place: the place's own, or one before the door.
        let mut gate_of: BTreeMap<(PlaceId, PlaceId), usize> = BTreeMap::new();
        let mut standoff_of: BTreeMap<PlaceId, f64> = BTreeMap::new();
        let mut first_of: BTreeMap<PlaceId, usize> = BTreeMap::new();
        for place in &map.places {
            first_of.insert(place.id, graph.vertices.len());
            let gates = graph.add_place(map, place, &raster, &mut standoff_of);
            gate_of.extend(gates.into_iter().map(|(other, vertex)| ((place.id, other), vertex)));
        }
        let routes = map.connections.iter().filter_map(|connection| {
            let Connection { a, b, route, .. } = connection;
            Some(([(*a, *b), (*b, *a)], route.as_ref()?))
        });
        let shortcuts =
            map.shortcuts.iter().map(|way| ([(way.a, way.within), (way.b, way.within)], &way.route));
        for (ends, route) in routes.chain(shortcuts) {
            let [Some(&from), Some(&to)] = ends.map(|key| gate_of.get(&key)) else { continue };
            let cut = ends.map(|(id, _)| standoff_of.get(&id).copied().unwrap_or(0.0));
            graph.add_route(&route.line, cut, [from, to]);
        }
        for (lift, stop) in stops {
            if let Some(&first) = first_of.get(&stop.place) {
                graph.add_stop(lift, &stop.line, &level.name, first);
            }
        }
        let mut seen = BTreeSet::new();
        graph.lanes.retain(|lane| {
            lane.from != lane.to && seen.insert((lane.from.min(lane.to), lane.from.max(lane.to)))
        });
        graph
    }

    /// Adds the vertices of `place`; returns for every neighbor the vertex that leads to it.
    fn add_place(
        &mut self,
        map: &TopologicalMap,
        place: &'a Place,
        raster: &PlaceRaster,
        standoff_of: &mut BTreeMap<PlaceId, f64>,
    ) -> Vec<(PlaceId, usize)> {
        let lines: Vec<(PlaceId, Vec<Point2>)> = map
            .connections_of(place.id)
            .filter(|connection| connection.route.is_some())
            .map(|connection| (connection.other_end(place.id), connection.line_from(place.id)))
            .collect();
        let jambs = place.doorway.as_ref().filter(|_| lines.len() > 1).map(|doorway| doorway.jambs);
        let Some((jambs, standoff_m)) =
            jambs.and_then(|jambs| Some((jambs, standoff(&lines, jambs, raster)?)))
        else {
            self.vertices.push(Vertex::new(map.station(place), place.name.clone()));
            return lines.iter().map(|&(other, _)| (other, self.vertices.len() - 1)).collect();
        };
        standoff_of.insert(place.id, standoff_m);
        self.doors.push((&place.name, jambs));
        let first = self.vertices.len();
        for (side, (_, line)) in lines.iter().enumerate() {
            let name = format!("{}/{}", place.name, side + 1);
            self.vertices.push(Vertex::new(trimmed(line, standoff_m)[0], name));
        }
        for from in first..self.vertices.len() {
            let others = from + 1..self.vertices.len();
            self.lanes.extend(others.map(|to| Lane { from, to }));
        }
        lines.iter().enumerate().map(|(side, &(other, _))| (other, first + side)).collect()
    }

    /// Adds the bends of a route and the lanes between them; `cut` meters at its ends belong to doors.
    fn add_route(&mut self, line: &[Point2], cut: [f64; 2], gates: [usize; 2]) {
        let backwards: Vec<Point2> = line.iter().rev().copied().collect();
        let mut line = trimmed(&backwards, cut[1]);
        line.reverse();
        let line = trimmed(&line, cut[0]);
        let mut last = gates[0];
        for &at in &line[1..line.len().max(2) - 1] {
            self.vertices.push(Vertex::new(at, String::new()));
            self.lanes.push(Lane { from: last, to: self.vertices.len() - 1 });
            last = self.vertices.len() - 1;
        }
        self.lanes.push(Lane { from: last, to: gates[1] });
    }

    /// Adds the vertex in the cabin of `lift` and the way to it from the vertex `first` of the place. That of a doorway stands
    /// before its door: the way leads over the station.
    fn add_stop(&mut self, lift: &'a RmfLift, line: &[Point2], level: &str, first: usize) {
        let Some(&at) = line.last() else { return };
        let from = self.vertices[first].at;
        let before = (line[0] != from).then_some(from);
        let line: Vec<Point2> = before.into_iter().chain(line.iter().copied()).collect();
        let name = format!("{} {level}", lift.name);
        self.vertices.push(Vertex { at, name, lift: Some(&lift.name) });
        self.add_route(&line, [0.0; 2], [first, self.vertices.len() - 1]);
    }

    /// The door that `lane` crosses.
    pub(super) fn door_on(&self, lane: &Lane) -> Option<&'a str> {
        let [from, to] = [lane.from, lane.to].map(|index| self.vertices[index].at);
        let crossed = |(_, [a, b]): &&(&str, [Point2; 2])| segments_cross(*a, *b, from, to);
        self.doors.iter().find(crossed).map(|&(name, _)| name)
    }
}

/// The first distance from the door at which straight lanes between all its sides run through free cells and one of them crosses
/// the line between the `jambs`, at most half of the shortest line. `None` if there is none.
fn standoff(lines: &[(PlaceId, Vec<Point2>)], jambs: [Point2; 2], raster: &PlaceRaster) -> Option<f64> {
    let shortest = lines.iter().map(|(_, line)| length(line)).min_by(f64::total_cmp)?;
    DOOR_STANDOFFS_M.into_iter().filter(|&standoff_m| standoff_m <= 0.5 * shortest).find(|&standoff_m| {
        let gates: Vec<Point2> = lines.iter().map(|(_, line)| trimmed(line, standoff_m)[0]).collect();
        let lanes =
            || gates.iter().enumerate().flat_map(|(i, &a)| gates[i + 1..].iter().map(move |&b| (a, b)));
        lanes().all(|(a, b)| raster.is_free_between(a, b))
            && lanes().any(|(a, b)| segments_cross(jambs[0], jambs[1], a, b))
    })
}

fn length(line: &[Point2]) -> f64 {
    line.windows(2).map(|ends| ends[0].distance(ends[1])).sum()
}

/// The rest of `line` after its first `cut_m` meters; at least its last point.
fn trimmed(line: &[Point2], cut_m: f64) -> Vec<Point2> {
    let mut left = cut_m;
    for (index, ends) in line.windows(2).enumerate() {
        let leg = ends[0].distance(ends[1]);
        if left < leg {
            let start = ends[0] + (ends[1] - ends[0]) * (left / leg);
            return std::iter::once(start).chain(line[index + 1..].iter().copied()).collect();
        }
        left -= leg;
    }
    line.last().copied().into_iter().collect()
}
