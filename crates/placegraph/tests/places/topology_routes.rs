//! Routes run through free cells only and join what touches.

use crate::building;
use std::path::PathBuf;

use placegraph::geom::{Point2, Pose2};
use placegraph::grid::{Cell, CellGraph, Grid, MapFrame, Occupancy, OccupancyGrid};
use placegraph::labels::{Label, LabelSet};
use placegraph::regions::{DiagonalSteps, connected};
use placegraph::topology::TopologicalMap;
use placegraph::topology::query::find_route;
use placegraph_testkit::segments::cells_on_segment;
use proptest::prelude::*;

/// Every cell that a route touches, with the rounding of the way to the map frame and back left out.
fn assert_free(grid: &OccupancyGrid, map: &TopologicalMap) -> usize {
    let mut n_legs = 0;
    let routes = map.connections.iter().filter_map(|c| Some((c.a, c.b, c.route.as_ref()?)));
    for (from, to, route) in routes.chain(map.shortcuts.iter().map(|way| (way.a, way.b, &way.route))) {
        for ends in route.line.windows(2) {
            let [a, b] = [ends[0], ends[1]].map(|point| grid.frame.cells_from_map(point));
            for (x, y) in cells_on_segment(a, b, 1e-6) {
                let free = grid.is_free(Cell::new(x as u32, y as u32));
                assert!(free, "{from:?} to {to:?} touches ({x}, {y})");
            }
            n_legs += 1;
        }
    }
    n_legs
}

#[test]
fn routes_of_a_turned_building_stay_free() {
    for pose in
        [Pose2::default(), Pose2::new(-3.7, 12.3, 0.4), Pose2::new(1.0, 2.0, std::f64::consts::FRAC_PI_2)]
    {
        let building = building::drawn(pose);
        assert!(building.map.connections.iter().all(|connection| connection.route.is_some()));
        assert!(assert_free(&building.grid, &building.map) >= building.map.connections.len());
    }
}

#[test]
fn a_route_leads_from_station_to_station() {
    let building = building::drawn(Pose2::default());
    for connection in &building.map.connections {
        let route = connection.route.as_ref().unwrap();
        let [a, b] = [connection.a, connection.b].map(|id| building.map.place(id).unwrap());
        assert_eq!(*route.line.first().unwrap(), building.map.station(a));
        assert_eq!(*route.line.last().unwrap(), building.map.station(b));
        let length: f64 = route.line.windows(2).map(|ends| ends[0].distance(ends[1])).sum();
        assert!((route.length_m - length).abs() < 1e-9);
        assert!(route.length_m >= building.map.station(a).distance(building.map.station(b)) - 1e-9);
    }
}

#[test]
fn the_station_of_a_doorway_is_its_center() {
    let building = building::drawn(Pose2::default());
    let doorway = building.place_at(6, 7);
    let jambs = doorway.doorway.as_ref().unwrap().jambs;
    let station = building.map.station(doorway);
    assert!(station.distance(jambs[0].midpoint(jambs[1])) <= 0.05, "{station:?} {jambs:?}");
}

#[test]
fn an_open_way_is_a_straight_line() {
    // The drawing's first room and its doorway see one another.
    let building = building::drawn(Pose2::default());
    let (room, doorway) = (building.place_at(5, 12).id, building.place_at(6, 7).id);
    let connection = building.map.connections_of(room).find(|c| c.other_end(room) == doorway).unwrap();
    assert!(connection.route.as_ref().unwrap().line.len() <= 3, "{:?}", connection.route);
}

#[test]
fn cells_that_meet_at_a_corner_only_have_no_route() {
    let building = building::from_letters(&Grid::from_rows(2, 2, b"r##c".to_vec()), Pose2::default());
    assert!(building.map.connections.iter().all(|connection| connection.route.is_none()));
}

/// A hall of 10 by 2.5 m whose middle, its station, lies 4 m from two doors side by side at its left end; a third door is at its
/// right end.
const HALL: &str = "
    ##########################################
    #rrrr#rrrr###########################rrrr#
    #rrrr#rrrr###########################rrrr#
    ##dd###dd#############################dd##
    #cccccccccccccccccccccccccccccccccccccccc#
    #cccccccccccccccccccccccccccccccccccccccc#
    #cccccccccccccccccccccccccccccccccccccccc#
    #cccccccccccccccccccccccccccccccccccccccc#
    #cccccccccccccccccccccccccccccccccccccccc#
    #cccccccccccccccccccccccccccccccccccccccc#
    #cccccccccccccccccccccccccccccccccccccccc#
    #cccccccccccccccccccccccccccccccccccccccc#
    #cccccccccccccccccccccccccccccccccccccccc#
    #cccccccccccccccccccccccccccccccccccccccc#
    ##########################################
";

#[test]
fn neighboring_doors_of_a_hall_have_a_way_of_their_own() {
    let building = building::from_drawing(HALL, Pose2::new(2.0, -1.0, 0.7));
    let map = &building.map;
    let [left, second, right] = [3, 8, 39].map(|x| building.place_at(x, 11).id);
    let hall = building.place_at(20, 5).id;
    let way = map.shortcuts.iter().find(|way| (way.a, way.b) == (left.min(second), left.max(second)));
    let way = way.expect("a way from door to door");
    assert_eq!(way.within, hall);
    // 5 letters of a quarter of a meter, and half a meter at the most to get past the corners of the doors.
    assert!((1.25..1.75).contains(&way.route.length_m), "{}", way.route.length_m);
    let ends = [way.route.line[0], *way.route.line.last().unwrap()];
    assert_eq!(ends, [way.a, way.b].map(|id| map.station(map.place(id).unwrap())));
    // The way to the far door passes the second one: of the left door it is no neighbor.
    assert!(map.shortcuts.iter().all(|way| (way.a, way.b) != (left.min(right), left.max(right))));
    let route = find_route(map, left, second).unwrap();
    assert_eq!((route.places, route.length_m), (vec![left, hall, second], way.route.length_m));
    // That doorway is passed, and not gone through.
    assert_eq!(find_route(map, left, right).unwrap().places, [left, hall, right]);
    assert_free(&building.grid, map);
}

proptest! {
    /// Rooms and corridors in random rubble: whatever the regions look like, routes are free, and a pair that
    /// shares a side and can be reached has one.
    #[test]
    fn routes_in_rubble_stay_free(letters in proptest::collection::vec(prop_oneof![
        4 => Just(b'r'), 3 => Just(b'c'), 2 => Just(b'#'), 1 => Just(b'd')
    ], 18 * 14)) {
        let building = building::from_letters(&Grid::from_rows(18, 14, letters), Pose2::default());
        assert_free(&building.grid, &building.map);
    }
}

/// Folders of the evaluation maps that have classes.
fn labeled_maps() -> Vec<PathBuf> {
    let Some(data) = std::env::var_os("PLACEGRAPH_DATA") else {
        println!("skipped: PLACEGRAPH_DATA names no folder with maps");
        return Vec::new();
    };
    let mut folders: Vec<PathBuf> = std::fs::read_dir(PathBuf::from(data).join("eval"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.join("labels_hand.png").exists())
        .collect();
    folders.sort();
    folders
}

/// A gray image with row 0 at the bottom.
fn gray(path: &std::path::Path) -> Grid<u8> {
    let image = image::open(path).unwrap().into_luma8();
    let (width, height) = image.dimensions();
    let rows: Vec<u8> = image.into_raw().chunks_exact(width as usize).rev().flatten().copied().collect();
    Grid::from_rows(width, height, rows)
}

#[test]
fn routes_of_the_evaluation_maps_stay_free() {
    for folder in labeled_maps() {
        let pixels = gray(&folder.join("map.png"));
        let labels_image = gray(&folder.join("labels_hand.png"));
        let cells = pixels.map(|value| match value {
            254 => Occupancy::Free,
            0 => Occupancy::Occupied,
            _ => Occupancy::Unknown,
        });
        let grid = OccupancyGrid { frame: MapFrame::new(0.05, Pose2::new(-3.0, 4.0, 0.3)).unwrap(), cells };
        let graph = CellGraph::new(&grid.cells);
        let labeling: Vec<Label> =
            graph.cells().iter().map(|&cell| Label(labels_image[cell].saturating_sub(1).min(2))).collect();
        let regions = connected(&graph, &labeling, DiagonalSteps::default());
        let building = building::finish(grid, graph, LabelSet::default(), regions);
        let n_legs = assert_free(&building.grid, &building.map);
        let touching = building.map.connections.iter().filter(|c| c.contact_m > 0.0);
        let (n_routes, n_touching) =
            touching.fold((0, 0), |(routes, all), c| (routes + usize::from(c.route.is_some()), all + 1));
        println!("{}: {n_legs} legs, {n_routes} of {n_touching} connections", folder.display());
        assert_eq!(n_routes, n_touching, "cells that share a side are a way: {}", folder.display());
    }
}

#[test]
fn cells_on_a_segment_by_clipping() {
    let cells = cells_on_segment(Point2::new(0.5, 0.5), Point2::new(1.5, 1.5), 0.0);
    assert_eq!(cells, [(0, 0), (1, 0), (0, 1), (1, 1)]);
}

/// A door on the left, and a wall that juts out between it and the middle of the room.
const CORNER: &str = "
    #####################
    #cc#rrrr##rrrrrrrrrr#
    #cc#rrrr##rrrrrrrrrr#
    #ccdrrrr##rrrrrrrrrr#
    #ccdrrrr##rrrrrrrrrr#
    #ccdrrrrrrrrrrrrrrrr#
    #ccdrrrrrrrrrrrrrrrr#
    #cc#rrrrrrrrrrrrrrrr#
    #cc#rrrrrrrrrrrrrrrr#
    #####################
";

#[test]
fn routes_keep_away_from_corners_where_that_is_not_far() {
    let building = building::from_drawing(CORNER, Pose2::default());
    let room = building.place_at(5, 2).id;
    let route = building.map.connections_of(room).next().unwrap().route.as_ref().unwrap();
    assert!(route.line.len() > 2, "around the corner: {route:?}");
    // The shortest way touches the corner; a letter is 0.25 m.
    assert!(route.clearance_m.unwrap() >= 0.3, "{route:?}");
}
