//! Keep-out areas as polygons, for Nav2's vector-object server.

use super::yaml::{tenth_mm, yaml_bytes};
use super::{ExportError, Keepout};
use crate::grid::GridShape;
use crate::topology::TopologicalMap;

/// Parameters of the vector-object server: a polygon per place with the value of `keepout`, and no raster. A place
/// without an entry is omitted. Holes cannot be expressed, so everything that a place surrounds is covered too.
///
/// # Errors
/// If a cost is not in 0 to 100, or one is given to a place that the map does not have.
pub fn vector_shapes(
    map: &TopologicalMap,
    shape: &GridShape,
    frame_id: &str,
    keepout: &Keepout,
) -> Result<Vec<u8>, ExportError> {
    use serde_json::json;
    keepout.check(map)?;
    let mut parameters = json!({
        "map_topic": "vo_map",
        "global_frame_id": frame_id,
        "resolution": shape.frame.resolution_m(),
        "default_value": -1,
        "overlay_type": 0,
        "update_frequency": 1.0,
        "transform_tolerance": 0.1,
    });
    let mut names = Vec::new();
    for place in &map.places {
        let value = keepout.cost.get(place).unwrap_or(0.0).round() as u8;
        for (part, polygon) in place.outline.iter().enumerate() {
            let name = format!("place_{}_{part}", place.id.0);
            let points: Vec<f64> =
                polygon.exterior.iter().flat_map(|p| [tenth_mm(p.x), tenth_mm(p.y)]).collect();
            parameters[&name] = json!({
                "type": "polygon", "frame_id": frame_id, "closed": true, "value": value, "points": points,
            });
            names.push(name);
        }
    }
    parameters["shapes"] = json!(names);
    let file = json!({
        "vector_object_server": { "ros__parameters": parameters },
        "costmap_filter_info_server": { "ros__parameters": {
            "type": 0, "filter_info_topic": "vo_costmap_filter_info", "mask_topic": "vo_map",
            "base": 0.0, "multiplier": 1.0,
        } },
    });
    yaml_bytes(&file, "vector shapes")
}
