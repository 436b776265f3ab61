//! Files to types: map_server YAML, images, CARMEN and Valetudo maps, recordings, label images; and the check of a map.
//!
//! The parsers take bytes and give types: [`ros::parse_yaml`], [`image::decode`], [`carmen::parse`], [`valetudo::parse`],
//! [`read_label_file`], [`read_labels`], [`read_rooms`], [`TrainingFile::from_toml`]; [`recording::grids`] takes an open recording. Only [`load_map`], [`load_labels`], [`read`],
//! [`read_cells`], [`open_stream`] and [`recording::Recording::open`] open files; [`load_map_from`] takes their bytes. All of
//! them are for hostile input: sizes are checked from the header before memory is taken, numbers are checked to be
//! finite, a path in a file is not followed out of its folder, and whatever is wrong is a typed error, never a
//! panic (`docs/reliability.md`).
//!
//! Images have their first row at the top, grids their row 0 at the bottom. The readers here and the writers
//! in [`crate::export`] turn one into the other; nothing else does.

pub mod carmen;
mod check;
mod class_table;
mod error;
mod file;
mod finding;
pub mod image;
mod labels;
mod load;
pub mod recording;
pub mod ros;
mod shape;
mod smoothing;
mod storage;
mod training_file;
pub mod valetudo;

pub use crate::labels::LabelCell;
pub use check::{MapCheck, Shares, check};
pub use class_table::read_classes;
pub use error::MapError;
#[doc(hidden)]
pub use error::has_memory;
pub use file::{MAX_TEXT_BYTES, NamedFiles, named_file, namesake, open_stream, read, read_cells};
pub use finding::{Finding, Severity};
pub use labels::{
    LabelCoding, LabelFileError, LabelImageError, LabelTarget, LabelsYaml, image_size, load_labels,
    read_label_file, read_labels, read_rooms,
};
pub use load::{
    Gray205, LoadedMap, ReadOptions, ReplacedImage, Source, load_map, load_map_from, map_name, read_image,
};
pub use training_file::{TrainingFile, TrainingFileError, TrainingMap};

use serde::Serialize;

use crate::grid::OccupancyGrid;

/// The kinds of map file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Format {
    /// A map_server YAML and its image.
    MapServer,
    /// An image alone.
    Image,
    /// A CARMEN map.
    Carmen,
    /// A map of a robot vacuum, as the JSON of Valetudo.
    Valetudo,
    /// A recording of ROS: MCAP, or a bag.
    Recording,
}

impl Format {
    /// All kinds.
    pub const ALL: [Self; 5] = [Self::MapServer, Self::Image, Self::Carmen, Self::Valetudo, Self::Recording];

    /// What people call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::MapServer => "map_server YAML",
            Self::Image => "image",
            Self::Carmen => "CARMEN map",
            Self::Valetudo => "Valetudo JSON",
            Self::Recording => "recording",
        }
    }

    /// Whether thresholds decide which of its values are free and which are occupied.
    pub fn has_thresholds(self) -> bool {
        self != Self::Valetudo
    }
}

/// A kind of map file that holds a whole map.
struct Reader {
    /// Endings of the names of such files, in lower case.
    extensions: &'static [&'static str],
    /// Whether a file with such a name that begins so is of this kind, and not of another program.
    is_certain: fn(&[u8]) -> bool,
    /// Whether a file that begins so is of this kind, whatever its name.
    is_known: fn(&[u8]) -> bool,
    /// Most bytes of a file with at most this many cells.
    max_bytes: fn(u64) -> u64,
    /// Reads a whole file.
    read: ReadMap,
}

/// Makes a map of the bytes of a file.
type ReadMap = fn(&[u8], &ReadOptions) -> Result<(OccupancyGrid, Source), MapError>;

/// All of them. What none of them knows is an image.
const READERS: &[Reader] = &[carmen::READER, valetudo::READER];

/// Whether a file with this extension, in lower case, can hold a whole map.
pub fn may_hold_map(extension: &str) -> bool {
    READERS.iter().any(|reader| reader.extensions.contains(&extension))
}

/// Whether a file with this extension, in lower case, that begins with `head` holds a whole map.
pub fn holds_map(extension: &str, head: &[u8]) -> bool {
    READERS.iter().any(|reader| reader.extensions.contains(&extension) && (reader.is_certain)(head))
}

/// The kind of file that begins with `head`.
fn reader_of(head: &[u8]) -> Option<&'static Reader> {
    READERS.iter().find(|reader| (reader.is_known)(head))
}
