//! The result: places with their geometry, and the connections between them. Everything is in meters in the map
//! frame, and is serialized as `places` and `connections` of `topology.json`.

use serde::{Deserialize, Serialize};

use crate::geom::{EllipseAxes, Point2};
use crate::labels::Role;
use crate::regions::RegionId;

/// Number of a place: its region's value in the region image, from 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(transparent)]
pub struct PlaceId(pub u32);

impl PlaceId {
    /// The largest number of a place: a region image has 16 bits per pixel.
    pub const MAX: Self = Self(u16::MAX as u32);
}

/// An outline: the exterior ring counter-clockwise, holes clockwise, no ring repeats its first point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PolygonWithHoles {
    /// The outer ring.
    pub exterior: Vec<Point2>,
    /// The rings of everything that the region surrounds.
    pub holes: Vec<Vec<Point2>>,
}

impl PolygonWithHoles {
    /// Its rings, the outer one first.
    pub fn rings(&self) -> impl Iterator<Item = &Vec<Point2>> {
        std::iter::once(&self.exterior).chain(&self.holes)
    }
}

/// The members that only a doorway has.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Doorway {
    /// Clear width of the opening, in meters.
    pub width_m: f64,
    /// The points where the narrowest line across the opening meets the walls.
    pub jambs: [Point2; 2],
    /// The places on its two sides, largest contact first; a doorway at the edge of the explored area has
    /// fewer than two.
    pub sides: Vec<PlaceId>,
}

/// A vertex of the topological map: one region.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Place {
    /// Unique number, from 1.
    pub id: PlaceId,
    /// Name for people, unique; by default class and number.
    pub name: String,
    /// Name of its class.
    pub class: String,
    /// Role of its class.
    pub role: Role,
    /// Mean probability of its class over its cells.
    pub probability: f64,
    /// Number of its cells.
    pub n_cells: u32,
    /// Area of its cells, in square meters.
    pub area_m2: f64,
    /// Mean of its cells' centers; may lie outside of a bent place.
    pub centroid: Point2,
    /// Axes of its cells' second moments.
    pub axes: EllipseAxes,
    /// Center of its cell with the largest clearance: always inside.
    pub anchor: Point2,
    /// Distance from the anchor to the nearest cell outside of this place, in meters.
    pub clearance_m: f64,
    /// Outline along the sides of the cells. There is more than one polygon if cells touch only at a corner.
    pub outline: Vec<PolygonWithHoles>,
    /// Only for the role doorway.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub doorway: Option<Doorway>,
    /// Whether no route leads there from the position of the robot ([`reach`](super::reach)).
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub cut_off: bool,
}

impl Place {
    /// The rings of all parts of its outline.
    pub fn rings(&self) -> impl Iterator<Item = &Vec<Point2>> {
        self.outline.iter().flat_map(PolygonWithHoles::rings)
    }

    /// The outer ring of the largest part, for formats that have room for one.
    pub fn largest_exterior(&self) -> &[Point2] {
        let rings = self.outline.iter().map(|part| part.exterior.as_slice());
        rings.max_by(|a, b| ring_area(a).total_cmp(&ring_area(b))).unwrap_or_default()
    }
}

/// The area within a ring, positive counter-clockwise.
fn ring_area(ring: &[Point2]) -> f64 {
    let next = ring.iter().cycle().skip(1);
    0.5 * ring.iter().zip(next).map(|(a, b)| a.x * b.y - b.x * a.y).sum::<f64>()
}

/// An edge of the topological map: two places that touch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Connection {
    /// The place with the lower number.
    pub a: PlaceId,
    /// The place with the higher number.
    pub b: PlaceId,
    /// Number of pairs of cells that share a side, times the resolution: length of the common border.
    pub contact_m: f64,
    /// The point of the common border nearest to its mean.
    pub middle: Point2,
    /// The route between the two places; absent if there is none, or if it was not computed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub route: Option<Route>,
}

/// A route through free cells from the station of one place to that of another. The station of a doorway is its
/// center, the station of any other place its anchor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Route {
    /// Length of the line, in meters.
    pub length_m: f64,
    /// Corners of the line, from the station of `a` to that of `b`; every cell it touches is free.
    pub line: Vec<Point2>,
    /// Distance from the line to the nearest cell that is not free, in meters, at most half a meter or the robot's
    /// radius, where the search ends. Absent if it was not computed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clearance_m: Option<f64>,
}

impl Route {
    /// The route along `line`.
    pub fn along(line: Vec<Point2>) -> Self {
        let length_m = line.windows(2).map(|ends| ends[0].distance(ends[1])).sum();
        Self { length_m, line, clearance_m: None }
    }

    /// The same route in the other direction.
    pub fn reversed(&self) -> Self {
        Self { line: self.line.iter().rev().copied().collect(), ..*self }
    }
}

/// A way between two doors of a place that does not pass the place's station. Only ways clearly shorter than that over the
/// station are kept, and only between doors that no third one parts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shortcut {
    /// The place that both doors lead into.
    pub within: PlaceId,
    /// The doorway with the lower number.
    pub a: PlaceId,
    /// The doorway with the higher number.
    pub b: PlaceId,
    /// From the station of `a` to that of `b`.
    pub route: Route,
}

impl Connection {
    /// The end that is not `place`.
    pub fn other_end(&self, place: PlaceId) -> PlaceId {
        if self.a == place { self.b } else { self.a }
    }

    /// The line of the route, starting at `place`; empty without a route.
    pub fn line_from(&self, place: PlaceId) -> Vec<Point2> {
        match &self.route {
            Some(route) if place == self.a => route.line.clone(),
            Some(route) => route.reversed().line,
            None => Vec::new(),
        }
    }
}

/// Places and the connections between them. The ends of connections exist, each pair occurs once, and `a < b`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TopologicalMap {
    /// The vertices, by number.
    pub places: Vec<Place>,
    /// The edges, by their ends.
    pub connections: Vec<Connection>,
    /// Further ways between doors, by place and ends.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub shortcuts: Vec<Shortcut>,
    /// The last number given, here or in an earlier result whose numbers are kept; the next new place gets the number
    /// after it ([`super::identity`]).
    #[serde(default)]
    pub last_id: PlaceId,
}

impl TopologicalMap {
    /// The place numbered `id`.
    pub fn place(&self, id: PlaceId) -> Option<&Place> {
        self.places.binary_search_by_key(&id, |place| place.id).ok().map(|index| &self.places[index])
    }

    /// The point where routes enter and leave `place`: the end of its routes, or its anchor if it has none.
    pub fn station(&self, place: &Place) -> Point2 {
        let line = self.connections_of(place.id).find_map(|connection| {
            let line = &connection.route.as_ref()?.line;
            if connection.a == place.id { line.first() } else { line.last() }.copied()
        });
        line.unwrap_or(place.anchor)
    }

    /// The width of the narrower doorway at the ends of `connection`, if there is one.
    pub fn width_m(&self, connection: &Connection) -> Option<f64> {
        let places = [connection.a, connection.b].into_iter().filter_map(|id| self.place(id));
        places.filter_map(|place| Some(place.doorway.as_ref()?.width_m)).min_by(f64::total_cmp)
    }

    /// The places that are not cut off, and the connections between them.
    pub fn reached(&self) -> Self {
        let is_cut_off = |id: PlaceId| self.place(id).is_some_and(|place| place.cut_off);
        let places = self.places.iter().filter(|place| !place.cut_off).map(|place| {
            let mut place = place.clone();
            if let Some(doorway) = &mut place.doorway {
                doorway.sides.retain(|&side| !is_cut_off(side));
            }
            place
        });
        let both = |connection: &&Connection| !is_cut_off(connection.a) && !is_cut_off(connection.b);
        Self {
            places: places.collect(),
            connections: self.connections.iter().filter(both).cloned().collect(),
            shortcuts: self.shortcuts.iter().filter(|way| !is_cut_off(way.within)).cloned().collect(),
            last_id: self.last_id,
        }
    }

    /// The map, built of regions, without the places of those for which `is_none` holds.
    pub(crate) fn without(mut self, is_none: impl Fn(RegionId) -> bool) -> Self {
        let is_left = |place: PlaceId| !is_none(RegionId(place.0 - 1));
        self.places.retain(|place| is_left(place.id));
        self.connections.retain(|connection| is_left(connection.a) && is_left(connection.b));
        self.shortcuts.retain(|way| [way.within, way.a, way.b].into_iter().all(&is_left));
        for doorway in self.places.iter_mut().filter_map(|place| place.doorway.as_mut()) {
            doorway.sides.retain(|&side| is_left(side));
        }
        self
    }

    /// The connections of the place numbered `id`.
    pub fn connections_of(&self, id: PlaceId) -> impl Iterator<Item = &Connection> {
        self.connections.iter().filter(move |connection| connection.a == id || connection.b == id)
    }
}
