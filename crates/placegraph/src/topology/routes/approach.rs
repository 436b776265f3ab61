//! The ways from the stations of places to points of their own: lifts, stairs.

use super::{UNREACHED, Walks, node_near};
use crate::geom::Point2;
use crate::grid::FreeSpace;
use crate::regions::{RegionId, RegionMap};
use crate::topology::{PlaceId, Route, TopologicalMap, all_touched};

/// How a point is reached.
#[derive(Clone, Debug, PartialEq)]
pub enum Approach {
    /// From the station of the place that contains it.
    From {
        /// The place.
        place: PlaceId,
        /// From the place's station to the point.
        route: Route,
    },
    /// The point is not in a free cell.
    NotFree,
    /// Its cell belongs to no place.
    NoPlace,
    /// The robot does not fit between the station and the point.
    TooNarrow {
        /// The place that contains the point.
        place: PlaceId,
    },
}

/// How each of `points` is reached from the station of its place, by a robot that needs `radius_m` meters on all sides. `place_ids`
/// has the number of every region's place.
///
/// Cost: that of [`lay_routes`](super::lay_routes).
pub fn approaches(
    map: &TopologicalMap,
    space: &FreeSpace,
    regions: &RegionMap,
    place_ids: &[Option<PlaceId>],
    radius_m: f64,
    points: &[Point2],
) -> Vec<Approach> {
    let station = |id: &Option<PlaceId>| {
        let place = map.place((*id)?)?;
        node_near(space, map.station(place))
    };
    // The search of a region begins at no other region's node, so any node stands for a station that is not there.
    let stations = place_ids.iter().map(|id| station(id).unwrap_or_default()).collect();
    let walks = Walks::from_stations(stations, space, regions, radius_m);
    let approach = |&point: &Point2| {
        let Some(node) = node_near(space, point) else { return Approach::NotFree };
        let region = regions.region_of[node];
        let Some(place) = place_ids[region.index()] else { return Approach::NoPlace };
        if walks.cost_of(node) == UNREACHED {
            return Approach::TooNarrow { place };
        }
        let mut path = walks.way_back(node);
        path.reverse();
        let mut route = walks.route(&path, &[region], space);
        // To the point itself, not to the middle of its cell.
        if route.line.last().is_some_and(|&end| end != point) {
            let mut line = route.line;
            if let [.., before, _] = line.as_slice()
                && walks.is_open(region, space, *before, point)
            {
                line.pop();
            }
            line.push(point);
            route = Route { clearance_m: route.clearance_m, ..Route::along(line) };
        }
        Approach::From { place, route }
    };
    points.iter().map(approach).collect()
}

impl Walks<'_> {
    /// Whether the robot gets straight from one point of the map frame to the other within `region`.
    fn is_open(&self, region: RegionId, space: &FreeSpace, from: Point2, to: Point2) -> bool {
        let [from, to] = [from, to].map(|point| space.frame.cells_from_map(point));
        all_touched(from, to, |x, y| self.node_in(&[region], x, y).is_some()) && self.keeps_radius(from, to)
    }
}
