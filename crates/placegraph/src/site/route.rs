//! Ways through a site: on foot or on wheels over the floors, by lift and by stairs between them.

use super::{Shaft, ShaftKind, SiteDocument, Stop};
use crate::geom::Point2;
use crate::topology::query::{Itinerary, RouteIndex};
use crate::topology::{PlaceId, PlaceRaster, TopologicalMap};

/// What a ride costs by its waiting, in meters of way: a lift is taken where it saves more. Its height is added.
pub const RIDE_M: f64 = 20.0;

/// A way through a site.
#[derive(Clone, Debug, PartialEq)]
pub struct SiteRoute {
    /// Its parts, in order.
    pub legs: Vec<Leg>,
}

/// A part of a way.
#[derive(Clone, Debug, PartialEq)]
pub enum Leg {
    /// Over a floor.
    Walk {
        /// Position of the level.
        level: usize,
        /// The way, in meters of the level's map frame.
        way: Itinerary,
    },
    /// Between floors.
    Ride {
        /// Position of the lift or the stairs.
        shaft: usize,
        /// Positions of the levels where it begins and ends.
        levels: [usize; 2],
    },
}

impl SiteRoute {
    /// Length of the way over floors, in meters.
    pub fn length_m(&self) -> f64 {
        let walks =
            self.legs.iter().map(|leg| if let Leg::Walk { way, .. } = leg { way.length_m } else { 0.0 });
        walks.sum()
    }
}

/// Where legs begin and end.
#[derive(Clone, Copy)]
struct Terminal<'a> {
    level: usize,
    place: PlaceId,
    /// The lift or the stairs, and where they can be entered; none at both ends of the way.
    stop: Option<(usize, &'a Stop)>,
}

impl Terminal<'_> {
    /// From the station of the place to the terminal.
    fn spur(&self) -> (f64, Vec<Point2>) {
        self.stop.map_or((0.0, Vec::new()), |(_, stop)| (stop.route.length_m, stop.route.line.clone()))
    }
}

/// Terminals and the floors between them.
struct Search<'a> {
    site: &'a SiteDocument,
    terminals: Vec<Terminal<'a>>,
    floors: &'a [RouteIndex<'a>],
}

impl SiteDocument {
    /// The shortest way between two places, each the position of its level and its number; `None` if there is none. Robots take lifts
    /// alone, others `stairs` too. Every ride costs [`RIDE_M`] (stairs do not) and its height. Ties go to the shaft that stands first.
    ///
    /// Cost: `O(s²)` for s stops, and a search over every floor that is crossed.
    pub fn route(&self, from: (usize, PlaceId), to: (usize, PlaceId), stairs: bool) -> Option<SiteRoute> {
        let maps: Vec<TopologicalMap> = self.levels.iter().map(super::Level::topology).collect();
        let floors: Vec<RouteIndex<'_>> = maps.iter().map(RouteIndex::new).collect();
        let end = |(level, place)| Terminal { level, place, stop: None };
        let shafts = self.shafts.iter().enumerate();
        let shafts = shafts.filter(|(_, shaft)| stairs || shaft.kind == ShaftKind::Lift);
        let stops = shafts.flat_map(|(index, shaft)| {
            shaft.stops.iter().filter_map(move |stop| {
                let level = self.level(&stop.level)?.0;
                Some(Terminal { level, place: stop.place, stop: Some((index, stop)) })
            })
        });
        let terminals = [end(from), end(to)].into_iter().chain(stops).collect();
        let search = Search { site: self, terminals, floors: &floors };
        let path = search.shortest()?;
        Some(SiteRoute { legs: search.legs(&path, &maps) })
    }
}

impl Search<'_> {
    /// The terminals on the shortest way from the first to the second [Dijkstra 1959].
    fn shortest(&self) -> Option<Vec<usize>> {
        let n = self.terminals.len();
        let mut cost = vec![f64::INFINITY; n];
        let mut before = vec![None; n];
        let mut is_done = vec![false; n];
        cost[0] = 0.0;
        loop {
            let open = (0..n).filter(|&index| !is_done[index] && cost[index] < f64::INFINITY);
            let here = open.min_by(|&a, &b| cost[a].total_cmp(&cost[b]))?;
            if here == 1 {
                break;
            }
            is_done[here] = true;
            for next in (0..n).filter(|&next| !is_done[next]).collect::<Vec<_>>() {
                let total = cost[here] + self.cost(here, next);
                if total < cost[next] {
                    (cost[next], before[next]) = (total, Some(here));
                }
            }
        }
        let mut path = vec![1];
        while let Some(last) = before[path[path.len() - 1]] {
            path.push(last);
        }
        path.reverse();
        Some(path)
    }

    /// What the leg between two terminals costs, in meters; infinite where there is none.
    fn cost(&self, from: usize, to: usize) -> f64 {
        let [a, b] = [from, to].map(|index| &self.terminals[index]);
        if let Some(shaft) = self.ride(a, b) {
            let [low, high] = [a, b].map(|end| self.site.levels[end.level].elevation_m);
            let waiting_m = if shaft.kind == ShaftKind::Lift { RIDE_M } else { 0.0 };
            return waiting_m + (high - low).abs();
        }
        if a.level != b.level {
            return f64::INFINITY;
        }
        let way = self.floors[a.level].route(a.place, b.place);
        way.map_or(f64::INFINITY, |way| a.spur().0 + way.length_m + b.spur().0)
    }

    /// The lift or the stairs that both terminals are stops of.
    fn ride(&self, a: &Terminal<'_>, b: &Terminal<'_>) -> Option<&Shaft> {
        let (index, other) = a.stop.zip(b.stop).map(|(a, b)| (a.0, b.0))?;
        (index == other && a.level != b.level).then(|| &self.site.shafts[index])
    }

    /// The legs between the terminals of `path`.
    fn legs(&self, path: &[usize], maps: &[TopologicalMap]) -> Vec<Leg> {
        let leg = |ends: &[usize]| {
            let [a, b] = [ends[0], ends[1]].map(|index| &self.terminals[index]);
            if self.ride(a, b).is_some() {
                return Some(Leg::Ride { shaft: a.stop?.0, levels: [a.level, b.level] });
            }
            let way = self.floors[a.level].route(a.place, b.place)?;
            let mut line = a.spur().1;
            line.reverse();
            line.extend(&way.line);
            line.extend(b.spur().1);
            line.dedup();
            let shape = self.site.levels[a.level].map.shape().ok()?;
            let way = Itinerary { line, ..way };
            Some(Leg::Walk {
                level: a.level,
                way: way.pulled_straight(&PlaceRaster::new(&maps[a.level], shape)),
            })
        };
        path.windows(2).filter_map(leg).collect()
    }
}
