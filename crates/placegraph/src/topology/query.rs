//! Queries of a topological map: the place at a point, a place by name, the route between two places.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::sync::OnceLock;

use rstar::primitives::{GeomWithData, Line};
use rstar::{PointDistance, RTree};

use super::{Connection, Place, PlaceId, PlaceRaster, Route, TopologicalMap};
use crate::geom::Point2;
use crate::grid::GridShape;
use crate::labels::Role;

/// One side of an outline and the place that it bounds.
type Border = GeomWithData<Line<[f64; 2]>, PlaceId>;

/// An index that finds the place at a point in about a microsecond ([`PlaceIndex::locate`]). Building it costs `O(e
/// log e)` for e sides of outlines.
#[derive(Clone, Debug)]
pub struct PlaceIndex {
    raster: PlaceRaster,
    borders: RTree<Border>,
}

/// Where a point lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Whereabouts {
    /// In a place.
    Inside {
        /// The place.
        place: PlaceId,
        /// Distance to its border, in meters.
        border_m: f64,
    },
    /// Outside of all places: on a wall, in unknown space or outside of the map.
    Outside {
        /// The place nearest to the point.
        nearest: PlaceId,
        /// Distance to it, in meters.
        distance_m: f64,
    },
}

impl PlaceIndex {
    /// The index of `map`, whose outlines run along the cells of `shape`.
    pub fn new(map: &TopologicalMap, shape: GridShape) -> Self {
        let rings = map.places.iter().flat_map(|place| {
            let rings = place.rings();
            rings.map(|ring| (place.id, ring))
        });
        let borders = rings.flat_map(|(id, ring)| {
            let next = ring.iter().cycle().skip(1);
            ring.iter().zip(next).map(move |(a, b)| Border::new(Line::new([a.x, a.y], [b.x, b.y]), id))
        });
        Self { raster: PlaceRaster::new(map, shape), borders: RTree::bulk_load(borders.collect()) }
    }

    /// The location of `point` in the map frame; `None` only for a map without places. A point on the border of two
    /// places belongs to the cell to its upper right.
    pub fn locate(&self, point: Point2) -> Option<Whereabouts> {
        let at = [point.x, point.y];
        let border = self.borders.nearest_neighbor(at)?;
        let distance = border.distance_2(&at).sqrt();
        // Any way out of a place meets its own border first, so the nearest border is its own.
        Some(match self.raster.place_at(point) {
            Some(place) => Whereabouts::Inside { place, border_m: distance },
            None => Whereabouts::Outside { nearest: border.data, distance_m: distance },
        })
    }
}

/// No place has this name or number.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected the name or the number of a place, found {found:?}; there are {}", listed(known))]
pub struct UnknownPlace {
    /// The name or number that was looked up.
    pub found: String,
    /// The existing names, those that begin like it first.
    pub known: Vec<String>,
}

impl UnknownPlace {
    /// The error for a name `found` that is not among `known`.
    pub fn new(found: &str, mut known: Vec<String>) -> Self {
        known.sort_by_cached_key(|name| (Reverse(common_beginning(name, found)), name_and_number(name)));
        Self { found: found.to_owned(), known }
    }
}

/// A name without the number at its end, and the number: "room 9" comes before "room 10".
fn name_and_number(name: &str) -> (String, u64) {
    let base = name.trim_end_matches(|c: char| c.is_ascii_digit());
    (base.to_owned(), name[base.len()..].parse().unwrap_or(0))
}

/// Number of characters in which two texts begin alike, without regard to case.
fn common_beginning(a: &str, b: &str) -> usize {
    let [a, b] = [a, b].map(|text| text.to_lowercase().chars().collect::<Vec<_>>());
    a.iter().zip(&b).take_while(|(a, b)| a == b).count()
}

/// The first dozen names, and how many more there are.
pub(crate) fn listed(names: &[String]) -> String {
    const SHOWN: usize = 12;
    match names.len() {
        0 => "none".to_owned(),
        n if n <= SHOWN => names.join(", "),
        n => format!("{} and {} more", names[..SHOWN].join(", "), n - SHOWN),
    }
}

/// The place with the name or number `text`.
pub fn find_place<'a>(map: &'a TopologicalMap, text: &str) -> Option<&'a Place> {
    let named = map.places.iter().find(|place| place.name == text);
    named.or_else(|| map.place(PlaceId(text.parse().ok()?)))
}

/// [`find_place`], or an error with the existing names.
///
/// # Errors
/// If no place has this name or number.
pub fn place_called<'a>(map: &'a TopologicalMap, text: &str) -> Result<&'a Place, UnknownPlace> {
    let names = || map.places.iter().map(|place| place.name.clone()).collect();
    find_place(map, text).ok_or_else(|| UnknownPlace::new(text, names()))
}

/// A route through the map.
#[derive(Clone, Debug, PartialEq)]
pub struct Itinerary {
    /// The places and doorways on the route, from the first to the last.
    pub places: Vec<PlaceId>,
    /// Length of the route, in meters.
    pub length_m: f64,
    /// Its corners, from the first place's station to the last one's.
    pub line: Vec<Point2>,
}

impl Itinerary {
    /// The same route without its detours to the stations that it passes, where straight lines through the cells of
    /// `raster` allow.
    pub fn pulled_straight(&self, raster: &PlaceRaster) -> Self {
        let mut line: Vec<Point2> = self.line.first().copied().into_iter().collect();
        let mut corner = 0;
        while corner + 1 < self.line.len() {
            let visible = |&to: &usize| raster.is_free_between(self.line[corner], self.line[to]);
            corner = (corner + 2..self.line.len()).rev().find(visible).unwrap_or(corner + 1);
            line.push(self.line[corner]);
        }
        let length_m = line.windows(2).map(|ends| ends[0].distance(ends[1])).sum();
        Self { places: self.places.clone(), length_m, line }
    }
}

/// An index that finds routes ([`RouteIndex::route`]): the first query from a place costs a search over the map,
/// every other one only the steps of its answer, about a microsecond.
///
/// Building it costs `O(m)` for m connections; every place that was asked from adds 24 bytes a place.
#[derive(Debug)]
pub struct RouteIndex<'a> {
    map: &'a TopologicalMap,
    /// The ways from every place.
    steps: Vec<Vec<Step<'a>>>,
    /// The shortest routes from every place to all others, filled in at the first query.
    ways_from: Vec<OnceLock<Vec<Reached<'a>>>>,
}

/// A way from one place to another.
#[derive(Clone, Copy, Debug)]
struct Step<'a> {
    /// The position of the place that it leads to.
    to: usize,
    /// The place that it leads through, if that is neither.
    within: Option<PlaceId>,
    route: &'a Route,
    is_forward: bool,
}

impl Step<'_> {
    /// The corners on the way back.
    fn back(&self) -> Vec<Point2> {
        if self.is_forward { self.route.reversed().line } else { self.route.line.clone() }
    }
}

/// How a place is reached: how far it is, from which place and by which way. Infinitely far if it is not.
#[derive(Clone, Copy, Debug)]
struct Reached<'a> {
    length_m: f64,
    last: Option<(usize, Step<'a>)>,
}

impl<'a> RouteIndex<'a> {
    /// The index of `map`.
    pub fn new(map: &'a TopologicalMap) -> Self {
        let mut steps = vec![Vec::new(); map.places.len()];
        let routes = map.connections.iter().filter_map(|connection| {
            let Connection { a, b, route, .. } = connection;
            Some(([*a, *b], None, route.as_ref()?))
        });
        let shortcuts = map.shortcuts.iter().map(|way| ([way.a, way.b], Some(way.within), &way.route));
        for (ends, within, route) in routes.chain(shortcuts) {
            if let [Some(a), Some(b)] = ends.map(|end| position(map, end)) {
                steps[a].push(Step { to: b, within, route, is_forward: true });
                steps[b].push(Step { to: a, within, route, is_forward: false });
            }
        }
        let ways_from = map.places.iter().map(|_| OnceLock::new()).collect();
        Self { map, steps, ways_from }
    }

    /// The shortest route from one place to another along the routes of the connections, or `None` if there is none.
    /// Ties go to the route through the lower-numbered place.
    pub fn route(&self, from: PlaceId, to: PlaceId) -> Option<Itinerary> {
        let (from, to) = position(self.map, from).zip(position(self.map, to))?;
        let ways = self.ways_from[from].get_or_init(|| self.search(from));
        let mut places = vec![self.map.places[to].id];
        let mut line: Vec<Point2> = Vec::new();
        let mut here = to;
        while let Some((before, step)) = ways[here].last {
            // The lines share their ends.
            line.extend(step.back().into_iter().skip(usize::from(!line.is_empty())));
            here = before;
            places.extend(step.within);
            places.push(self.map.places[here].id);
        }
        places.reverse();
        line.reverse();
        let places = self.without_passed(places);
        (here == from).then_some(Itinerary { places, length_m: ways[to].length_m, line })
    }

    /// `places` without the doorways that the way only passes: it comes from the place that it goes on in.
    fn without_passed(&self, places: Vec<PlaceId>) -> Vec<PlaceId> {
        let is_doorway = |id| self.map.place(id).is_some_and(|place| place.role == Role::Doorway);
        let mut kept: Vec<PlaceId> = Vec::with_capacity(places.len());
        for id in places {
            match kept[..] {
                [.., before, passed] if before == id && is_doorway(passed) => kept.truncate(kept.len() - 1),
                _ => kept.push(id),
            }
        }
        kept
    }

    /// Dijkstra's search from the place at `from`. Cost: `O(m log m)` for m connections.
    fn search(&self, from: usize) -> Vec<Reached<'a>> {
        let mut ways = vec![Reached { length_m: f64::INFINITY, last: None }; self.steps.len()];
        ways[from].length_m = 0.0;
        // Lengths as bits: those of non-negative numbers order like the numbers.
        let mut queue = BinaryHeap::from([Reverse((0, from))]);
        while let Some(Reverse((bits, here))) = queue.pop() {
            if bits > ways[here].length_m.to_bits() {
                continue;
            }
            for &step in &self.steps[here] {
                let length_m = ways[here].length_m + step.route.length_m;
                if length_m < ways[step.to].length_m {
                    ways[step.to] = Reached { length_m, last: Some((here, step)) };
                    queue.push(Reverse((length_m.to_bits(), step.to)));
                }
            }
        }
        ways
    }
}

/// Where the place numbered `id` stands in the map.
fn position(map: &TopologicalMap, id: PlaceId) -> Option<usize> {
    map.places.binary_search_by_key(&id, |place| place.id).ok()
}

/// One result of [`RouteIndex::route`], for a single query.
pub fn find_route(map: &TopologicalMap, from: PlaceId, to: PlaceId) -> Option<Itinerary> {
    RouteIndex::new(map).route(from, to)
}
