//! Every format is read back by something that this project did not write, and says where things are.

use std::collections::{BTreeMap, BTreeSet};

use crate::building::{self, Building};
use geojson::{FeatureCollection, GeometryValue};
use placegraph::export::*;
use placegraph::geom::{Point2, Pose2};
use placegraph::grid::Cell;
use placegraph::topology::PlaceId;

/// Neither at the origin nor along the axes.
pub(crate) const TURNED: Pose2 = Pose2::new(-3.7, 12.3, 0.4);
pub(crate) const UPRIGHT: Pose2 = Pose2::new(-3.7, 12.3, 0.0);

/// Half the diagonal of a cell and what formats round away.
const WITHIN_A_CELL_M: f64 = 0.05;

/// A doorway that leads from two rooms into a corridor.
const THREE_SIDES: &str = "
    ##############
    #rrrrrr#ccccc#
    #rrrrrr#ccccc#
    #rrrrrddccccc#
    ######ddccccc#
    #rrrrrddccccc#
    #rrrrrr#ccccc#
    #rrrrrr#ccccc#
    ##############
";

fn rmf(building: &Building) -> RmfBuilding<'_> {
    RmfBuilding::of_level("drawn", "L1", &building.map, building.shape(), "home.png")
}

pub(crate) fn sheet(building: &Building, rotated: Rotated) -> MaskSheet {
    MaskSheet {
        shape: building.shape(),
        rotated,
        image_name: "mask.png".into(),
        map_name: "mask.yaml".into(),
        frame_id: "map".into(),
    }
}

fn tmap_info() -> TmapInfo {
    TmapInfo {
        name: "drawn".into(),
        metric_map: "drawn".into(),
        frame_id: "map".into(),
        last_updated: "11-22-2026_08-30-00".into(),
    }
}

/// The first doorway of the drawing: in the wall between the first room and the corridor.
pub(crate) fn known_doorway(building: &Building) -> (PlaceId, Point2) {
    (building.place_at(6, 7).id, building.at(6, 7))
}

#[test]
fn nav2_route_graph_is_a_graph_of_free_straight_lines() {
    let building = building::drawn(TURNED);
    let bytes = nav2_route(&building.map, "map").unwrap();
    let collection: FeatureCollection = String::from_utf8(bytes).unwrap().parse().unwrap();
    let mut nodes = BTreeMap::new();
    let mut edges = Vec::new();
    for feature in &collection.features {
        let properties = feature.properties.as_ref().unwrap();
        let id = |key: &str| properties[key].as_u64().unwrap();
        let metadata = properties["metadata"].as_object().unwrap();
        assert!(metadata["class"].is_string());
        match &feature.geometry.as_ref().unwrap().value {
            GeometryValue::Point { coordinates } => {
                nodes.insert(id("id"), Point2::new(coordinates[0], coordinates[1]));
                if !metadata.contains_key("bend") {
                    assert!(metadata["area_m2"].is_f64() && metadata["probability"].is_f64());
                    assert_eq!(
                        metadata["x_values"].as_array().unwrap().len(),
                        metadata["y_values"].as_array().unwrap().len()
                    );
                }
            }
            GeometryValue::LineString { .. } => edges.push((id("id"), id("startid"), id("endid"))),
            other => panic!("{other:?}"),
        }
    }
    let (doorway, center) = known_doorway(&building);
    assert!(nodes[&(doorway.0 as u64)].distance(center) <= WITHIN_A_CELL_M);
    let ids: BTreeSet<u64> = edges.iter().map(|edge| edge.0).chain(nodes.keys().copied()).collect();
    assert_eq!(ids.len(), edges.len() + nodes.len(), "ids of nodes and edges are disjoint");
    let ways: BTreeSet<(u64, u64)> = edges.iter().map(|edge| (edge.1, edge.2)).collect();
    for &(from, to) in &ways {
        assert!(ways.contains(&(to, from)));
        // The consumer ignores an edge's own line and drives straight.
        let [a, b] = [from, to].map(|end| building.grid.frame.cells_from_map(nodes[&end]));
        for (x, y) in placegraph_testkit::segments::cells_on_segment(a, b, 1e-6) {
            assert!(
                building.grid.is_free(Cell::new(x as u32, y as u32)),
                "{from} to {to} touches ({x}, {y})"
            );
        }
    }
    assert_eq!(reached(1, &ways).len(), nodes.len(), "one component");
}

fn reached(from: u64, ways: &BTreeSet<(u64, u64)>) -> BTreeSet<u64> {
    let mut reached = BTreeSet::from([from]);
    loop {
        let next: BTreeSet<u64> =
            ways.iter().filter(|way| reached.contains(&way.0)).map(|way| way.1).collect();
        let before = reached.len();
        reached.extend(next);
        if reached.len() == before {
            return reached;
        }
    }
}

#[test]
fn a_map_without_routes_has_no_route_graph() {
    let building = building::from_drawing("rrr", UPRIGHT);
    assert_eq!(nav2_route(&building.map, "map"), Err(ExportError::NoRoute));
}

#[test]
fn geojson_says_meters_and_has_the_area_it_names() {
    let building = building::drawn(TURNED);
    let bytes = regions_geojson(&building.map, "map", None).unwrap();
    let collection: FeatureCollection = String::from_utf8(bytes).unwrap().parse().unwrap();
    let members = collection.foreign_members.as_ref().unwrap();
    assert_eq!(members["crs"]["properties"]["name"], "urn:ogc:def:crs:EPSG::3857");
    assert_eq!(collection.features.len(), building.map.places.len());
    for feature in &collection.features {
        let GeometryValue::Polygon { coordinates } = &feature.geometry.as_ref().unwrap().value else {
            panic!("the building's places have one polygon each")
        };
        let area: f64 = coordinates.iter().map(|ring| ring_area(ring)).sum();
        let named = feature.properties.as_ref().unwrap()["area_m2"].as_f64().unwrap();
        assert!((area - named).abs() < 1e-6 * named, "{area} {named}");
        assert!(
            ring_area(&coordinates[0]) > 0.0 && coordinates[1..].iter().all(|hole| ring_area(hole) < 0.0)
        );
    }
}

/// Positive counter-clockwise.
fn ring_area(ring: &[geojson::Position]) -> f64 {
    assert_eq!(ring.first(), ring.last());
    0.5 * ring.windows(2).map(|ends| ends[0][0] * ends[1][1] - ends[1][0] * ends[0][1]).sum::<f64>()
}

#[test]
fn a_lane_names_the_door_that_it_crosses() {
    let building = building::from_drawing(THREE_SIDES, TURNED);
    let bytes = rmf_nav_graph(&rmf(&building)).unwrap();
    let graph: serde_json::Value = serde_saphyr::from_slice(&bytes).unwrap();
    let point = |value: &serde_json::Value| [0, 1].map(|axis| value[axis].as_f64().unwrap());
    let level = &graph["levels"]["L1"];
    let vertex = |index: &serde_json::Value| &level["vertices"][index.as_u64().unwrap() as usize];
    let doors = graph["doors"].as_object().unwrap();
    let (name, door) = doors.iter().next().unwrap();
    let jambs = [0, 1].map(|end| point(&door["endpoints"][end]));
    let [mut n_through, mut n_beside] = [0, 0];
    for lane in level["lanes"].as_array().unwrap() {
        let ends = [vertex(&lane[0]), vertex(&lane[1])];
        let crosses = rmf_segments_intersect(point(ends[0]), point(ends[1]), jambs[0], jambs[1]);
        assert_eq!(lane[2].get("door_name").is_some(), crosses, "{lane}");
        if ends.iter().all(|end| end[2]["name"].as_str().unwrap().starts_with(&format!("{name}/"))) {
            *if crosses { &mut n_through } else { &mut n_beside } += 1;
        }
    }
    // Both rooms to the corridor and back through the door; from room to room on its near side.
    assert_eq!((doors.len(), n_through, n_beside), (1, 4, 2));
}

/// How RMF's editor decides that a lane leads through a door.
fn rmf_segments_intersect(a: [f64; 2], b: [f64; 2], c: [f64; 2], d: [f64; 2]) -> bool {
    let det = (a[0] - b[0]) * (c[1] - d[1]) - (a[1] - b[1]) * (c[0] - d[0]);
    let t = ((a[0] - c[0]) * (c[1] - d[1]) - (a[1] - c[1]) * (c[0] - d[0])) / det;
    let u = -((a[0] - b[0]) * (a[1] - c[1]) - (a[1] - b[1]) * (a[0] - c[0])) / det;
    det.abs() >= 0.01 && (0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&u)
}

#[test]
fn yaml_keeps_names_that_look_like_something_else() {
    let mut building = building::drawn(UPRIGHT);
    for (place, name) in
        building.map.places.iter_mut().zip(["no", "007", "null", "a: b # c", "1e3", "~", "x\ty"])
    {
        name.clone_into(&mut place.name);
    }
    let bytes = tmap2(&building.map, &tmap_info()).unwrap();
    let file: serde_json::Value = serde_saphyr::from_slice(&bytes).unwrap();
    for (place, node) in building.map.places.iter().zip(file["nodes"].as_array().unwrap()) {
        assert_eq!(node["node"]["name"], place.name.as_str());
    }
}

#[test]
fn the_drawing_is_valid_svg() {
    let building = building::drawn(TURNED);
    let svg = regions_svg(&building.map, &building.labels, &building.shape());
    let tree = resvg::usvg::Tree::from_str(&svg, &resvg::usvg::Options::default()).unwrap();
    // 240 by 95 cells of 2 pixels and two margins.
    assert!((tree.size().width() - 520.0).abs() < 0.5 && (tree.size().height() - 230.0).abs() < 0.5);
}

#[test]
fn a_report_cannot_be_left_by_a_name() {
    let mut building = building::drawn(UPRIGHT);
    building.map.places[0].name = "</script><script>alert(1)</script>".into();
    let html = report_html(&report_input(&building)).unwrap();
    assert_eq!(html.matches("</script>").count(), 4, "two pictures, data, script");
    assert!(!html.contains("@DATA@") && !html.contains("<script>alert"));
}

fn report_input(building: &Building) -> ReportInput<'_> {
    ReportInput {
        title: "Drawn building",
        frame_id: "map",
        map: &building.map,
        labels: &building.labels,
        shape: Box::leak(Box::new(building.shape())),
        occupancy: Some(&building.grid.cells),
        probability: None,
        findings: &[],
        provenance: "drawn by hand",
    }
}

#[test]
fn what_is_cut_off_is_closed_and_in_no_graph() {
    let mut building = building::drawn(Pose2::default());
    let shut = building.place_at(40, 15).id;
    building.map.places.iter_mut().find(|place| place.id == shut).unwrap().cut_off = true;
    let name = building.map.place(shut).unwrap().name.clone();
    let at = building.grid.frame.cell_at(building.at(40, 15)).unwrap();
    let cell = |keepout: &Keepout| {
        let files = keepout_mask(&building.map, &sheet(&building, Rotated::Refuse), keepout).unwrap();
        let image = image::load_from_memory(&files.image).unwrap().into_luma8();
        image.get_pixel(at.x, image.height() - 1 - at.y).0[0]
    };
    assert_eq!(cell(&Keepout::default()), 100);
    let mut named = Keepout::default();
    named.cost.place.insert(name.clone(), 0.0);
    assert_eq!(cell(&named), 0, "unless the place is named");
    for graph in [
        nav2_route(&building.map, "map").unwrap(),
        rmf_nav_graph(&rmf(&building)).unwrap(),
        tmap2(&building.map, &tmap_info()).unwrap(),
    ] {
        let text = String::from_utf8(graph).unwrap();
        assert!(!text.contains(&name) && text.contains("corridor"), "{text}");
    }
}

#[test]
fn segments_are_the_rooms_in_both_lists() {
    let building = building::drawn(Pose2::default());
    let list: serde_json::Value =
        serde_json::from_slice(&segments_json(&building.map, "home").unwrap()).unwrap();
    let valetudo: serde_json::Value =
        serde_json::from_slice(&valetudo_json(&building.map, &building.shape()).unwrap()).unwrap();
    let layers = valetudo["layers"].as_array().unwrap();
    let segments: Vec<_> = layers.iter().filter(|layer| layer["type"] == "segment").collect();
    assert_eq!(list.as_array().unwrap().len(), segments.len());
    for (listed, segment) in list.as_array().unwrap().iter().zip(&segments) {
        assert_eq!(
            (&listed["id"], &listed["name"]),
            (&segment["metaData"]["segmentId"], &segment["metaData"]["name"])
        );
        assert_eq!(listed["group"], "home");
        let id: u32 = listed["id"].as_str().unwrap().parse().unwrap();
        let place = building.map.place(PlaceId(id)).unwrap();
        assert_eq!(segment["metaData"]["area"].as_u64().unwrap(), (place.area_m2 * 1e4).round() as u64);
        // A run that contains the anchor, y from the top.
        let at = building.grid.frame.cell_at(place.anchor).unwrap();
        let row = u64::from(building.grid.cells.height() - 1 - at.y);
        let runs: Vec<u64> =
            segment["compressedPixels"].as_array().unwrap().iter().map(|n| n.as_u64().unwrap()).collect();
        let has = |run: &[u64]| run[1] == row && (run[0]..run[0] + run[2]).contains(&u64::from(at.x));
        assert!(runs.chunks_exact(3).any(has), "{id}");
    }
    assert_eq!(valetudo["pixelSize"], 5);
}

#[test]
fn the_building_lies_on_its_background() {
    let building = building::drawn(Pose2::new(-3.0, 2.0, 0.4));
    let shape = building.shape();
    let file: serde_json::Value =
        serde_saphyr::from_str(&String::from_utf8(rmf_building(&rmf(&building)).unwrap()).unwrap()).unwrap();
    let level = &file["levels"]["L1"];
    let layer = &level["layers"]["map"];
    assert_eq!(layer["filename"], "home.png");
    let number = |key: &str| layer["transform"][key].as_f64().unwrap();
    let image =
        image::load_from_memory(&rmf_background(&building.map, &shape).unwrap()).unwrap().into_luma8();
    // As the editor places a pixel: turned by -yaw, y up, the first row at the translation.
    let value = |place: &placegraph::topology::Place| {
        let (x, y) = (place.anchor.x - number("translation_x"), place.anchor.y - number("translation_y"));
        let (sin, cos) = (-number("yaw")).sin_cos();
        let (column, row) = ((x * cos + y * sin) / number("scale"), (y * cos - x * sin) / number("scale"));
        image.get_pixel(column as u32, row as u32).0[0]
    };
    assert!(building.map.places.iter().all(|place| value(place) == 255));
    let n_corners: usize =
        building.map.places.iter().flat_map(|place| &place.outline).map(|part| part.exterior.len()).sum();
    let n_floor: usize = level["floors"]
        .as_array()
        .unwrap()
        .iter()
        .map(|floor| floor["vertices"].as_array().unwrap().len())
        .sum();
    assert!(n_floor <= n_corners && n_floor >= 3 * building.map.places.len(), "{n_floor} of {n_corners}");
}

#[test]
fn graphviz_reads_backslashes_as_they_are() {
    let mut building = building::drawn(Pose2::default());
    building.map.places[0].name = "c:\\new \"lab\"\\".to_owned();
    let text = dot(&building.map, &building.labels);
    assert!(text.contains(r#"c:\\new \"lab\"\\"#), "{text}");
    assert!(!text.contains(r"c:\new"), "{text}");
}
