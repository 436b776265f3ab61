//! Sites of several floors: names, lifts, routes, and what is refused.

use std::sync::LazyLock;

use placegraph::document::{MapInfo, TopologyDocument};
use placegraph::geom::Point2;
use placegraph::grid::OccupancyGrid;
use placegraph::model::Model;
use placegraph::pipeline::{Analysis, Config, analyze};
use placegraph::progress::Silent;
use placegraph::site::{LabeledFloor, Leg, RIDE_M, ShaftKind, SiteDocument, SiteError, SiteFile, stops};
use placegraph::topology::edits::EditFile;
use placegraph::topology::query::find_route;
use placegraph::topology::{Place, PlaceId, PlaceRaster};

const DRAWING: &str = include_str!("../../examples/data/building.txt");

/// A corridor with rooms on both sides, 25 cm a letter, 10.5 by 4.75 m.
fn floor(edits: &str) -> (OccupancyGrid, Analysis) {
    let map = OccupancyGrid::from_ascii(0.25, &DRAWING.replace(['c', 'r', 'd'], "."));
    let config = Config { edits: EditFile::from_toml(edits).unwrap().edits, ..Config::default() };
    let analysis = analyze(&map, &Model::builtin(), &config, &Silent);
    (map, analysis)
}

static PLAIN: LazyLock<(OccupancyGrid, Analysis)> = LazyLock::new(|| floor(""));

fn labeled(file: &SiteFile, level: &str, (map, analysis): &(OccupancyGrid, Analysis)) -> LabeledFloor {
    let info = MapInfo::of(map, level, "1");
    let mut document = TopologyDocument::new(info, None, &Model::builtin().label_set, &analysis.topology);
    document.seal().unwrap();
    LabeledFloor { document, stops: stops(file, level, analysis, 0.0).unwrap() }
}

/// A file of two floors, and what is added to it.
fn file(more: &str) -> SiteFile {
    let floors = "name = 's'\n[[floor]]\nlevel = 1\nmap = 'a'\n[[floor]]\nlevel = 'L2'\nmap = 'b'\n";
    SiteFile::from_toml(&(floors.to_owned() + more)).unwrap()
}

fn joined(more: &str) -> SiteDocument {
    let file = file(more);
    SiteDocument::join(&file, &["1", "L2"].map(|level| labeled(&file, level, &PLAIN))).unwrap()
}

const LIFT: &str = "[[lift]]\nname = 'lift A'\nat = { 1 = [1.0, 2.4], L2 = [9.0, 2.4] }\n";
const STAIRS: &str = "[[stairs]]\nname = 'stairs'\nat = { 1 = [5.0, 2.4], L2 = [5.0, 2.4] }\n";

/// The place that contains a point.
fn place_at(site: &SiteDocument, level: usize, x: f64, y: f64) -> &Place {
    let level = &site.levels[level];
    let raster = PlaceRaster::new(&level.topology(), level.map.shape().unwrap());
    level.place(raster.place_at(Point2::new(x, y)).unwrap()).unwrap()
}

#[test]
fn names_are_unique_in_the_site_and_those_of_people_stay() {
    let file = file(LIFT);
    let named = floor("[[edit]]\naction = 'rename'\nat = [1.0, 0.8]\nname = 'kitchen'\n");
    let floors = [labeled(&file, "1", &named), labeled(&file, "L2", &PLAIN)];
    let site = SiteDocument::join(&file, &floors).unwrap();
    assert_eq!(place_at(&site, 0, 1.0, 0.8).name, "kitchen");
    let above = place_at(&site, 1, 1.0, 0.8);
    assert_eq!(above.name, format!("L2 room {}", above.id.0));
    assert_eq!(site.place_called("kitchen").unwrap(), (0, place_at(&site, 0, 1.0, 0.8)));
    // Both floors have a kitchen now.
    let twice = SiteDocument::join(&file, &["1", "L2"].map(|level| labeled(&file, level, &named)));
    assert!(
        matches!(twice, Err(SiteError::DoublePlace { name, levels }) if name == "kitchen" && levels == ["1", "L2"])
    );
}

#[test]
fn a_route_rides_between_the_floors() {
    let site = joined(LIFT);
    let (from, to) = (place_at(&site, 0, 9.0, 0.8), place_at(&site, 1, 1.0, 4.0));
    let route = site.route((0, from.id), (1, to.id), false).unwrap();
    let [
        Leg::Walk { level: 0, way: first },
        Leg::Ride { shaft: 0, levels: [0, 1] },
        Leg::Walk { level: 1, way: last },
    ] = route.legs.as_slice()
    else {
        panic!("{route:?}")
    };
    assert_eq!(first.line.last(), Some(&Point2::new(1.0, 2.4)), "into the lift");
    assert_eq!(last.line.first(), Some(&Point2::new(9.0, 2.4)), "out of the lift");
    assert_eq!((first.places.first(), last.places.last()), (Some(&from.id), Some(&to.id)));
    for (level, way) in [(0, first), (1, last)] {
        let level = &site.levels[level];
        let raster = PlaceRaster::new(&level.topology(), level.map.shape().unwrap());
        assert!(way.line.windows(2).all(|ends| raster.is_free_between(ends[0], ends[1])));
        // Not shorter than straight ahead, not longer than over the station of the corridor.
        let ends = [way.line[0], way.line[way.line.len() - 1]];
        let stop = site.shafts[0].stops.iter().find(|stop| stop.level == level.level).unwrap();
        let map = level.topology();
        let over = [way.places[0], way.places[way.places.len() - 1]];
        let over_m = find_route(&map, over[0], over[1]).unwrap().length_m + stop.route.length_m;
        assert!((ends[0].distance(ends[1])..=over_m).contains(&way.length_m), "{} {over_m}", way.length_m);
    }
    assert!((route.length_m() - first.length_m - last.length_m).abs() < 1e-12);
    // On one floor nobody rides.
    let same = site.route((0, from.id), (0, place_at(&site, 0, 1.0, 0.8).id), false).unwrap();
    assert!(matches!(same.legs.as_slice(), [Leg::Walk { level: 0, .. }]));
}

#[test]
fn robots_do_not_take_stairs_and_people_do_where_they_are_shorter() {
    let site = joined(&[LIFT, STAIRS].concat());
    let [a, b] = [0, 1].map(|level| (level, place_at(&site, level, 5.0, 2.4).id));
    let by = |stairs: bool| {
        let route = site.route(a, b, stairs).unwrap();
        let shaft = route.legs.iter().find_map(|leg| match leg {
            Leg::Ride { shaft, .. } => Some(site.shafts[*shaft].kind),
            Leg::Walk { .. } => None,
        });
        shaft.unwrap()
    };
    assert_eq!((by(false), by(true)), (ShaftKind::Lift, ShaftKind::Stairs));
    let only_stairs = joined(STAIRS);
    assert_eq!(only_stairs.route(a, b, false), None);
    assert!(only_stairs.route(a, b, true).is_some());
}

#[test]
fn a_lift_that_saves_less_than_its_waiting_is_not_taken() {
    // Two lifts side by side: over the other floor and back is never shorter on one floor.
    let far = "[[lift]]\nname = 'lift B'\nat = { 1 = [9.0, 2.4], L2 = [9.5, 2.4] }\n";
    let site = joined(&[LIFT, far].concat());
    let [a, b] = [1.0, 9.0].map(|x| (0, place_at(&site, 0, x, 0.8).id));
    assert_eq!(site.route(a, b, false).unwrap().legs.len(), 1);
    const { assert!(RIDE_M > 10.5, "the floor is shorter than what a ride costs") };
}

#[test]
fn what_cannot_be_a_lift_is_refused_with_its_place() {
    let refused = |at: &str| {
        let file = file(&format!("[[lift]]\nname = 'lift A'\nat = {{ 1 = [1.0, 2.4], L2 = {at} }}\n"));
        stops(&file, "L2", &PLAIN.1, 0.0).unwrap_err().to_string()
    };
    for at in ["[-5.0, 2.4]", "[0.1, 0.1]", "[1e7, 0.0]"] {
        let message = refused(at);
        assert!(message.starts_with("lift A on L2 is at ") && message.contains("not free"), "{message}");
    }
    let file = file(LIFT);
    let message = stops(&file, "L2", &PLAIN.1, 5.0).unwrap_err().to_string();
    assert!(message.contains("radius of 5 m") && message.contains("lift A on L2"), "{message}");
    // Stairs are for people, whatever the robot's radius.
    let stairs = self::file(STAIRS);
    assert!(stops(&stairs, "L2", &PLAIN.1, 5.0).unwrap()[0].is_some());
}

#[test]
fn a_site_file_that_contradicts_itself_is_refused() {
    let floors = "name = 's'\n[[floor]]\nlevel = 'a'\nmap = 'm'\n[[floor]]\nlevel = 'b'\nmap = 'm'\n";
    let lift = |at: &str| format!("{floors}[[lift]]\nname = 'l'\nat = {at}\n");
    let cases = [
        ("name = 's'\n".to_owned(), "at least one [[floor]]"),
        (floors.replace("'b'", "'A'"), "twice"),
        (floors.replace("'b'", "'../b'"), "the name of a level"),
        (floors.replace("'s'", "'.s'"), "the name of a site"),
        (floors.replace("'b'", "''"), "the name of a level"),
        (floors.replace("map = 'm'", "map = 'm'\nheight = 3"), "line 5, column 1: unknown field `height`"),
        (
            lift("{ a = [0, 0], c = [0, 0] }"),
            "stops on \"c\", which is not a level of this site; there are a, b",
        ),
        (lift("{ a = [0, 0] }"), "at least two levels"),
        (lift("{ a = [0, 0], b = [nan, 0] }"), "the point of l on b"),
        (lift("{ a = [0, 0], b = [0, 0] }\nsize_m = [0, 1]"), "0.3 to 20 m"),
        (
            lift("{ a = [0, 0], b = [0, 0] }\n[[stairs]]\nname = 'l'\nat = { a = [0, 0], b = [0, 0] }"),
            "twice",
        ),
        (floors.replace("map = 'm'", "map = 'm'\npose = [0, 0, inf]"), "the pose of floor a"),
    ];
    for (text, words) in cases {
        let message = SiteFile::from_toml(&text).unwrap_err().to_string();
        assert!(message.contains(words) && message.lines().count() == 1, "{words}: {message}");
    }
    let heights = |text: &str| {
        let file = SiteFile::from_toml(text).unwrap();
        file.floors.iter().map(|floor| floor.elevation_m.unwrap()).collect::<Vec<_>>()
    };
    assert_eq!(heights(floors), [0.0, 4.0]);
    assert_eq!(heights(&floors.replacen("map = 'm'", "map = 'm'\nelevation = -3", 1)), [-3.0, 1.0]);
}

#[test]
fn a_document_is_read_as_it_was_written_and_refused_where_it_was_changed() {
    let mut site = joined(&[LIFT, STAIRS].concat());
    let files = site.files().unwrap();
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(
        names,
        [
            "1.route_graph.geojson",
            "L2.route_graph.geojson",
            "s.building.yaml",
            "nav_graph.yaml",
            "s.1.png",
            "s.L2.png",
            "site.json"
        ]
    );
    let (_, bytes) = files.last().unwrap();
    let read = SiteDocument::from_json(bytes).unwrap();
    assert!(read == site && read.is_sealed());
    let changed = |change: fn(&mut SiteDocument)| {
        let mut site = read.clone();
        change(&mut site);
        assert!(!site.is_sealed());
        SiteDocument::from_json(site.to_json().unwrap().as_bytes()).unwrap_err()
    };
    assert!(matches!(changed(|site| site.shafts[0].stops[1].level = "L3".into()), SiteError::Stop { .. }));
    assert!(matches!(changed(|site| site.shafts[0].stops[1].place = PlaceId(999)), SiteError::Stop { .. }));
    assert!(matches!(changed(|site| site.shafts[0].stops[0].route.line.clear()), SiteError::Stop { .. }));
    assert!(matches!(changed(|site| site.levels[1].level = "1".into()), SiteError::DoubleLevel { .. }));
    assert!(matches!(changed(|site| site.shafts[1].name = "lift A".into()), SiteError::DoublePlace { .. }));
    assert!(matches!(changed(|site| site.levels[0].places[0].area_m2 += 1.0), SiteError::Level { .. }));
    assert!(matches!(changed(|site| site.levels[0].site_from_map.x = 1e12), SiteError::Number { .. }));
}

#[test]
fn a_part_that_a_lift_joins_is_not_cut_off() {
    // A room of its own in the left half, which no door joins.
    let drawing = "##########\n#...#....#\n#...#....#\n#...#....#\n#...#....#\n##########";
    let map = OccupancyGrid::from_ascii(0.5, drawing);
    let analysis = analyze(&map, &Model::builtin(), &Config::default(), &Silent);
    let apart = (map, analysis);
    let document = |more: &str| {
        let file = file(more);
        let floors = [labeled(&file, "1", &apart), labeled(&file, "L2", &PLAIN)];
        SiteDocument::join(&file, &floors).unwrap()
    };
    assert!(place_at(&document(LIFT.replace("1.0, 2.4", "3.5, 1.5").as_str()), 0, 1.2, 1.2).cut_off);
    let site = document(LIFT.replace("1.0, 2.4", "1.2, 1.2").as_str());
    assert!(!place_at(&site, 0, 1.2, 1.2).cut_off, "reached from above");
    let stairs = STAIRS.replace("5.0, 2.4]", "1.2, 1.2]");
    assert!(place_at(&document(&stairs), 0, 1.2, 1.2).cut_off, "robots do not take stairs");
}

#[test]
fn the_building_of_open_rmf_has_all_levels_and_lifts() {
    // The second floor is turned by half a turn, and its lift stands on that of the first.
    let more = LIFT.to_owned() + STAIRS;
    let file = SiteFile::from_toml(
        &("name = 's'\n[[floor]]\nlevel = '1'\nmap = 'a'\n[[floor]]\nlevel = 'L2'\nmap = 'b'\npose = [10, 4.8, 180]\n".to_owned()
            + &more),
    )
    .unwrap();
    let floors = ["1", "L2"].map(|level| labeled(&file, level, &PLAIN));
    let mut site = SiteDocument::join(&file, &floors).unwrap();
    assert_eq!(site.findings, [""; 0], "(9, 2.4) turned is (1, 2.4)");
    let files = site.files().unwrap();
    let yaml = |name: &str| -> serde_json::Value {
        let (_, bytes) = files.iter().find(|(file, _)| file == name).unwrap();
        serde_saphyr::from_slice(bytes).unwrap()
    };
    let graph = yaml("nav_graph.yaml");
    let position: Vec<f64> = graph["lifts"]["lift A"]["position"]
        .as_array()
        .unwrap()
        .iter()
        .map(|v| v.as_f64().unwrap())
        .collect();
    assert_eq!(position[..2], [1.0, 2.4]);
    assert!(graph["lifts"].get("stairs").is_none());
    for level in ["1", "L2"] {
        let vertices = graph["levels"][level]["vertices"].as_array().unwrap();
        let in_lift: Vec<usize> =
            (0..vertices.len()).filter(|&index| vertices[index][2]["lift"] == "lift A").collect();
        let [vertex] = in_lift[..] else { panic!("one vertex in the lift: {in_lift:?}") };
        let at = [0, 1].map(|axis| vertices[vertex][axis].as_f64().unwrap());
        assert!((at[0] - 1.0).abs() < 1e-3 && (at[1] - 2.4).abs() < 1e-3, "{level}: {at:?}");
        let lanes = graph["levels"][level]["lanes"].as_array().unwrap();
        let reached = lanes.iter().filter(|lane| lane[1] == vertex).count();
        assert_eq!(reached, 1, "{level}: a lane leads into the lift");
    }
    let building = yaml("s.building.yaml");
    let lift = &building["lifts"]["lift A"];
    assert_eq!((&lift["lowest_floor"], &lift["highest_floor"]), (&"1".into(), &"L2".into()));
    assert_eq!(building["levels"]["L2"]["elevation"].as_f64(), Some(4.0));
    let cabins = building["levels"]["L2"]["vertices"].as_array().unwrap().iter();
    assert_eq!(cabins.filter(|vertex| vertex[4]["lift_cabin"][1] == "lift A").count(), 1);
    // Every side that a level has a door on is a door of the cabin.
    for sides in lift["level_doors"].as_object().unwrap().values() {
        assert!(lift["doors"].get(sides[0].as_str().unwrap()).is_some());
    }
}
