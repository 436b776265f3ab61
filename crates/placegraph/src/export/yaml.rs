//! Code that the YAML formats share.

use serde::Serialize;
use serde_saphyr::FlowSeq;

use super::ExportError;
use crate::geom::Point2;

/// The bytes of `value` as YAML.
pub(super) fn yaml_bytes(value: &impl Serialize, format: &'static str) -> Result<Vec<u8>, ExportError> {
    let text = serde_saphyr::to_string(value).map_err(|error| ExportError::writer(format, &error))?;
    Ok(text.into_bytes())
}

/// Rounds to a tenth of a millimeter. Smaller numbers would be written with an exponent, which readers of
/// YAML 1.1 take for a string where the mantissa has no point.
pub(super) fn tenth_mm(value: f64) -> f64 {
    // Adding zero turns −0 into 0.
    (value * 1e4).round() / 1e4 + 0.0
}

/// A point as `[x, y]` on one line.
pub(super) fn xy(point: Point2) -> FlowSeq<[f64; 2]> {
    FlowSeq([tenth_mm(point.x), tenth_mm(point.y)])
}
