//! Which place is here, and how does one get there.

use crate::building;
use std::collections::BTreeMap;
use std::sync::LazyLock;

use petgraph::graph::UnGraph;
use placegraph::geom::{Point2, Pose2};
use placegraph::topology::query::{PlaceIndex, RouteIndex, Whereabouts, find_place, find_route};
use placegraph::topology::{Connection, PlaceId, PlaceRaster};
use proptest::prelude::*;

#[test]
fn the_raster_is_the_region_map() {
    for pose in [Pose2::default(), Pose2::new(-3.7, 12.3, 0.4)] {
        let building = building::drawn(pose);
        let raster = PlaceRaster::new(&building.map, building.shape());
        for cell in building.grid.cells.cells() {
            let expected = building
                .space
                .graph
                .node_at(cell)
                .map(|node| PlaceId(building.regions.region_of[node].0 + 1));
            assert_eq!(raster.place_in(cell), expected, "{cell:?}");
        }
    }
}

#[test]
fn places_are_found_by_name_and_by_number() {
    let mut map = building::drawn(Pose2::default()).map;
    map.places[2].name = "1".into();
    assert_eq!(find_place(&map, "1").unwrap().id, PlaceId(3));
    assert_eq!(find_place(&map, "2").unwrap().id, PlaceId(2));
    assert!(find_place(&map, "nowhere").is_none());
}

#[test]
fn a_route_names_the_doorways_it_goes_through() {
    let building = building::drawn(Pose2::new(-3.7, 12.3, 0.4));
    let id = |x, y| building.place_at(x, y).id;
    let (first, third) = (id(5, 12), id(40, 15));
    let route = find_route(&building.map, first, third).unwrap();
    assert_eq!(route.places, [first, id(6, 7), id(10, 4), id(18, 7), id(16, 15), id(32, 10), third]);
    let raster = PlaceRaster::new(&building.map, building.shape());
    let short = route.pulled_straight(&raster);
    assert!(short.length_m < route.length_m && short.places == route.places);
    assert!(short.line.windows(2).all(|ends| raster.is_free_between(ends[0], ends[1])));
    let back = find_route(&building.map, third, first).unwrap();
    assert!((back.length_m - route.length_m).abs() < 1e-9);
    assert_eq!(find_route(&building.map, first, first).unwrap().places, [first]);
    assert!(find_route(&building.map, first, PlaceId(999)).is_none());
}

#[test]
fn routes_between_all_places_are_as_short_as_petgraph_finds_them() {
    let building = building::drawn(Pose2::new(-3.7, 12.3, 0.4));
    let map = &building.map;
    let mut graph = UnGraph::<PlaceId, f64>::default();
    let nodes: BTreeMap<PlaceId, _> = map.places.iter().map(|p| (p.id, graph.add_node(p.id))).collect();
    for connection in &map.connections {
        let length_m = connection.route.as_ref().map_or(f64::INFINITY, |route| route.length_m);
        graph.add_edge(nodes[&connection.a], nodes[&connection.b], length_m);
    }
    for way in &map.shortcuts {
        graph.add_edge(nodes[&way.a], nodes[&way.b], way.route.length_m);
    }
    let index = RouteIndex::new(map);
    let mut n_routes = 0;
    for from in map.places.iter().map(|place| place.id) {
        let lengths = petgraph::algo::dijkstra(&graph, nodes[&from], None, |edge| *edge.weight());
        for to in map.places.iter().map(|place| place.id) {
            let route = index.route(from, to).unwrap();
            assert!((route.length_m - lengths[&nodes[&to]]).abs() < 1e-9, "{from:?} to {to:?}");
            let line: f64 = route.line.windows(2).map(|ends| ends[0].distance(ends[1])).sum();
            assert!((line - route.length_m).abs() < 1e-9, "{from:?} to {to:?}");
            assert_eq!([route.places[0], *route.places.last().unwrap()], [from, to]);
            n_routes += 1;
        }
    }
    assert!(n_routes > 40);
}

/// Distance to the nearest outline by looking at every side.
fn plain_distance(building: &building::Building, point: Point2) -> f64 {
    let mut nearest = f64::INFINITY;
    for ring in building
        .map
        .places
        .iter()
        .flat_map(|place| &place.outline)
        .flat_map(|part| std::iter::once(&part.exterior).chain(&part.holes))
    {
        for (index, &a) in ring.iter().enumerate() {
            let b = ring[(index + 1) % ring.len()];
            let t = ((point - a).dot(b - a) / (b - a).dot(b - a)).clamp(0.0, 1.0);
            nearest = nearest.min(point.distance(a + (b - a) * t));
        }
    }
    nearest
}

static TURNED: LazyLock<(building::Building, PlaceIndex)> = LazyLock::new(|| {
    let building = building::drawn(Pose2::new(-3.7, 12.3, 0.4));
    let index = PlaceIndex::new(&building.map, building.shape());
    (building, index)
});

proptest! {
    #[test]
    fn where_is_what_the_cells_and_all_sides_say(u in -1.0..13.0f64, v in -1.0..6.0f64) {
        let (building, index) = &*TURNED;
        let point = building.grid.frame.map_from_grid().apply(Point2::new(u, v));
        let cell = building.shape().cell_at(point);
        let place = cell.and_then(|cell| building.space.graph.node_at(cell)).map(|node| PlaceId(building.regions.region_of[node].0 + 1));
        let distance = plain_distance(building, point);
        match index.locate(point).unwrap() {
            Whereabouts::Inside { place: found, border_m } => {
                prop_assert_eq!(Some(found), place);
                prop_assert!((border_m - distance).abs() < 1e-9);
            }
            Whereabouts::Outside { distance_m, .. } => {
                prop_assert_eq!(None, place);
                prop_assert!((distance_m - distance).abs() < 1e-9);
            }
        }
    }
}

#[test]
fn of_equally_long_ways_the_one_over_the_lower_number_is_taken() {
    let mut map = building::drawn(Pose2::default()).map;
    let line = map.connections.iter().find_map(|connection| connection.route.clone()).unwrap();
    let model = map.connections[0].clone();
    let joined = [(1, 2), (1, 3), (2, 4), (3, 4)];
    map.connections = joined
        .map(|(a, b)| Connection { a: PlaceId(a), b: PlaceId(b), route: Some(line.clone()), ..model.clone() })
        .to_vec();
    let places = |from, to| find_route(&map, PlaceId(from), PlaceId(to)).unwrap().places;
    assert_eq!(places(1, 4), [1, 2, 4].map(PlaceId));
    assert_eq!(places(4, 1), [4, 2, 1].map(PlaceId));
    assert_eq!(places(2, 3), [2, 1, 3].map(PlaceId));
}
