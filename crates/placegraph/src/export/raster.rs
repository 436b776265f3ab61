//! Label and region images with the map_server YAML that georeferences them.
//!
//! An image's first row is the map's top row; the writers here flip. Cost: one pass and the compression.

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

use crate::grid::{CellGraph, MapFrame};
use crate::labels::{LabelSet, Labeling};
use crate::regions::RegionMap;
use crate::topology::PlaceId;

/// Why a raster cannot be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RasterError {
    /// A 16-bit image holds numbers up to 65535.
    #[error("expected place numbers up to 65535 for a 16-bit image, found {found}")]
    TooManyRegions {
        /// The largest number.
        found: u32,
    },
}

/// The label image: an 8-bit gray PNG of the map's size, with `k` for the k-th class from 1, and 0 for cells that are
/// not free. Values are at most 8, so map_server reads them unchanged in mode raw.
///
/// # Panics
/// If `labeling` has not one label per node.
pub fn label_png(graph: &CellGraph, labeling: &Labeling) -> Vec<u8> {
    assert_eq!(labeling.len(), graph.n_nodes(), "one label per node");
    let pixels = image_rows(graph, |node| labeling[node].0 + 1);
    png(graph, &pixels, ExtendedColorType::L8)
}

/// The region image: a 16-bit gray PNG of the map's size, with the number of the place, and 0 for cells outside of
/// all places; `place_ids` has the number of every region that is a place. map_server reduces images to 8 bits, so
/// this one is for programs that read 16.
///
/// # Errors
/// If a number is above 65535.
///
/// # Panics
/// If `regions` has not one region per node, or `place_ids` not one entry per region.
pub fn region_png(
    graph: &CellGraph,
    regions: &RegionMap,
    place_ids: &[Option<PlaceId>],
) -> Result<Vec<u8>, RasterError> {
    assert_eq!(regions.region_of.len(), graph.n_nodes(), "one region per node");
    assert_eq!(place_ids.len(), regions.regions.len(), "one entry per region");
    let found = place_ids.iter().flatten().map(|id| id.0).max().unwrap_or(0);
    if found > u32::from(u16::MAX) {
        return Err(RasterError::TooManyRegions { found });
    }
    // The encoder takes samples in the order of this machine's bytes.
    let number =
        |node: usize| place_ids[regions.region_of[node].index()].map_or(0, |id| id.0 as u16).to_ne_bytes();
    let pixels = image_rows(graph, number);
    Ok(png(graph, pixels.as_flattened(), ExtendedColorType::L16))
}

/// The map_server YAML of an image in mode raw, with resolution and origin of `frame` to the last bit.
pub fn raster_yaml(image: &str, frame: &MapFrame) -> String {
    let origin = frame.map_from_grid();
    format!(
        "image: {}\nmode: raw\nresolution: {}\norigin: [{}, {}, {}]\nnegate: 0\n\
         occupied_thresh: 0.65\nfree_thresh: 0.196\n",
        // A JSON string is a YAML string, whatever the file is called.
        serde_json::Value::from(image),
        yaml_float(frame.resolution_m()),
        yaml_float(origin.x),
        yaml_float(origin.y),
        yaml_float(origin.yaw_rad),
    )
}

/// [`raster_yaml`] of a label image, with the names, roles and colors of its classes, which map_server does not look at.
pub fn labels_yaml(image: &str, frame: &MapFrame, classes: &LabelSet) -> String {
    // JSON is YAML.
    let classes = serde_json::to_string(classes).unwrap_or_default();
    format!("{}classes: {classes}\n", raster_yaml(image, frame))
}

/// The shortest decimal with the same bits, always with a point and never with an exponent: YAML 1.1 readers
/// take `1e-7` for a string and `1` for an integer.
fn yaml_float(value: f64) -> String {
    let text = value.to_string();
    if text.contains('.') { text } else { text + ".0" }
}

/// A value per pixel, rows from the map's top: 0 where there is no node.
fn image_rows<T: Copy + Default>(graph: &CellGraph, value: impl Fn(usize) -> T) -> Vec<T> {
    let width = graph.width() as usize;
    let mut pixels = vec![T::default(); width * graph.height() as usize];
    for (node, cell) in graph.cells_in_rows(0..graph.height()).enumerate() {
        let row = (graph.height() - 1 - cell.y) as usize;
        pixels[row * width + cell.x as usize] = value(node);
    }
    pixels
}

#[expect(clippy::expect_used, reason = "the buffer has the size stated, and memory cannot refuse a write")]
fn png(graph: &CellGraph, bytes: &[u8], color: ExtendedColorType) -> Vec<u8> {
    let mut file = Vec::new();
    PngEncoder::new_with_quality(&mut file, CompressionType::Fast, FilterType::Adaptive)
        .write_image(bytes, graph.width(), graph.height(), color)
        .expect("a PNG in memory");
    file
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floats_keep_their_bits_and_their_point() {
        for (value, text) in
            [(0.05, "0.05"), (-10.0, "-10.0"), (1e-7, "0.0000001"), (0.1 + 0.2, "0.30000000000000004")]
        {
            assert_eq!(yaml_float(value), text);
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), value.to_bits());
        }
        assert_eq!(yaml_float(1e300).parse::<f64>().unwrap().to_bits(), 1e300f64.to_bits());
    }
}
