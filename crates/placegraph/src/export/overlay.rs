//! Outlines, doorways and the graph as SVG elements, to draw over a picture of the map.

use std::fmt::Write as _;

use super::canvas::mixed;
use crate::geom::Point2;
use crate::grid::MapFrame;
use crate::labels::{LabelSet, Role};
use crate::topology::{Place, TopologicalMap};

/// The fonts of all pictures; the first is embedded in the program.
pub(super) const FONTS: &str = "DejaVu Sans Condensed, DejaVu Sans, Arial, sans-serif";
/// Color of text and of the graph.
pub(super) const INK: &str = "#232936";

/// Places without connections are drawn from this area on, in m².
const ISLAND_M2: f64 = 1.0;

/// How meters of the map frame become pixels, y down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The position of the map's cells.
    pub frame: MapFrame,
    /// The left border of the picture, in cells.
    pub left_cells: f64,
    /// The upper border of the picture, in cells.
    pub top_cells: f64,
    /// Pixels per cell.
    pub px_per_cell: f64,
    /// Position of the upper left corner of the map on the page, in pixels.
    pub offset_px: [f64; 2],
    /// Size of text, in pixels; everything drawn follows it.
    pub text_px: f64,
}

impl View {
    /// The pixel coordinates of a point of the map frame.
    pub fn pixel(&self, point: Point2) -> Point2 {
        let cells = self.frame.cells_from_map(point);
        Point2::new(
            self.offset_px[0] + (cells.x - self.left_cells) * self.px_per_cell,
            self.offset_px[1] + (self.top_cells - cells.y) * self.px_per_cell,
        )
    }
}

/// The SVG elements of `topology`, without the `svg` element around them: outlines of the places, openings of the
/// doorways, the graph, and its nodes with place ids. Names that are not made of class and id are below the nodes.
///
/// Cost: linear in outline points.
pub fn overlay_svg(topology: &TopologicalMap, label_set: &LabelSet, view: &View) -> String {
    let mut svg = String::new();
    let (doorways, others): (Vec<&Place>, Vec<&Place>) =
        topology.places.iter().partition(|place| place.role == Role::Doorway);
    for place in doorways.iter().chain(&others) {
        outline(&mut svg, place, label_set, view);
    }
    for place in &doorways {
        jambs(&mut svg, place, label_set, view);
    }
    edges(&mut svg, topology, view);
    for place in doorways {
        diamond(&mut svg, place, label_set, view);
    }
    for place in others {
        circle(&mut svg, place, label_set, view);
    }
    svg
}

/// The places that the report's page lists at once: not the islands behind walls and inside furniture, which connect to
/// nothing and are smaller than [`ISLAND_M2`].
pub(super) fn listed_places(topology: &TopologicalMap) -> Vec<&Place> {
    let mut is_connected = vec![false; topology.places.len()];
    for id in topology.connections.iter().flat_map(|connection| [connection.a, connection.b]) {
        if let Ok(index) = topology.places.binary_search_by_key(&id, |place| place.id) {
            is_connected[index] = true;
        }
    }
    let listed = topology.places.iter().zip(is_connected);
    listed
        .filter(|(place, connected)| *connected || place.area_m2 >= ISLAND_M2)
        .map(|(place, _)| place)
        .collect()
}

/// `text` for use in SVG: markup escaped, control characters left out.
pub(super) fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars().filter(|c| !c.is_control() && !matches!(c, '\u{fffe}' | '\u{ffff}')) {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            other => escaped.push(other),
        }
    }
    escaped
}

/// `#rrggbb`.
pub(super) fn hex([red, green, blue]: [u8; 3]) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// The color of lines around places of a class.
fn dark(place: &Place, label_set: &LabelSet) -> String {
    let color = label_set.label(&place.class).map_or([128; 3], |label| label_set.class(label).color);
    hex(mixed(color, [24, 28, 40], 0.45))
}

/// Appends formatted text; writing to a string cannot fail.
macro_rules! push {
    ($svg:expr, $($format:tt)*) => { let _ = writeln!($svg, $($format)*); };
}

fn outline(svg: &mut String, place: &Place, label_set: &LabelSet, view: &View) {
    let mut path = String::new();
    for ring in place.rings() {
        path += &path_data(ring, view);
        path.push('Z');
    }
    let color = dark(place, label_set);
    push!(
        svg,
        r#"<path d="{path}" fill="none" stroke="{color}" stroke-width="1" shape-rendering="crispEdges"/>"#
    );
}

fn jambs(svg: &mut String, place: &Place, label_set: &LabelSet, view: &View) {
    let Some(doorway) = &place.doorway else { return };
    let [a, b] = doorway.jambs.map(|jamb| view.pixel(jamb));
    let (color, width) = (dark(place, label_set), 0.22 * view.text_px);
    push!(
        svg,
        r#"<path d="M{:.1} {:.1}L{:.1} {:.1}" stroke="{color}" stroke-width="{width:.2}" stroke-linecap="round"/>"#,
        a.x,
        a.y,
        b.x,
        b.y
    );
}

fn edges(svg: &mut String, topology: &TopologicalMap, view: &View) {
    for (color, opacity, width) in [("#ffffff", 0.75, 0.3), (INK, 0.9, 0.12)] {
        let width = width * view.text_px;
        push!(
            svg,
            r#"<g fill="none" stroke="{color}" stroke-opacity="{opacity}" stroke-width="{width:.2}" stroke-linejoin="round">"#
        );
        for connection in &topology.connections {
            let Some(route) = &connection.route else { continue };
            push!(svg, r#"<path d="{}"/>"#, path_data(&route.line, view));
        }
        push!(svg, "</g>");
    }
}

/// The lines between `points` as SVG path data.
fn path_data(points: &[Point2], view: &View) -> String {
    let mut data = String::new();
    for (index, &point) in points.iter().enumerate() {
        let Point2 { x, y } = view.pixel(point);
        let _ = write!(data, "{}{x:.1} {y:.1}", if index == 0 { 'M' } else { 'L' });
    }
    data
}

fn diamond(svg: &mut String, place: &Place, label_set: &LabelSet, view: &View) {
    let Point2 { x, y } = view.pixel(place.anchor);
    let (color, r, width) = (dark(place, label_set), 0.42 * view.text_px, 0.1 * view.text_px);
    push!(
        svg,
        r##"<path d="M{x:.1} {:.1}L{:.1} {y:.1}L{x:.1} {:.1}L{:.1} {y:.1}Z" fill="{color}" stroke="#ffffff" stroke-width="{width:.2}"/>"##,
        y - r,
        x + r,
        y + r,
        x - r
    );
    // The number is next to it, so that neither hides the passage, and smaller than those of rooms.
    let size = 0.72 * view.text_px;
    push!(
        svg,
        r##"<text x="{:.1}" y="{:.1}" font-family="{FONTS}" font-weight="bold" font-size="{size:.1}" fill="{color}" stroke="#ffffff" stroke-width="{:.2}" stroke-linejoin="round" paint-order="stroke">{}</text>"##,
        x + 1.25 * r,
        y - 0.35 * r,
        0.28 * size,
        place.id.0
    );
    own_name(svg, place, Point2::new(x, y + r + size), size);
}

fn circle(svg: &mut String, place: &Place, label_set: &LabelSet, view: &View) {
    let Point2 { x, y } = view.pixel(place.anchor);
    let size = view.text_px;
    let id = place.id.0.to_string();
    let r = size * if id.len() < 3 { 0.85 } else { 0.3 + 0.28 * id.len() as f64 };
    let (color, width) = (dark(place, label_set), 0.16 * size);
    push!(
        svg,
        r##"<circle cx="{x:.1}" cy="{y:.1}" r="{r:.1}" fill="#ffffff" stroke="{color}" stroke-width="{width:.2}"/>"##
    );
    push!(
        svg,
        r#"<text x="{x:.1}" y="{:.1}" font-family="{FONTS}" font-weight="bold" font-size="{:.1}" text-anchor="middle" fill="{INK}">{id}</text>"#,
        y + 0.31 * size,
        0.86 * size
    );
    own_name(svg, place, Point2::new(x, y + r + size), size);
}

/// The name of a place that has one of its own, with its base line around `at`.
fn own_name(svg: &mut String, place: &Place, at: Point2, size: f64) {
    if place.name == format!("{} {}", place.class, place.id.0) {
        return;
    }
    push!(
        svg,
        r##"<text x="{:.1}" y="{:.1}" font-family="{FONTS}" font-size="{size:.1}" text-anchor="middle" fill="{INK}" stroke="#ffffff" stroke-width="{:.2}" stroke-linejoin="round" paint-order="stroke">{}</text>"##,
        at.x,
        at.y,
        0.25 * size,
        escaped(&place.name)
    );
}
