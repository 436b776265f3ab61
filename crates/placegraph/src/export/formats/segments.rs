//! Rooms for vacuum robots: the list of segments that Home Assistant's vacuums have, and a map of Valetudo's format with the same
//! segments.

use serde_json::{Value, json};

use crate::export::ExportError;
use crate::grid::GridShape;
use crate::labels::Role;
use crate::topology::{Place, PlaceRaster, TopologicalMap};

/// The places that are not doorways, as Home Assistant's `Segment`: `id` (a text), `name`, and `group`, the name of
/// the map.
///
/// # Errors
/// None for maps that this library built.
pub fn segments_json(map: &TopologicalMap, group: &str) -> Result<Vec<u8>, ExportError> {
    let segment = |place: &Place| json!({ "id": place.id.0.to_string(), "name": place.name, "group": group });
    bytes(&map.places.iter().filter(|place| is_segment(place)).map(segment).collect(), "segments")
}

/// The places as a map of Valetudo (version 2): a segment for every place, doorways as floor. Lengths are in
/// centimeters from the upper left corner, y down; the rotation of the map is omitted.
///
/// # Errors
/// If a cell is not a whole number of centimeters: the format has no other.
pub fn valetudo_json(map: &TopologicalMap, shape: &GridShape) -> Result<Vec<u8>, ExportError> {
    let cell_cm = (shape.frame.resolution_m() * 100.0).round();
    if cell_cm < 1.0 || (cell_cm / 100.0 - shape.frame.resolution_m()).abs() > 1e-6 {
        return Err(ExportError::Centimeters { resolution_m: shape.frame.resolution_m() });
    }
    let raster = PlaceRaster::new(map, *shape);
    // Per place stretches of [x, y, number of pixels].
    let mut runs: Vec<Vec<u32>> = vec![Vec::new(); map.places.len()];
    for y in (0..shape.height).rev() {
        for span in raster.row(y) {
            if let Ok(index) = map.places.binary_search_by_key(&span.place, |place| place.id) {
                runs[index].extend([span.start, shape.height - 1 - y, span.end - span.start]);
            }
        }
    }
    let layer = |kind: &str, meta: Value, runs: &[u32]| json!({ "__class": "MapLayer", "type": kind, "metaData": meta, "pixels": [], "compressedPixels": runs });
    let area = |runs: &[u32]| {
        let n: u64 = runs.chunks_exact(3).map(|run| u64::from(run[2])).sum();
        n * (cell_cm * cell_cm) as u64
    };
    let (segments, floor): (Vec<_>, Vec<_>) =
        map.places.iter().zip(&runs).partition(|(place, _)| is_segment(place));
    let mut layers: Vec<Value> = segments
        .into_iter()
        .map(|(place, runs)| {
            let meta = json!({
                "area": area(runs), "segmentId": place.id.0.to_string(), "active": false, "name": place.name,
            });
            layer("segment", meta, runs)
        })
        .collect();
    let floor: Vec<u32> = floor.into_iter().flat_map(|(_, runs)| runs).copied().collect();
    layers.push(layer("floor", json!({ "area": area(&floor) }), &floor));
    let total: u64 = layers.iter().filter_map(|layer| layer["metaData"]["area"].as_u64()).sum();
    let map = json!({
        "__class": "ValetudoMap",
        "metaData": { "version": 2, "totalLayerArea": total },
        "size": { "x": u64::from(shape.width) * cell_cm as u64, "y": u64::from(shape.height) * cell_cm as u64 },
        "pixelSize": cell_cm as u64,
        "layers": layers,
        "entities": [],
    });
    bytes(&map, "Valetudo map")
}

fn is_segment(place: &Place) -> bool {
    place.role != Role::Doorway
}

fn bytes(value: &Value, what: &'static str) -> Result<Vec<u8>, ExportError> {
    let mut bytes = serde_json::to_vec(value).map_err(|error| ExportError::writer(what, &error))?;
    bytes.push(b'\n');
    Ok(bytes)
}
