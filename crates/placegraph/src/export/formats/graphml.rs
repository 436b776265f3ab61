//! The topological map as GraphML, for NetworkX, Gephi and yEd.
//!
//! An undirected graph: a node per place, an edge per connection. The class is in the attribute `class`, as
//! everywhere; every measure is a double.

use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesText, Event};

use crate::export::ExportError;
use crate::grid::GridShape;
use crate::topology::{Connection, Place, TopologicalMap};

type Out = Writer<Vec<u8>>;

/// An attribute: what it belongs to, name, type.
type Key = (&'static str, &'static str, &'static str);

const KEYS: [Key; 21] = [
    ("graph", "frame", "string"),
    ("graph", "resolution", "double"),
    ("graph", "origin_x", "double"),
    ("graph", "origin_y", "double"),
    ("graph", "origin_yaw", "double"),
    ("node", "name", "string"),
    ("node", "class", "string"),
    ("node", "probability", "double"),
    ("node", "area_m2", "double"),
    ("node", "x", "double"),
    ("node", "y", "double"),
    ("node", "major_m", "double"),
    ("node", "minor_m", "double"),
    ("node", "direction_rad", "double"),
    ("node", "anchor_x", "double"),
    ("node", "anchor_y", "double"),
    ("node", "clearance_m", "double"),
    ("node", "width_m", "double"),
    ("edge", "contact_m", "double"),
    ("edge", "length_m", "double"),
    ("edge", "width_m", "double"),
];

/// The graph of `map`, made on the grid `shape`, with coordinates in the frame `frame_id`.
///
/// # Errors
/// None for maps that this library built.
pub fn graphml(map: &TopologicalMap, shape: &GridShape, frame_id: &str) -> Result<Vec<u8>, ExportError> {
    let mut out = Writer::new_with_indent(Vec::new(), b' ', 2);
    write(&mut out, map, shape, frame_id).map_err(|error| ExportError::writer("GraphML", &error))?;
    let mut bytes = out.into_inner();
    bytes.push(b'\n');
    Ok(bytes)
}

fn write(out: &mut Out, map: &TopologicalMap, shape: &GridShape, frame_id: &str) -> std::io::Result<()> {
    out.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let root =
        out.create_element("graphml").with_attribute(("xmlns", "http://graphml.graphdrawing.org/xmlns"));
    root.write_inner_content(|out| {
        for (index, (owner, name, kind)) in KEYS.iter().enumerate() {
            let id = format!("d{index}");
            let key = [("id", id.as_str()), ("for", owner), ("attr.name", name), ("attr.type", kind)];
            out.create_element("key").with_attributes(key).write_empty()?;
        }
        let graph = [("id", "places"), ("edgedefault", "undirected")];
        out.create_element("graph").with_attributes(graph).write_inner_content(|out| {
            let origin = shape.frame.map_from_grid();
            text(out, "graph", "frame", frame_id)?;
            number(out, "graph", "resolution", shape.frame.resolution_m())?;
            number(out, "graph", "origin_x", origin.x)?;
            number(out, "graph", "origin_y", origin.y)?;
            number(out, "graph", "origin_yaw", origin.yaw_rad)?;
            map.places.iter().try_for_each(|place| node(out, place))?;
            map.connections.iter().try_for_each(|connection| edge(out, map, connection))
        })?;
        Ok(())
    })?;
    Ok(())
}

fn node(out: &mut Out, place: &Place) -> std::io::Result<()> {
    let id = place.id.0.to_string();
    out.create_element("node").with_attribute(("id", id.as_str())).write_inner_content(|out| {
        text(out, "node", "name", &place.name)?;
        text(out, "node", "class", &place.class)?;
        let measures = [
            ("probability", place.probability),
            ("area_m2", place.area_m2),
            ("x", place.centroid.x),
            ("y", place.centroid.y),
            ("major_m", place.axes.major_m),
            ("minor_m", place.axes.minor_m),
            ("direction_rad", place.axes.direction_rad),
            ("anchor_x", place.anchor.x),
            ("anchor_y", place.anchor.y),
            ("clearance_m", place.clearance_m),
        ];
        measures.iter().try_for_each(|&(name, value)| number(out, "node", name, value))?;
        place.doorway.iter().try_for_each(|doorway| number(out, "node", "width_m", doorway.width_m))
    })?;
    Ok(())
}

fn edge(out: &mut Out, map: &TopologicalMap, connection: &Connection) -> std::io::Result<()> {
    let [a, b] = [connection.a, connection.b].map(|id| id.0.to_string());
    let ends = [("source", a.as_str()), ("target", b.as_str())];
    out.create_element("edge").with_attributes(ends).write_inner_content(|out| {
        number(out, "edge", "contact_m", connection.contact_m)?;
        connection.route.iter().try_for_each(|route| number(out, "edge", "length_m", route.length_m))?;
        map.width_m(connection).iter().try_for_each(|&width_m| number(out, "edge", "width_m", width_m))
    })?;
    Ok(())
}

fn number(out: &mut Out, owner: &str, name: &str, value: f64) -> std::io::Result<()> {
    text(out, owner, name, &format!("{value:?}"))
}

fn text(out: &mut Out, owner: &str, name: &str, value: &str) -> std::io::Result<()> {
    let index = KEYS.iter().position(|key| (key.0, key.1) == (owner, name)).unwrap_or_default();
    let id = format!("d{index}");
    out.create_element("data")
        .with_attribute(("key", id.as_str()))
        .write_text_content(BytesText::new(value))?;
    Ok(())
}
