//! Errors of map files.

use std::io;
use std::path::PathBuf;

use super::Format;
use crate::grid::FrameError;

/// Why a map could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// The error of a file, and which file.
    #[error("{error} (in {})", path.display())]
    InFile {
        /// What is wrong.
        error: Box<MapError>,
        /// The file at fault.
        path: PathBuf,
    },
    /// A file cannot be opened or read.
    #[error("cannot read the file: {error}")]
    Io {
        /// What the system says.
        error: io::Error,
    },
    /// A file is larger than its kind can be: a map of its size, a text, a model.
    #[error("expected a file of at most {max_bytes} bytes, found a larger one")]
    FileTooLarge {
        /// The limit.
        max_bytes: u64,
    },
    /// The YAML does not parse, lacks a key, or a value has another type.
    #[error(
        "expected a map_server YAML (image, resolution, origin, negate, occupied_thresh, free_thresh): {}{message}",
        place(*line, *column)
    )]
    Yaml {
        /// What the parser says.
        message: String,
        /// Line, from 1; 0 if it is not known.
        line: u64,
        /// Column, from 1; 0 if it is not known.
        column: u64,
    },
    /// `mode` is none of the three.
    #[error("expected mode trinary, scale or raw, found {found:?}")]
    Mode {
        /// The value found.
        found: String,
    },
    /// `negate` is neither a truth value nor an integer.
    #[error("expected negate to be 0, 1, true or false, found {found:?}")]
    Negate {
        /// The value found.
        found: String,
    },
    /// `origin` does not hold three numbers.
    #[error("expected an origin of three numbers [x, y, yaw], found {found}")]
    Origin {
        /// How many it holds.
        found: usize,
    },
    /// A threshold is not finite.
    #[error("expected a finite number as {key}, found {found}")]
    Threshold {
        /// The key at fault.
        key: &'static str,
        /// The value found.
        found: f64,
    },
    /// The thresholds leave no room between free and occupied, or are no probabilities.
    #[error(
        "free_thresh {free_thresh} must be below occupied_thresh {occupied_thresh}, both from 0 to 1: programs \
         disagree about what such thresholds mean; map savers write 0.196 and 0.65"
    )]
    Thresholds {
        /// Occupied from here on.
        occupied_thresh: f64,
        /// Free up to here.
        free_thresh: f64,
    },
    /// Resolution or origin cannot georeference a grid.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// A file names another one outside its own folder.
    #[error(
        "{name} does not lie in the folder of the file that names it{}",
        if beside.is_empty() {
            ": correct the path, relative to that folder".to_owned()
        } else {
            format!(", but {} lies there: write the name of the right one", beside.join(" or "))
        }
    )]
    Outside {
        /// The path as named.
        name: String,
        /// Names of files in the folder that may be meant.
        beside: Vec<String>,
    },
    /// A file that is needed is not among those that were given.
    #[error("the file {name}, which this one names, is missing: give both")]
    NotGiven {
        /// Its name.
        name: String,
    },
    /// Not a regular file: a folder, a pipe, a device.
    #[error("expected a regular file, found {found}")]
    NoFile {
        /// What it is.
        found: &'static str,
    },
    /// A file was written to, or cut off, while it was read.
    #[error("the file changed while it was being read: try again")]
    Changed,
    /// The image that the YAML names cannot be read.
    #[error("cannot read the image {}: {error}", image.display())]
    ImageFile {
        /// The image.
        image: PathBuf,
        /// What is wrong.
        error: Box<MapError>,
    },
    /// The bytes are not an image of a known kind.
    #[error("expected a PNG, BMP or PNM (PGM, PBM, PPM) image, found {found}")]
    ImageFormat {
        /// What they look like.
        found: &'static str,
    },
    /// The image is damaged.
    #[error("the image is damaged: {message}")]
    ImageData {
        /// What the decoder says.
        message: String,
    },
    /// A side of the map is zero.
    #[error("expected at least one cell, found {width} x {height}")]
    Empty {
        /// Columns.
        width: u64,
        /// Rows.
        height: u64,
    },
    /// The map has more cells than allowed.
    #[error("expected at most {max_cells} cells, found {width} x {height}")]
    TooManyCells {
        /// Columns.
        width: u64,
        /// Rows.
        height: u64,
        /// The limit.
        max_cells: u64,
    },
    /// The system does not give the memory that reading a map of this size takes.
    #[error("not enough memory: reading {width} x {height} cells needs {n_bytes} bytes")]
    Memory {
        /// Columns.
        width: u64,
        /// Rows.
        height: u64,
        /// What reading takes at most.
        n_bytes: u64,
    },
    /// An image without YAML, and no resolution was given.
    #[error(
        "an image alone has no scale: {}",
        yaml.as_ref().map_or_else(
            || "give its meters per pixel".to_owned(),
            |yaml| format!("read {yaml} next to it instead, or give its meters per pixel")
        )
    )]
    NoResolution {
        /// Name of a YAML file next to the image, with the same stem.
        yaml: Option<String>,
    },
    /// The file is of a known kind, but damaged.
    #[error("the {} cannot be read: {message}", format.name())]
    Damaged {
        /// Its kind.
        format: Format,
        /// What is wrong.
        message: String,
    },
    /// A recording is damaged.
    #[error("the recording cannot be read: {message}")]
    Recording {
        /// What is wrong.
        message: String,
    },
    /// A recording of an unknown kind.
    #[error("recordings are read as MCAP, found {found}: convert it, for example with `{command}`")]
    RecordingFormat {
        /// What it is.
        found: &'static str,
        /// What makes an MCAP file of it.
        command: &'static str,
    },
    /// A recording without maps.
    #[error("expected a recording with messages of the type nav_msgs/msg/OccupancyGrid, found none")]
    NoRecordedGrid,
    /// Several topics have maps, and none was chosen.
    #[error("several topics have maps, choose one of them: {}", found.join(", "))]
    SeveralTopics {
        /// The topics.
        found: Vec<String>,
    },
    /// The requested topic has no maps.
    #[error("expected maps on the topic {topic}, found {}", listed(found))]
    NoSuchTopic {
        /// The topic.
        topic: String,
        /// The topics that have maps.
        found: Vec<String>,
    },
    /// A recorded message is not a map.
    #[error("the map on {topic} cannot be read: {message}")]
    RecordedGrid {
        /// Its topic.
        topic: String,
        /// What is wrong.
        message: String,
    },
    /// The comments are not followed by the CARMEN tag.
    #[error("expected CARMENMAPFILEv020 after the comments, found {found:?}")]
    CarmenTag {
        /// The bytes found, printable ones as they are.
        found: String,
    },
    /// A CARMEN file ends early, or its gzip stream is damaged.
    #[error("the CARMEN map is damaged or cut off in its {part}: {error}")]
    CarmenRead {
        /// Where the reader was.
        part: &'static str,
        /// What the stream says.
        error: io::Error,
    },
    /// A CARMEN file without a grid.
    #[error("expected a GRIDMAP chunk, found {n_chunks} chunks of other types")]
    CarmenNoGrid {
        /// Chunks seen.
        n_chunks: u32,
    },
    /// The size of a CARMEN chunk is impossible.
    #[error("expected a chunk size that fits {expected}, found {found}")]
    CarmenSize {
        /// What the size must fit.
        expected: &'static str,
        /// The size found.
        found: i64,
    },
    /// A cell of a CARMEN grid is neither a probability nor −1.
    #[error("expected a probability or -1 in cell ({x}, {y}), found {found}")]
    CarmenValue {
        /// Column, from the left.
        x: u32,
        /// Row, from the bottom.
        y: u32,
        /// The value found.
        found: f64,
    },
}

/// Memory that reading takes per cell at most, in addition to the file itself: samples, gray values, and the map.
const READ_BYTES_PER_CELL: u64 = 32;

/// The least that is probed for. The C library of Linux keeps freed blocks up to the largest it has seen freed, if that is not
/// above 32 MiB, instead of returning them: a smaller probe would make the program keep what it could return.
const LEAST_PROBE: u64 = 33 << 20;

/// Whether the system would give `n_bytes` of memory now, and 33 MiB if these are more.
///
/// A failed allocation ends the program at once, without a message; with a probe first, there is one. Memory that
/// the system promises and does not have is not noticed.
pub fn has_memory(n_bytes: u64) -> bool {
    let mut probe: Vec<u8> = Vec::new();
    let n_bytes = n_bytes.max(LEAST_PROBE);
    let is_given = usize::try_from(n_bytes).is_ok_and(|n_bytes| probe.try_reserve_exact(n_bytes).is_ok());
    // Memory that is never used would not be allocated.
    std::hint::black_box(&probe);
    is_given
}

/// Words in a row, or that there are none.
fn listed(words: &[String]) -> String {
    if words.is_empty() { "none".to_owned() } else { format!("them on {}", words.join(", ")) }
}

/// Where a parser stopped, in words; nothing if it does not know.
fn place(line: u64, column: u64) -> String {
    if line == 0 { String::new() } else { format!("line {line}, column {column}: ") }
}

impl MapError {
    /// The error itself, without the files that it is in.
    pub fn cause(&self) -> &Self {
        match self {
            Self::InFile { error, .. } | Self::ImageFile { error, .. } => error.cause(),
            other => other,
        }
    }

    /// The same error, with the file it is in: where that is known, it is not the folder around it.
    pub(super) fn in_file(self, path: &std::path::Path) -> Self {
        match self {
            Self::InFile { .. } => self,
            error => Self::InFile { error: Box::new(error), path: path.to_owned() },
        }
    }

    /// Checks a size read from a header, before memory is taken for it.
    pub(super) fn check_size(width: u64, height: u64, max_cells: u64) -> Result<(), Self> {
        if width == 0 || height == 0 {
            return Err(Self::Empty { width, height });
        }
        // Sides are u32 in a grid, and node ids too.
        let limit = max_cells.min(u64::from(u32::MAX) - 1);
        if width.checked_mul(height).is_none_or(|cells| cells > limit) {
            return Err(Self::TooManyCells { width, height, max_cells: limit });
        }
        let n_bytes = width * height * READ_BYTES_PER_CELL;
        if has_memory(n_bytes) { Ok(()) } else { Err(Self::Memory { width, height, n_bytes }) }
    }
}
