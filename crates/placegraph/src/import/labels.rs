//! Label images and room images: drawn by people, one pixel per cell.

use super::image::{self, Raster, Samples};
use super::valetudo;
use crate::grid::Grid;
use crate::labels::{Label, LabelSet};

/// What a label image says of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LabelCell {
    /// Nothing: no class was drawn here.
    None,
    /// The class drawn.
    Class(Label),
    /// To be left out of training and scores: free, but ambiguous.
    Ignore,
}

/// Which pixel values stand for what: red, green, blue, or three times the gray value.
///
/// Alpha is not looked at, and palettes are expanded: the color counts, not its place in the palette.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LabelCoding {
    entries: Vec<([u8; 3], LabelCell)>,
}

/// Why a label image or a room image could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LabelImageError {
    /// The bytes are no readable image.
    #[error(transparent)]
    Image(#[from] super::MapError),
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
    /// The image has 16 bits a sample, or colors where ids are expected.
    #[error("expected {expected}, found {found}")]
    PixelType {
        /// What can be read.
        expected: &'static str,
        /// What the image has.
        found: &'static str,
    },
    /// A pixel has a value that stands for nothing.
    #[error(
        "found {} in {n_pixels} pixels, first in column {x} of row {y} from the top; expected one of {}",
        describe(*value), expected.iter().map(|&v| describe(v)).collect::<Vec<_>>().join(", ")
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

impl LabelCoding {
    /// The coding of this program's own label images: 0 no class, `k` the k-th class from 1, 255 ignore.
    pub fn of(classes: &LabelSet) -> Self {
        let class = classes.labels().map(|label| ([label.0 + 1; 3], LabelCell::Class(label)));
        let mut coding = Self { entries: vec![([0; 3], LabelCell::None), ([255; 3], LabelCell::Ignore)] };
        coding.entries.extend(class);
        coding
    }

    /// The coding with `entries`; where a value stands twice, the first counts.
    pub fn new(entries: Vec<([u8; 3], LabelCell)>) -> Self {
        Self { entries }
    }

    fn meaning(&self, value: [u8; 3]) -> Option<LabelCell> {
        self.entries.iter().find(|(known, _)| *known == value).map(|&(_, cell)| cell)
    }
}

/// Reads a label image (8 bits a sample, gray or color) of `size` = (width, height) in cells; row 0 of the
/// result is the image's bottom row.
///
/// # Errors
/// If the bytes are no image, it has another size or 16 bits a sample, or a value that stands for nothing.
pub fn read_labels(
    bytes: &[u8],
    size: (u32, u32),
    coding: &LabelCoding,
) -> Result<Grid<LabelCell>, LabelImageError> {
    let raster = decode(bytes, size)?;
    let channels = raster.channels;
    let Samples::Eight(samples) = &raster.samples else {
        let (expected, found) = ("a label image with 8 bits a sample", "16 bits");
        return Err(LabelImageError::PixelType { expected, found });
    };
    let color = |pixel: &[u8]| match channels.n_colors() {
        1 => [pixel[0]; 3],
        _ => [pixel[0], pixel[1], pixel[2]],
    };
    let mut cells = Vec::with_capacity(samples.len() / channels.n_samples());
    // Neighboring pixels mostly agree: look a value up only where it changes.
    let mut last = None;
    for (index, pixel) in samples.chunks_exact(channels.n_samples()).enumerate() {
        let value = color(pixel);
        let cell = match last {
            Some((known, cell)) if known == value => cell,
            _ => coding.meaning(value).ok_or_else(|| LabelImageError::UnknownValue {
                value,
                n_pixels: samples.chunks_exact(channels.n_samples()).filter(|p| color(p) == value).count()
                    as u64,
                x: (index % size.0 as usize) as u32,
                y: (index / size.0 as usize) as u32,
                expected: coding.entries.iter().map(|&(known, _)| known).collect(),
            })?,
        };
        last = Some((value, cell));
        cells.push(cell);
    }
    Ok(flipped(size, &cells))
}

/// Width and height of an image of at most `max_pixels` pixels, from its header.
///
/// # Errors
/// If the bytes are no image of a kind that is read, it has no pixel, or more of them.
pub fn image_size(bytes: &[u8], max_pixels: u64) -> Result<(u32, u32), LabelImageError> {
    match image::declared_size(bytes) {
        Some((width, height)) => {
            super::MapError::check_size(width, height, max_pixels)?;
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
