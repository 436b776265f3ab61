//! Maps in recordings of ROS 2: the `nav_msgs/OccupancyGrid` messages of MCAP files.
//!
//! A recording is read from its beginning to its end, chunk by chunk; what is kept is one message of each topic. Chunks may be
//! compressed by zstd or LZ4.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Read};

use mcap::McapError;
use mcap::read::LinearReader as Records;
use mcap::records::{ChunkHeader, Record};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::file::max_bytes;
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

/// What a recording's schema must be called.
const GRID_TYPES: [&str; 2] = ["nav_msgs/msg/OccupancyGrid", "nav_msgs/OccupancyGrid"];

/// Most bytes that are asked of the file at once.
const READ_BYTES: usize = 1 << 20;

/// Hands all grids of `options.topic`, or of all topics, to `each` in the order in which they were recorded, and returns the
/// topics of all grids. Cost: the whole recording is read and unpacked once.
///
/// # Errors
/// If the recording is damaged or cut off, or `each` fails.
pub fn grids<E: From<MapError>>(
    source: &mut dyn Read,
    options: &ReadOptions,
    each: &mut dyn FnMut(RecordedGrid) -> Result<(), E>,
) -> Result<BTreeSet<String>, E> {
    let max_bytes = max_bytes(options.max_cells);
    let limit = usize::try_from(max_bytes).unwrap_or(usize::MAX);
    let reader_options =
        LinearReaderOptions::default().with_emit_chunks(true).with_record_length_limit(limit);
    let mut reader = LinearReader::new_with_options(reader_options);
    let mut state = Scan { options, schemas: BTreeSet::new(), topics: BTreeMap::new(), each };
    while let Some(event) = reader.next_event() {
        match event.map_err(damaged)? {
            LinearReadEvent::ReadRequest(needed) => {
                if needed > limit {
                    return Err(MapError::FileTooLarge { max_bytes }.into());
                }
                let buffer = reader.insert(needed.min(READ_BYTES));
                let n_read = read_some(source, buffer).map_err(|error| MapError::Io { error })?;
                reader.notify_read(n_read);
            }
            LinearReadEvent::Record { opcode, data } => {
                match mcap::parse_record(opcode, data).map_err(damaged)? {
                    Record::Chunk { header, data } => {
                        let unpacked = unpack(&header, &data, max_bytes)?;
                        for record in Records::sans_magic(&unpacked) {
                            state.take(record.map_err(damaged)?)?;
                        }
                    }
                    record => state.take(record)?,
                }
            }
        }
    }
    Ok(state.topics.into_values().collect())
}

/// The last grid of `options.topic`; of the only topic with grids where that says nothing.
///
/// # Errors
/// If the recording is damaged or cut off, there is no grid, or there are several topics and none was asked for.
pub fn last_grid(source: &mut dyn Read, options: &ReadOptions) -> Result<RecordedGrid, MapError> {
    let mut last: BTreeMap<String, RecordedGrid> = BTreeMap::new();
    let topics = grids(source, options, &mut |grid| {
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

/// What is known while records go by.
struct Scan<'a, E> {
    options: &'a ReadOptions,
    /// Schemas of grids.
    schemas: BTreeSet<u16>,
    /// Channels with grids.
    topics: BTreeMap<u16, String>,
    each: &'a mut dyn FnMut(RecordedGrid) -> Result<(), E>,
}

impl<E> Scan<'_, E> {
    fn take(&mut self, record: Record<'_>) -> Result<(), E> {
        match record {
            Record::Schema { header, .. } if GRID_TYPES.contains(&header.name.as_str()) => {
                self.schemas.insert(header.id);
            }
            Record::Channel(channel)
                if self.schemas.contains(&channel.schema_id) && channel.message_encoding == "cdr" =>
            {
                self.topics.insert(channel.id, channel.topic);
            }
            Record::Message { header, data } => {
                let wanted = |topic: &&String| {
                    let plain = |topic: &str| topic.trim_start_matches('/').to_owned();
                    self.options.topic.as_ref().is_none_or(|asked| plain(asked) == plain(topic))
                };
                if let Some(topic) = self.topics.get(&header.channel_id).filter(wanted) {
                    let (topic, log_time_ns) = (topic.clone(), header.log_time);
                    (self.each)(RecordedGrid { topic, log_time_ns, cdr: data.into_owned() })?;
                }
            }
            _ => {}
        }
        Ok(())
    }
}

/// The records of a chunk.
fn unpack(header: &ChunkHeader, data: &[u8], max_bytes: u64) -> Result<Vec<u8>, MapError> {
    if header.uncompressed_size > max_bytes {
        return Err(MapError::FileTooLarge { max_bytes });
    }
    let wrong = |message: String| MapError::Recording { message };
    let mut records = Vec::new();
    let mut read =
        |source: &mut dyn Read| source.take(header.uncompressed_size + 1).read_to_end(&mut records);
    match header.compression.as_str() {
        "" => read(&mut &*data),
        "lz4" => read(&mut lz4_flex::frame::FrameDecoder::new(data)),
        "zstd" => {
            let decoder = ruzstd::decoding::StreamingDecoder::new(data);
            read(&mut decoder.map_err(|error| wrong(format!("a chunk does not unpack: {error}")))?)
        }
        other => return Err(wrong(format!("a chunk is compressed by {other:?}; zstd and lz4 are read"))),
    }
    .map_err(|error| wrong(format!("a chunk does not unpack: {error}")))?;
    if records.len() as u64 != header.uncompressed_size {
        return Err(wrong(format!("a chunk of {} bytes has {}", header.uncompressed_size, records.len())));
    }
    if header.uncompressed_crc != 0 && crc32fast::hash(&records) != header.uncompressed_crc {
        return Err(wrong("a chunk has another checksum than it says".to_owned()));
    }
    Ok(records)
}

fn read_some(source: &mut dyn Read, buffer: &mut [u8]) -> io::Result<usize> {
    loop {
        match source.read(buffer) {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            other => return other,
        }
    }
}

fn damaged(error: McapError) -> MapError {
    let message = match error {
        McapError::UnexpectedEof => {
            "it is cut off, as one is whose recorder did not end in order; `mcap recover` mends such files"
                .to_owned()
        }
        McapError::BadMagic => "it does not begin as an MCAP file does".to_owned(),
        other => other.to_string(),
    };
    MapError::Recording { message }
}
