//! Nav2 route graph: the GeoJSON file that the route server loads.
//!
//! The server ignores the geometry of edges and drives straight from node to node, so every bend of a route is
//! a node of its own: every edge is a straight line through free cells. Nodes of places carry the place's id;
//! bends and edges are numbered above them. Scorers read floats, so every number of the metadata is one.

use geojson::{Feature, FeatureCollection, Geometry, GeometryValue, JsonObject, JsonValue};
use serde_json::json;

use super::ExportError;
use super::geojson::{collection_bytes, position};
use super::waypoints::{Leg, Waypoint, WaypointKind, waypoints};
use crate::topology::TopologicalMap;

/// The route graph of the places of `map` that are not cut off, with coordinates in the frame `frame_id`.
///
/// # Errors
/// If no connection has a route: the server refuses a graph without edges.
pub fn nav2_route(map: &TopologicalMap, frame_id: &str) -> Result<Vec<u8>, ExportError> {
    let map = &map.reached();
    let (nodes, legs) = waypoints(map);
    if legs.is_empty() {
        return Err(ExportError::NoRoute);
    }
    let first_bend = map.places.last().map_or(0, |place| place.id.0 as usize + 1);
    let node_id = |index: usize| match nodes[index].kind {
        WaypointKind::Station => nodes[index].place.id.0 as usize,
        WaypointKind::Bend => first_bend + index - map.places.len(),
    };
    let first_edge = first_bend + nodes.len() - map.places.len();
    let points = nodes.iter().enumerate().map(|(index, node)| {
        let geometry = GeometryValue::Point { coordinates: position(node.at) };
        feature(geometry, json!({ "id": node_id(index), "frame": frame_id, "metadata": node_metadata(node) }))
    });
    let ways = legs.iter().flat_map(|leg| [(leg, leg.from, leg.to), (leg, leg.to, leg.from)]);
    let edges = ways.enumerate().map(|(index, (leg, from, to))| {
        let line = [from, to].map(|end| position(nodes[end].at)).to_vec();
        let geometry = GeometryValue::LineString { coordinates: line };
        let length_m = nodes[from].at.distance(nodes[to].at);
        let metadata = edge_metadata(leg, &nodes[to], length_m);
        let ends = (node_id(from), node_id(to));
        feature(
            geometry,
            json!({ "id": first_edge + index, "startid": ends.0, "endid": ends.1, "metadata": metadata }),
        )
    });
    collection_bytes(
        FeatureCollection::new(points.chain(edges).collect::<Vec<_>>()),
        "placegraph_route_graph",
    )
}

fn feature(geometry: GeometryValue, properties: JsonValue) -> Feature {
    let properties: Option<JsonObject> = match properties {
        JsonValue::Object(members) => Some(members),
        _ => None,
    };
    Feature {
        bbox: None,
        geometry: Some(Geometry::new(geometry)),
        id: None,
        properties,
        foreign_members: None,
    }
}

fn node_metadata(node: &Waypoint<'_>) -> JsonValue {
    let place = node.place;
    if node.kind == WaypointKind::Bend {
        return json!({ "class": place.class, "place": place.name, "bend": true });
    }
    // The metadata has room for one ring.
    let outline = place.largest_exterior();
    let mut metadata = json!({
        "name": place.name,
        "class": place.class,
        "area_m2": place.area_m2,
        "probability": place.probability,
        // The convention of Nav2's sample graph for an outline.
        "x_values": outline.iter().map(|corner| corner.x).collect::<Vec<_>>(),
        "y_values": outline.iter().map(|corner| corner.y).collect::<Vec<_>>(),
    });
    if let Some(doorway) = &place.doorway {
        metadata["width_m"] = json!(doorway.width_m);
    }
    metadata
}

/// The edge is of the class that it leads into: that of its end, or of the doorway it leads through.
fn edge_metadata(leg: &Leg<'_>, to: &Waypoint<'_>, length_m: f64) -> JsonValue {
    let mut metadata = json!({ "class": to.place.class, "length_m": length_m });
    if let Some(width_m) = leg.width_m {
        metadata["width_m"] = json!(width_m);
    }
    if let Some(clearance_m) = leg.route.clearance_m {
        metadata["clearance_m"] = json!(clearance_m);
    }
    metadata
}
