//! The check of a map: every finding on a drawing, and how often it is right on real maps.

use crate::real_maps;
use std::fs;
use std::path::{Path, PathBuf};

use placegraph::geom::Pose2;
use placegraph::grid::{Cell, Grid, MapFrame, Occupancy, OccupancyGrid};
use placegraph::import::ros::Interpretation;
use placegraph::import::{
    Finding, Format, Gray205, LoadedMap, ReadOptions, ReplacedImage, Severity, Source, check, load_map,
};

fn loaded(grid: OccupancyGrid) -> LoadedMap {
    let source = Source::new(Format::MapServer, Interpretation::default());
    LoadedMap { grid, name: "map".into(), source, hash: String::new(), files: Vec::new() }
}

/// A room of `width` × `height` free cells inside walls of one cell, in unknown space.
fn room(width: u32, height: u32, resolution_m: f64) -> LoadedMap {
    let (w, h) = (width + 4, height + 4);
    let depth = |x: u32, y: u32| x.min(y).min(w - 1 - x).min(h - 1 - y);
    let cells = Grid::filled(w, h, ()).cells().map(|cell| match depth(cell.x, cell.y) {
        0 => Occupancy::Unknown,
        1 => Occupancy::Occupied,
        _ => Occupancy::Free,
    });
    let frame = MapFrame::new(resolution_m, Pose2::default()).unwrap();
    loaded(OccupancyGrid { frame, cells: Grid::from_rows(w, h, cells.collect()) })
}

/// Free and all else exchanged, as when `negate` is wrong.
fn negated(map: &LoadedMap) -> LoadedMap {
    let cells = map.grid.cells.map(|&state| match state {
        Occupancy::Occupied => Occupancy::Free,
        _ => Occupancy::Occupied,
    });
    loaded(OccupancyGrid { frame: map.grid.frame, cells })
}

fn scaled(map: &LoadedMap, factor: f64) -> LoadedMap {
    let frame = MapFrame::new(map.grid.frame.resolution_m() * factor, Pose2::default()).unwrap();
    loaded(OccupancyGrid { frame, cells: map.grid.cells.clone() })
}

fn names(map: &LoadedMap) -> Vec<&'static str> {
    check(map).findings.iter().map(name).collect()
}

fn name(finding: &Finding) -> &'static str {
    match finding {
        Finding::NoFreeCell => "no free cell",
        Finding::Gray205Unknown { .. } => "205 unknown",
        Finding::Gray205Free { .. } => "205 free",
        Finding::Inverted { .. } => "inverted",
        Finding::OpenToBorder { .. } => "border",
        Finding::Resolution { .. } => "resolution",
        Finding::NoOccupiedCell => "no occupied cell",
        Finding::NoUnknownCell => "no unknown cell",
        Finding::ReplacedImage(_) => "replaced image",
        Finding::YawInDegrees { .. } => "yaw",
        Finding::Smoothed { .. } => "smoothed",
        Finding::Transparent { .. } => "transparent",
        Finding::Islands { .. } => "islands",
        Finding::Unexplored { .. } => "unexplored",
        _ => "new",
    }
}

#[test]
fn a_room_is_fine_and_its_negative_is_not() {
    let room = room(60, 40, 0.05);
    assert!(names(&room).is_empty());
    let found = check(&negated(&room));
    assert!(found.findings.iter().any(|f| matches!(f, Finding::Inverted { .. })), "{found}");
    assert!(found.to_string().contains("check negate"), "{found}");
}

#[test]
fn a_wrong_resolution_is_found_both_ways() {
    assert_eq!(names(&room(60, 40, 0.0005)), ["resolution"]);
    assert_eq!(names(&room(60, 40, 5.0)), ["resolution"]);
    // 40 m x 15 m may be a hall, 300 m x 200 m without a pillar may not.
    for (map, told) in [
        (room(400, 150, 0.1), "one large hall, or a building with a wrong resolution: check the resolution"),
        (room(60, 40, 5.0), "hardly a building: correct the resolution"),
    ] {
        let texts: Vec<String> = check(&map).findings.iter().map(ToString::to_string).collect();
        assert!(texts[0].ends_with(told), "{texts:?}");
    }
}

#[test]
fn the_border_counts_cells() {
    let map = loaded(OccupancyGrid::from_ascii(
        1.0,
        "
        #....?
        #....#
        #....#
        ######
        ",
    ));
    let found = check(&map);
    assert_eq!(found.findings, [Finding::OpenToBorder { n_cells: 4 }]);
    assert_eq!(found.findings[0].severity(), Severity::Warning);
    assert!((found.shares.free - 0.5).abs() < 1e-12);
    assert_eq!(found.shares.to_string(), "free 50.0 %, occupied 45.8 %, unknown 4.2 %");
}

#[test]
fn maps_without_one_of_the_states() {
    let none = loaded(OccupancyGrid::from_ascii(1.0, "####\n####"));
    let found = check(&none);
    assert_eq!(found.findings[0], Finding::NoFreeCell);
    assert_eq!(found.findings[0].severity(), Severity::Error);
    assert!(names(&none).contains(&"no unknown cell"));
    assert!(names(&loaded(OccupancyGrid::from_ascii(1.0, "????\n?..?\n????"))).contains(&"no occupied cell"));
}

#[test]
fn how_the_map_was_read_is_told() {
    let mut map = room(60, 40, 0.05);
    map.source.transparent_cells = 3;
    map.source.gray_205_cells = 704;
    map.source.blended_cells = 28;
    map.source.replaced_image =
        Some(ReplacedImage { named: "/home/someone/map.pgm".into(), read: "map.pgm".into() });
    assert_eq!(names(&map), ["replaced image", "205 unknown", "smoothed", "transparent"]);
    let text = check(&map).to_string();
    for words in [
        "704 cells, 25.0 %",
        "trust its thresholds",
        "28 pixels (1.0 %)",
        "/home/someone/map.pgm, which is not there; map.pgm next to the YAML file was read instead",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
    map.source.gray_205 = Gray205::AsFile;
    assert!(names(&map).contains(&"205 free"));
}

#[test]
fn a_yaw_of_more_than_a_turn_may_be_in_degrees() {
    let turned = |yaw_rad| {
        let mut map = room(60, 40, 0.05);
        map.grid.frame = MapFrame::new(0.05, Pose2::new(-3.0, -2.0, yaw_rad)).unwrap();
        check(&map)
    };
    for degrees in [90.0, -90.0, 180.0, 45.0] {
        let text = turned(degrees).to_string();
        assert!(text.contains(&format!("write {:.6}", f64::to_radians(degrees))), "{text}");
    }
    for radians in [0.0, 1.6, -3.0, 6.2] {
        assert!(turned(radians).findings.is_empty(), "{radians}");
    }
}

#[test]
fn specks_do_not_judge_the_scale() {
    // As many single free cells outside of the walls as there are in the room, none beside another.
    let room = room(60, 40, 0.05);
    let (width, height) = (200, 200);
    let at = |x: u32, y: u32| match (x < 64 && y < 44, x.is_multiple_of(3) && y.is_multiple_of(3)) {
        (true, _) => room.grid.cells[Cell::new(x, y)],
        (false, true) if x > 65 || y > 45 => Occupancy::Free,
        _ => Occupancy::Unknown,
    };
    let cells = (0..height).flat_map(|y| (0..width).map(move |x| at(x, y))).collect();
    let grid = OccupancyGrid { frame: room.grid.frame, cells: Grid::from_rows(width, height, cells) };
    assert!(grid.count(Occupancy::Free) > 2 * 2400);
    let map = loaded(grid);
    assert_eq!(
        names(&map).into_iter().filter(|name| *name != "border").collect::<Vec<_>>(),
        ["inverted", "islands"][1..]
    );
    assert_eq!(check(&map).n_parts, 1);
}

#[test]
fn parts_are_what_is_joined_and_large_enough() {
    let map = OccupancyGrid::from_ascii(
        0.5,
        "
        ....#.#..
        ....###..
        ",
    );
    assert_eq!(check(&loaded(map)).n_parts, 3);
}

#[test]
fn specks_are_counted() {
    let mut map = room(60, 40, 0.05);
    for index in 0..12 {
        map.grid.cells.values_mut()[index * 5] = Occupancy::Free;
    }
    let found = check(&map).findings;
    let islands = found.iter().find_map(|f| match f {
        Finding::Islands { n_islands, area_m2 } => Some((*n_islands, *area_m2)),
        _ => None,
    });
    assert!(islands.is_some_and(|(n, area)| n == 12 && (area - 12.0 * 0.0025).abs() < 1e-12), "{found:?}");
}

#[test]
fn a_hall_explored_along_its_walls_only_is_told_and_a_core_with_walls_is_not() {
    // A ring of free cells, 2 m wide, around 8 m x 4 m that are unknown; or the same with a wall around them.
    let mut hall = room(60, 40, 0.2);
    let middle = |x: std::ops::Range<u32>, y: std::ops::Range<u32>| {
        x.flat_map(move |x| y.clone().map(move |y| Cell::new(x, y)))
    };
    for cell in middle(12..52, 12..32) {
        hall.grid.cells[cell] = Occupancy::Unknown;
    }
    assert_eq!(names(&hall), ["unexplored"]);
    let text = check(&hall).to_string();
    assert!(
        text.contains("warning: 1 unknown area (32 m² beside 64 m² of free cells) is enclosed"),
        "{text}"
    );
    let mut core = hall.grid.clone();
    for cell in middle(11..53, 11..33) {
        if !(12..52).contains(&cell.x) || !(12..32).contains(&cell.y) {
            core.cells[cell] = Occupancy::Occupied;
        }
    }
    assert!(names(&loaded(core)).is_empty());
}

fn eval_maps(data: &Path) -> Vec<PathBuf> {
    let folders = fs::read_dir(data.join("eval")).unwrap().map(|entry| entry.unwrap().path());
    let mut maps: Vec<PathBuf> =
        folders.map(|folder| folder.join("map.yaml")).filter(|yaml| yaml.exists()).collect();
    maps.sort();
    maps
}

#[test]
fn real_maps_pass_and_spoiled_copies_are_found() {
    let Some(data) = real_maps::folder() else { return };
    let has = |map: &LoadedMap, wanted: &str| usize::from(names(map).contains(&wanted));
    let mut unexplored = Vec::new();
    let (mut false_alarms, mut inverted, mut too_coarse, mut too_fine) = (0, 0, 0, 0);
    let maps = eval_maps(&data);
    for path in &maps {
        let map = load_map(path, &ReadOptions::default()).unwrap();
        let alarms: Vec<_> =
            names(&map).into_iter().filter(|found| ["inverted", "resolution"].contains(found)).collect();
        if !alarms.is_empty() {
            println!("false alarm {alarms:?} on {}", path.display());
            false_alarms += 1;
        }
        if has(&map, "unexplored") > 0 {
            unexplored.push(path.clone());
        }
        inverted += has(&negated(&map), "inverted");
        too_coarse += has(&scaled(&map, 10.0), "resolution");
        too_fine += has(&scaled(&map, 0.1), "resolution");
    }
    let n = maps.len();
    println!(
        "{n} maps: false alarms {false_alarms}; found {inverted} of {n} negatives, {too_coarse} of {n} ten times \
         too coarse, {too_fine} of {n} ten times too fine"
    );
    assert_eq!(false_alarms, 0);
    // The laser was not driven through the middle of this one.
    assert_eq!(unexplored, [data.join("eval/ros_willow_2010_10cm/map.yaml")]);
    let ring = data.join("cases/20-explored-along-walls/factory.yaml");
    assert!(names(&load_map(&ring, &ReadOptions::default()).unwrap()).contains(&"unexplored"));
    assert!(inverted * 100 >= n * 95, "{inverted} of {n} negatives");
    assert!(too_fine * 100 >= n * 80, "{too_fine} of {n} ten times too fine");
    assert!(too_coarse * 100 >= n * 50, "{too_coarse} of {n} ten times too coarse");
}
