//! Maps of robot vacuums, as the JSON of Valetudo.
//!
//! Layers of pixels of `pixelSize` centimeters: `floor` and `segment` (a room) are free, `wall` is occupied and wins where layers
//! overlap, all else is unknown. Pixels are runs `x, y, length` in `compressedPixels`, or pairs `x, y` in `pixels` of
//! older files; y runs downward. The grid is the box around all pixels with five unknown cells on each side. The map frame has
//! Valetudo's x and its y turned upward, in meters: the pixel at the origin has its upper left corner at (0, 0).

use std::collections::BTreeMap;

use serde::Deserialize;

use super::ros::Interpretation;
use super::{Format, MapError, ReadOptions, Reader, Source};
use crate::geom::Pose2;
use crate::grid::{Cell, Grid, MapFrame, Occupancy, OccupancyGrid};

/// Largest file that is read, in bytes: homes take a tenth of a megabyte.
pub const MAX_BYTES: u64 = 1 << 24;
/// Unknown cells around the pixels.
const MARGIN: i64 = 5;
/// Layers hardly overlap; more pixels than this for each cell of the box are not a map.
const MAX_PIXELS_PER_CELL: u64 = 8;

/// A map of a robot vacuum.
#[derive(Clone, Debug, PartialEq)]
pub struct ValetudoMap {
    /// Resolution, and where the grid lies.
    pub frame: MapFrame,
    /// Free floor, walls, and everything else.
    pub cells: Grid<Occupancy>,
    /// Number of the segment of each cell, 0 for none; segments are the rooms in the vacuum's app.
    pub segments: Grid<u16>,
    /// Names that people gave segments, by their numbers.
    pub names: BTreeMap<u16, String>,
}

#[derive(Deserialize)]
struct Document {
    #[serde(rename = "__class")]
    class: String,
    #[serde(rename = "pixelSize")]
    pixel_size_cm: f64,
    layers: Vec<Layer>,
}

#[derive(Deserialize)]
struct Layer {
    #[serde(rename = "type")]
    kind: String,
    #[serde(default, rename = "metaData")]
    about: About,
    #[serde(default)]
    pixels: Vec<i32>,
    #[serde(default, rename = "compressedPixels")]
    runs: Vec<i32>,
}

#[derive(Default, Deserialize)]
struct About {
    #[serde(default, rename = "segmentId")]
    segment: serde_json::Value,
    #[serde(default)]
    name: Option<String>,
}

/// Pixels of one row, y down.
#[derive(Clone, Copy)]
struct Run {
    x: i64,
    y: i64,
    n: i64,
}

impl Layer {
    fn runs(&self) -> impl Iterator<Item = Run> + '_ {
        let runs = self.runs.as_chunks::<3>().0.iter().map(|&[x, y, n]| Run {
            x: x.into(),
            y: y.into(),
            n: n.into(),
        });
        let pixels =
            self.pixels.as_chunks::<2>().0.iter().map(|&[x, y]| Run { x: x.into(), y: y.into(), n: 1 });
        runs.chain(pixels)
    }

    fn occupancy(&self) -> Option<Occupancy> {
        match self.kind.as_str() {
            "floor" | "segment" => Some(Occupancy::Free),
            "wall" => Some(Occupancy::Occupied),
            _ => None,
        }
    }

    /// Number of the segment, if the layer is one: what Valetudo calls it if that is a number, else `otherwise`.
    fn segment(&self, otherwise: u16) -> u16 {
        let id = match &self.about.segment {
            serde_json::Value::String(text) => text.parse().ok(),
            serde_json::Value::Number(number) => number.as_u64().and_then(|n| u16::try_from(n).ok()),
            _ => None,
        };
        if self.kind == "segment" { id.filter(|&id| id > 0).unwrap_or(otherwise) } else { 0 }
    }
}

/// How map files of this kind are read.
pub(super) const READER: Reader = Reader {
    extensions: &["json"],
    is_certain: |head| String::from_utf8_lossy(head).contains("ValetudoMap"),
    is_known: is_json,
    max_bytes: |_| MAX_BYTES,
    read,
};

fn read(bytes: &[u8], options: &ReadOptions) -> Result<(OccupancyGrid, Source), MapError> {
    let map = parse(bytes, options.max_cells)?;
    let grid = OccupancyGrid { frame: options.frame(map.frame)?, cells: map.cells };
    Ok((grid, Source::new(Format::Valetudo, Interpretation::default())))
}

/// Whether `bytes` begin like JSON.
pub fn is_json(bytes: &[u8]) -> bool {
    bytes.trim_ascii_start().starts_with(b"{")
}

fn damaged(message: String) -> MapError {
    MapError::Damaged { format: Format::Valetudo, message }
}

/// Reads a Valetudo map. Cost: one pass over the pixels.
///
/// # Errors
/// If the bytes are not the JSON of a Valetudo map, the size of a pixel is not above 0, a list of pixels is not made of whole
/// runs, there are no pixels, or the box around them has more than `max_cells` cells.
pub fn parse(bytes: &[u8], max_cells: u64) -> Result<ValetudoMap, MapError> {
    if bytes.len() as u64 > MAX_BYTES {
        return Err(MapError::FileTooLarge { max_bytes: MAX_BYTES });
    }
    let document: Document = serde_json::from_slice(bytes).map_err(|error| damaged(error.to_string()))?;
    if document.class != "ValetudoMap" {
        return Err(damaged(format!("its __class is {:?}", document.class)));
    }
    let layers: Vec<&Layer> = document.layers.iter().filter(|layer| layer.occupancy().is_some()).collect();
    let bounds = Bounds::around(&layers)?;
    let (width, height) = (bounds.right - bounds.left + 2 * MARGIN, bounds.end - bounds.top + 2 * MARGIN);
    // Both are above 0, and sums of two numbers of 32 bits.
    MapError::check_size(width as u64, height as u64, max_cells)?;
    let n_pixels = layers.iter().flat_map(|layer| layer.runs()).map(|run| run.n as u64).sum::<u64>();
    if n_pixels > MAX_PIXELS_PER_CELL.saturating_mul((width * height) as u64) {
        return Err(damaged(format!("{n_pixels} pixels in {width} x {height} cells")));
    }
    let (left, bottom) = (bounds.left - MARGIN, bounds.end + MARGIN);
    let resolution_m = document.pixel_size_cm / 100.0;
    let origin = Pose2::new(left as f64 * resolution_m, -(bottom as f64) * resolution_m, 0.0);
    let frame = MapFrame::new(resolution_m, origin)?;
    let mut map = ValetudoMap {
        frame,
        cells: Grid::filled(width as u32, height as u32, Occupancy::Unknown),
        segments: Grid::filled(width as u32, height as u32, 0),
        names: BTreeMap::new(),
    };
    for (layer, number) in layers.iter().zip(1..) {
        let (state, segment) = (layer.occupancy().unwrap_or(Occupancy::Unknown), layer.segment(number));
        if let Some(name) = layer.about.name.as_ref().filter(|_| segment > 0) {
            map.names.insert(segment, name.clone());
        }
        for Run { x, y, n } in layer.runs() {
            // The flip: the pixel's row ends where the cell's begins.
            let y = (bottom - 1 - y) as u32;
            for cell in (0..n).map(|step| Cell::new((x + step - left) as u32, y)) {
                if map.cells[cell] == Occupancy::Occupied {
                    continue;
                }
                map.cells[cell] = state;
                if state == Occupancy::Occupied {
                    map.segments[cell] = 0;
                } else if segment > 0 {
                    map.segments[cell] = segment;
                }
            }
        }
    }
    Ok(map)
}

/// The box around pixels: first column and row, and those past the last.
struct Bounds {
    left: i64,
    right: i64,
    top: i64,
    end: i64,
}

impl Bounds {
    fn around(layers: &[&Layer]) -> Result<Self, MapError> {
        let wrong = |message: String| Err(damaged(message));
        let mut bounds: Option<Self> = None;
        for layer in layers {
            if !layer.runs.len().is_multiple_of(3) || !layer.pixels.len().is_multiple_of(2) {
                return wrong(format!("a layer of type {} ends within a pixel", layer.kind));
            }
            for Run { x, y, n } in layer.runs() {
                if n < 1 {
                    return wrong(format!("a run of {n} pixels at ({x}, {y})"));
                }
                let old = bounds.unwrap_or(Self { left: x, right: x + n, top: y, end: y + 1 });
                bounds = Some(Self {
                    left: old.left.min(x),
                    right: old.right.max(x + n),
                    top: old.top.min(y),
                    end: old.end.max(y + 1),
                });
            }
        }
        bounds.map_or_else(|| wrong("no floor, segment or wall has a pixel".to_owned()), Ok)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(layers: &str) -> Result<ValetudoMap, MapError> {
        let text =
            format!(r#"{{"__class": "ValetudoMap", "pixelSize": 5, "size": {{}}, "layers": [{layers}]}}"#);
        parse(text.as_bytes(), 1000)
    }

    /// Rows from the top without the margin: the number of a segment, `.` for other floor, `#` for walls.
    fn drawn(map: &ValetudoMap) -> Vec<String> {
        let (w, h) = (map.cells.width(), map.cells.height());
        let symbol = |x, y| match (map.cells[Cell::new(x, y)], map.segments[Cell::new(x, y)]) {
            (Occupancy::Free, 0) => '.',
            (Occupancy::Free, n) => char::from_digit(n.into(), 10).unwrap(),
            (Occupancy::Occupied, _) => '#',
            (Occupancy::Unknown, _) => '?',
        };
        let margin = MARGIN as u32;
        (margin..h - margin).rev().map(|y| (margin..w - margin).map(|x| symbol(x, y)).collect()).collect()
    }

    #[test]
    fn layers_are_painted_and_walls_win() {
        let found = map(
            r#"{"type": "wall", "compressedPixels": [10, 20, 4, 12, 21, 1]},
               {"type": "segment", "metaData": {"segmentId": "7", "name": "Kitchen"}, "compressedPixels": [10, 21, 2, 12, 21, 1]},
               {"type": "segment", "metaData": {"segmentId": 3}, "pixels": [13, 21, 13, 22]},
               {"type": "floor", "compressedPixels": [10, 22, 3]},
               {"type": "carpet", "compressedPixels": [0, 0, 9]}"#,
        )
        .unwrap();
        assert_eq!(drawn(&found), ["####", "77#3", "...3"]);
        assert_eq!(found.names, BTreeMap::from([(7, "Kitchen".to_owned())]));
        // Pixel (10, 22) is the lowest and leftmost: its lower left corner is (0.5, -1.15), five cells inside.
        assert!((found.frame.resolution_m() - 0.05).abs() < 1e-12);
        let origin = found.frame.map_from_grid();
        assert!((origin.x - 0.25).abs() < 1e-12 && (origin.y + 1.4).abs() < 1e-12, "{origin:?}");
        assert!(found.cells.row(0).iter().all(|&state| state == Occupancy::Unknown));
    }

    #[test]
    fn what_is_no_map_is_one_clear_error_each() {
        let message = |layers: &str| map(layers).unwrap_err().to_string();
        assert!(message("").contains("no floor, segment or wall"));
        assert!(message(r#"{"type": "wall", "compressedPixels": [1, 2]}"#).contains("ends within a pixel"));
        assert!(message(r#"{"type": "wall", "compressedPixels": [1, 2, 0]}"#).contains("a run of 0 pixels"));
        assert!(
            message(r#"{"type": "wall", "compressedPixels": [1, 2, -3]}"#).contains("a run of -3 pixels")
        );
        let far = r#"{"type": "wall", "compressedPixels": [-2147483648, 0, 1, 2147483647, 0, 2147483647]}"#;
        assert!(matches!(map(far), Err(MapError::TooManyCells { .. })));
        let again = "0, 0, 50, ".repeat(120);
        let many = format!(r#"{{"type": "wall", "compressedPixels": [{again} 0, 0, 50]}}"#);
        assert!(message(&many).contains("6050 pixels"), "{}", message(&many));
        for other in [r#"{"__class": "Other", "pixelSize": 5, "layers": []}"#, "{}", "{\"__class\"", ""] {
            assert!(
                matches!(
                    parse(other.as_bytes(), 100),
                    Err(MapError::Damaged { format: Format::Valetudo, .. })
                ),
                "{other}"
            );
        }
        for size in ["0", "-5", "1e400", "null"] {
            let text = format!(
                r#"{{"__class": "ValetudoMap", "pixelSize": {size}, "layers": [{{"type": "wall", "compressedPixels": [1, 1, 1]}}]}}"#
            );
            assert!(parse(text.as_bytes(), 1000).is_err(), "{size}");
        }
    }
}
