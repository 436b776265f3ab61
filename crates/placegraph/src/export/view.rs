//! The data of a result that the viewer shows, in the report and on the browser page.
//!
//! The viewer is plain script (`assets/viewer`); it takes the result as JSON in cells, y down from the map's upper
//! edge, and pictures as a byte per cell. Cost: linear in cells (the pictures) and corners of outlines.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use super::ReportInput;
use super::overlay::listed_places;
use crate::geom::Point2;
use crate::grid::{CellGraph, Grid, Occupancy};
use crate::labels::Labeling;
use crate::topology::{Connection, Place, PlaceId};

/// Style of the viewer and of the page around it.
pub const VIEWER_STYLE: &str = include_str!("../../assets/viewer/viewer.css");

/// The viewer, each module after those that it uses.
const MODULES: [&str; 8] = [
    include_str!("../../assets/viewer/dom.js"),
    include_str!("../../assets/viewer/camera.js"),
    include_str!("../../assets/viewer/mapdata.js"),
    include_str!("../../assets/viewer/placement.js"),
    include_str!("../../assets/viewer/raster.js"),
    include_str!("../../assets/viewer/layers.js"),
    include_str!("../../assets/viewer/viewer.js"),
    include_str!("../../assets/viewer/controls.js"),
];

/// The viewer and then `modules` as one script that needs no server. Names are unique over all modules, so imports
/// and exports are removed.
pub fn viewer_script(modules: &[&str]) -> String {
    let mut script = "\"use strict\";\n(() => {\n".to_owned();
    for line in MODULES.iter().chain(modules).flat_map(|module| module.lines()) {
        if !line.starts_with("import ") {
            script += line.strip_prefix("export ").unwrap_or(line);
            script.push('\n');
        }
    }
    script + "})();\n"
}

/// The result as the viewer's JSON, without pictures.
pub fn view_json(input: &ReportInput<'_>) -> String {
    let listed: BTreeSet<PlaceId> = listed_places(input.map).iter().map(|place| place.id).collect();
    let places = input.map.places.iter().map(|place| place_data(input, place, !listed.contains(&place.id)));
    let data = json!({
        "title": input.title,
        "frame": input.frame_id,
        "resolution_m": input.shape.frame.resolution_m(),
        "origin": input.shape.frame.map_from_grid(),
        "width": input.shape.width,
        "height": input.shape.height,
        "classes": input.labels.classes(),
        "places": places.collect::<Vec<_>>(),
        "connections": input.map.connections.iter().map(|c| connection_data(input, c)).collect::<Vec<_>>(),
        "findings": input.findings,
        "provenance": input.provenance,
    });
    data.to_string()
}

/// One byte per cell, first row on top: 255 free, 128 unknown, 0 occupied.
pub fn view_occupancy(cells: &Grid<Occupancy>) -> Vec<u8> {
    from_top(cells, |value| match value {
        Occupancy::Free => 255,
        Occupancy::Unknown => 128,
        Occupancy::Occupied => 0,
    })
}

/// One byte per cell, first row on top: the probability of the most likely class in 255ths, 0 for cells that are not
/// free.
pub fn view_probability(cells: &Grid<f32>) -> Vec<u8> {
    from_top(cells, |p| (p * 255.0).round() as u8)
}

/// One byte per cell, first row on top: the class of the cell, numbered from 1; 0 for cells that are not free.
///
/// # Panics
/// If there is not one label per node.
pub fn view_labels(graph: &CellGraph, labeling: &Labeling) -> Vec<u8> {
    let numbers: Vec<u8> = labeling.iter().map(|label| label.0 + 1).collect();
    from_top(&graph.to_grid(&numbers, 0), |number| number)
}

fn from_top<T: Copy>(cells: &Grid<T>, byte: impl Fn(T) -> u8) -> Vec<u8> {
    let rows = (0..cells.height()).rev();
    rows.flat_map(|y| cells.row(y).iter().map(|&value| byte(value))).collect()
}

/// A point in cells, y down from the map's upper edge, as the viewer draws it.
fn on_page(input: &ReportInput<'_>, point: Point2) -> Value {
    let cells = input.shape.frame.cells_from_map(point);
    let hundredth = |v: f64| (v * 100.0).round() / 100.0 + 0.0;
    json!([hundredth(cells.x), hundredth(input.shape.height as f64 - cells.y)])
}

fn place_data(input: &ReportInput<'_>, place: &Place, is_speck: bool) -> Value {
    let points = |ring: &Vec<Point2>| ring.iter().map(|&point| on_page(input, point)).collect::<Vec<_>>();
    let rings = place.rings();
    json!({
        "id": place.id,
        "name": place.name,
        "class": place.class,
        "probability": place.probability,
        "area_m2": place.area_m2,
        "speck": is_speck,
        "clearance_m": place.clearance_m,
        "x": place.anchor.x,
        "y": place.anchor.y,
        "at": on_page(input, input.map.station(place)),
        "rings": rings.map(points).collect::<Vec<_>>(),
        "width_m": place.doorway.as_ref().map(|doorway| doorway.width_m),
        "jambs": place.doorway.as_ref().map(|doorway| doorway.jambs.map(|jamb| on_page(input, jamb))),
        "sides": place.doorway.as_ref().map(|doorway| &doorway.sides),
    })
}

fn connection_data(input: &ReportInput<'_>, connection: &Connection) -> Value {
    json!({
        "a": connection.a,
        "b": connection.b,
        "contact_m": connection.contact_m,
        "length_m": connection.route.as_ref().map(|route| route.length_m),
        "line": connection.line_from(connection.a).into_iter().map(|p| on_page(input, p)).collect::<Vec<_>>(),
    })
}
