//! Label images and room images: drawn by people, one pixel per cell.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::Cursor;

use super::LabelCoding;
use crate::grid::Grid;
use crate::import::image::{self, Raster, Samples};
use crate::import::{MapError, valetudo};
use crate::labels::LabelCell;

/// Why a label image or a room image could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LabelImageError {
    /// The bytes are not a readable image.
    #[error(transparent)]
    Image(#[from] MapError),
    /// The image does not cover the map pixel for cell.
    #[error(
        "expected an image of {} x {} pixels like the map, found {} x {}",
        expected.0, expected.1, found.0, found.1
    )]
    Size {
        /// Width and height of the map.
        expected: (u32, u32),
        /// Width and height of the image.
        found: (u32, u32),
    },
    /// The image has colors where ids are expected, or numbers that are no labels.
    #[error("expected {expected}, found {found}")]
    PixelType {
        /// What can be read.
        expected: &'static str,
        /// What the image has.
        found: &'static str,
    },
    /// A pixel has a value that stands for nothing.
    #[error(
        "found {} in {n_pixels} pixels, first in column {x} of row {y} from the top{}; expected one of {}",
        describe(*value), also(others), expected.iter().map(|&v| describe(v)).collect::<Vec<_>>().join(", ")
    )]
    UnknownValue {
        /// The value: that of the first such pixel.
        value: [u8; 3],
        /// Number of pixels with this value.
        n_pixels: u64,
        /// Column of the first one, from the left, from 0.
        x: u32,
        /// Row of the first one, from the image's top, from 0.
        y: u32,
        /// Other values that stand for nothing, each with its number of pixels, the most frequent first.
        others: Vec<([u8; 3], u64)>,
        /// The values that stand for something.
        expected: Vec<[u8; 3]>,
    },
}

fn describe(value: [u8; 3]) -> String {
    match value {
        [r, g, b] if r == g && g == b => format!("gray {r}"),
        [r, g, b] => format!("color [{r}, {g}, {b}]"),
    }
}

/// Values that an error lists; an image with more was painted with soft edges.
const MAX_LISTED: usize = 5;

fn also(others: &[([u8; 3], u64)]) -> String {
    let list = |others: &[([u8; 3], u64)]| {
        others.iter().map(|&(v, n)| format!("{} in {n}", describe(v))).collect::<Vec<_>>().join(", ")
    };
    match others.len() {
        0 => String::new(),
        1..=MAX_LISTED => format!(", also {}", list(others)),
        n => format!(
            ", also {}, and {} more values: paint without soft edges (antialiasing)",
            list(&others[..MAX_LISTED]),
            n - MAX_LISTED
        ),
    }
}

/// Reads a label image (gray, color or with a palette) of `size` = (width, height) in cells; row 0 of the
/// result is the image's bottom row. Samples of 16 bits are numbers to 255, or such numbers times 257. The colors of a
/// palette count; if one has no meaning, the places in the palette do.
///
/// # Errors
/// If the bytes are no image, it has another size, or a value that stands for nothing.
pub fn read_labels(
    bytes: &[u8],
    size: (u32, u32),
    coding: &LabelCoding,
) -> Result<Grid<LabelCell>, LabelImageError> {
    let raster = decode(bytes, size)?;
    let cells = meanings(&raster, coding);
    if cells.is_err()
        && let Some(places) = palette_places(bytes, size)
    {
        let channels = image::Channels::Gray;
        let raster = Raster { channels, samples: Samples::Eight(places), ..raster };
        if let Ok(cells) = meanings(&raster, coding) {
            return Ok(cells);
        }
    }
    cells
}

/// The cells of a raster, or the values that stand for nothing.
fn meanings(raster: &Raster, coding: &LabelCoding) -> Result<Grid<LabelCell>, LabelImageError> {
    let samples = in_8_bits(&raster.samples)?;
    let (n_samples, n_colors) = (raster.channels.n_samples(), raster.channels.n_colors());
    // What is fully transparent was not painted.
    let value = |pixel: &[u8]| match (n_colors, pixel) {
        (1, [_, 0]) | (3, [_, _, _, 0]) => [0; 3],
        (1, _) => [pixel[0]; 3],
        _ => [pixel[0], pixel[1], pixel[2]],
    };
    let mut cells = Vec::with_capacity(samples.len() / n_samples);
    // Neighboring pixels mostly agree: look a value up only where it changes.
    let mut last = None;
    for (index, pixel) in samples.chunks_exact(n_samples).enumerate() {
        let value_here = value(pixel);
        let cell = match last {
            Some((known, cell)) if known == value_here => cell,
            _ => coding.meaning(value_here).ok_or_else(|| {
                let values = samples.chunks_exact(n_samples).map(value);
                unknown_value(value_here, values, index, raster.width as usize, coding)
            })?,
        };
        last = Some((value_here, cell));
        cells.push(cell);
    }
    Ok(flipped((raster.width, raster.height), &cells))
}

/// Numbers of 16 bits as such of 8: as they stand, or, where all are multiples of 257, as GIMP widens them.
fn in_8_bits(samples: &Samples) -> Result<Cow<'_, [u8]>, LabelImageError> {
    let wide = match samples {
        Samples::Eight(samples) => return Ok(Cow::Borrowed(samples)),
        Samples::Sixteen(samples) => samples,
    };
    let divisor = if wide.iter().all(|&v| v.is_multiple_of(257)) { 257 } else { 1 };
    let narrow = wide.iter().map(|&v| u8::try_from(v / divisor)).collect::<Result<Vec<u8>, _>>();
    let (expected, found) = ("numbers to 255 in a label image of 16 bits", "larger ones");
    Ok(Cow::Owned(narrow.map_err(|_| LabelImageError::PixelType { expected, found })?))
}

/// The value of the pixel at `index`, which stands for nothing, and all others like it.
fn unknown_value(
    value: [u8; 3],
    values: impl Iterator<Item = [u8; 3]>,
    index: usize,
    width: usize,
    coding: &LabelCoding,
) -> LabelImageError {
    let mut strays: BTreeMap<[u8; 3], u64> = BTreeMap::new();
    for stray in values.filter(|&value| coding.meaning(value).is_none()) {
        *strays.entry(stray).or_insert(0) += 1;
    }
    let n_pixels = strays.remove(&value).unwrap_or(0);
    let mut others: Vec<([u8; 3], u64)> = strays.into_iter().collect();
    others.sort_by_key(|&(_, n)| std::cmp::Reverse(n));
    LabelImageError::UnknownValue {
        value,
        n_pixels,
        x: (index % width) as u32,
        y: (index / width) as u32,
        others,
        expected: coding.values().collect(),
    }
}

/// The place of every pixel in the palette of a PNG, rows from the top; `None` if it has no palette of 8 bits.
fn palette_places(bytes: &[u8], size: (u32, u32)) -> Option<Vec<u8>> {
    let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().ok()?;
    let kind = reader.info().color_type;
    if kind != png::ColorType::Indexed {
        return None;
    }
    let depth = reader.info().bit_depth as usize;
    let mut rows = vec![0; reader.output_buffer_size()?];
    reader.next_frame(&mut rows).ok()?;
    let (width, height) = (size.0 as usize, size.1 as usize);
    let stride = (width * depth).div_ceil(8);
    let place = |(row, x): (&[u8], usize)| {
        let bit = x * depth;
        let shift = 8 - depth - bit % 8;
        (row[bit / 8] >> shift) & (0xff_u8 >> (8 - depth))
    };
    let rows = rows.chunks_exact(stride).take(height);
    Some(rows.flat_map(|row| (0..width).map(move |x| place((row, x)))).collect())
}

/// Width and height of an image of at most `max_pixels` pixels, from its header.
///
/// # Errors
/// If the bytes are no image of a kind that is read, it has no pixel, or more of them.
pub fn image_size(bytes: &[u8], max_pixels: u64) -> Result<(u32, u32), LabelImageError> {
    match image::declared_size(bytes) {
        Some((width, height)) => {
            MapError::check_size(width, height, max_pixels)?;
            // Sides are 32 bit in every header.
            Ok((width as u32, height as u32))
        }
        // The decoder says what is wrong.
        None => {
            image::decode(bytes, max_pixels).map(|raster| (raster.width, raster.height)).map_err(Into::into)
        }
    }
}

/// Reads a room image (gray, 8 or 16 bits), or the segments of a Valetudo map: an id per cell, 0 in no room; row 0 of the
/// result is the map's lowest row.
///
/// # Errors
/// If the bytes are no image and no Valetudo map, it has another size than `size` = (width, height), or it is not gray.
pub fn read_rooms(bytes: &[u8], size: (u32, u32)) -> Result<Grid<u16>, LabelImageError> {
    if valetudo::is_json(bytes) {
        let segments = valetudo::parse(bytes, max_pixels(size))?.segments;
        let found = (segments.width(), segments.height());
        return if found == size {
            Ok(segments)
        } else {
            Err(LabelImageError::Size { expected: size, found })
        };
    }
    let raster = decode(bytes, size)?;
    if raster.channels.n_samples() > 1 {
        let (expected, found) = ("a gray image of room ids", "colors or alpha");
        return Err(LabelImageError::PixelType { expected, found });
    }
    Ok(match &raster.samples {
        Samples::Eight(ids) => flipped(size, &ids.iter().map(|&id| id.into()).collect::<Vec<u16>>()),
        Samples::Sixteen(ids) => flipped(size, ids),
    })
}

fn decode(bytes: &[u8], size: (u32, u32)) -> Result<Raster, LabelImageError> {
    let raster = image::decode(bytes, max_pixels(size))?;
    let found = (raster.width, raster.height);
    if found != size {
        return Err(LabelImageError::Size { expected: size, found });
    }
    Ok(raster)
}

/// What is about as large as the map is read; the exact size is compared after, with a better error.
fn max_pixels(size: (u32, u32)) -> u64 {
    u64::from(size.0) * u64::from(size.1) * 4 + (1 << 20)
}

/// The flip: the image's last row is the map's first.
fn flipped<T: Copy>((width, height): (u32, u32), from_top: &[T]) -> Grid<T> {
    Grid::from_rows(width, height, from_top.chunks_exact(width as usize).rev().flatten().copied().collect())
}
