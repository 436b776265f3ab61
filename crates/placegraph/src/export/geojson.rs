//! The places as GeoJSON polygons, for QGIS and GeoPandas.
//!
//! Coordinates are meters of the map frame, whose name is the member `frame_id`. RFC 7946 takes every file for degrees; the member
//! `crs` with EPSG:3857 is what makes readers take meters, and what Nav2's own files carry. With a [`Georeference`] they are
//! longitude and latitude (EPSG:4326), as the RFC has them.

use geojson::{Feature, FeatureCollection, Geometry, GeometryValue, JsonObject, Position};
use serde_json::json;

use super::ExportError;
use crate::geom::Point2;
use crate::topology::{Place, PolygonWithHoles, TopologicalMap};

/// The position of a map on Earth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Georeference {
    /// Latitude of the map frame's origin, in degrees north (WGS 84).
    pub latitude_deg: f64,
    /// Its longitude, in degrees east.
    pub longitude_deg: f64,
    /// Where the y axis of the map frame points, in degrees clockwise from true north.
    pub heading_deg: f64,
}

/// Semi-major axis of the WGS 84 ellipsoid, in meters, and its squared eccentricity.
const WGS84_A_M: f64 = 6_378_137.0;
const WGS84_E2: f64 = 6.694_379_990_14e-3;

impl Georeference {
    /// Largest latitude: near the poles a degree of longitude has no length.
    pub const MAX_LATITUDE_DEG: f64 = 89.0;

    /// The georeference, or `None` if a number is no such angle: latitudes to [`Self::MAX_LATITUDE_DEG`], longitudes to 180, headings
    /// to 360 degrees on both sides of 0.
    pub fn new(latitude_deg: f64, longitude_deg: f64, heading_deg: f64) -> Option<Self> {
        let is_angle = latitude_deg.abs() <= Self::MAX_LATITUDE_DEG
            && longitude_deg.abs() <= 180.0
            && heading_deg.abs() <= 360.0;
        is_angle.then_some(Self { latitude_deg, longitude_deg, heading_deg })
    }

    /// Longitude and latitude of a point of the map frame, in degrees. On the plane that touches the ellipsoid at the origin: a building
    /// of 1 km is placed within some centimeters.
    pub fn degrees(&self, point: Point2) -> [f64; 2] {
        let (sin_heading, cos_heading) = self.heading_deg.to_radians().sin_cos();
        let east = point.x * cos_heading + point.y * sin_heading;
        let north = point.y * cos_heading - point.x * sin_heading;
        let (sin_latitude, cos_latitude) = self.latitude_deg.to_radians().sin_cos();
        let w2 = 1.0 - WGS84_E2 * sin_latitude * sin_latitude;
        // Radii of curvature along the meridian and across it.
        let along = WGS84_A_M * (1.0 - WGS84_E2) / (w2 * w2.sqrt());
        let across = WGS84_A_M / w2.sqrt();
        let longitude = self.longitude_deg + (east / (across * cos_latitude)).to_degrees();
        [longitude, self.latitude_deg + (north / along).to_degrees()].map(|v| (v * 1e9).round() / 1e9)
    }
}

/// The places as a collection of polygons with their figures: in meters of the frame `frame_id`, or, with a georeference, in
/// degrees. The properties keep their points in meters of the map frame.
///
/// # Errors
/// None for maps that this library built.
pub fn regions_geojson(
    map: &TopologicalMap,
    frame_id: &str,
    georeference: Option<&Georeference>,
) -> Result<Vec<u8>, ExportError> {
    let at = |point: Point2| match georeference {
        Some(georeference) => Position::from(georeference.degrees(point)),
        None => position(point),
    };
    let features: Vec<Feature> = map.places.iter().map(|place| place_feature(place, &at)).collect();
    let mut members = JsonObject::new();
    members.insert("frame_id".to_owned(), json!(frame_id));
    members.insert("units".to_owned(), json!(if georeference.is_some() { "degrees" } else { "meters" }));
    if let Some(Georeference { latitude_deg, longitude_deg, heading_deg }) = georeference {
        let values = json!({ "latitude_deg": latitude_deg, "longitude_deg": longitude_deg, "heading_deg": heading_deg });
        members.insert("georeference".to_owned(), values);
    }
    let crs = if georeference.is_some() { "urn:ogc:def:crs:OGC:1.3:CRS84" } else { METERS };
    bytes_of(FeatureCollection::new(features), "regions", crs, members)
}

/// What makes readers take meters.
const METERS: &str = "urn:ogc:def:crs:EPSG::3857";

/// The bytes of `collection`, with its name and with meters as its unit.
pub(super) fn collection_bytes(collection: FeatureCollection, name: &str) -> Result<Vec<u8>, ExportError> {
    bytes_of(collection, name, METERS, JsonObject::new())
}

fn bytes_of(
    mut collection: FeatureCollection,
    name: &str,
    crs: &str,
    mut members: JsonObject,
) -> Result<Vec<u8>, ExportError> {
    members.insert("name".to_owned(), json!(name));
    members.insert("crs".to_owned(), json!({ "type": "name", "properties": { "name": crs } }));
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

fn place_feature(place: &Place, at: &impl Fn(Point2) -> Position) -> Feature {
    let mut polygons: Vec<_> = place.outline.iter().map(|part| polygon(part, at)).collect();
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
    if place.cut_off {
        set("cut_off", json!(true));
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
pub(super) fn polygon(part: &PolygonWithHoles, at: &impl Fn(Point2) -> Position) -> Vec<Vec<Position>> {
    part.rings().map(|ring| ring.iter().chain(ring.first()).map(|&corner| at(corner)).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degrees_of_points_around_an_origin() {
        // At 48° N a degree of latitude is 111.1903 km and one of longitude 74.6254 km long (WGS 84).
        let north_up = Georeference { latitude_deg: 48.0, longitude_deg: 7.8, heading_deg: 0.0 };
        let [longitude, latitude] = north_up.degrees(Point2::new(74.6254, 111.1903));
        assert!(
            (longitude - 7.801).abs() < 2e-8 && (latitude - 48.001).abs() < 2e-8,
            "{longitude} {latitude}"
        );
        // The map's y axis points east: its x axis then points south.
        let turned = Georeference { heading_deg: 90.0, ..north_up };
        let [longitude, latitude] = turned.degrees(Point2::new(111.1903, 74.6254));
        assert!(
            (longitude - 7.801).abs() < 2e-8 && (latitude - 47.999).abs() < 2e-8,
            "{longitude} {latitude}"
        );
        let [longitude, latitude] = turned.degrees(Point2::new(0.0, 0.0));
        assert!((longitude - 7.8).abs() < 1e-12 && (latitude - 48.0).abs() < 1e-12);
    }
}
