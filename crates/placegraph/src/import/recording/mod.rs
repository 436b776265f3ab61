//! Maps in recordings of ROS: the `nav_msgs/OccupancyGrid` messages of MCAP files, and with the features `sqlite` and `ros1` of bags of
//! SQLite (`.db3`), as ROS 2 wrote them before Iron, and of ROS 1 (`.bag`); alone, packed as a whole by zstd (`.mcap.zstd`), or in the
//! folder that ROS 2's recorder makes.
//!
//! A recording is read from its beginning to its end; what is kept is one message of each topic.

#[cfg(feature = "ros1")]
mod bag_file;
mod folder;
mod mcap_file;
#[cfg(feature = "sqlite")]
mod sqlite_file;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::io::Read;
use std::path::{Path, PathBuf};

use super::file::{max_bytes, open_stream};
use super::ros::{self, Interpretation, Mode};
use super::{Format, MapError, ReadOptions, Source};
use crate::geom::Pose2;
use crate::grid::{Cell, Grid, MapFrame, OccupancyGrid};
use crate::messages;

/// A grid of a recording, as it was sent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordedGrid {
    /// Its topic.
    pub topic: String,
    /// When it was recorded, in nanoseconds since 1970 or the start of a simulation.
    pub log_time_ns: u64,
    /// The message as CDR.
    pub cdr: Vec<u8>,
}

/// The kinds of recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Container {
    /// MCAP, of ROS 2 since Iron.
    Mcap,
    /// A database of SQLite, of ROS 2 before Iron.
    Sqlite,
    /// A bag of ROS 1.
    Ros1,
    /// A folder with recordings of the other kinds and a `metadata.yaml`, as ROS 2's recorder makes it.
    Folder,
}

impl Container {
    /// The kind of a file by the ending of its name, whether or not this kind is read; of a folder by its `metadata.yaml`.
    pub fn of(path: &Path) -> Option<Self> {
        if folder::is_bag(path) {
            return Some(Self::Folder);
        }
        let unpacked = if is_packed(path) { Path::new(path.file_stem()?) } else { path };
        let extension = unpacked.extension()?.to_ascii_lowercase();
        match extension.to_str()? {
            "mcap" => Some(Self::Mcap),
            "db3" => Some(Self::Sqlite),
            "bag" => Some(Self::Ros1),
            _ => None,
        }
    }
}

/// Whether a file is packed by zstd as a whole, by the ending of its name.
fn is_packed(path: &Path) -> bool {
    let is = |ending: &str| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(ending));
    is("zstd") || is("zst")
}

/// A recording that is open: of a folder, all its files.
pub struct Recording<'a> {
    files: Vec<PathBuf>,
    parts: Vec<(Option<PathBuf>, Opened<'a>)>,
}

impl fmt::Debug for Recording<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Recording").field("files", &self.files).finish_non_exhaustive()
    }
}

enum Opened<'a> {
    Mcap(Box<dyn Read + 'a>),
    #[cfg(feature = "ros1")]
    Ros1(Box<dyn Read + 'a>),
    #[cfg(feature = "sqlite")]
    Sqlite(sqlite_file::Database),
}

impl Recording<'static> {
    /// Opens the recording at `path`. A database that is packed as a whole is unpacked into memory, of at most 1 GiB.
    ///
    /// # Errors
    /// If it cannot be opened, is no regular file, or is of a kind that is not read: with the features `sqlite` and `ros1`, all are.
    pub fn open(path: &Path) -> Result<Self, MapError> {
        if Container::of(path) != Some(Container::Folder) {
            return Ok(Self { files: vec![path.to_owned()], parts: vec![(None, Opened::at(path)?)] });
        }
        let files = folder::files(path)?;
        let part = |file: &PathBuf| {
            let opened = Opened::at(file).map_err(|error| error.in_file(file))?;
            Ok((Some(file.clone()), opened))
        };
        let parts = files[1..].iter().map(part).collect::<Result<Vec<_>, MapError>>()?;
        Ok(Self { files, parts })
    }
}

impl<'a> Recording<'a> {
    /// A recording in memory.
    ///
    /// # Errors
    /// If it is of a kind that is not read, or is none of its kind.
    pub fn from_bytes(container: Container, bytes: &'a [u8]) -> Result<Self, MapError> {
        let opened = match container {
            Container::Mcap => Opened::Mcap(Box::new(bytes)),
            #[cfg(feature = "ros1")]
            Container::Ros1 => Opened::Ros1(Box::new(bytes)),
            #[cfg(feature = "sqlite")]
            Container::Sqlite => Opened::Sqlite(sqlite_file::Database::from_bytes(bytes)?),
            other => return Err(not_read(other)),
        };
        Ok(Self { files: Vec::new(), parts: vec![(None, opened)] })
    }

    /// The files that are open, of a folder its `metadata.yaml` too; none of a recording in memory.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }
}

impl Opened<'static> {
    /// Opens one file.
    fn at(path: &Path) -> Result<Self, MapError> {
        let source = || -> Result<Box<dyn Read>, MapError> {
            let file = open_stream(path)?;
            Ok(if is_packed(path) { Box::new(unpacked(file)?) } else { Box::new(file) })
        };
        Ok(match Container::of(path).unwrap_or(Container::Mcap) {
            Container::Mcap => Self::Mcap(source()?),
            #[cfg(feature = "ros1")]
            Container::Ros1 => Self::Ros1(source()?),
            #[cfg(feature = "sqlite")]
            Container::Sqlite if is_packed(path) => {
                Self::Sqlite(sqlite_file::Database::from_bytes(&unpacked_whole(source()?)?)?)
            }
            #[cfg(feature = "sqlite")]
            Container::Sqlite => Self::Sqlite(sqlite_file::Database::open(path)?),
            other => return Err(not_read(other)),
        })
    }
}

/// What `source` holds, packed by zstd.
fn unpacked(source: impl Read) -> Result<impl Read, MapError> {
    ruzstd::decoding::StreamingDecoder::new(source).map_err(|error| does_not_unpack(&error))
}

/// All that `source` gives, of at most [`MAX_UNPACKED_BYTES`].
#[cfg(feature = "sqlite")]
fn unpacked_whole(source: impl Read) -> Result<Vec<u8>, MapError> {
    let mut bytes = Vec::new();
    source.take(MAX_UNPACKED_BYTES + 1).read_to_end(&mut bytes).map_err(|error| does_not_unpack(&error))?;
    if bytes.len() as u64 > MAX_UNPACKED_BYTES {
        return Err(wrong("it is larger than 1 GiB, unpacked: unpack it first with `zstd -d`".to_owned()));
    }
    Ok(bytes)
}

/// Most bytes of a database that is packed as a whole.
#[cfg(feature = "sqlite")]
const MAX_UNPACKED_BYTES: u64 = 1 << 30;

fn does_not_unpack(error: &dyn fmt::Display) -> MapError {
    wrong(format!("what is compressed does not unpack: {error}"))
}

/// The error for a bag that this build does not read.
fn not_read(container: Container) -> MapError {
    let (found, command) = match container {
        Container::Ros1 => ("a bag of ROS 1 (.bag)", "mcap convert in.bag out.mcap"),
        Container::Folder => ("a folder", "ros2 bag convert"),
        Container::Mcap | Container::Sqlite => ("a bag of SQLite (.db3)", "ros2 bag convert"),
    };
    MapError::RecordingFormat { found, command }
}

/// What the type of a grid is called.
const GRID_TYPES: [&str; 2] = ["nav_msgs/msg/OccupancyGrid", "nav_msgs/OccupancyGrid"];

/// Hands all grids of `options.topic`, or of all topics, to `each` in the order in which they were recorded, and returns the
/// topics of all grids. Cost: the whole recording is read and unpacked once.
///
/// # Errors
/// If the recording is damaged or cut off, or `each` fails.
pub fn grids<E: From<MapError>>(
    recording: Recording<'_>,
    options: &ReadOptions,
    each: &mut dyn FnMut(RecordedGrid) -> Result<(), E>,
) -> Result<BTreeSet<String>, E> {
    let mut topics = BTreeSet::new();
    for (file, opened) in recording.parts {
        let each = &mut |grid| each(grid).map_err(Stopped::ByCaller);
        let found = match opened {
            Opened::Mcap(mut source) => mcap_file::grids(&mut source, options, each),
            #[cfg(feature = "ros1")]
            Opened::Ros1(mut source) => bag_file::grids(&mut source, options, each),
            #[cfg(feature = "sqlite")]
            Opened::Sqlite(database) => database.grids(options, each),
        };
        topics.extend(found.map_err(|stopped| match (stopped, &file) {
            (Stopped::ByCaller(error), _) => error,
            (Stopped::ByRecording(error), Some(file)) => error.in_file(file).into(),
            (Stopped::ByRecording(error), None) => error.into(),
        })?);
    }
    Ok(topics)
}

/// Why a recording was not read to its end.
enum Stopped<E> {
    ByCaller(E),
    ByRecording(MapError),
}

impl<E> From<MapError> for Stopped<E> {
    fn from(error: MapError) -> Self {
        Self::ByRecording(error)
    }
}

/// The last grid of `options.topic`; of the only topic with grids where that says nothing.
///
/// # Errors
/// If the recording is damaged or cut off, there is no grid, or there are several topics and none was asked for.
pub fn last_grid(recording: Recording<'_>, options: &ReadOptions) -> Result<RecordedGrid, MapError> {
    let mut last: BTreeMap<String, RecordedGrid> = BTreeMap::new();
    let topics = grids(recording, options, &mut |grid| {
        // Recorders may write messages a little out of order.
        if last.get(&grid.topic).is_none_or(|before| before.log_time_ns <= grid.log_time_ns) {
            last.insert(grid.topic.clone(), grid);
        }
        Ok::<(), MapError>(())
    })?;
    let found = || topics.iter().cloned().collect();
    match (&options.topic, last.len()) {
        (Some(topic), 0) => Err(MapError::NoSuchTopic { topic: topic.clone(), found: found() }),
        (None, 0) => Err(MapError::NoRecordedGrid),
        (_, 1) => last.into_values().next().ok_or(MapError::NoRecordedGrid),
        _ => Err(MapError::SeveralTopics { found: found() }),
    }
}

/// The map of a recorded grid.
///
/// The message has the resolution as a 32-bit float: it is taken for the shortest decimal number that rounds to it, 0.05 and
/// not 0.05000000074505806, so that results are those of the map's file; the yaw is rounded to 10⁻¹² rad.
///
/// # Errors
/// If the bytes are no such message, or the message is no map: no cells, cells missing, no resolution, a grid that is tilted, values
/// that are neither −1 nor 0 to 100.
pub fn map_of(grid: &RecordedGrid, options: &ReadOptions) -> Result<(OccupancyGrid, Source), MapError> {
    let wrong = |message: String| MapError::RecordedGrid { topic: grid.topic.clone(), message };
    let message: messages::OccupancyGrid = messages::from_cdr(&grid.cdr).map_err(wrong)?;
    let info = message.info;
    MapError::check_size(info.width.into(), info.height.into(), options.max_cells)?;
    let n_cells = info.width as usize * info.height as usize;
    if message.data.len() != n_cells {
        return Err(wrong(format!("expected {n_cells} cells, found {}", message.data.len())));
    }
    if let Some(value) = message.data.iter().find(|value| !(-1..=100).contains(*value)) {
        return Err(wrong(format!("expected occupancies of -1 (unknown) or 0 to 100, found {value}")));
    }
    let position = info.origin.position;
    let yaw_rad = yaw_rad(info.origin.orientation).map_err(wrong)?;
    let resolution_m = info.resolution.to_string().parse().unwrap_or(f64::from(info.resolution));
    let frame = MapFrame::new(resolution_m, Pose2::new(position.x, position.y, yaw_rad))?;
    let how = options.interpretation(Interpretation { mode: Mode::Raw, ..Interpretation::default() });
    how.check_thresholds()?;
    let mut cells = Grid::filled(info.width, info.height, ros::occupancy(-1, &how));
    for (y, row) in (0..).zip(message.data.chunks_exact(info.width as usize)) {
        for (x, &value) in (0..).zip(row) {
            cells[Cell::new(x, y)] = ros::occupancy(value, &how);
        }
    }
    Ok((OccupancyGrid { frame: options.frame(frame)?, cells }, Source::new(Format::Recording, how)))
}

/// The turn about the z axis that `q` is, in radians.
fn yaw_rad(q: messages::Quaternion) -> Result<f64, String> {
    let norm = (q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w).sqrt();
    // What a message holds that was never filled.
    if norm == 0.0 {
        return Ok(0.0);
    }
    if norm.is_nan() || (norm - 1.0).abs() > 0.01 {
        return Err(format!("expected a unit quaternion as orientation, found one of length {norm}"));
    }
    if q.x.hypot(q.y) > 0.01 {
        return Err("expected a map that lies flat, found one that is tilted".to_owned());
    }
    let sign = if q.w < 0.0 { -1.0 } else { 1.0 };
    Ok((2.0 * (sign * q.z).atan2(sign * q.w) * 1e12).round() / 1e12)
}

/// Whether the grids of `topic` are asked for; with and without its first slash it is the same topic.
fn is_wanted(options: &ReadOptions, topic: &str) -> bool {
    let plain = |topic: &str| topic.trim_start_matches('/').to_owned();
    options.topic.as_ref().is_none_or(|asked| plain(asked) == plain(topic))
}

fn wrong(message: String) -> MapError {
    MapError::Recording { message }
}
