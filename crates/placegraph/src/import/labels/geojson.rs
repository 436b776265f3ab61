//! GeoJSON polygons in meters of the map frame, as QGIS and GeoPandas write them: the property `class` names the class.

use geojson::{FeatureCollection, GeometryValue, Position};

use super::paint::Canvas;
use super::{LabelFileError, LabelTarget, on_grid};
use crate::geom::Point2;

const KIND: &str = "GeoJSON with polygons";

/// Properties that may name the class, the best first.
const PROPERTIES: [&str; 3] = ["class", "label", "category"];

pub(super) fn paint(
    bytes: &[u8],
    target: &LabelTarget<'_>,
    canvas: &mut Canvas,
) -> Result<(), LabelFileError> {
    let collection: FeatureCollection = super::parsed(bytes, KIND)?;
    if let Some(found) = degrees(&collection) {
        return Err(LabelFileError::Degrees { found });
    }
    let frame = target.frame.ok_or(LabelFileError::NoFrame)?;
    for (feature, number) in collection.features.iter().zip(1..) {
        let what = || format!("feature {number}");
        let wrong = |message: String| LabelFileError::Shape { what: what(), message };
        let class = PROPERTIES.iter().find_map(|name| feature.property(name)?.as_str());
        let class =
            class.ok_or_else(|| wrong("expected the name of its class as property \"class\"".into()))?;
        let cell = target.meaning(class, what)?;
        let value = feature.geometry.as_ref().map(|geometry| &geometry.value);
        let polygons = match value {
            Some(GeometryValue::Polygon { coordinates }) => std::slice::from_ref(coordinates),
            Some(GeometryValue::MultiPolygon { coordinates }) => coordinates,
            Some(other) => return Err(wrong(format!("expected a polygon, found a {}", other.type_name()))),
            None => return Err(wrong("expected a polygon, found no geometry".into())),
        };
        for polygon in polygons {
            let ring =
                |points: &Vec<Position>| on_grid(&points.iter().map(point).collect::<Vec<_>>(), &frame);
            canvas.fill(&polygon.iter().map(ring).collect::<Vec<_>>(), cell);
        }
    }
    Ok(())
}

fn point(position: &Position) -> Point2 {
    match *position.as_slice() {
        [x, y, ..] => Point2::new(x, y),
        // Its ring is left out.
        _ => Point2::new(f64::NAN, f64::NAN),
    }
}

/// The reference system of the file, if its unit is degrees. Without one, coordinates are meters: GeoPandas writes none where none
/// was set.
fn degrees(collection: &FeatureCollection) -> Option<String> {
    let name = collection.foreign_members.as_ref()?.get("crs")?.get("properties")?.get("name")?.as_str()?;
    (name.contains("CRS84") || name.ends_with(":4326")).then(|| name.chars().take(80).collect())
}
