//! `report.html`: the whole result on one page that needs no network and no server.
//!
//! The page is a template with the viewer's style and script; what it shows is put in as JSON, pictures as data
//! addresses. Cost: linear in cells (the pictures) and corners of outlines.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

use super::ExportError;
use super::view::{VIEWER_STYLE, view_json, view_occupancy, view_probability, viewer_script};
use crate::grid::{Grid, GridShape, Occupancy};
use crate::labels::LabelSet;
use crate::topology::TopologicalMap;

const TEMPLATE: &str = include_str!("../../assets/report/report.html");
const STYLE: &str = include_str!("../../assets/report/report.css");
const MODULES: [&str; 2] =
    [include_str!("../../assets/report/tables.js"), include_str!("../../assets/report/report.js")];

/// The content of a report.
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
    /// The grid of the map.
    pub shape: &'a GridShape,
    /// The cells of the map; without them, the page has no map layer.
    pub occupancy: Option<&'a Grid<Occupancy>>,
    /// Probability of the most likely class of every cell, 0 for cells that are not free; without it, the page shows
    /// the mean of each place.
    pub probability: Option<&'a Grid<f32>>,
    /// Findings of the check of the map, in plain words.
    pub findings: &'a [String],
    /// Program, map and model of the result, for the foot of the page.
    pub provenance: &'a str,
}

/// The HTML text of the page.
///
/// # Errors
/// None for maps that this library built.
pub fn report_html(input: &ReportInput<'_>) -> Result<String, ExportError> {
    let shape = input.shape;
    let occupancy = input.occupancy.map(|cells| picture(shape, &view_occupancy(cells))).transpose()?;
    let probability = input.probability.map(|cells| picture(shape, &view_probability(cells))).transpose()?;
    let style = format!("{VIEWER_STYLE}{STYLE}");
    Ok(fill_page(
        TEMPLATE,
        &[
            ("@STYLE@", &style),
            ("@OCCUPANCY@", occupancy.as_deref().unwrap_or_default()),
            ("@PROBABILITY@", probability.as_deref().unwrap_or_default()),
            ("@DATA@", &in_script(&view_json(input))),
            ("@SCRIPT@", &viewer_script(&MODULES)),
        ],
    ))
}

/// JSON as the content of a script element, which only `<` could end.
pub fn in_script(json: &str) -> String {
    json.replace('<', "\\u003c")
}

/// Replaces every placeholder in `template`, each of which occurs once. Inserted text is not searched.
pub fn fill_page(template: &str, values: &[(&str, &str)]) -> String {
    let mut page = String::new();
    let mut rest = template;
    while let Some((at, placeholder, value)) = values
        .iter()
        .filter_map(|(placeholder, value)| Some((rest.find(placeholder)?, placeholder, value)))
        .min()
    {
        page += &rest[..at];
        page += value;
        rest = &rest[at + placeholder.len()..];
    }
    page + rest
}

/// The data address of a gray picture.
fn picture(shape: &GridShape, bytes: &[u8]) -> Result<String, ExportError> {
    let mut png = Vec::new();
    PngEncoder::new(&mut png)
        .write_image(bytes, shape.width, shape.height, ExtendedColorType::L8)
        .map_err(|error| ExportError::writer("PNG", &error))?;
    Ok(format!("data:image/png;base64,{}", STANDARD.encode(png)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_put_into_a_page_is_not_searched() {
        let page = fill_page("<@A@|@B@>", &[("@A@", "@B@ $1"), ("@B@", "x")]);
        assert_eq!(page, "<@B@ $1|x>");
        assert_eq!(fill_page("plain", &[("@A@", "x")]), "plain");
    }
}
