//! The map as pixels: free cells in the color of their class, walls dark, unknown cells light.

use std::ops::Range;

use super::overlay::listed_places;
use crate::geom::Point2;
use crate::grid::{Cell, Occupancy, OccupancyGrid};
use crate::labels::{Label, LabelSet};
use crate::topology::{Place, TopologicalMap};

/// Color of occupied cells.
pub(super) const WALL: [u8; 3] = [52, 58, 70];
/// Color of unknown cells and of the page.
pub(super) const PAPER: [u8; 3] = [255, 255, 255];
/// Pictures of maps smaller than this get several pixels per cell, at most [`MAX_PX_PER_CELL`].
const LONGEST_SIDE_PX: f64 = 2000.0;
const MAX_PX_PER_CELL: f64 = 8.0;
/// The smallest maps are drawn larger, for the sake of the text in them.
const SHORTEST_SIDE_PX: f64 = 800.0;
/// Larger maps are drawn with several cells per pixel.
const MAX_SIDE_PX: f64 = 4096.0;
/// Space around the places for the walls around them, in meters.
const WALL_M: f64 = 0.5;
/// Cells of unknown space around what is known.
const MARGIN_CELLS: u32 = 4;
/// A wall weighs as much as this many free cells in a pixel, so that thin walls stay visible.
const WALL_WEIGHT: u32 = 4;

/// The part of a map that is drawn, in cells, and its scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Crop {
    pub(super) left: u32,
    pub(super) bottom: u32,
    pub(super) width: u32,
    pub(super) height: u32,
    /// Whole above 1.
    pub(super) px_per_cell: f64,
}

impl Crop {
    /// The bounding box of what is known, with a margin; the whole map where nothing is.
    pub(super) fn of_known(grid: &OccupancyGrid) -> Self {
        let cells = &grid.cells;
        let is_known = |&value: &Occupancy| value != Occupancy::Unknown;
        let (mut left, mut right) = (cells.width(), 0);
        let (mut bottom, mut top) = (cells.height(), 0);
        for y in 0..cells.height() {
            let row = cells.row(y);
            let Some(first) = row.iter().position(is_known) else { continue };
            let last = row.iter().rposition(is_known).unwrap_or(first);
            left = left.min(first as u32);
            right = right.max(last as u32 + 1);
            bottom = bottom.min(y);
            top = y + 1;
        }
        if left >= right {
            (left, right, bottom, top) = (0, cells.width(), 0, cells.height());
        }
        Self::of_cells(grid, [left, bottom, right, top], MARGIN_CELLS)
    }

    /// The bounding box of the places that a picture shows, with room for the walls around them; of what is known where there is
    /// no place. Small places that nothing leads to do not widen it, unless they would be cut.
    pub(super) fn of_places(grid: &OccupancyGrid, topology: &TopologicalMap) -> Self {
        let margin = (WALL_M / grid.frame.resolution_m()).ceil().clamp(f64::from(MARGIN_CELLS), 100.0) as u32;
        let listed = listed_places(topology);
        let Some(mut bounds) = listed.iter().map(|place| Bounds::of(place, grid)).reduce(Bounds::union)
        else {
            return Self::of_known(grid);
        };
        let all: Vec<Bounds> = topology.places.iter().map(|place| Bounds::of(place, grid)).collect();
        loop {
            let shown = bounds.widened(margin, grid);
            let cut = all.iter().copied().filter(|place| place.meets(shown));
            let whole = cut.fold(bounds, Bounds::union);
            if whole == bounds {
                break;
            }
            bounds = whole;
        }
        Self::of_cells(grid, [bounds.left, bounds.bottom, bounds.right, bounds.top], margin)
    }

    /// The cells from the left, lower to the right, upper ones, with a margin of this many cells.
    fn of_cells(grid: &OccupancyGrid, [left, bottom, right, top]: [u32; 4], margin: u32) -> Self {
        let (left, bottom) = (left.saturating_sub(margin), bottom.saturating_sub(margin));
        let width = (right + margin).min(grid.cells.width()) - left;
        let height = (top + margin).min(grid.cells.height()) - bottom;
        let longest = width.max(height) as f64;
        let px_per_cell = if longest > MAX_SIDE_PX {
            MAX_SIDE_PX / longest
        } else {
            let px_per_cell = (LONGEST_SIDE_PX / longest).min(MAX_PX_PER_CELL);
            px_per_cell.max(SHORTEST_SIDE_PX / longest).round().max(1.0)
        };
        Self { left, bottom, width, height, px_per_cell }
    }

    /// Number of pixels per row.
    pub(super) fn width_px(&self) -> u32 {
        (self.width as f64 * self.px_per_cell).ceil() as u32
    }

    /// Number of rows of pixels.
    pub(super) fn height_px(&self) -> u32 {
        (self.height as f64 * self.px_per_cell).ceil() as u32
    }

    /// The pixel of the upper left corner of a cell.
    fn pixel(&self, cell: Cell) -> (usize, usize) {
        let x = (cell.x - self.left) as f64 * self.px_per_cell;
        let y = (self.bottom + self.height - 1 - cell.y) as f64 * self.px_per_cell;
        (x as usize, y as usize)
    }
}

/// A box of cells: from the left, lower one to the one before the right, upper one.
#[derive(Clone, Copy, PartialEq)]
struct Bounds {
    left: u32,
    bottom: u32,
    right: u32,
    top: u32,
}

impl Bounds {
    /// The cells around a place.
    fn of(place: &Place, grid: &OccupancyGrid) -> Self {
        let corners = place.outline.iter().flat_map(|part| &part.exterior);
        let corners = corners.map(|&corner| grid.frame.cells_from_map(corner));
        let [low, high] = corners
            .fold([(f64::INFINITY, f64::INFINITY), (0.0, 0.0)], |[low, high], Point2 { x, y }| {
                [(low.0.min(x), low.1.min(y)), (high.0.max(x), high.1.max(y))]
            });
        let cell = |v: f64, most: u32| (v.max(0.0) as u32).min(most);
        let (width, height) = (grid.cells.width(), grid.cells.height());
        let left = cell((low.0 + 0.5).floor(), width - 1);
        let bottom = cell((low.1 + 0.5).floor(), height - 1);
        let right = cell((high.0 - 0.5).ceil(), width).max(left + 1);
        let top = cell((high.1 - 0.5).ceil(), height).max(bottom + 1);
        Self { left, bottom, right, top }
    }

    fn union(self, other: Self) -> Self {
        Self {
            left: self.left.min(other.left),
            bottom: self.bottom.min(other.bottom),
            right: self.right.max(other.right),
            top: self.top.max(other.top),
        }
    }

    fn widened(self, margin: u32, grid: &OccupancyGrid) -> Self {
        Self {
            left: self.left.saturating_sub(margin),
            bottom: self.bottom.saturating_sub(margin),
            right: (self.right + margin).min(grid.cells.width()),
            top: (self.top + margin).min(grid.cells.height()),
        }
    }

    fn meets(self, other: Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.bottom < other.top
            && other.bottom < self.top
    }
}

/// The color of a class in the picture: its own, lightened, so that lines and text stand out.
pub(super) fn pastel(color: [u8; 3]) -> [u8; 3] {
    mixed(color, PAPER, 0.42)
}

/// `color` with `share` of `other`.
pub(super) fn mixed(color: [u8; 3], other: [u8; 3], share: f64) -> [u8; 3] {
    std::array::from_fn(|i| (color[i] as f64 * (1.0 - share) + other[i] as f64 * share).round() as u8)
}

/// The part of a map that is painted.
pub(super) struct Painting<'a> {
    grid: &'a OccupancyGrid,
    /// Of the free cells, in row-major order.
    labeling: &'a [Label],
    /// Where the labels of every row of cells begin.
    first_label: Vec<usize>,
    /// The color of every label.
    colors: Vec<[u8; 3]>,
    crop: Crop,
}

/// Rows of a page, as RGBA pixels from the top.
pub(super) struct Canvas<'a> {
    pub(super) rgba: &'a mut [u8],
    pub(super) stride_px: usize,
    /// Which rows of the page these are.
    pub(super) rows: Range<usize>,
    /// Where on the page the map's upper left corner is.
    pub(super) offset: (usize, usize),
}

impl Canvas<'_> {
    /// The pixels of a row of the map and what follows, if that row is here.
    fn row(&mut self, y: usize) -> Option<&mut [u8]> {
        let row = y + self.offset.1;
        let start = 4 * ((row.checked_sub(self.rows.start)?) * self.stride_px + self.offset.0);
        self.rows.contains(&row).then(|| &mut self.rgba[start..])
    }
}

impl<'a> Painting<'a> {
    pub(super) fn new(
        grid: &'a OccupancyGrid,
        labeling: &'a [Label],
        label_set: &LabelSet,
        crop: Crop,
    ) -> Self {
        let mut n_free = 0;
        let first_label = (0..grid.cells.height()).map(|y| {
            let first = n_free;
            n_free += grid.cells.row(y).iter().filter(|&&value| value == Occupancy::Free).count();
            first
        });
        let colors = label_set.classes().iter().map(|class| pastel(class.color)).collect();
        Self { grid, labeling, first_label: first_label.collect(), colors, crop }
    }

    /// Paints what `canvas` shows of the map.
    pub(super) fn paint(&self, mut canvas: Canvas<'_>) {
        if self.crop.px_per_cell < 1.0 {
            self.paint_reduced(&mut canvas);
        } else {
            self.paint_enlarged(&mut canvas);
        }
    }

    /// The known cells of a row in the picture with their colors and weights.
    fn row(&self, y: u32) -> impl Iterator<Item = (Cell, [u8; 3], u32)> {
        let mut labels = self.labeling[self.first_label[y as usize]..].iter();
        let columns = self.crop.left..self.crop.left + self.crop.width;
        let known = (0..).zip(self.grid.cells.row(y)).filter_map(move |(x, occupancy)| match occupancy {
            Occupancy::Free => labels.next().map(|label| (Cell::new(x, y), self.colors[label.index()], 1)),
            Occupancy::Occupied => Some((Cell::new(x, y), WALL, WALL_WEIGHT)),
            Occupancy::Unknown => None,
        });
        known.filter(move |(cell, ..)| columns.contains(&cell.x))
    }

    /// Rows of cells, each with its first row of pixels.
    fn rows(&self) -> impl Iterator<Item = (u32, usize)> {
        let Crop { left, bottom, height, .. } = self.crop;
        (bottom..bottom + height).map(move |y| (y, self.crop.pixel(Cell::new(left, y)).1))
    }

    /// A square of pixels per cell.
    fn paint_enlarged(&self, canvas: &mut Canvas<'_>) {
        let side = self.crop.px_per_cell as usize;
        for (row, first) in self.rows() {
            for y in first..first + side {
                let Some(pixels) = canvas.row(y) else { continue };
                for (cell, [red, green, blue], _) in self.row(row) {
                    let start = 4 * self.crop.pixel(cell).0;
                    for pixel in pixels[start..start + 4 * side].chunks_exact_mut(4) {
                        pixel.copy_from_slice(&[red, green, blue, 255]);
                    }
                }
            }
        }
    }

    /// The weighted mean color of the cells that share a pixel.
    fn paint_reduced(&self, canvas: &mut Canvas<'_>) {
        // A row of pixels at a time: the rows of its cells follow each other.
        let mut sums: Vec<[u32; 4]> = vec![[0; 4]; self.crop.width_px() as usize];
        let rows: Vec<(u32, usize)> = self.rows().collect();
        for rows in rows.chunk_by(|a, b| a.1 == b.1) {
            let Some(pixels) = canvas.row(rows[0].1) else { continue };
            for (cell, color, weight) in rows.iter().flat_map(|&(row, _)| self.row(row)) {
                let sum = &mut sums[self.crop.pixel(cell).0];
                for (channel, value) in sum.iter_mut().zip(color) {
                    *channel += weight * value as u32;
                }
                sum[3] += weight;
            }
            for (pixel, sum) in pixels.chunks_exact_mut(4).zip(&mut sums).filter(|(_, sum)| sum[3] > 0) {
                let [red, green, blue, n] = std::mem::take(sum);
                pixel.copy_from_slice(&[(red / n) as u8, (green / n) as u8, (blue / n) as u8, 255]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::labels::LabelField;

    #[test]
    fn the_crop_is_what_is_known_and_a_margin() {
        let mut drawing = vec!["?".repeat(30); 20];
        drawing[5].replace_range(10..12, "#.");
        let grid = OccupancyGrid::from_ascii(0.05, &drawing.join("\n"));
        let crop = Crop::of_known(&grid);
        assert_eq!((crop.left, crop.bottom, crop.width, crop.height), (6, 10, 10, 9));
        assert_eq!((crop.width_px(), crop.height_px()), (800, 720));
        // The wall's upper left corner: 4 cells from the left, 4 from the top.
        assert_eq!(crop.pixel(Cell::new(10, 14)), (320, 320));
    }

    #[test]
    fn places_are_shown_whole_or_not_at_all() {
        // A room, a slit behind its left wall that reaches out of the margin, and a speck far away.
        let mut rows = vec!["#".repeat(60); 40];
        for row in &mut rows[10..30] {
            row.replace_range(20..40, &".".repeat(20));
        }
        rows[20].replace_range(2..18, &".".repeat(16));
        rows[38].replace_range(58..59, ".");
        let grid = OccupancyGrid::from_ascii(0.1, &rows.join("\n"));
        let space = crate::grid::FreeSpace::of(&grid);
        let labels = vec![Label(1); space.graph.n_nodes()];
        let regions =
            crate::regions::connected(&space.graph, &labels, crate::regions::DiagonalSteps::default());
        let field = LabelField::from_rows(3, [0.0, 1.0, 0.0].repeat(labels.len()));
        let topology = crate::topology::build(&space, &field, &regions, &LabelSet::default());
        assert_eq!(topology.places.len(), 3);
        let crop = Crop::of_places(&grid, &topology);
        assert_eq!((crop.left, crop.bottom, crop.width, crop.height), (0, 5, 45, 30));
    }

    #[test]
    fn the_scale_falls_with_the_size_of_the_map() {
        let half_px_per_cell = |side: u32| {
            let cells = crate::grid::Grid::filled(side, 1, Occupancy::Free);
            let frame = OccupancyGrid::from_ascii(0.05, ".").frame;
            (2.0 * Crop::of_known(&OccupancyGrid { frame, cells }).px_per_cell) as u32
        };
        let found = [20, 100, 160, 250, 400, 1000, 3000, 8192].map(half_px_per_cell);
        assert_eq!(found, [80, 16, 16, 16, 10, 4, 2, 1]);
    }

    #[test]
    fn nothing_known_is_the_whole_map() {
        let crop = Crop::of_known(&OccupancyGrid::from_ascii(0.05, "???\n???\n"));
        assert_eq!((crop.width, crop.height), (3, 2));
    }

    #[test]
    fn large_maps_shrink_and_keep_thin_walls() {
        let mut row = vec![Occupancy::Free; 8192];
        row[4] = Occupancy::Occupied;
        let cells = crate::grid::Grid::from_rows(8192, 1, row);
        let grid = OccupancyGrid { frame: OccupancyGrid::from_ascii(0.05, ".").frame, cells };
        let crop = Crop::of_known(&grid);
        let mut rgba = vec![0; 4096 * 4];
        let canvas = Canvas { rgba: &mut rgba, stride_px: 4096, rows: 0..1, offset: (0, 0) };
        Painting::new(&grid, &[Label(0); 8191], &LabelSet::default(), crop).paint(canvas);
        let free = pastel(LabelSet::default().classes()[0].color);
        assert_eq!(rgba[..3], free);
        assert_eq!(rgba[8] as u32, (4 * WALL[0] as u32 + free[0] as u32) / 5);
    }
}
