//! The topological map as a Graphviz graph; `neato -n2` draws it in the map's own layout.

use std::fmt::Write;

use crate::geom::Point2;
use crate::labels::{LabelSet, Role};
use crate::topology::{Place, TopologicalMap};

/// Graphviz points per meter of the map.
const POINTS_PER_M: f64 = 36.0;

/// The graph of `map`: a node per place at its station, in the color of its class, and an edge per connection.
pub fn dot(map: &TopologicalMap, labels: &LabelSet) -> String {
    let mut out = String::from("graph places {\n");
    out.push_str("  graph [overlap=true, splines=false];\n");
    out.push_str("  node [style=filled, fontname=\"Helvetica\", fontsize=10];\n");
    for place in &map.places {
        node(&mut out, place, map.station(place), labels);
    }
    for connection in &map.connections {
        let _ = write!(
            out,
            "  {} -- {} [contact_m=\"{:?}\"",
            connection.a.0, connection.b.0, connection.contact_m
        );
        if let Some(route) = &connection.route {
            let _ = write!(out, ", length_m=\"{:?}\"", route.length_m);
        }
        out.push_str("];\n");
    }
    out.push_str("}\n");
    out
}

fn node(out: &mut String, place: &Place, at: Point2, labels: &LabelSet) {
    let color = labels.label(&place.class).map_or([200; 3], |label| labels.class(label).color);
    let shape = if place.role == Role::Doorway { "box" } else { "ellipse" };
    let (x, y) = (at.x * POINTS_PER_M, at.y * POINTS_PER_M);
    let _ = writeln!(
        out,
        "  {} [label={}, class={}, area_m2=\"{:?}\", shape={shape}, fillcolor=\"#{:02x}{:02x}{:02x}\", pos=\"{x:.3},{y:.3}!\"];",
        place.id.0,
        quoted(&place.name),
        quoted(&place.class),
        place.area_m2,
        color[0],
        color[1],
        color[2],
    );
}

/// A quoted string of the DOT language, in which a backslash begins an escape.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}
