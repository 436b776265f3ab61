//! Pictures of labels, a square of pixels per cell: walls dark, classes in their colors, errors marked.

use anyhow::Result;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, imageops};
use placegraph::grid::{Cell, Grid, Occupancy, OccupancyGrid};
use placegraph::labels::{Label, LabelSet};

type Color = [u8; 3];

const PAPER: Color = [255; 3];
const WALL: Color = [52, 58, 70];
/// Free cells without a label.
const UNLABELED: Color = [200; 3];
/// Cells with the wrong label.
const WRONG: Color = [230, 0, 170];
/// Between the training and the test part.
const SPLIT: Color = [0; 3];
/// The longer side of a picture is at most this, unless the map itself is larger.
const SIDE_PX: u32 = 900;
/// Unknown cells around what is known.
const MARGIN_CELLS: u32 = 3;

/// The cells from column `first` on, in the colors of their labels.
pub(super) fn labels_png(map: &OccupancyGrid, labels: &Grid<Option<Label>>, first: u32) -> Result<Vec<u8>> {
    cells_png(map, first, |cell| labels[cell].map_or(UNLABELED, class_color))
}

/// The drawn labels of the whole map, with a line in front of column `split`.
pub(super) fn drawn_png(map: &OccupancyGrid, labels: &Grid<Option<Label>>, split: u32) -> Result<Vec<u8>> {
    cells_png(map, 0, |cell| {
        if split > 0 && cell.x == split { SPLIT } else { labels[cell].map_or(UNLABELED, class_color) }
    })
}

/// The cells from column `first` on: wrong ones marked, right ones pale, gray where `truth` says nothing.
pub(super) fn errors_png(
    map: &OccupancyGrid,
    found: &Grid<Option<Label>>,
    truth: &Grid<Option<Label>>,
    first: u32,
) -> Result<Vec<u8>> {
    cells_png(map, first, |cell| match truth[cell] {
        None => UNLABELED,
        Some(truth) if found[cell] == Some(truth) => pale(class_color(truth)),
        Some(_) => WRONG,
    })
}

fn class_color(label: Label) -> Color {
    LabelSet::default().class(label).color
}

fn pale(color: Color) -> Color {
    color.map(|channel| channel / 3 + 170)
}

/// Paints free cells as `color` says, from column `first` on, cropped to what is known.
fn cells_png(map: &OccupancyGrid, first: u32, color: impl Fn(Cell) -> Color) -> Result<Vec<u8>> {
    let [left, bottom, right, top] = crop(&map.cells, first);
    let (width, height) = (right - left, top - bottom);
    let side = (SIDE_PX / width.max(height)).max(1);
    let mut rgb = Vec::with_capacity((width * height * side * side * 3) as usize);
    for y in (bottom..top).rev() {
        let row = (left..right).flat_map(|x| {
            let cell = Cell::new(x, y);
            let color = match map.cells[cell] {
                Occupancy::Free => color(cell),
                Occupancy::Occupied => WALL,
                Occupancy::Unknown => PAPER,
            };
            std::iter::repeat_n(color, side as usize).flatten()
        });
        let row: Vec<u8> = row.collect();
        (0..side).for_each(|_| rgb.extend_from_slice(&row));
    }
    png(&rgb, (width * side, height * side), FilterType::NoFilter)
}

/// A picture at half its size, in few bytes.
pub(super) fn halved_png(picture: &[u8]) -> Result<Vec<u8>> {
    let picture = image::load_from_memory(picture)?.into_rgb8();
    let (width, height) = ((picture.width() / 2).max(1), (picture.height() / 2).max(1));
    let halved = imageops::resize(&picture, width, height, imageops::FilterType::Triangle);
    png(&halved, (width, height), FilterType::Adaptive)
}

fn png(rgb: &[u8], (width, height): (u32, u32), filter: FilterType) -> Result<Vec<u8>> {
    let mut png = Vec::new();
    let encoder = PngEncoder::new_with_quality(&mut png, CompressionType::Best, filter);
    encoder.write_image(rgb, width, height, ExtendedColorType::Rgb8)?;
    Ok(png)
}

/// Left, bottom, right and top of the known cells from column `first` on, with a margin.
fn crop(cells: &Grid<Occupancy>, first: u32) -> [u32; 4] {
    let known = cells.cells().filter(|&cell| cell.x >= first && cells[cell] != Occupancy::Unknown);
    let (mut left, mut bottom, mut right, mut top) = (cells.width(), cells.height(), 0, 0);
    for Cell { x, y } in known {
        (left, right) = (left.min(x), right.max(x + 1));
        (bottom, top) = (bottom.min(y), top.max(y + 1));
    }
    if left >= right {
        return [0, 0, cells.width(), cells.height()];
    }
    [
        left.saturating_sub(MARGIN_CELLS).max(first),
        bottom.saturating_sub(MARGIN_CELLS),
        (right + MARGIN_CELLS).min(cells.width()),
        (top + MARGIN_CELLS).min(cells.height()),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixels(png: &[u8]) -> image::RgbImage {
        image::load_from_memory(png).unwrap().into_rgb8()
    }

    #[test]
    fn the_top_row_comes_first_and_cells_are_squares() {
        let map = OccupancyGrid::from_ascii(1.0, "#.\n..");
        let labels = map.cells.map(|_| Some(Label(1)));
        let picture = pixels(&labels_png(&map, &labels, 0).unwrap());
        assert_eq!(picture.dimensions(), (900, 900));
        assert_eq!(picture.get_pixel(449, 449).0, WALL);
        assert_eq!(picture.get_pixel(450, 0).0, class_color(Label(1)));
        assert_eq!(picture.get_pixel(0, 450).0, class_color(Label(1)));
    }

    #[test]
    fn a_halved_picture_has_half_the_sides() {
        let map = OccupancyGrid::from_ascii(1.0, "#?");
        let labels = map.cells.map(|_| None);
        let picture = pixels(&halved_png(&labels_png(&map, &labels, 0).unwrap()).unwrap());
        assert_eq!(picture.dimensions(), (450, 225));
        assert_eq!((picture.get_pixel(0, 0).0, picture.get_pixel(449, 0).0), (WALL, PAPER));
    }

    #[test]
    fn errors_are_marked_where_there_is_a_truth() {
        let map = OccupancyGrid::from_ascii(1.0, "....");
        let truth = Grid::from_rows(4, 1, vec![Some(Label(0)), Some(Label(0)), None, Some(Label(2))]);
        let found = Grid::from_rows(4, 1, vec![Some(Label(0)), Some(Label(1)), Some(Label(1)), None]);
        let picture = pixels(&errors_png(&map, &found, &truth, 0).unwrap());
        let cells = [0, 1, 2, 3].map(|x| picture.get_pixel(x * 225, 0).0);
        assert_eq!(cells, [pale(class_color(Label(0))), WRONG, UNLABELED, WRONG]);
    }

    #[test]
    fn columns_before_the_first_are_left_out() {
        let cells = OccupancyGrid::from_ascii(1.0, "..........").cells;
        assert_eq!(crop(&cells, 6), [6, 0, 10, 1]);
    }
}
