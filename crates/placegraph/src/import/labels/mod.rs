//! Labels drawn by people: images, one pixel per cell, and the polygons and masks of labeling tools.
//!
//! A cell belongs to a polygon if its center lies inside (even–odd rule over all its rings). A center on the border belongs to
//! the polygon above and to the right of it, so polygons that share a border neither overlap nor leave cells out.
//! Shapes are painted in the order of the file: the last one counts.

mod coco;
mod coding;
mod geojson;
mod image;
mod label_map;
mod labelme;
mod paint;
mod yaml;

use std::path::Path;

use serde::Deserialize;
use serde::de::{DeserializeOwned, IgnoredAny};

use super::MapError;
use crate::document::TopologyDocument;
use crate::geom::Point2;
use crate::grid::{Grid, MapFrame, OccupancyGrid};
use crate::labels::LabelCell;
use paint::Canvas;

pub use coding::LabelCoding;
pub use image::{LabelImageError, image_size, read_labels, read_rooms};
pub use yaml::LabelsYaml;

/// Largest label file in JSON.
const MAX_JSON_BYTES: u64 = 1 << 28;

/// The map that labels belong to, and what names and pixels mean.
#[derive(Clone, Copy, Debug)]
pub struct LabelTarget<'a> {
    /// Name of the map or of its image, without extension: finds it among the images of a COCO file.
    pub name: &'a str,
    /// Width and height of the map, in cells.
    pub size: (u32, u32),
    /// Where the cells are; needed for labels in meters only.
    pub frame: Option<MapFrame>,
    /// What names and pixels mean.
    pub coding: &'a LabelCoding,
}

impl<'a> LabelTarget<'a> {
    /// The target for labels of `map`.
    pub fn of(name: &'a str, map: &OccupancyGrid, coding: &'a LabelCoding) -> Self {
        let size = (map.cells.width(), map.cells.height());
        Self { name, size, frame: Some(map.frame), coding }
    }

    fn check_size(&self, found: (u64, u64), what: &'static str) -> Result<(), LabelFileError> {
        let expected = self.size;
        if found == (expected.0.into(), expected.1.into()) {
            Ok(())
        } else {
            Err(LabelFileError::Size { expected, found, what })
        }
    }

    /// What the name of a class means; `what` says where it stands in the file.
    fn meaning(&self, name: &str, what: impl FnOnce() -> String) -> Result<LabelCell, LabelFileError> {
        self.coding.named(name).ok_or_else(|| LabelFileError::Class {
            found: name.to_owned(),
            what: what(),
            expected: self.coding.names(),
        })
    }
}

/// Why a label file cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LabelFileError {
    /// The file cannot be read.
    #[error(transparent)]
    File(MapError),
    /// The label image cannot be used.
    #[error(transparent)]
    Image(#[from] LabelImageError),
    /// JSON of a kind that is not read.
    #[error("expected labels as labelme JSON, COCO JSON, GeoJSON or topology.json, found other JSON")]
    UnknownJson,
    /// Not the JSON of its kind.
    #[error("expected {kind}: {message}")]
    Json {
        /// The kind.
        kind: &'static str,
        /// What is wrong, and where.
        message: String,
    },
    /// The file belongs to a map of another size.
    #[error(
        "expected {what} of {} x {} pixels like the map, found {} x {}",
        expected.0, expected.1, found.0, found.1
    )]
    Size {
        /// Width and height of the map.
        expected: (u32, u32),
        /// Width and height in the file.
        found: (u64, u64),
        /// What has this size.
        what: &'static str,
    },
    /// A class that the label set lacks.
    #[error("{what} has the class {found:?}, which is not one of {}", expected.join(", "))]
    Class {
        /// Its name.
        found: String,
        /// Where it stands.
        what: String,
        /// The names that are known.
        expected: Vec<String>,
    },
    /// A shape that stands for no cells.
    #[error("{what}: {message}")]
    Shape {
        /// Which shape.
        what: String,
        /// Why.
        message: String,
    },
    /// Several images, and none that can be recognized as the map.
    #[error(
        "expected one image of {} x {} pixels, or one called like the map, {map:?}; found {n_found} images, {n_fitting} of that size",
        expected.0, expected.1
    )]
    Images {
        /// Width and height of the map.
        expected: (u32, u32),
        /// Name of the map.
        map: String,
        /// Images in the file.
        n_found: usize,
        /// Those of the map's size.
        n_fitting: usize,
    },
    /// Coordinates in degrees.
    #[error(
        "expected coordinates in meters of the map frame, found the reference system {found:?}: save the layer with EPSG:3857"
    )]
    Degrees {
        /// What the file names.
        found: String,
    },
    /// Coordinates in meters, and nobody says where the cells are.
    #[error(
        "labels in meters need the frame of the map: its resolution and origin, as a map_server YAML has them"
    )]
    NoFrame,
    /// A line of a label map.
    #[error("expected lines like corridor:86,156,214:: in the label map, found {found:?} in line {line}")]
    LabelMap {
        /// Number of the line, from 1.
        line: usize,
        /// The line.
        found: String,
    },
}

/// Labels of any kind that is read: an image, labelme JSON, COCO JSON, GeoJSON or `topology.json`; row 0 of the result is
/// the map's lowest row. `label_map` is the text of a `labelmap.txt`, which says what the colors of an image mean.
///
/// # Errors
/// If the bytes are none of these, do not fit the map, or name a class that the coding does not know.
pub fn read_label_file(
    bytes: &[u8],
    label_map: Option<&[u8]>,
    target: &LabelTarget<'_>,
) -> Result<Grid<LabelCell>, LabelFileError> {
    if bytes.trim_ascii_start().first() == Some(&b'{') {
        return read_json(bytes, target);
    }
    match label_map {
        Some(text) => Ok(read_labels(bytes, target.size, &label_map::coding(text, target.coding)?)?),
        None => Ok(read_labels(bytes, target.size, target.coding)?),
    }
}

/// Reads the file at `path`, an image with at most `max_cells` pixels or JSON, as [`read_label_file`] does. The
/// `labelmap.txt` of a segmentation mask is sought next to the image and in the folder above it.
///
/// # Errors
/// As [`read_label_file`], and if the file cannot be read.
pub fn load_labels(
    path: &Path,
    max_cells: u64,
    target: &LabelTarget<'_>,
) -> Result<Grid<LabelCell>, LabelFileError> {
    let bytes = super::file::read_with(path, |head| match head.trim_ascii_start().first() {
        Some(b'{') => Ok(MAX_JSON_BYTES),
        _ => super::file::max_file_bytes(head, max_cells),
    });
    let bytes = bytes.map_err(LabelFileError::File)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let above = folder.parent().map(|above| above.join(label_map::NAME));
    let mut beside = std::iter::once(folder.join(label_map::NAME)).chain(above);
    let label_map = beside.find(|path| path.is_file());
    let text = label_map.map(|path| super::read(&path, super::MAX_TEXT_BYTES)).transpose();
    read_label_file(&bytes, text.map_err(LabelFileError::File)?.as_deref(), target)
}

/// The members that tell kinds of JSON apart.
#[derive(Deserialize)]
struct Head {
    shapes: Option<IgnoredAny>,
    annotations: Option<IgnoredAny>,
    features: Option<IgnoredAny>,
    places: Option<IgnoredAny>,
}

fn read_json(bytes: &[u8], target: &LabelTarget<'_>) -> Result<Grid<LabelCell>, LabelFileError> {
    let head: Head = parsed(bytes, "labels as JSON")?;
    let mut canvas = Canvas::new(target.size);
    match head {
        Head { shapes: Some(_), .. } => labelme::paint(bytes, target, &mut canvas)?,
        Head { annotations: Some(_), .. } => coco::paint(bytes, target, &mut canvas)?,
        Head { features: Some(_), .. } => geojson::paint(bytes, target, &mut canvas)?,
        Head { places: Some(_), .. } => paint_places(bytes, target, &mut canvas)?,
        _ => return Err(LabelFileError::UnknownJson),
    }
    Ok(canvas.into_cells())
}

fn parsed<T: DeserializeOwned>(bytes: &[u8], kind: &'static str) -> Result<T, LabelFileError> {
    serde_json::from_slice(bytes).map_err(|error| LabelFileError::Json { kind, message: error.to_string() })
}

/// The places of a result, after its edits.
fn paint_places(bytes: &[u8], target: &LabelTarget<'_>, canvas: &mut Canvas) -> Result<(), LabelFileError> {
    let kind = "the topology.json of a result";
    let document = TopologyDocument::from_json(bytes)
        .map_err(|error| LabelFileError::Json { kind, message: error.to_string() })?;
    target.check_size((document.map.width.into(), document.map.height.into()), "the map of the document")?;
    let shape =
        document.map.shape().map_err(|error| LabelFileError::Json { kind, message: error.to_string() })?;
    for place in &document.places {
        let cell = target.meaning(&place.class, || format!("place {:?}", place.name))?;
        for part in &place.outline {
            let rings: Vec<_> = part.rings().map(|ring| on_grid(ring, &shape.frame)).collect();
            canvas.fill(&rings, cell);
        }
    }
    Ok(())
}

/// Points of the map frame in cells from the lower left corner of the map.
fn on_grid(ring: &[Point2], frame: &MapFrame) -> Vec<Point2> {
    ring.iter().map(|&point| frame.cells_from_map(point)).collect()
}
