//! Bags of ROS 1, version 2.0: records, one after the other, most of them in chunks that may be compressed by bzip2 or LZ4.
//!
//! A record is a header of named fields and then its data, each behind its length; numbers have their lowest byte first
//! (<http://wiki.ros.org/Bags/Format/2.0>). Indices are passed over: a bag that was never indexed is read as well.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, BufRead, BufReader, Read};

use byteorder::{LE, ReadBytesExt};

use super::{GRID_TYPES, MapError, ReadOptions, RecordedGrid, is_wanted, max_bytes, wrong};
use crate::messages::{self, Header, MapMetaData, OccupancyGrid, Point, Pose, Quaternion, Time};

const MAGIC: &[u8] = b"#ROSBAG V2.0\n";

/// Most bytes of a header.
const MAX_HEADER_BYTES: u64 = 1 << 20;

/// The kinds of record that matter, by the field `op` of their headers.
const MESSAGE: u8 = 2;
const CHUNK: u8 = 5;
const CONNECTION: u8 = 7;

/// [`super::grids`] of a bag of ROS 1.
pub(super) fn grids<E: From<MapError>>(
    source: &mut dyn Read,
    options: &ReadOptions,
    each: &mut dyn FnMut(RecordedGrid) -> Result<(), E>,
) -> Result<BTreeSet<String>, E> {
    let mut source = BufReader::new(source);
    let mut magic = Vec::new();
    source.by_ref().take(MAGIC.len() as u64).read_to_end(&mut magic).map_err(damaged)?;
    if magic != MAGIC {
        return Err(wrong("it does not begin as a bag of ROS 1, version 2.0, does".to_owned()).into());
    }
    let mut scan = Scan { options, topics: BTreeMap::new(), each };
    scan.records(&mut source, true)?;
    Ok(scan.topics.into_values().collect())
}

/// What is known while records go by.
struct Scan<'a, E> {
    options: &'a ReadOptions,
    /// Connections with grids.
    topics: BTreeMap<u32, String>,
    each: &'a mut dyn FnMut(RecordedGrid) -> Result<(), E>,
}

impl<E: From<MapError>> Scan<'_, E> {
    /// All records of `source`, in which chunks may be.
    fn records(&mut self, source: &mut dyn BufRead, may_have_chunks: bool) -> Result<(), E> {
        let max_bytes = max_bytes(self.options.max_cells);
        while !source.fill_buf().map_err(damaged)?.is_empty() {
            let header = block(source, MAX_HEADER_BYTES)?;
            let fields = Fields(&header);
            match fields.get("op")? {
                [CHUNK] if may_have_chunks => {
                    let records = unpack(&fields, &block(source, max_bytes)?, max_bytes)?;
                    self.records(&mut records.as_slice(), false)?;
                }
                [CONNECTION] => self.connection(&fields, &block(source, MAX_HEADER_BYTES)?)?,
                [MESSAGE] => match self.topics.get(&fields.number("conn")?) {
                    Some(topic) if is_wanted(self.options, topic) => {
                        let topic = topic.clone();
                        let message = block(source, max_bytes)?;
                        self.message(topic, &fields, &message)?;
                    }
                    _ => skip(source)?,
                },
                _ => skip(source)?,
            }
        }
        Ok(())
    }

    fn connection(&mut self, fields: &Fields<'_>, about: &[u8]) -> Result<(), MapError> {
        if GRID_TYPES.iter().any(|name| Fields(about).get("type").is_ok_and(|found| found == name.as_bytes()))
        {
            let topic = String::from_utf8_lossy(fields.get("topic")?).into_owned();
            self.topics.insert(fields.number("conn")?, topic);
        }
        Ok(())
    }

    fn message(&mut self, topic: String, fields: &Fields<'_>, bytes: &[u8]) -> Result<(), E> {
        let cut = |_| wrong("the time of a message is cut off".to_owned());
        let mut time = fields.get("time")?;
        let seconds = time.read_u32::<LE>().map_err(cut)?;
        let nanoseconds = time.read_u32::<LE>().map_err(cut)?;
        let log_time_ns = u64::from(seconds) * 1_000_000_000 + u64::from(nanoseconds);
        let wrong = |message: String| MapError::RecordedGrid { topic: topic.clone(), message };
        let grid = grid_of(bytes).map_err(|error| wrong(format!("the message is cut off: {error}")))?;
        let cdr = messages::to_cdr(&grid).map_err(|error| wrong(error.to_string()))?;
        (self.each)(RecordedGrid { topic, log_time_ns, cdr })
    }
}

/// A `nav_msgs/OccupancyGrid` of ROS 1: the fields of that of ROS 2 behind a number, without gaps between them.
fn grid_of(mut bytes: &[u8]) -> io::Result<OccupancyGrid> {
    let from = &mut bytes;
    let _number = from.read_u32::<LE>()?;
    let stamp = time(from)?;
    let frame_id = String::from_utf8_lossy(&counted(from)?).into_owned();
    let info = MapMetaData {
        map_load_time: time(from)?,
        resolution: from.read_f32::<LE>()?,
        width: from.read_u32::<LE>()?,
        height: from.read_u32::<LE>()?,
        origin: Pose { position: position(from)?, orientation: orientation(from)? },
    };
    let data = counted(from)?.into_iter().map(u8::cast_signed).collect();
    Ok(OccupancyGrid { header: Header { stamp, frame_id }, info, data })
}

/// Times of ROS 1 have no sign.
fn time(from: &mut &[u8]) -> io::Result<Time> {
    Ok(Time { sec: from.read_u32::<LE>()?.cast_signed(), nanosec: from.read_u32::<LE>()? })
}

fn position(from: &mut &[u8]) -> io::Result<Point> {
    Ok(Point { x: from.read_f64::<LE>()?, y: from.read_f64::<LE>()?, z: from.read_f64::<LE>()? })
}

fn orientation(from: &mut &[u8]) -> io::Result<Quaternion> {
    let Point { x, y, z } = position(from)?;
    Ok(Quaternion { x, y, z, w: from.read_f64::<LE>()? })
}

/// Bytes behind their number.
fn counted(from: &mut &[u8]) -> io::Result<Vec<u8>> {
    let n = from.read_u32::<LE>()? as usize;
    let (bytes, rest) = from.split_at_checked(n).ok_or(io::ErrorKind::UnexpectedEof)?;
    *from = rest;
    Ok(bytes.to_vec())
}

/// The fields of a header, each `name=value` behind its length.
struct Fields<'a>(&'a [u8]);

impl<'a> Fields<'a> {
    fn get(&self, name: &str) -> Result<&'a [u8], MapError> {
        let mut rest = self.0;
        while !rest.is_empty() {
            let field = rest.read_u32::<LE>().ok().and_then(|n| rest.split_at_checked(n as usize));
            let (field, after) =
                field.ok_or_else(|| wrong("the header of a record is damaged".to_owned()))?;
            rest = after;
            if let Some(value) =
                field.strip_prefix(name.as_bytes()).and_then(|value| value.strip_prefix(b"="))
            {
                return Ok(value);
            }
        }
        Err(wrong(format!("the header of a record has no field {name}")))
    }

    fn number(&self, name: &str) -> Result<u32, MapError> {
        let mut value = self.get(name)?;
        value.read_u32::<LE>().map_err(|_| wrong(format!("the field {name} of a record is no number")))
    }
}

/// The records of a chunk.
fn unpack(fields: &Fields<'_>, data: &[u8], max_bytes: u64) -> Result<Vec<u8>, MapError> {
    let size = u64::from(fields.number("size")?);
    if size > max_bytes {
        return Err(MapError::FileTooLarge { max_bytes });
    }
    let mut records = Vec::new();
    let mut read = |source: &mut dyn Read| source.take(size + 1).read_to_end(&mut records);
    match fields.get("compression")? {
        b"none" => read(&mut &*data),
        b"bz2" => read(&mut bzip2::bufread::BzDecoder::new(data)),
        b"lz4" => read(&mut lz4_flex::frame::FrameDecoder::new(data)),
        other => {
            let other = String::from_utf8_lossy(other);
            return Err(wrong(format!("a chunk is compressed by {other:?}; bz2 and lz4 are read")));
        }
    }
    .map_err(|error| wrong(format!("a chunk does not unpack: {error}")))?;
    if records.len() as u64 != size {
        return Err(wrong(format!("a chunk of {size} bytes has {}", records.len())));
    }
    Ok(records)
}

/// The bytes behind their number, of which there may be `max_bytes`.
fn block(source: &mut dyn BufRead, max_bytes: u64) -> Result<Vec<u8>, MapError> {
    let n = u64::from(source.read_u32::<LE>().map_err(damaged)?);
    if n > max_bytes {
        return Err(MapError::FileTooLarge { max_bytes });
    }
    let mut bytes = Vec::new();
    source.take(n).read_to_end(&mut bytes).map_err(damaged)?;
    if bytes.len() as u64 == n { Ok(bytes) } else { Err(damaged(io::ErrorKind::UnexpectedEof.into())) }
}

/// Passes over the bytes behind their number.
fn skip(source: &mut dyn BufRead) -> Result<(), MapError> {
    let n = u64::from(source.read_u32::<LE>().map_err(damaged)?);
    let n_skipped = io::copy(&mut source.take(n), &mut io::sink()).map_err(damaged)?;
    if n_skipped == n { Ok(()) } else { Err(damaged(io::ErrorKind::UnexpectedEof.into())) }
}

fn damaged(error: io::Error) -> MapError {
    if error.kind() != io::ErrorKind::UnexpectedEof {
        return MapError::Io { error };
    }
    wrong(
        "it is cut off, as one is whose recorder did not end in order; `rosbag reindex` mends such files"
            .to_owned(),
    )
}
