//! Recordings of ROS 2 as MCAP: read chunk by chunk, each of which may be compressed by zstd or LZ4.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Read};

use mcap::McapError;
use mcap::records::{ChunkHeader, Record, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::{GRID_TYPES, MapError, ReadOptions, RecordedGrid, is_wanted, max_bytes, wrong};

/// The records that lead to grids. Others, such as attachments, are not looked into.
const TAKEN: [u8; 4] = [op::SCHEMA, op::CHANNEL, op::MESSAGE, op::CHUNK];

/// Most bytes that are asked of the file at once.
const READ_BYTES: usize = 1 << 20;

/// [`super::grids`] of an MCAP file.
pub(super) fn grids<E: From<MapError>>(
    source: &mut dyn Read,
    options: &ReadOptions,
    each: &mut dyn FnMut(RecordedGrid) -> Result<(), E>,
) -> Result<BTreeSet<String>, E> {
    let mut state = Scan { options, schemas: BTreeSet::new(), topics: BTreeMap::new(), each };
    state.records(source, false)?;
    Ok(state.topics.into_values().collect())
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

impl<E: From<MapError>> Scan<'_, E> {
    /// Takes all records of a file or of a chunk, which begins and ends without the magic bytes, and has no chunks.
    fn records(&mut self, source: &mut dyn Read, is_chunk: bool) -> Result<(), E> {
        let max_bytes = max_bytes(self.options.max_cells);
        let limit = usize::try_from(max_bytes).unwrap_or(usize::MAX);
        let reader_options = LinearReaderOptions::default()
            .with_emit_chunks(true)
            .with_record_length_limit(limit)
            .with_skip_start_magic(is_chunk)
            .with_skip_end_magic(is_chunk);
        let mut reader = LinearReader::new_with_options(reader_options);
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
                LinearReadEvent::Record { opcode, data } if TAKEN.contains(&opcode) => {
                    match mcap::parse_record(opcode, data).map_err(damaged)? {
                        Record::Chunk { .. } if is_chunk => {
                            return Err(wrong("a chunk is in a chunk".to_owned()).into());
                        }
                        Record::Chunk { header, data } => {
                            let unpacked = unpack(&header, &data, max_bytes)?;
                            self.records(&mut &*unpacked, true)?;
                        }
                        record => self.take(record)?,
                    }
                }
                LinearReadEvent::Record { .. } => {}
            }
        }
        Ok(())
    }

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
                let wanted = |topic: &&String| is_wanted(self.options, topic);
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
    wrong(message)
}
