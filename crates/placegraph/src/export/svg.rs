//! The places as a drawing: filled by class, with doorways and the graph over them.

use std::fmt::Write;

use super::overlay::{FONTS, View, escaped, hex, overlay_svg};
use crate::grid::GridShape;
use crate::labels::LabelSet;
use crate::topology::{Place, TopologicalMap};

/// Pixels per meter of the map.
const PX_PER_M: f64 = 40.0;

/// Free space around the map, in pixels.
const MARGIN_PX: f64 = 20.0;

/// Height of text, in meters of the map.
const TEXT_M: f64 = 0.45;

/// The drawing of `map`, made on the grid `shape`; a rotated map is drawn along its grid.
pub fn regions_svg(map: &TopologicalMap, labels: &LabelSet, shape: &GridShape) -> String {
    let px_per_cell = PX_PER_M * shape.frame.resolution_m();
    let view = View {
        frame: shape.frame,
        left_cells: 0.0,
        top_cells: shape.height as f64,
        px_per_cell,
        offset_px: [MARGIN_PX; 2],
        text_px: TEXT_M * PX_PER_M,
    };
    let [width, height] = [shape.width, shape.height].map(|n| n as f64 * px_per_cell + 2.0 * MARGIN_PX);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.1} {height:.1}\" font-family=\"{FONTS}\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
    );
    for place in &map.places {
        fill(&mut svg, place, labels, &view);
    }
    svg.push_str(&overlay_svg(map, labels, &view));
    svg.push_str("</svg>\n");
    svg
}

/// The area of `place`, with its name for readers that show one.
fn fill(svg: &mut String, place: &Place, labels: &LabelSet, view: &View) {
    let color = labels.label(&place.class).map_or([200; 3], |label| labels.class(label).color);
    let mut path = String::new();
    for ring in place.rings() {
        for (index, &corner) in ring.iter().enumerate() {
            let at = view.pixel(corner);
            let _ = write!(path, "{}{:.2} {:.2}", if index == 0 { 'M' } else { 'L' }, at.x, at.y);
        }
        path.push('Z');
    }
    let _ = writeln!(
        svg,
        "<path id=\"place-{}\" class=\"{}\" d=\"{path}\" fill=\"{}\" fill-rule=\"evenodd\"><title>{}</title></path>",
        place.id.0,
        escaped(&place.class),
        hex(color),
        escaped(&place.name),
    );
}
