//! What a robot with a size reaches: routes keep its radius, what is cut off is told.

use placegraph::geom::{Point2, Pose2};
use placegraph::grid::Cell;
use placegraph::topology::reach::{GraphCheck, Robot, mark_cut_off, remarks};
use placegraph::topology::{TopologicalMap, lay_routes};
use proptest::prelude::*;

use crate::building::{self, Building};

/// A room behind a door that is shut, one with a narrow door, one with a wide one.
const FLAT: &str = "
    ####################
    #rrrrr#rrrrr#rrrrrr#
    #rrrrr#rrrrr#rrrrrr#
    #rrrrr#rrrrr#rrrrrr#
    #######d######dddd##
    #cccccccccccccccccc#
    #cccccccccccccccccc#
    #cccccccccccccccccc#
    ####################
";

fn laid(building: &Building, radius_m: f64) -> TopologicalMap {
    let mut map = building.map.clone();
    lay_routes(&mut map, &building.space, &building.regions, radius_m);
    mark_cut_off(&mut map, building.shape(), None);
    map
}

fn cut_off(map: &TopologicalMap) -> Vec<&str> {
    map.places.iter().filter(|place| place.cut_off).map(|place| place.name.as_str()).collect()
}

/// Least distance from points on all routes, a fifth of a cell apart, to the nearest cell that is not free, in meters.
fn least_clearance_m(building: &Building, map: &TopologicalMap) -> f64 {
    let resolution_m = building.grid.frame.resolution_m();
    let (width, height) = (building.space.graph.width(), building.space.graph.height());
    let walls: Vec<Cell> = building.grid.cells.cells().filter(|&cell| !building.grid.is_free(cell)).collect();
    let distance = |point: Point2| {
        let beside = |v: f64, low: u32| (f64::from(low) - v).max(v - f64::from(low) - 1.0).max(0.0);
        let to_border = point.x.min(point.y).min(f64::from(width) - point.x).min(f64::from(height) - point.y);
        walls
            .iter()
            .map(|wall| beside(point.x, wall.x).hypot(beside(point.y, wall.y)))
            .fold(to_border, f64::min)
    };
    let mut least = f64::INFINITY;
    for ends in map
        .connections
        .iter()
        .flat_map(|connection| &connection.route)
        .flat_map(|route| route.line.windows(2))
    {
        let [a, b] = [ends[0], ends[1]].map(|point| building.grid.frame.cells_from_map(point));
        let n = (a.distance(b) * 5.0).ceil().max(1.0) as u32;
        for step in 0..=n {
            let part = f64::from(step) / f64::from(n);
            least = least.min(distance(a + (b - a) * part));
        }
    }
    least * resolution_m
}

#[test]
fn a_shut_room_is_cut_off_and_told() {
    let building = building::from_drawing(FLAT, Pose2::new(2.0, -1.0, 0.3));
    let map = laid(&building, 0.0);
    let shut = building.place_at(3, 6);
    assert_eq!(cut_off(&map), [shut.name.as_str()]);
    let told = remarks(&map, &Robot::default()).join("\n");
    assert!(
        told.contains("1 room, 0.9 m², cannot be reached from the largest part: are doors shut?"),
        "{told}"
    );
    assert!(told.contains(&shut.name), "{told}");
    assert_eq!(map.reached().places.len(), map.places.len() - 1);

    let check = GraphCheck::of(&map, 0.0);
    let areas = |map: &TopologicalMap| map.places.iter().map(|place| place.area_m2).sum::<f64>();
    assert!((check.reached_share - (1.0 - shut.area_m2 / areas(&map))).abs() < 1e-12, "{check:?}");
    // Of six places five are joined: 10 of 15 pairs.
    assert!((check.joined_share - 10.0 / 15.0).abs() < 1e-12, "{check:?}");
    assert_eq!(check.n_blocked, 0);
}

#[test]
fn the_part_is_that_where_the_robot_is() {
    let building = building::from_drawing(FLAT, Pose2::default());
    let mut map = building.map.clone();
    let shut = building.place_at(3, 6);
    mark_cut_off(&mut map, building.shape(), Some(building.at(3, 6)));
    assert!(map.places.iter().all(|place| place.cut_off == (place.id != shut.id)));
    // A point in a wall is that of the nearest place.
    mark_cut_off(&mut map, building.shape(), Some(building.at(0, 6)));
    assert_eq!(map.reached().places.len(), 1);
}

#[test]
fn a_door_that_is_too_narrow_is_no_way() {
    // A letter is 0.25 m: the narrow door is that wide, the wide one 1 m.
    let building = building::from_drawing(FLAT, Pose2::default());
    let map = laid(&building, 0.2);
    let [narrow, behind, shut] = [(7, 4), (9, 6), (3, 6)].map(|(x, y)| building.place_at(x, y).name.clone());
    let found: std::collections::BTreeSet<&str> = cut_off(&map).into_iter().collect();
    assert_eq!(found, [narrow.as_str(), behind.as_str(), shut.as_str()].into());
    let told = remarks(&map, &Robot { radius_m: 0.2, from: None }).join("\n");
    assert!(
        told.contains("too narrow for a robot of 0.20 m radius") && told.contains("0.25 m wide"),
        "{told}"
    );
    assert!(told.contains("are doors shut, or too narrow for the robot?"), "{told}");
    let reached = map.reached();
    assert!(reached.connections.iter().all(|c| [c.a, c.b].iter().all(|&end| reached.place(end).is_some())));
    let check = GraphCheck::of(&map, 0.2);
    assert_eq!(check.n_blocked, 2);
    let text = check.to_string();
    assert!(text.contains("joins 20 % of all pairs") && text.contains("0.20 m radius, 2 passages"), "{text}");
    // Half of the wide door, with what a step takes.
    assert!(
        !laid(&building, 0.45)
            .places
            .iter()
            .any(|place| place.cut_off && place.id == building.place_at(15, 4).id)
    );
    assert!(laid(&building, 0.51).connections.iter().all(|connection| connection.route.is_none()));
}

#[test]
fn routes_keep_the_radius_and_tell_their_clearance() {
    for yaw_rad in [0.0, 0.7] {
        let building = building::drawn(Pose2::new(-3.0, 2.0, yaw_rad));
        for radius_m in [0.0, 0.1, 0.2, 0.3] {
            let map = laid(&building, radius_m);
            let found = least_clearance_m(&building, &map);
            assert!(found >= radius_m - 1e-6, "{radius_m}: {found}");
            let told = GraphCheck::of(&map, radius_m).least_clearance_m.unwrap();
            assert!(told <= found + 1e-6 && told >= radius_m - 1e-9, "{radius_m}: {told} {found}");
            if found < 0.5 {
                assert!(found - told < 0.02, "{radius_m}: {told} {found}");
            }
            assert!(map.connections.iter().all(|connection| connection.route.is_some()), "{radius_m}");
        }
    }
}

proptest! {
    /// In rubble, whatever the radius: what has a route keeps it.
    #[test]
    fn routes_in_rubble_keep_the_radius(
        letters in proptest::collection::vec(prop_oneof![9 => Just(b'r'), 4 => Just(b'c'), 1 => Just(b'#')], 14 * 11),
        radius_cells in 1.0..8.0f64,
    ) {
        let rows: Vec<Vec<u8>> = letters.chunks(14).map(<[u8]>::to_vec).collect();
        let drawing: Vec<String> = rows.iter().map(|row| String::from_utf8(row.clone()).unwrap()).collect();
        let building = building::from_drawing(&drawing.join("\n"), Pose2::default());
        let radius_m = radius_cells * 0.05;
        let map = laid(&building, radius_m);
        let least = least_clearance_m(&building, &map);
        prop_assert!(least >= radius_m - 1e-6, "{} {}", least, radius_m);
    }
}
