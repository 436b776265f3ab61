//! Kinds of maps that were labeled wrong once: open halls, furnished wards, outlines of objects, fans of beams, homes of robot vacuums,
//! halls explored along their walls.
//!
//! The real ones are in the folder `cases` of the one that `PLACEGRAPH_DATA` names; without it these tests are skipped.

use std::path::Path;

use placegraph::grid::{Grid, MapFrame, Occupancy, OccupancyGrid};
use placegraph::import::{ReadOptions, load_map};
use placegraph::labels::Role;
use placegraph::model::Model;
use placegraph::pipeline::{Config, analyze};
use placegraph::progress::Silent;
use placegraph::topology::TopologicalMap;

fn topology(map: &OccupancyGrid) -> TopologicalMap {
    analyze(map, &Model::builtin(), &Config::default(), &Silent).topology
}

/// Numbers of passages, places and doorways of a case.
fn counts(case: &str) -> Option<[usize; 3]> {
    let Some(data) = std::env::var_os("PLACEGRAPH_DATA") else {
        println!("skipped: PLACEGRAPH_DATA does not name the folder of maps");
        return None;
    };
    let map = load_map(&Path::new(&data).join("cases").join(case), &ReadOptions::default()).unwrap().grid;
    let topology = topology(&map);
    let n_of = |role: Role| topology.places.iter().filter(|place| place.role == role).count();
    let counts = [Role::Passage, Role::Place, Role::Doorway].map(n_of);
    println!("{case}: {counts:?}");
    Some(counts)
}

#[test]
fn an_empty_hall_is_one_place() {
    for (width_m, height_m) in [(8, 8), (20, 8), (12, 30), (40, 15), (15, 40), (60, 10), (30, 30)] {
        let (width, height) = (width_m * 10 + 2, height_m * 10 + 2);
        let is_wall = |x: u32, y: u32| x == 0 || y == 0 || x + 1 == width || y + 1 == height;
        let mut cells = Grid::filled(width, height, Occupancy::Free);
        for cell in cells.cells() {
            if is_wall(cell.x, cell.y) {
                cells[cell] = Occupancy::Occupied;
            }
        }
        let map =
            OccupancyGrid { cells, frame: MapFrame::new(0.1, placegraph::geom::Pose2::default()).unwrap() };
        let names: Vec<String> = topology(&map).places.into_iter().map(|place| place.name).collect();
        assert_eq!(names.len(), 1, "{width_m} x {height_m} m: {names:?}");
    }
}

#[test]
fn open_halls_hold_no_patches_of_corridor() {
    let Some(hall) = counts("04-corridor-in-open-hall/hall40x15.yaml") else { return };
    assert_eq!(hall, [0, 1, 0]);
    assert_eq!(counts("04-corridor-in-open-hall/walls.yaml"), Some([0, 1, 0]));
    // Seven aisles between racks, and a stub.
    let [n_corridors, n_rooms, _] = counts("04-corridor-in-open-hall/warehouse.yaml").unwrap();
    assert!(n_corridors <= 8 && n_rooms <= 2, "{n_corridors} corridors, {n_rooms} rooms");
}

#[test]
fn lanes_between_furniture_are_no_corridors() {
    // Five and nine before; a tongue between two parts of a ward is left.
    let Some([n_corridors, ..]) = counts("05-corridor-among-furniture/hospital.yaml") else { return };
    assert!(n_corridors <= 2, "{n_corridors} corridors");
    let [n_corridors, ..] = counts("05-corridor-among-furniture/nus_com1.yaml").unwrap();
    assert!(n_corridors <= 5, "{n_corridors} corridors");
}

#[test]
fn objects_drawn_as_outlines_are_no_places() {
    // Four rooms and a corridor; 31 places before.
    let Some([n_corridors, n_rooms, _]) = counts("06-hollow-objects/inside.yaml") else { return };
    assert!(n_corridors <= 2 && n_rooms <= 12, "{n_corridors} corridors, {n_rooms} rooms");
}

#[test]
fn fans_of_beams_are_few_places() {
    let Some([n_corridors, n_rooms, _]) = counts("07-fans-through-glass/map.yaml") else { return };
    assert!(n_corridors <= 1 && n_rooms <= 6, "{n_corridors} corridors, {n_rooms} rooms");
    let [n_corridors, n_rooms, _] = counts("07-fans-through-glass/office.yaml").unwrap();
    assert!(n_corridors == 0 && n_rooms <= 4, "{n_corridors} corridors, {n_rooms} rooms");
}

#[test]
fn homes_of_robot_vacuums_have_rooms_and_doorways() {
    let Some(home) = counts("08-vacuum-homes/x10plus_1104_with_obstacle/map.yaml") else { return };
    assert_eq!(home, [0, 4, 2]);
    let [n_corridors, n_rooms, n_doorways] = counts("19-frame-and-small-home/casa.yaml").unwrap();
    assert!(n_corridors == 0 && n_rooms >= 4, "{n_corridors}, {n_rooms}, {n_doorways}");
}

#[test]
fn a_hall_explored_along_its_walls_is_in_few_parts() {
    // Eleven before.
    let Some([n_corridors, n_rooms, _]) = counts("20-explored-along-walls/factory.yaml") else { return };
    assert!(n_corridors <= 2 && n_rooms <= 5, "{n_corridors} corridors, {n_rooms} rooms");
}
