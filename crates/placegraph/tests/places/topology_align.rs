//! Two mapping sessions of one building are laid on one another; those of two buildings are not.

use std::collections::BTreeMap;

use placegraph::geom::{Point2, Pose2};
use placegraph::grid::{Cell, Grid};
use placegraph::topology::TopologicalMap;
use placegraph::topology::align::{Alignment, align};
use placegraph::topology::identity::carry_over;

use crate::building::{self, Building, SCALE};

/// Other buildings of about the same size.
const OTHERS: [&str; 3] = [
    "
    ########################################
    #rrrrrrrrr#rrrrrrrrr#rrrrrrrrr#rrrrrrrr#
    #rrrrrrrrr#rrrrrrrrr#rrrrrrrrr#rrrrrrrr#
    #rrrrrrrrr#rrrrrrrrr#rrrrrrrrr#rrrrrrrr#
    #rrrrrrrrr#rrrrrrrrr#rrrrrrrrr#rrrrrrrr#
    ###dd#######dd#########dd#######dd######
    #cccccccccccccccccccccccccccccccccccccc#
    #cccccccccccccccccccccccccccccccccccccc#
    ######dd############dd##################
    #rrrrrrrrrrrrr#rrrrrrrrrrrrrrrrrrrrrrrr#
    #rrrrrrrrrrrrr#rrrrrrrrrrrrrrrrrrrrrrrr#
    #rrrrrrrrrrrrr#rrrrrrrrrrrrrrrrrrrrrrrr#
    #rrrrrrrrrrrrr#rrrrrrrrrrrrrrrrrrrrrrrr#
    ########################################
    ",
    "
    ##########################
    #rrrrrrrrr#rrrrrrrrrrrrrr#
    #rrrrrrrrr#rrrrrrrrrrrrrr#
    #rrrrrrrrr#rrrrrrrrrrrrrr#
    #rrrrrrrrrdrrrrrrrrrrrrrr#
    #rrrrrrrrrdrrrrrrrrrrrrrr#
    #rrrrrrrrr#rrrrrrrrrrrrrr#
    #rrrr######rrrrrrrrrrrrrr#
    #rrrr#ccccc#rrrrrrrrrrrrr#
    #rrrrdcccccdrrrrrrrrrrrrr#
    #rrrrdcccccdrrrrrrrrrrrrr#
    #rrrr#ccccc#####rrrrrrrrr#
    ######ccccc#rrr#rrrrrrrrr#
    #rrrr#ccccc#rrr#rrrrrrrrr#
    #rrrrdcccccdrrr#rrrrrrrrr#
    #rrrrdcccccdrrr#rrrrrrrrr#
    #rrrr#ccccc#rrr#rrrrrrrrr#
    ##########################
    ",
    "
    ####################
    #rrrrrrrrrrrrrrrrrr#
    #rrrrrrrrrrrrrrrrrr#
    #rrrrr####rrrrrrrrr#
    #rrrrr#??#rrrrrrrrr#
    #rrrrr####rrrrrrrrr#
    #rrrrrrrrrrrrrrrrrr#
    ########dd##########
    #rrrrrrrrrrrrrrrrrr#
    #rrrrrrrrrrrrrrrrrr#
    ####################
    ",
];

/// The building of `drawing` as another session maps it: turned and shifted, on an upright grid of its own. Point p of the drawing is at
/// `pose` p.
fn mapped_again(drawing: &str, pose: Pose2) -> Building {
    let rows: Vec<&[u8]> =
        drawing.lines().map(|line| line.trim().as_bytes()).filter(|line| !line.is_empty()).collect();
    let cell_m = 0.25 / f64::from(SCALE);
    let size = Point2::new(rows[0].len() as f64 * 0.25, rows.len() as f64 * 0.25);
    let corners = [(0.0, 0.0), (size.x, 0.0), (0.0, size.y), (size.x, size.y)]
        .map(|(x, y)| pose.apply(Point2::new(x, y)));
    let low = corners.iter().fold(corners[0], |low, c| Point2::new(low.x.min(c.x), low.y.min(c.y)));
    let high = corners.iter().fold(corners[0], |high, c| Point2::new(high.x.max(c.x), high.y.max(c.y)));
    let side = |length: f64| (length / cell_m).ceil() as u32 + 1;
    let empty = Grid::filled(side(high.x - low.x), side(high.y - low.y), ());
    let letter = |cell: Cell| {
        let at = Point2::new(
            low.x + (f64::from(cell.x) + 0.5) * cell_m,
            low.y + (f64::from(cell.y) + 0.5) * cell_m,
        );
        let at = pose.apply_inverse(at);
        let inside = (0.0..size.x).contains(&at.x) && (0.0..size.y).contains(&at.y);
        if inside { rows[rows.len() - 1 - (at.y / 0.25) as usize][(at.x / 0.25) as usize] } else { b'?' }
    };
    let letters = Grid::from_rows(empty.width(), empty.height(), empty.cells().map(letter).collect());
    building::from_letters(&letters, Pose2::new(low.x, low.y, 0.0))
}

/// Turn error in degrees and the distance by which the middle of the building is missed.
fn error(found: Alignment, truth: Pose2, old: &TopologicalMap) -> (f64, f64) {
    let turn = (found.new_from_old.yaw_rad - truth.yaw_rad).rem_euclid(std::f64::consts::TAU);
    let turn = turn.min(std::f64::consts::TAU - turn).to_degrees();
    let n = old.places.len() as f64;
    let middle = old.places.iter().fold(Point2::new(0.0, 0.0), |sum, place| {
        Point2::new(sum.x + place.centroid.x / n, sum.y + place.centroid.y / n)
    });
    (turn, found.new_from_old.apply(middle).distance(truth.apply(middle)))
}

#[test]
fn turns_of_any_angle_and_shifts_are_found() {
    for drawing in [building::DRAWING, OTHERS[0], OTHERS[1]] {
        let old = mapped_again(drawing, Pose2::default());
        for (yaw_deg, x, y) in
            [(0.0, 30.0, -4.0), (37.3, 0.0, 0.0), (90.0, -8.0, 100.0), (171.8, 2.0, 3.0), (284.0, -50.0, 1.0)]
        {
            let truth = Pose2::new(x, y, f64::to_radians(yaw_deg));
            let new = mapped_again(drawing, truth);
            let found = align(&old.map, &new.map).unwrap();
            let (turn_deg, shift_m) = error(found, truth, &old.map);
            assert!(found.is_certain(), "{yaw_deg}: {found:?}");
            assert!(turn_deg < 0.5 && shift_m < 0.1, "{yaw_deg}: {turn_deg} {shift_m} {found:?}");
        }
    }
}

#[test]
fn a_room_more_and_a_room_less_do_not_matter() {
    let old = mapped_again(OTHERS[0], Pose2::default());
    let truth = Pose2::new(4.0, -2.0, 1.1);
    let mut new = mapped_again(OTHERS[0], truth);
    let largest = new.map.places.iter().max_by(|a, b| a.area_m2.total_cmp(&b.area_m2)).unwrap().id;
    new.map.places.retain(|place| place.id != largest);
    let found = align(&old.map, &new.map).unwrap();
    let (turn_deg, shift_m) = error(found, truth, &old.map);
    assert!(found.is_certain() && turn_deg < 0.5 && shift_m < 0.1, "{turn_deg} {shift_m} {found:?}");
}

#[test]
fn other_buildings_are_refused() {
    let drawings = [building::DRAWING, OTHERS[0], OTHERS[1], OTHERS[2]];
    for (index, old) in drawings.iter().enumerate() {
        for new in &drawings[index + 1..] {
            let (old, new) =
                (mapped_again(old, Pose2::default()), mapped_again(new, Pose2::new(1.0, 2.0, 0.4)));
            let found = align(&old.map, &new.map).unwrap();
            assert!(!found.is_certain(), "{found:?}");
        }
    }
    assert_eq!(align(&TopologicalMap::default(), &mapped_again(OTHERS[0], Pose2::default()).map), None);
}

#[test]
fn a_building_that_looks_alike_from_two_sides_is_not_certain() {
    let hall = "##########\n#rrrrrrrr#\n#rrrrrrrr#\n#rrrrrrrr#\n#rrrrrrrr#\n##########";
    let (old, new) = (mapped_again(hall, Pose2::default()), mapped_again(hall, Pose2::new(1.0, 0.0, 0.2)));
    let found = align(&old.map, &new.map).unwrap();
    assert!(found.score > 0.9 && found.runner_up > 0.9 && !found.is_certain(), "{found:?}");
}

#[test]
fn names_last_over_a_new_session_once_it_is_aligned() {
    let mut old = mapped_again(building::DRAWING, Pose2::default());
    for place in &mut old.map.places {
        place.name = format!("named {}", place.id.0);
    }
    let truth = Pose2::new(3.0, -7.0, f64::to_radians(90.0));
    let new = mapped_again(building::DRAWING, truth);
    // As it is, the frames disagree: nothing is handed out, and numbers are new.
    let carried = carry_over(&new.map, new.shape(), &old.map, &BTreeMap::new());
    assert!(carried.matched_share < 0.5, "{}", carried.matched_share);
    assert!(carried.changes.is_empty());
    let highest = old.map.places.last().unwrap().id;
    assert!(carried.map.places.iter().all(|place| place.id > highest && !place.name.starts_with("named")));

    let found = align(&old.map, &new.map).unwrap();
    let moved = old.map.moved(found.new_from_old);
    let carried = carry_over(&new.map, new.shape(), &moved, &BTreeMap::new());
    assert!(carried.matched_share > 0.9 && carried.changes.is_empty(), "{:?}", carried.changes);
    for place in &carried.map.places {
        let before = old.map.place(place.id).unwrap();
        assert_eq!(place.name, format!("named {}", place.id.0));
        assert!(truth.apply(before.centroid).distance(place.centroid) < 0.1);
    }
}

#[test]
fn moving_a_map_moves_all_of_it() {
    let building = building::drawn(Pose2::default());
    let pose = Pose2::new(1.5, -2.0, 0.7);
    let moved = building.map.moved(pose);
    let drawn_there = building::drawn(pose).map;
    for (a, b) in moved.places.iter().zip(&drawn_there.places) {
        assert!(a.anchor.distance(b.anchor) < 1e-9 && a.centroid.distance(b.centroid) < 1e-9);
        assert!((a.axes.direction_rad - b.axes.direction_rad).abs() < 1e-9, "{:?} {:?}", a.axes, b.axes);
        let corners = a.outline[0].exterior.iter().zip(&b.outline[0].exterior);
        assert!(corners.clone().count() > 3 && corners.into_iter().all(|(a, b)| a.distance(*b) < 1e-9));
        if let (Some(a), Some(b)) = (&a.doorway, &b.doorway) {
            assert!(a.jambs[0].distance(b.jambs[0]) < 1e-9);
        }
    }
    for (a, b) in moved.connections.iter().zip(&drawn_there.connections) {
        assert!(a.middle.distance(b.middle) < 1e-9);
        let (a, b) = (a.route.as_ref().unwrap(), b.route.as_ref().unwrap());
        assert!(a.line.iter().zip(&b.line).all(|(a, b)| a.distance(*b) < 1e-9));
    }
}
