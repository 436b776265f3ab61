//! CARMEN map files, plain or gzipped.
//!
//! Comment lines that start with `#`, the tag `CARMENMAPFILEv020`, then chunks: a type byte (bit 7 set: a
//! zero-terminated name precedes the data), a 32-bit size of what follows it, a description of 10 characters,
//! data. All numbers are little-endian. The grid (type 1) is its sides as 32-bit integers, the resolution, and
//! the probability of every cell, column by column from the lower left, −1 where nothing is known. Resolution
//! and cells are 32-bit floats, or 64-bit ones in some forks: the size of the chunk decides.
//!
//! A file may go on after the grid with places and off-limits shapes, or with a stray byte; of a gzipped file that is unpacked,
//! so that its checksum is checked, but nothing is made of it.
//! The global offset (type 64) is not applied: places and poses of CARMEN are in the grid's own frame.

use std::io::{self, Read};

use flate2::read::MultiGzDecoder;

use super::ros::{self, Interpretation, Mode};
use super::{Format, MapError, ReadOptions, Reader, Source, file};
use crate::geom::Pose2;
use crate::grid::{Cell, Grid, MapFrame, Occupancy, OccupancyGrid};

const TAG: &[u8] = b"CARMENMAPFILEv020";
const GZIP_MAGIC: &[u8] = &[0x1f, 0x8b];
/// Size of the description that every chunk begins with.
const DESCRIPTION: u32 = 10;
const NAMED: u8 = 1 << 7;
const GRIDMAP: u8 = 1;

/// The grid of a CARMEN map file.
#[derive(Clone, Debug, PartialEq)]
pub struct CarmenMap {
    /// Meters per cell: the shortest decimal that reads as the file's 32-bit float.
    pub resolution_m: f64,
    /// Probability that a cell is occupied; −1 if it is unknown.
    pub probabilities: Grid<f32>,
}

/// The state of a cell with probability `p`: free up to `free_thresh`, occupied from `occupied_thresh` on,
/// unknown between them and where `p` is −1.
///
/// CARMEN itself stores no thresholds; those of map_server (0.196 and 0.65) give it the same three states.
pub fn occupancy(p: f32, how: &Interpretation) -> Occupancy {
    if p < 0.0 { Occupancy::Unknown } else { ros::probability_occupancy(f64::from(p), how) }
}

/// How map files of this kind are read.
pub(super) const READER: Reader = Reader {
    extensions: &["map", "gz"],
    is_certain: is_carmen,
    is_known: is_carmen,
    max_bytes: file::max_bytes,
    read,
};

fn read(bytes: &[u8], options: &ReadOptions) -> Result<(OccupancyGrid, Source), MapError> {
    let map = parse(bytes, options.max_cells)?;
    let how = options.interpretation(Interpretation { mode: Mode::Raw, ..Default::default() });
    how.check_thresholds()?;
    let cells = map.probabilities.map(|&p| occupancy(p, &how));
    let frame = options.frame(MapFrame::new(map.resolution_m, Pose2::default())?)?;
    let source = Source { gray_205: options.gray_205, ..Source::new(Format::Carmen, how) };
    Ok((OccupancyGrid { frame, cells }, source))
}

/// Whether `bytes` begin like a CARMEN map: gzipped, with a comment, or with the tag.
pub fn is_carmen(bytes: &[u8]) -> bool {
    bytes.starts_with(GZIP_MAGIC) || bytes.starts_with(b"#") || bytes.starts_with(b"CARMEN")
}

/// Reads the first grid of a CARMEN map file.
///
/// Memory grows with the data that is really there, also when it is gzipped, up to 16 bytes per cell. Cost: one pass.
///
/// # Errors
/// If the tag or the grid is missing, the file is cut off or its gzip stream damaged, the grid has no cell or
/// more than `max_cells`, or a cell is neither a probability nor −1.
pub fn parse(bytes: &[u8], max_cells: u64) -> Result<CarmenMap, MapError> {
    if bytes.starts_with(GZIP_MAGIC) {
        let mut stream = io::BufReader::new(MultiGzDecoder::new(bytes));
        let map = parse_stream(&mut stream, max_cells)?;
        // Length and checksum stand at the end of the stream.
        let rest = io::copy(&mut stream.take(u64::from(MAX_OTHER_CHUNKS) + 1), &mut io::sink());
        match rest.map_err(in_part("gzip stream"))? {
            n if n > u64::from(MAX_OTHER_CHUNKS) => {
                Err(MapError::CarmenSize { expected: "64 MiB of chunks behind the grid", found: n as i64 })
            }
            _ => Ok(map),
        }
    } else {
        parse_stream(&mut &bytes[..], max_cells)
    }
}

/// Places, off-limits shapes and the like are small; before the grid there may be no more of them than this.
const MAX_OTHER_CHUNKS: u32 = 1 << 26;

fn parse_stream(stream: &mut dyn Read, max_cells: u64) -> Result<CarmenMap, MapError> {
    skip_comments_and_tag(stream)?;
    let mut n_chunks = 0;
    let mut n_skipped = 0u32;
    while let Some((kind, size)) = chunk_header(stream, n_chunks)? {
        if kind & !NAMED == GRIDMAP {
            let name = if kind & NAMED == 0 { 0 } else { skip_name(stream, size)? };
            return grid(stream, size - name, max_cells);
        }
        n_skipped = n_skipped.saturating_add(size).saturating_add(DESCRIPTION);
        if n_skipped > MAX_OTHER_CHUNKS {
            let expected = "64 MiB of chunks before the grid";
            return Err(MapError::CarmenSize { expected, found: n_skipped.into() });
        }
        skip(stream, size)?;
        n_chunks += 1;
    }
    Err(MapError::CarmenNoGrid { n_chunks })
}

/// Comments have no fixed length; a file whose comments pass this is no map.
const MAX_COMMENTS: u32 = 1 << 16;

fn skip_comments_and_tag(stream: &mut dyn Read) -> Result<(), MapError> {
    let mut byte = read_bytes::<1>(stream, "comments")?[0];
    let mut n_comment = 0;
    while byte == b'#' && n_comment < MAX_COMMENTS {
        while byte != b'\n' && n_comment < MAX_COMMENTS {
            byte = read_bytes::<1>(stream, "comments")?[0];
            n_comment += 1;
        }
        byte = read_bytes::<1>(stream, "comments")?[0];
    }
    let mut found = vec![byte];
    stream.take(TAG.len() as u64 - 1).read_to_end(&mut found).map_err(in_part("tag"))?;
    if found != TAG {
        return Err(MapError::CarmenTag { found: found.escape_ascii().to_string() });
    }
    Ok(())
}

/// Type of the next chunk and size of its data after the description, or `None` at the end of the file.
fn chunk_header(stream: &mut dyn Read, n_chunks: u32) -> Result<Option<(u8, u32)>, MapError> {
    let mut kind = [0];
    if stream.read(&mut kind).map_err(in_part("chunks"))? == 0 {
        return Ok(None);
    }
    let part = if n_chunks == 0 { "first chunk" } else { "chunks" };
    let size = i32::from_le_bytes(read_bytes(stream, part)?);
    read_bytes::<{ DESCRIPTION as usize }>(stream, part)?;
    let expected = "its 10 characters of description";
    match u32::try_from(size).ok().and_then(|size| size.checked_sub(DESCRIPTION)) {
        Some(rest) => Ok(Some((kind[0], rest))),
        None => Err(MapError::CarmenSize { expected, found: size.into() }),
    }
}

/// Passes over the name of a chunk of `size` bytes; returns the name's size.
fn skip_name(stream: &mut dyn Read, size: u32) -> Result<u32, MapError> {
    for n_read in 1..=size {
        if read_bytes::<1>(stream, "name of a chunk")? == [0] {
            return Ok(n_read);
        }
    }
    Err(MapError::CarmenSize { expected: "its name", found: size.into() })
}

fn skip(stream: &mut dyn Read, size: u32) -> Result<(), MapError> {
    let skipped = io::copy(&mut stream.take(size.into()), &mut io::sink()).map_err(in_part("chunks"))?;
    if skipped < u64::from(size) {
        return Err(in_part("chunks")(io::ErrorKind::UnexpectedEof.into()));
    }
    Ok(())
}

/// Reads a grid chunk of `size` bytes.
fn grid(stream: &mut dyn Read, size: u32, max_cells: u64) -> Result<CarmenMap, MapError> {
    let side = |stream: &mut dyn Read| -> Result<u64, MapError> {
        let found = i32::from_le_bytes(read_bytes(stream, "grid")?);
        u64::try_from(found)
            .map_err(|_| MapError::CarmenSize { expected: "the side of a grid", found: found.into() })
    };
    let (width, height) = (side(stream)?, side(stream)?);
    MapError::check_size(width, height, max_cells)?;
    let n_cells = width * height;
    let rest = u64::from(size).saturating_sub(8);
    let widths = [(4, 4), (8, 4), (8, 8), (4, 8)];
    let Some((resolution_bytes, cell_bytes)) = widths.into_iter().find(|(r, c)| r + c * n_cells == rest)
    else {
        let expected = "a grid of 32-bit or 64-bit floats of its width and height";
        return Err(MapError::CarmenSize { expected, found: size.into() });
    };
    let resolution_m = match resolution_bytes {
        4 => widened(f32::from_le_bytes(read_bytes(stream, "grid")?)),
        _ => f64::from_le_bytes(read_bytes(stream, "grid")?),
    };
    let mut data = Vec::new();
    stream.take(n_cells * cell_bytes).read_to_end(&mut data).map_err(in_part("grid"))?;
    if data.len() as u64 != n_cells * cell_bytes {
        return Err(in_part("grid")(io::ErrorKind::UnexpectedEof.into()));
    }
    let column_major: Vec<f32> = if cell_bytes == 4 {
        data.as_chunks::<4>().0.iter().map(|&b| f32::from_le_bytes(b)).collect()
    } else {
        data.as_chunks::<8>().0.iter().map(|&b| f64::from_le_bytes(b) as f32).collect()
    };
    let probabilities = transposed(width as u32, height as u32, &column_major)?;
    Ok(CarmenMap { resolution_m, probabilities })
}

/// Columns from the left, each from the bottom, to rows from the bottom.
fn transposed(width: u32, height: u32, column_major: &[f32]) -> Result<Grid<f32>, MapError> {
    let mut grid = Grid::filled(width, height, 0.0);
    for (index, &p) in column_major.iter().enumerate() {
        let (x, y) = ((index / height as usize) as u32, (index % height as usize) as u32);
        // The fork that writes f64 rounds as it likes; a probability may pass 1 by that much.
        let is_unknown = (p + 1.0).abs() < 1e-6;
        if !(is_unknown || (0.0..=1.0 + 1e-6).contains(&p)) {
            return Err(MapError::CarmenValue { x, y, found: f64::from(p) });
        }
        grid[Cell::new(x, y)] = p;
    }
    Ok(grid)
}

/// The decimal that people wrote: 0.1, not 0.10000000149.
fn widened(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}

fn read_bytes<const N: usize>(stream: &mut dyn Read, part: &'static str) -> Result<[u8; N], MapError> {
    let mut bytes = [0; N];
    stream.read_exact(&mut bytes).map_err(in_part(part))?;
    Ok(bytes)
}

fn in_part(part: &'static str) -> impl Fn(io::Error) -> MapError {
    move |error| MapError::CarmenRead { part, error }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A map of 2 columns and 3 rows: the left column is 0, 1, −1 from the bottom, the right 0.5.
    fn file(resolution: &[u8], cell: impl Fn(f64) -> Vec<u8>) -> Vec<u8> {
        let mut grid = [2i32.to_le_bytes(), 3i32.to_le_bytes()].concat();
        grid.extend_from_slice(resolution);
        grid.extend([0.0, 1.0, -1.0, 0.5, 0.5, 0.5].into_iter().flat_map(cell));
        let mut bytes = b"# a map\n#\nCARMENMAPFILEv020".to_vec();
        for (kind, data) in [(32, &b"creator"[..]), (GRIDMAP, &grid), (4, &b"places"[..])] {
            bytes.push(kind);
            bytes.extend((data.len() as i32 + 10).to_le_bytes());
            bytes.extend(b"TENLETTERS");
            bytes.extend(data);
        }
        bytes.push(b'\n');
        bytes
    }

    fn narrow() -> Vec<u8> {
        file(&0.1f32.to_le_bytes(), |p| (p as f32).to_le_bytes().to_vec())
    }

    #[test]
    fn floats_of_both_widths_and_columns_from_the_lower_left() {
        let wide = |p: f64| p.to_le_bytes().to_vec();
        let mixed = file(&0.1f64.to_le_bytes(), |p| (p as f32).to_le_bytes().to_vec());
        for bytes in [narrow(), mixed, file(&0.1f64.to_le_bytes(), wide), file(&0.1f32.to_le_bytes(), wide)] {
            let map = parse(&bytes, 6).unwrap();
            assert_eq!(map.resolution_m.to_string(), "0.1");
            assert_eq!(map.probabilities.values(), [0.0, 0.5, 1.0, 0.5, -1.0, 0.5]);
        }
    }

    #[test]
    fn every_shorter_file_is_an_error() {
        let bytes = narrow();
        let end_of_grid = bytes.len() - b"\n".len() - 15 - b"places".len();
        for n in 0..end_of_grid {
            assert!(parse(&bytes[..n], 6).is_err(), "{n} bytes");
        }
        assert!(parse(&bytes[..end_of_grid], 6).is_ok());
    }

    #[test]
    fn every_damage_of_a_gzip_stream_is_an_error() {
        use flate2::{Compression, GzBuilder};
        use std::io::Write;
        // Stored blocks: no code of the compression notices a changed bit, only the checksum does.
        let packed = |level| {
            let mut packer = GzBuilder::new().write(Vec::new(), Compression::new(level));
            packer.write_all(&narrow()).unwrap();
            packer.finish().unwrap()
        };
        for level in [0, 6] {
            let bytes = packed(level);
            assert_eq!(parse(&bytes, 6).unwrap(), parse(&narrow(), 6).unwrap());
            // The header's time, flags and system (bytes 4 to 9) say nothing of the data.
            let mut n_unnoticed = 0;
            for (at, bit) in (10..bytes.len()).flat_map(|at| (0..8).map(move |bit| (at, bit))) {
                let mut damaged = bytes.clone();
                damaged[at] ^= 1 << bit;
                if let Ok(map) = parse(&damaged, 6) {
                    assert_eq!(
                        map.probabilities,
                        parse(&bytes, 6).unwrap().probabilities,
                        "bit {bit} of byte {at}"
                    );
                    n_unnoticed += 1;
                }
            }
            // Bits that fill up a byte, or describe a code that is not used, say nothing.
            assert!(n_unnoticed < 16, "level {level}: {n_unnoticed}");
            for n in 0..bytes.len() {
                assert!(parse(&bytes[..n], 6).is_err(), "level {level}, {n} bytes");
            }
            assert!(parse(&[&bytes[..], b"junk after it"].concat(), 6).is_err(), "level {level}");
        }
    }

    #[test]
    fn sizes_and_values_are_checked() {
        assert!(matches!(parse(&narrow(), 5), Err(MapError::TooManyCells { .. })));
        let nan = file(&0.1f32.to_le_bytes(), |_| f32::NAN.to_le_bytes().to_vec());
        assert!(matches!(parse(&nan, 6), Err(MapError::CarmenValue { x: 0, y: 0, .. })));
        assert!(matches!(parse(b"# only a comment\nand text after it", 6), Err(MapError::CarmenTag { .. })));
        assert!(matches!(parse(b"CARMENMAPFILEv020", 6), Err(MapError::CarmenNoGrid { n_chunks: 0 })));
        // Cut off within the chunk before the grid, of which 4 of 7 bytes are there.
        let cut = b"CARMENMAPFILEv020\x20\x11\0\0\0TENLETTERScrea";
        assert!(matches!(parse(cut, 6), Err(MapError::CarmenRead { part: "chunks", .. })));
    }
}
