//! `report.html`: the whole result on one page that needs no network and no server.
//!
//! The page is a template with a style sheet and a script; what it shows is put in as JSON, pictures as data
//! addresses. Cost: linear in cells (the pictures) and corners of outlines.

use std::collections::BTreeSet;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use serde_json::{Value, json};

use super::ExportError;
use super::overlay::listed_places;
use crate::geom::Point2;
use crate::grid::{Grid, GridShape, Occupancy};
use crate::labels::LabelSet;
use crate::topology::{Connection, Place, PlaceId, TopologicalMap};

const TEMPLATE: &str = include_str!("../../assets/report.html");

/// Where the template takes its data.
const PLACEHOLDER: &str = "\"@DATA@\"";

/// What a report is about.
#[derive(Clone, Copy, Debug)]
pub struct ReportInput<'a> {
    /// Heading of the page.
    pub title: &'a str,
    /// Name of the frame that coordinates are in.
    pub frame_id: &'a str,
    /// The result.
    pub map: &'a TopologicalMap,
    /// Its classes.
    pub labels: &'a LabelSet,
    /// The grid it was made from.
    pub shape: &'a GridShape,
    /// The grid's values; without them the page has no such layer.
    pub occupancy: Option<&'a Grid<Occupancy>>,
    /// Probability of the most likely class of every cell, 0 where there is none; without it the page shows the
    /// mean of each place.
    pub probability: Option<&'a Grid<f32>>,
    /// What the check of the map found, in plain words.
    pub findings: &'a [String],
    /// What the result was made with and from, for the foot of the page.
    pub provenance: &'a str,
}

/// The page.
///
/// # Errors
/// None for maps that this library built.
pub fn report_html(input: &ReportInput<'_>) -> Result<String, ExportError> {
    let occupancy = input.occupancy.map(occupancy_picture).transpose()?;
    let probability = input.probability.map(probability_picture).transpose()?;
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
        "occupancy": occupancy,
        "probability": probability,
        "places": places.collect::<Vec<_>>(),
        "connections": input.map.connections.iter().map(|c| connection_data(input, c)).collect::<Vec<_>>(),
        "findings": input.findings,
        "provenance": input.provenance,
    });
    // Inside of a script element only `<` could end it.
    Ok(TEMPLATE.replacen(PLACEHOLDER, &data.to_string().replace('<', "\\u003c"), 1))
}

/// A point in cells, y down from the map's upper edge, as the page draws it.
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

fn occupancy_picture(cells: &Grid<Occupancy>) -> Result<String, ExportError> {
    // White, black and gray with transparency, so that unknown space takes the color of the page.
    let colors = cells.map(|value| match value {
        Occupancy::Free => [255, 255, 255, 255],
        Occupancy::Occupied => [40, 44, 56, 255],
        Occupancy::Unknown => [128, 134, 148, 90],
    });
    picture(&colors)
}

fn probability_picture(cells: &Grid<f32>) -> Result<String, ExportError> {
    picture(&cells.map(|&p| if p > 0.0 { shade(p) } else { [0; 4] }))
}

/// Dark violet for 0.3 and below, over teal, to yellow for 1.
fn shade(probability: f32) -> [u8; 4] {
    const STOPS: [[f32; 3]; 3] = [[68.0, 1.0, 84.0], [33.0, 145.0, 140.0], [253.0, 231.0, 37.0]];
    let t = ((probability - 0.3) / 0.7).clamp(0.0, 1.0) * 2.0;
    let first = (t as usize).min(1);
    let part = t - first as f32;
    let mix =
        |channel: usize| (STOPS[first][channel] * (1.0 - part) + STOPS[first + 1][channel] * part) as u8;
    [mix(0), mix(1), mix(2), 230]
}

/// The data address of a picture, first row on top.
fn picture(cells: &Grid<[u8; 4]>) -> Result<String, ExportError> {
    let pixels: Vec<u8> =
        (0..cells.height()).rev().flat_map(|y| cells.row(y).iter().flatten()).copied().collect();
    let mut png = Vec::new();
    PngEncoder::new(&mut png)
        .write_image(&pixels, cells.width(), cells.height(), ExtendedColorType::Rgba8)
        .map_err(|error| ExportError::writer("PNG", &error))?;
    Ok(format!("data:image/png;base64,{}", STANDARD.encode(png)))
}
