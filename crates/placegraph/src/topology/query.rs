//! Questions to a topological map: which place is here, what is it called, how does one get there.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use rstar::primitives::{GeomWithData, Line};
use rstar::{PointDistance, RTree};

use super::{Connection, Place, PlaceId, PlaceRaster, TopologicalMap};
use crate::geom::Point2;
use crate::grid::GridShape;

/// One side of an outline and the place that it bounds.
type Border = GeomWithData<Line<[f64; 2]>, PlaceId>;

/// Answers [`PlaceIndex::locate`] in about a microsecond. Building it costs `O(e log e)` for e sides of outlines.
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
    /// In no place: on a wall, in unknown space or outside of the map.
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
            let rings =
                place.outline.iter().flat_map(|part| std::iter::once(&part.exterior).chain(&part.holes));
            rings.map(|ring| (place.id, ring))
        });
        let borders = rings.flat_map(|(id, ring)| {
            let next = ring.iter().cycle().skip(1);
            ring.iter().zip(next).map(move |(a, b)| Border::new(Line::new([a.x, a.y], [b.x, b.y]), id))
        });
        Self { raster: PlaceRaster::new(map, shape), borders: RTree::bulk_load(borders.collect()) }
    }

    /// Where `point` of the map frame lies; `None` only for a map without places. A point on the border of two
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

/// The place that people call `text`: its name, or its number.
pub fn find_place<'a>(map: &'a TopologicalMap, text: &str) -> Option<&'a Place> {
    let named = map.places.iter().find(|place| place.name == text);
    named.or_else(|| map.place(PlaceId(text.parse().ok()?)))
}

/// A way through the map.
#[derive(Clone, Debug, PartialEq)]
pub struct Itinerary {
    /// The places and doorways on the way, from the first to the last.
    pub places: Vec<PlaceId>,
    /// Length of the way, in meters.
    pub length_m: f64,
    /// Its corners, from the first place's station to the last one's.
    pub line: Vec<Point2>,
}

impl Itinerary {
    /// The same way with its detours to the stations it passes cut off, as far as straight lines through the
    /// cells of `raster` allow.
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

/// A queue entry: length so far, as bits of a non-negative number (which order like the number), and place.
type Reached = Reverse<(u64, PlaceId)>;

/// The shortest way from one place to another along the routes of the connections, or `None` if there is none.
///
/// Cost: `O(m log m)` for m connections. Ties go to the place with the lower number.
pub fn find_route(map: &TopologicalMap, from: PlaceId, to: PlaceId) -> Option<Itinerary> {
    map.place(from).zip(map.place(to))?;
    let mut steps: BTreeMap<PlaceId, Vec<&Connection>> = BTreeMap::new();
    for connection in map.connections.iter().filter(|connection| connection.route.is_some()) {
        for end in [connection.a, connection.b] {
            steps.entry(end).or_default().push(connection);
        }
    }
    let mut best: BTreeMap<PlaceId, (f64, Option<&Connection>)> = BTreeMap::from([(from, (0.0, None))]);
    let mut queue: BinaryHeap<Reached> = BinaryHeap::from([Reverse((0, from))]);
    while let Some(Reverse((bits, here))) = queue.pop() {
        if here == to {
            return Some(itinerary(&best, from, to));
        }
        if bits > best[&here].0.to_bits() {
            continue;
        }
        for &connection in steps.get(&here).into_iter().flatten() {
            let there = connection.other_end(here);
            let length = best[&here].0 + connection.route.as_ref().map_or(0.0, |route| route.length_m);
            if best.get(&there).is_none_or(|&(known, _)| length < known) {
                best.insert(there, (length, Some(connection)));
                queue.push(Reverse((length.to_bits(), there)));
            }
        }
    }
    None
}

/// Walks back from `to` along the connections it was reached by.
fn itinerary(best: &BTreeMap<PlaceId, (f64, Option<&Connection>)>, from: PlaceId, to: PlaceId) -> Itinerary {
    let mut places = vec![to];
    let mut line: Vec<Point2> = Vec::new();
    let mut here = to;
    while let Some(&(_, Some(connection))) = best.get(&here) {
        let back = connection.line_from(here);
        // The lines share their ends.
        line.extend(back.into_iter().skip(usize::from(!line.is_empty())));
        here = connection.other_end(here);
        places.push(here);
    }
    debug_assert_eq!(here, from, "ways lead back to where they began");
    places.reverse();
    line.reverse();
    Itinerary { places, length_m: best[&to].0, line }
}
