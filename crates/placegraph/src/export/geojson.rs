//! The places as GeoJSON polygons, for QGIS and GeoPandas.
//!
//! Coordinates are meters of the map frame. RFC 7946 takes every file for degrees; the member `crs` with
//! EPSG:3857 is what makes readers take meters, and what Nav2's own files carry.

use geojson::{Feature, FeatureCollection, Geometry, GeometryValue, JsonObject, Position};
use serde_json::json;

use super::ExportError;
use crate::geom::Point2;
use crate::topology::{Place, PolygonWithHoles, TopologicalMap};

/// The places as a collection of polygons with their figures.
///
/// # Errors
/// None for maps that this library built.
pub fn regions_geojson(map: &TopologicalMap) -> Result<Vec<u8>, ExportError> {
    collection_bytes(
        FeatureCollection::new(map.places.iter().map(place_feature).collect::<Vec<_>>()),
        "regions",
    )
}

/// The bytes of `collection`, with its name and with meters as its unit.
pub(super) fn collection_bytes(
    mut collection: FeatureCollection,
    name: &str,
) -> Result<Vec<u8>, ExportError> {
    let mut members = JsonObject::new();
    members.insert("name".to_owned(), json!(name));
    members.insert(
        "crs".to_owned(),
        json!({ "type": "name", "properties": { "name": "urn:ogc:def:crs:EPSG::3857" } }),
    );
    collection.foreign_members = Some(members);
    let mut bytes =
        serde_json::to_vec(&collection).map_err(|error| ExportError::writer("GeoJSON", &error))?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// A point as GeoJSON writes it.
pub(super) fn position(point: Point2) -> Position {
    Position::from([point.x, point.y])
}

fn place_feature(place: &Place) -> Feature {
    let mut polygons: Vec<_> = place.outline.iter().map(polygon).collect();
    let geometry = match (polygons.len(), polygons.pop()) {
        (1, Some(only)) => GeometryValue::Polygon { coordinates: only },
        (_, last) => {
            polygons.extend(last);
            GeometryValue::MultiPolygon { coordinates: polygons }
        }
    };
    let mut properties = JsonObject::new();
    let mut set = |key: &str, value| properties.insert(key.to_owned(), value);
    set("id", json!(place.id.0));
    set("name", json!(place.name));
    set("class", json!(place.class));
    set("probability", json!(place.probability));
    set("area_m2", json!(place.area_m2));
    set("x", json!(place.centroid.x));
    set("y", json!(place.centroid.y));
    set("anchor_x", json!(place.anchor.x));
    set("anchor_y", json!(place.anchor.y));
    set("clearance_m", json!(place.clearance_m));
    set("major_m", json!(place.axes.major_m));
    set("minor_m", json!(place.axes.minor_m));
    if let Some(doorway) = &place.doorway {
        set("width_m", json!(doorway.width_m));
    }
    Feature {
        bbox: None,
        geometry: Some(Geometry::new(geometry)),
        id: Some(geojson::feature::Id::Number(place.id.0.into())),
        properties: Some(properties),
        foreign_members: None,
    }
}

/// Rings of GeoJSON repeat their first point.
fn polygon(part: &PolygonWithHoles) -> Vec<Vec<Position>> {
    part.rings()
        .map(|ring| ring.iter().chain(ring.first()).map(|&corner| position(corner)).collect())
        .collect()
}
