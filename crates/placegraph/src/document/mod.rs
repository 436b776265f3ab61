//! `topology.json`: the topological map as a document, out and in (`docs/topology-json.md`).

mod check;
mod layout;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::geom::{EllipseAxes, Point2, Pose2};
use crate::grid::{FrameError, GridShape, MapFrame, OccupancyGrid};
use crate::labels::LabelSet;
use crate::model::sha256_hex;
use crate::syntax::SyntaxError;
use crate::topology::reach::GraphCheck;
use crate::topology::{Connection, Doorway, Place, PlaceId, PolygonWithHoles, Route, TopologicalMap};

/// What the member `format` of every document says.
pub const FORMAT: &str = "placegraph-topology";

/// The version of the format that this program writes and reads.
pub const VERSION: u32 = 1;

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
    /// What wrote the document.
    pub program: ProgramInfo,
    /// The map it is about.
    pub map: MapInfo,
    /// The model that labeled the map; absent where labels came from elsewhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<ModelInfo>,
    /// The classes, in the order of their labels.
    pub classes: LabelSet,
    /// The places, by id.
    pub places: Vec<Place>,
    /// The connections, by their ends.
    pub connections: Vec<Connection>,
    /// How good the graph is for the robot; absent where it was not checked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub graph: Option<GraphCheck>,
    /// [`TopologicalMap::last_id`]; absent in documents from before there was one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub last_place_id: Option<PlaceId>,
    /// Wall time of the stages, in milliseconds. Empty where results must not differ between runs.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub timings_ms: BTreeMap<String, f64>,
    /// What was noticed about the input, in plain words.
    #[serde(default)]
    pub findings: Vec<String>,
    /// The formats that were asked for and cannot hold this map.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub skipped: Vec<SkippedFormat>,
    /// Those of the findings that keep the result from being what was asked for: nothing is free, an edit does not
    /// apply.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub errors: Vec<String>,
    /// The files that belong to the result, without the document itself.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<FileRecord>,
    /// SHA-256 of the document as it is written without this member and `timings_ms`, in hexadecimal: what was changed
    /// since shows.
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
    /// What is to be remembered of a file.
    pub fn of(name: &str, content: &[u8]) -> Self {
        Self { name: name.to_owned(), bytes: content.len() as u64, sha256: sha256_hex(content) }
    }

    /// Whether `content` is still that of the file.
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
    /// Why the map cannot be written in it.
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
    /// The options of the run that its results depend on.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub options: Vec<String>,
}

/// The map that a document is about.
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

/// Why bytes are no topological map.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TopologyError {
    /// More bytes than any document has.
    #[error("expected a document of at most {MAX_DOCUMENT_BYTES} bytes, found {found}")]
    TooLarge {
        /// Number of bytes.
        found: usize,
    },
    /// Not the JSON of a document.
    #[error("expected the JSON of a {FORMAT} document")]
    Json {
        /// What the parser says, with line and column.
        source: SyntaxError,
    },
    /// Another kind of document.
    #[error("expected format {FORMAT:?}, found {found:?}")]
    Format {
        /// The format found.
        found: String,
    },
    /// Another version.
    #[error("expected version {VERSION} of {FORMAT}, found {found}")]
    Version {
        /// The version found.
        found: u64,
    },
    /// A grid that cannot be.
    #[error(
        "expected a map with cells of a positive size, found {width} x {height} cells of {resolution_m} m"
    )]
    Map {
        /// Columns found.
        width: u32,
        /// Rows found.
        height: u32,
        /// Resolution found.
        resolution_m: f64,
    },
    /// The map has more cells than allowed.
    #[error("expected a document of a map of at most {max_cells} cells, found {width} x {height}")]
    TooManyCells {
        /// Columns found.
        width: u32,
        /// Rows found.
        height: u32,
        /// The limit.
        max_cells: u64,
    },
    /// A place has a number that a region image cannot hold.
    #[error("expected place ids up to {}, found {found}", PlaceId::MAX.0)]
    PlaceId {
        /// The id found.
        found: u32,
    },
    /// Two places have one name, or a name cannot be printed.
    #[error("expected a printable name of its own for every place, found {name:?} for place {place}")]
    PlaceName {
        /// The place.
        place: u32,
        /// Its name.
        name: String,
    },
    /// A probability is above 1.
    #[error("expected a probability up to 1 for place {place}, found {found}")]
    Probability {
        /// The place.
        place: u32,
        /// Its probability.
        found: f64,
    },
    /// The area of a place is not that of its cells.
    #[error("expected {expected} m² as the area of the cells of place {place}, found {found}")]
    Area {
        /// The place.
        place: u32,
        /// The area of its cells.
        expected: f64,
        /// The area found.
        found: f64,
    },
    /// The places have more cells than the map.
    #[error("expected places with {n_cells} cells at most, as the map has, found more")]
    Cells {
        /// Cells of the map.
        n_cells: u64,
    },
    /// A doorway lists a side twice, or itself.
    #[error("expected other places, each once, as the sides of place {place}, found {found}")]
    Sides {
        /// The doorway.
        place: u32,
        /// The side at fault.
        found: u32,
    },
    /// A route has no point, or is shorter than the straight line between its ends.
    #[error(
        "expected a route of points and of their length for the connection {a} to {b}, found {n_points} points and {length_m} m"
    )]
    Route {
        /// One end of the connection.
        a: u32,
        /// The other end.
        b: u32,
        /// Points found.
        n_points: usize,
        /// Length found.
        length_m: f64,
    },
    /// A measure is below 0 or no number.
    #[error("expected a number from 0 as {of}, found {found}")]
    Measure {
        /// What is measured.
        of: String,
        /// The number found.
        found: f64,
    },
    /// A point lies outside of the map.
    #[error("expected a point of the map as {of}, found ({x}, {y})")]
    Point {
        /// What the point is.
        of: String,
        /// First coordinate found.
        x: f64,
        /// Second coordinate found.
        y: f64,
    },
    /// Outlines cannot follow the sides of the map's cells.
    #[error("expected outlines along the sides of {n_cells} cells, found longer ones")]
    Outlines {
        /// Cells of the map.
        n_cells: u64,
    },
    /// Places are not numbered upwards from 1 or more.
    #[error("expected place ids above {previous}, found {found}")]
    PlaceOrder {
        /// The id before.
        previous: u32,
        /// The id found.
        found: u32,
    },
    /// A place has a class that is not listed, or another role than its class.
    #[error("expected a class of the document with role {role} in place {place}, found {class:?}")]
    PlaceClass {
        /// The place.
        place: u32,
        /// Its class.
        class: String,
        /// Its role.
        role: String,
    },
    /// The name of a file leads elsewhere.
    #[error("expected the plain name of a file of the result, found {found:?}")]
    FileName {
        /// The name found.
        found: String,
    },
    /// Something refers to a place that is not there.
    #[error("expected the id of a place in {referrer}, found {found}")]
    UnknownPlace {
        /// What refers to it.
        referrer: String,
        /// The id found.
        found: u32,
    },
    /// Connections are not in order, or one stands twice, or its ends are swapped.
    #[error("expected connections in order with a < b, each once, found {a} to {b}")]
    ConnectionOrder {
        /// The end `a` found.
        a: u32,
        /// The end `b` found.
        b: u32,
    },
}

/// What every version of the format has.
#[derive(Deserialize)]
struct Header {
    format: String,
    version: u64,
}

impl MapInfo {
    /// What `grid` says of itself, in the frame `map`.
    pub fn of(grid: &OccupancyGrid, name: &str, hash: &str) -> Self {
        Self {
            name: name.to_owned(),
            hash: hash.to_owned(),
            resolution_m: grid.frame.resolution_m(),
            origin: grid.frame.map_from_grid(),
            width: grid.cells.width(),
            height: grid.cells.height(),
            frame_id: "map".to_owned(),
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
            last_id: self.last_place_id.unwrap_or(largest),
        }
    }

    /// Checks that the map has at most `max_cells` cells: what is made of a document may take memory for each.
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

    /// The document as text.
    ///
    /// # Errors
    /// If a number is out of the range of JSON; no document made by [`TopologyDocument::new`] has one.
    pub fn to_json(&self) -> Result<String, TopologyError> {
        layout::to_json(self).map_err(|error| syntax(&error))
    }

    /// Names the hash of the document in it: results that say the same have the same, whenever they were made.
    ///
    /// # Errors
    /// As [`TopologyDocument::to_json`].
    pub fn seal(&mut self) -> Result<(), TopologyError> {
        self.sha256 = Some(self.fingerprint()?);
        Ok(())
    }

    /// Whether the document says what it said when it was sealed.
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
        check::check(&document)?;
        Ok(document)
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
        route: connection.route.as_ref().map(|route| Route {
            length_m: rounded(route.length_m),
            line: rounded_points(&route.line),
            // Down, so that what is written is kept.
            clearance_m: route.clearance_m.map(|clearance| (clearance * 1e4).floor() / 1e4),
        }),
        ..*connection
    }
}
