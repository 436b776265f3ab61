//! `topology.json`: writes and reads the topological map as a document (`docs/topology-json.md`).

mod check;
mod error;
pub(crate) mod layout;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::geom::{EllipseAxes, Point2, Pose2};
use crate::grid::{FrameError, GridShape, MapFrame, OccupancyGrid};
use crate::labels::LabelSet;
use crate::model::sha256_hex;
use crate::syntax::SyntaxError;
use crate::topology::reach::GraphCheck;
use crate::topology::{
    Connection, Doorway, Place, PlaceId, PolygonWithHoles, Route, Shortcut, TopologicalMap,
};

pub use error::TopologyError;

/// The value of the member `format` in every document.
pub const FORMAT: &str = "placegraph-topology";

/// The version of the format that this program writes and reads.
pub const VERSION: u32 = 1;

/// The frame that every result is in.
pub const FRAME_ID: &str = "map";

/// Levels of the text that get lines of their own: every place has one.
const INDENTED_LEVELS: usize = 3;

/// Largest document that is read, in bytes.
pub const MAX_DOCUMENT_BYTES: u64 = 1 << 30;

/// The content of a `topology.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TopologyDocument {
    /// [`FORMAT`].
    pub format: String,
    /// [`VERSION`].
    pub version: u32,
    /// The program that wrote the document.
    pub program: ProgramInfo,
    /// The map.
    pub map: MapInfo,
    /// The model that labeled the map; absent if the labels have another source.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<ModelInfo>,
    /// The classes, in the order of their labels.
    pub classes: LabelSet,
    /// The places, by id.
    pub places: Vec<Place>,
    /// The connections, by their ends.
    pub connections: Vec<Connection>,
    /// Further ways between doors, by place and ends.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub shortcuts: Vec<Shortcut>,
    /// How good the graph is for the robot; absent if it was not checked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub graph: Option<GraphCheck>,
    /// [`TopologicalMap::last_id`]; absent in documents from before there was one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub last_place_id: Option<PlaceId>,
    /// Wall time of the stages, in milliseconds. Empty if results must not differ between runs.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub timings_ms: BTreeMap<String, f64>,
    /// Remarks about the input, in plain words.
    #[serde(default)]
    pub findings: Vec<String>,
    /// The requested formats that cannot hold this map.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub skipped: Vec<SkippedFormat>,
    /// The findings that are errors: nothing is free, an edit does not apply.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub errors: Vec<String>,
    /// The files that belong to the result, without the document itself.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<FileRecord>,
    /// SHA-256 of the document without this member and `timings_ms`, in hexadecimal, which shows later changes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sha256: Option<String>,
}

/// A file of a result.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileRecord {
    /// Its name, without folders.
    pub name: String,
    /// Its size.
    pub bytes: u64,
    /// SHA-256 of its content, in hexadecimal.
    pub sha256: String,
}

impl FileRecord {
    /// Describes a file with this name and content.
    pub fn of(name: &str, content: &[u8]) -> Self {
        Self { name: name.to_owned(), bytes: content.len() as u64, sha256: sha256_hex(content) }
    }

    /// Whether `content` is the content of the file.
    pub fn matches(&self, content: &[u8]) -> bool {
        self.bytes == content.len() as u64 && self.sha256 == sha256_hex(content)
    }
}

/// A format that cannot hold a map.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SkippedFormat {
    /// Name of the format.
    pub format: String,
    /// Why the format cannot hold the map.
    pub reason: String,
}

/// The program that wrote a document.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProgramInfo {
    /// Its name.
    pub name: String,
    /// Its version.
    pub version: String,
    /// The options of the run that the result depends on.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub options: Vec<String>,
}

/// The map of a document.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MapInfo {
    /// Name of the map.
    pub name: String,
    /// Hash of its files, to notice that a document is out of date.
    pub hash: String,
    /// Side of a cell, in meters.
    pub resolution_m: f64,
    /// Pose of the lower left corner of the grid in the map frame.
    pub origin: Pose2,
    /// Number of columns.
    pub width: u32,
    /// Number of rows.
    pub height: u32,
    /// Name of the frame that all coordinates are in.
    pub frame_id: String,
}

/// The model behind a document.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelInfo {
    /// Name of the model.
    pub name: String,
    /// Hash of its file.
    pub hash: String,
}

/// What every version of the format has.
#[derive(Deserialize)]
struct Header {
    format: String,
    version: u64,
}

impl MapInfo {
    /// The description of `grid`, in the frame `map`.
    pub fn of(grid: &OccupancyGrid, name: &str, hash: &str) -> Self {
        Self {
            name: name.to_owned(),
            hash: hash.to_owned(),
            resolution_m: grid.frame.resolution_m(),
            origin: grid.frame.map_from_grid(),
            width: grid.cells.width(),
            height: grid.cells.height(),
            frame_id: FRAME_ID.to_owned(),
        }
    }
}

impl MapInfo {
    /// The grid that the document's outlines run along.
    ///
    /// # Errors
    /// If the resolution or the origin is no frame; never for a document that was read.
    pub fn shape(&self) -> Result<GridShape, FrameError> {
        let frame = MapFrame::new(self.resolution_m, self.origin)?;
        Ok(GridShape { frame, width: self.width, height: self.height })
    }
}

impl TopologyDocument {
    /// A document of `topology`, of a result that has neither options nor files yet, and nothing to remark. Measures are rounded to four decimals (points and areas to nine),
    /// so that the same bytes come out when the document is read and written again.
    pub fn new(
        map: MapInfo,
        model: Option<ModelInfo>,
        classes: &LabelSet,
        topology: &TopologicalMap,
    ) -> Self {
        Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            program: ProgramInfo {
                name: "placegraph".to_owned(),
                version: env!("CARGO_PKG_VERSION").to_owned(),
                options: Vec::new(),
            },
            map,
            model,
            classes: classes.clone(),
            places: topology.places.iter().map(rounded_place).collect(),
            connections: topology.connections.iter().map(rounded_connection).collect(),
            shortcuts: topology.shortcuts.iter().map(rounded_shortcut).collect(),
            graph: None,
            last_place_id: Some(topology.last_id),
            timings_ms: BTreeMap::new(),
            findings: Vec::new(),
            skipped: Vec::new(),
            errors: Vec::new(),
            files: Vec::new(),
            sha256: None,
        }
    }

    /// The map that the document holds.
    pub fn topology(&self) -> TopologicalMap {
        let largest = self.places.last().map_or(PlaceId(0), |place| place.id);
        TopologicalMap {
            places: self.places.clone(),
            connections: self.connections.clone(),
            shortcuts: self.shortcuts.clone(),
            last_id: self.last_place_id.unwrap_or(largest),
        }
    }

    /// Checks that the map has at most `max_cells` cells, because uses of a document may take memory for each cell.
    ///
    /// # Errors
    /// If it has more.
    pub fn check_size(&self, max_cells: u64) -> Result<(), TopologyError> {
        let (width, height) = (self.map.width, self.map.height);
        if u64::from(width) * u64::from(height) <= max_cells {
            Ok(())
        } else {
            Err(TopologyError::TooManyCells { width, height, max_cells })
        }
    }

    /// The text of the document.
    ///
    /// # Errors
    /// If a number is out of the range of JSON; no document made by [`TopologyDocument::new`] has one.
    pub fn to_json(&self) -> Result<String, TopologyError> {
        layout::to_json(self, INDENTED_LEVELS).map_err(|error| syntax(&error))
    }

    /// Stores the hash of the document in it: equal results have equal hashes, whenever they were made.
    ///
    /// # Errors
    /// As [`TopologyDocument::to_json`].
    pub fn seal(&mut self) -> Result<(), TopologyError> {
        self.sha256 = Some(self.fingerprint()?);
        Ok(())
    }

    /// Whether the document is unchanged since it was sealed.
    pub fn is_sealed(&self) -> bool {
        self.sha256.is_some() && self.fingerprint().ok() == self.sha256
    }

    fn fingerprint(&self) -> Result<String, TopologyError> {
        let content = Self { sha256: None, timings_ms: BTreeMap::new(), ..self.clone() };
        Ok(sha256_hex(content.to_json()?.as_bytes()))
    }

    /// Reads a document and checks what other code relies on: ids, order, classes, sizes, and that all points lie in
    /// the map.
    ///
    /// # Errors
    /// If the bytes are not JSON of this format and version, have unknown or missing members, or contradict
    /// themselves.
    pub fn from_json(bytes: &[u8]) -> Result<Self, TopologyError> {
        if bytes.len() as u64 > MAX_DOCUMENT_BYTES {
            return Err(TopologyError::TooLarge { found: bytes.len() });
        }
        let header: Header = serde_json::from_slice(bytes).map_err(|error| syntax(&error))?;
        if header.format != FORMAT {
            return Err(TopologyError::Format { found: header.format });
        }
        if header.version != VERSION as u64 {
            return Err(TopologyError::Version { found: header.version });
        }
        let document: Self = serde_json::from_slice(bytes).map_err(|error| syntax(&error))?;
        document.check()?;
        Ok(document)
    }

    /// Checks that the document does not contradict itself.
    pub(crate) fn check(&self) -> Result<(), TopologyError> {
        check::check(self)
    }
}

fn syntax(error: &serde_json::Error) -> TopologyError {
    TopologyError::Json { source: SyntaxError::of(error) }
}

/// `value` with four decimals, never −0.
fn rounded(value: f64) -> f64 {
    (value * 1e4).round() / 1e4 + 0.0
}

/// Points and areas keep nine decimals: outlines of rotated or fine maps must still have the area they name.
fn rounded_finely(value: f64) -> f64 {
    (value * 1e9).round() / 1e9 + 0.0
}

fn rounded_point(point: Point2) -> Point2 {
    Point2::new(rounded_finely(point.x), rounded_finely(point.y))
}

fn rounded_points(points: &[Point2]) -> Vec<Point2> {
    points.iter().map(|&point| rounded_point(point)).collect()
}

fn rounded_place(place: &Place) -> Place {
    let EllipseAxes { major_m, minor_m, direction_rad } = place.axes;
    Place {
        probability: rounded(place.probability),
        area_m2: rounded_finely(place.area_m2),
        centroid: rounded_point(place.centroid),
        axes: EllipseAxes {
            major_m: rounded(major_m),
            minor_m: rounded(minor_m),
            direction_rad: rounded(direction_rad),
        },
        anchor: rounded_point(place.anchor),
        clearance_m: rounded(place.clearance_m),
        outline: place
            .outline
            .iter()
            .map(|polygon| PolygonWithHoles {
                exterior: rounded_points(&polygon.exterior),
                holes: polygon.holes.iter().map(|ring| rounded_points(ring)).collect(),
            })
            .collect(),
        doorway: place.doorway.as_ref().map(|doorway| Doorway {
            width_m: rounded(doorway.width_m),
            jambs: doorway.jambs.map(rounded_point),
            sides: doorway.sides.clone(),
        }),
        ..place.clone()
    }
}

fn rounded_connection(connection: &Connection) -> Connection {
    Connection {
        contact_m: rounded(connection.contact_m),
        middle: rounded_point(connection.middle),
        route: connection.route.as_ref().map(rounded_route),
        ..*connection
    }
}

fn rounded_shortcut(way: &Shortcut) -> Shortcut {
    Shortcut { route: rounded_route(&way.route), ..*way }
}

fn rounded_route(route: &Route) -> Route {
    Route {
        length_m: rounded(route.length_m),
        line: rounded_points(&route.line),
        // Down, so that what is written is kept.
        clearance_m: route.clearance_m.map(|clearance| (clearance * 1e4).floor() / 1e4),
    }
}
