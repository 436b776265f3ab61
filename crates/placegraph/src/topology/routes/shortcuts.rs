//! Ways between the doors of one place that do not pass its station.
//!
//! The cells of a place belong to the door that is nearest by the cost of the way. Doors whose cells meet are neighbors (the
//! dual of this Voronoi diagram is the Delaunay graph of the doors, whose ways are never more than twice as long as those of
//! all pairs in the plane). Where the way from one to the other is clearly shorter than that over the station, it is kept.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU16, Ordering};

use rayon::prelude::*;

use super::{FreeSpace, Portals, Queue, UNREACHED, Walks, region_of};
use crate::regions::RegionId;
use crate::topology::{PlaceId, Shortcut, TopologicalMap};

/// A way is kept if it is at most this share of the way over the station.
const SHORTER: f64 = 0.9;

/// A door of a place: the connection through it.
struct Gate {
    doorway: PlaceId,
    /// The nodes on the side of the place and on that of the doorway.
    nodes: [usize; 2],
    /// Length of the route to the place's station, in meters.
    to_station_m: f64,
}

/// No door was nearest.
const NO_GATE: u16 = u16::MAX;

/// The shortcuts of all places, by place, and by the doors at their ends.
pub(super) fn lay(
    map: &TopologicalMap,
    walks: Walks<'_>,
    portals: &Portals<RegionId>,
    space: &FreeSpace,
) -> Vec<Shortcut> {
    let gates = gates(map, portals);
    let walks = restarted(walks, &gates);
    let nearest: Vec<AtomicU16> = (0..walks.graph.n_nodes()).map(|_| AtomicU16::new(NO_GATE)).collect();
    gates.par_iter().for_each_init(Queue::new, |queue, (&place, gates)| {
        let sources: Vec<usize> = gates.iter().map(|gate| gate.nodes[0]).collect();
        for (number, &source) in (0..).zip(&sources) {
            nearest[source].store(number, Ordering::Relaxed);
        }
        walks.search(queue, region_of(place), &sources, |next, node| {
            nearest[next].store(nearest[node].load(Ordering::Relaxed), Ordering::Relaxed);
        });
    });
    let crossings = walks.crossings(|nodes| {
        let [here, there] =
            nodes.map(|node| (walks.regions.region_of[node], nearest[node].load(Ordering::Relaxed)));
        (here.0 == there.0).then_some([here, there])
    });
    crossings
        .par_iter()
        .filter_map(|(&((region, a), (_, b)), portal)| {
            let within = PlaceId(region.0 + 1);
            let gates = gates.get(&within)?;
            let [a, b] = [gates.get(usize::from(a))?, gates.get(usize::from(b))?];
            let mut path = walks.way_back(a.nodes[1]);
            path.reverse();
            path.extend(walks.path_through(portal.nodes));
            path.extend(walks.way_back(b.nodes[1]));
            let route = walks.route(&path, &[region_of(a.doorway), region, region_of(b.doorway)], space);
            let is_shorter = route.length_m <= SHORTER * (a.to_station_m + b.to_station_m);
            is_shorter.then_some(Shortcut { within, a: a.doorway, b: b.doorway, route })
        })
        .collect()
}

/// The doors of every place that has two or more, by number.
fn gates(map: &TopologicalMap, portals: &Portals<RegionId>) -> BTreeMap<PlaceId, Vec<Gate>> {
    let is_doorway = |id: PlaceId| map.place(id).is_some_and(|place| place.doorway.is_some());
    let mut gates: BTreeMap<PlaceId, Vec<Gate>> = BTreeMap::new();
    for connection in &map.connections {
        let (Some(route), Some(portal)) =
            (&connection.route, portals.get(&(region_of(connection.a), region_of(connection.b))))
        else {
            continue;
        };
        let [a, b] = portal.nodes;
        let sides = [(connection.a, connection.b, [a, b]), (connection.b, connection.a, [b, a])];
        for (place, doorway, nodes) in
            sides.into_iter().filter(|side| !is_doorway(side.0) && is_doorway(side.1))
        {
            gates.entry(place).or_default().push(Gate { doorway, nodes, to_station_m: route.length_m });
        }
    }
    gates.retain(|_, gates| (2..usize::from(NO_GATE)).contains(&gates.len()));
    for gates in gates.values_mut() {
        gates.sort_by_key(|gate| gate.doorway);
    }
    gates
}

/// `walks` with the places of `gates` unreached; doorways keep the ways to their stations.
fn restarted<'a>(mut walks: Walks<'a>, gates: &BTreeMap<PlaceId, Vec<Gate>>) -> Walks<'a> {
    let regions = walks.regions;
    walks.cost.par_iter_mut().zip(&regions.region_of).for_each(|(cost, region)| {
        if gates.contains_key(&PlaceId(region.0 + 1)) {
            *cost.get_mut() = UNREACHED;
        }
    });
    walks
}
