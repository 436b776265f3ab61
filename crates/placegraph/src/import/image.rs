//! PNG, BMP and PNM images to samples, whatever their color type.
//!
//! Palettes and depths below 8 bits are expanded, PNM samples scaled from their maximum. Cost: one pass.

use std::io::Cursor;

use image::codecs::bmp::BmpDecoder;
use image::codecs::png::PngDecoder;
use image::codecs::pnm::{PnmDecoder, PnmSubtype, SampleEncoding};
use image::{ColorType, ImageDecoder, ImageError, ImageFormat, Limits};

use super::MapError;

/// The samples of a pixel, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channels {
    /// Gray.
    Gray,
    /// Gray, alpha.
    GrayAlpha,
    /// Red, green, blue.
    Rgb,
    /// Red, green, blue, alpha.
    Rgba,
}

impl Channels {
    /// Samples per pixel.
    pub const fn n_samples(self) -> usize {
        match self {
            Self::Gray => 1,
            Self::GrayAlpha => 2,
            Self::Rgb => 3,
            Self::Rgba => 4,
        }
    }

    /// Samples per pixel without alpha.
    pub const fn n_colors(self) -> usize {
        match self {
            Self::Gray | Self::GrayAlpha => 1,
            Self::Rgb | Self::Rgba => 3,
        }
    }
}

/// The samples of an image, at the depth of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Samples {
    /// 8 bits or fewer a sample, expanded to 0..=255.
    Eight(Vec<u8>),
    /// 16 bits a sample.
    Sixteen(Vec<u16>),
}

/// A decoded image: rows from the *top*, pixels from the left, samples in the order of `channels`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Raster {
    /// Number of columns, at least 1.
    pub width: u32,
    /// Number of rows, at least 1.
    pub height: u32,
    /// The samples of a pixel.
    pub channels: Channels,
    /// `width · height · channels.n_samples()` samples.
    pub samples: Samples,
}

impl Raster {
    /// The samples with 8 bits each: 16-bit ones are divided by 257 and rounded, as GraphicsMagick does.
    pub fn into_8_bit(self) -> Vec<u8> {
        match self.samples {
            Samples::Eight(samples) => samples,
            Samples::Sixteen(samples) => {
                samples.into_iter().map(|v| ((u32::from(v) + 128) / 257) as u8).collect()
            }
        }
    }
}

/// Width and height that the first bytes of an image declare; `None` where they are no header that is read.
pub(super) fn declared_size(head: &[u8]) -> Option<(u64, u64)> {
    let (width, height) = match image::guess_format(head).ok()? {
        // Signature, length and type of the first chunk, then both sides; other chunks may not fit the head.
        ImageFormat::Png => {
            let side = |at: usize| Some(u32::from_be_bytes(*head.get(at..)?.first_chunk::<4>()?));
            (side(16)?, side(20)?)
        }
        ImageFormat::Pnm => PnmDecoder::new(Cursor::new(head)).ok()?.dimensions(),
        ImageFormat::Bmp => BmpDecoder::new(Cursor::new(head)).ok()?.dimensions(),
        _ => return None,
    };
    Some((width.into(), height.into()))
}

/// Decodes `bytes`, a PNG, BMP or PNM image by its first bytes.
///
/// # Errors
/// If the bytes are none of these, the image is damaged or has no pixel, or it has more than `max_cells` pixels
/// (found from the header, before memory is taken).
pub fn decode(bytes: &[u8], max_cells: u64) -> Result<Raster, MapError> {
    let cursor = Cursor::new(bytes);
    let n_pixels = match declared_size(bytes) {
        Some((width, height)) => {
            MapError::check_size(width, height, max_cells)?;
            width * height
        }
        None => 0,
    };
    match image::guess_format(bytes) {
        Ok(ImageFormat::Png) => {
            check_palette(bytes)?;
            let mut limits = Limits::no_limits();
            // The decoder's own buffers: a row or two and the text chunks.
            limits.max_alloc = Some(n_pixels.saturating_mul(8).saturating_add(1 << 20));
            read(PngDecoder::with_limits(cursor, limits), max_cells)
        }
        Ok(ImageFormat::Pnm) => {
            check_maximum(bytes)?;
            read(PnmDecoder::new(cursor), max_cells)
        }
        Ok(ImageFormat::Bmp) => read(BmpDecoder::new(cursor), max_cells),
        Ok(other) => Err(MapError::ImageFormat { found: name(other) }),
        Err(_) if bytes.is_empty() => Err(MapError::ImageFormat { found: "an empty file" }),
        Err(_) if is_text(bytes) => Err(MapError::ImageFormat { found: "text" }),
        Err(_) => Err(MapError::ImageFormat { found: "unknown bytes" }),
    }
}

/// A palette has three bytes a color; `png` 0.18 panics where it ends within one.
fn check_palette(png: &[u8]) -> Result<(), MapError> {
    // After the signature: a chunk's length, its type, its bytes and a checksum, then the next one.
    let mut rest = png.get(8..).unwrap_or_default();
    while let Some((head, after)) = rest.split_first_chunk::<8>() {
        let [a, b, c, d, kind @ ..] = *head;
        let n_bytes = u32::from_be_bytes([a, b, c, d]) as usize;
        if &kind == b"PLTE" && !n_bytes.is_multiple_of(3) {
            let message = format!("a palette of {n_bytes} bytes, which are not three for each color");
            return Err(MapError::ImageData { message });
        }
        rest = after.get(n_bytes.saturating_add(4)..).unwrap_or_default();
    }
    Ok(())
}

/// Samples of a PNM above the maximum that it declares: the decoder would take them for the maximum, white for gray.
fn check_maximum(pnm: &[u8]) -> Result<(), MapError> {
    // What is wrong with a header, the decoder says.
    let Ok(decoder) = PnmDecoder::new(Cursor::new(pnm)) else { return Ok(()) };
    let n_samples = decoder.total_bytes();
    let (cursor, header) = decoder.into_inner();
    let (maximum, is_bitmap) = (header.maximal_sample(), matches!(header.subtype(), PnmSubtype::Bitmap(_)));
    if is_bitmap || matches!(maximum, 255 | 65_535) {
        return Ok(());
    }
    let data = pnm.get(cursor.position() as usize..).unwrap_or_default();
    let is_ascii = matches!(
        header.subtype(),
        PnmSubtype::Graymap(SampleEncoding::Ascii) | PnmSubtype::Pixmap(SampleEncoding::Ascii)
    );
    let largest = if is_ascii {
        let tokens = data.split(u8::is_ascii_whitespace).filter_map(|token| std::str::from_utf8(token).ok());
        tokens.filter_map(|token| token.parse().ok()).max()
    } else if maximum < 256 {
        data.iter().take(n_samples as usize).map(|&sample| u32::from(sample)).max()
    } else {
        let pairs = data.as_chunks::<2>().0.iter().take(n_samples as usize / 2);
        pairs.map(|&pair| u32::from(u16::from_be_bytes(pair))).max()
    };
    match largest {
        Some(found) if found > maximum => Err(MapError::ImageData {
            message: format!("a sample of {found} above its maximum of {maximum}"),
        }),
        _ => Ok(()),
    }
}

fn read<D: ImageDecoder>(decoder: Result<D, ImageError>, max_cells: u64) -> Result<Raster, MapError> {
    let damaged = |error: ImageError| MapError::ImageData { message: error.to_string() };
    let decoder = decoder.map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    MapError::check_size(width.into(), height.into(), max_cells)?;
    let (channels, wide) = match decoder.color_type() {
        ColorType::L8 => (Channels::Gray, false),
        ColorType::La8 => (Channels::GrayAlpha, false),
        ColorType::Rgb8 => (Channels::Rgb, false),
        ColorType::Rgba8 => (Channels::Rgba, false),
        ColorType::L16 => (Channels::Gray, true),
        ColorType::La16 => (Channels::GrayAlpha, true),
        ColorType::Rgb16 => (Channels::Rgb, true),
        ColorType::Rgba16 => (Channels::Rgba, true),
        _ => return Err(MapError::ImageFormat { found: "an image with samples that are no integers" }),
    };
    let mut bytes = vec![0; decoder.total_bytes() as usize];
    decoder.read_image(&mut bytes).map_err(damaged)?;
    let samples = if wide {
        let (pairs, _) = bytes.as_chunks::<2>();
        Samples::Sixteen(pairs.iter().map(|&pair| u16::from_ne_bytes(pair)).collect())
    } else {
        Samples::Eight(bytes)
    };
    Ok(Raster { width, height, channels, samples })
}

fn name(format: ImageFormat) -> &'static str {
    match format {
        ImageFormat::Jpeg => "JPEG, which blurs gray values: save the original as PNG",
        ImageFormat::Gif => "GIF: convert it to PNG",
        ImageFormat::Tiff => "TIFF: convert it to PNG",
        ImageFormat::WebP => "WebP: convert it to PNG",
        _ => "another image format: convert it to PNG",
    }
}

fn is_text(bytes: &[u8]) -> bool {
    bytes.iter().take(512).all(|&b| b.is_ascii_graphic() || b.is_ascii_whitespace())
}
