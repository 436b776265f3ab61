//! The picture of one simulated scan: the polygon of its end points over the map around it.

use std::fmt::Write;

use resvg::tiny_skia::Transform;

use super::overview::{blank, encode, parse};
use crate::geom::Point2;
use crate::grid::{Cell, Occupancy, OccupancyGrid};
use crate::scan::{N_BEAMS, RangeScan};

/// Longer side of the picture, in pixels.
const LONGEST_SIDE_PX: f64 = 1000.0;
/// Cells around what the scan sees.
const MARGIN_CELLS: f64 = 6.0;

/// A PNG of the scan from the center of `cell`: the map, the polygon Pol(z), a line per tenth beam, the robot.
///
/// Cost: linear in the cells of the part that the scan sees.
pub fn scan_png(grid: &OccupancyGrid, cell: Cell, scan: &RangeScan) -> Vec<u8> {
    let robot = cell.center();
    let ends: Vec<Point2> = (0..N_BEAMS)
        .map(|beam| {
            let end = scan.end_point(beam);
            let cells = 1.0 / grid.frame.resolution_m();
            Point2::new(robot.x + end.x * cells, robot.y + end.y * cells)
        })
        .collect();
    let window = Window::around(&ends, grid);
    let mut svg = window.walls(grid);
    let points: Vec<String> = ends.iter().map(|&end| window.pair(end)).collect();
    let center = window.pixel(robot);
    // Writing to a string cannot fail.
    let _ = write!(
        svg,
        r##"<polygon points="{}" fill="#569cd6" fill-opacity="0.35" stroke="#2f6fa8" stroke-width="1.5"/>"##,
        points.join(" ")
    );
    for end in ends.iter().step_by(10) {
        let end = window.pixel(*end);
        let _ = write!(
            svg,
            r##"<line x1="{:.1}" y1="{:.1}" x2="{:.1}" y2="{:.1}" stroke="#2f6fa8" stroke-opacity="0.5"/>"##,
            center.x, center.y, end.x, end.y
        );
    }
    let _ = write!(svg, r##"<circle cx="{:.1}" cy="{:.1}" r="6" fill="#ce4454"/>"##, center.x, center.y);
    let (width, height) = window.size_px();
    let svg =
        format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}">{svg}</svg>"#);
    let mut pixmap = blank(width, height);
    resvg::render(&parse(&svg), Transform::identity(), &mut pixmap.as_mut());
    encode(width, height, std::iter::once(pixmap))
}

/// The part of the map in the picture, in cells.
#[derive(Clone, Copy, Debug)]
struct Window {
    left: f64,
    right: f64,
    bottom: f64,
    top: f64,
    px_per_cell: f64,
}

impl Window {
    fn around(ends: &[Point2], grid: &OccupancyGrid) -> Self {
        let fold = |value: fn(&Point2) -> f64, pick: fn(f64, f64) -> f64, start: f64| {
            ends.iter().map(value).fold(start, pick)
        };
        let left = (fold(|end| end.x, f64::min, f64::INFINITY) - MARGIN_CELLS).floor().max(0.0);
        let bottom = (fold(|end| end.y, f64::min, f64::INFINITY) - MARGIN_CELLS).floor().max(0.0);
        let right =
            (fold(|end| end.x, f64::max, 0.0) + MARGIN_CELLS).ceil().min(f64::from(grid.cells.width()));
        let top =
            (fold(|end| end.y, f64::max, 0.0) + MARGIN_CELLS).ceil().min(f64::from(grid.cells.height()));
        let px_per_cell = LONGEST_SIDE_PX / (right - left).max(top - bottom);
        Self { left, right, bottom, top, px_per_cell }
    }

    fn size_px(&self) -> (u32, u32) {
        let side = |cells: f64| (cells * self.px_per_cell).ceil().max(1.0) as u32;
        (side(self.right - self.left), side(self.top - self.bottom))
    }

    /// Takes a point in cells to pixels, y down.
    fn pixel(&self, point: Point2) -> Point2 {
        Point2::new((point.x - self.left) * self.px_per_cell, (self.top - point.y) * self.px_per_cell)
    }

    fn pair(&self, point: Point2) -> String {
        let Point2 { x, y } = self.pixel(point);
        format!("{x:.1},{y:.1}")
    }

    /// Occupied and unknown cells, a rectangle for every run of equal cells in a row.
    fn walls(&self, grid: &OccupancyGrid) -> String {
        let mut svg = String::new();
        for y in self.bottom as u32..self.top as u32 {
            let row = &grid.cells.row(y)[self.left as usize..self.right as usize];
            let mut x = self.left;
            for run in row.chunk_by(|a, b| a == b) {
                let color = match run[0] {
                    Occupancy::Free => None,
                    Occupancy::Occupied => Some("#343a46"),
                    Occupancy::Unknown => Some("#d8dade"),
                };
                if let Some(color) = color {
                    let corner = self.pixel(Point2::new(x, f64::from(y) + 1.0));
                    let (width, height) = (run.len() as f64 * self.px_per_cell, self.px_per_cell);
                    // Writing to a string cannot fail.
                    let _ = write!(
                        svg,
                        r#"<rect x="{:.2}" y="{:.2}" width="{width:.2}" height="{height:.2}" fill="{color}" shape-rendering="crispEdges"/>"#,
                        corner.x, corner.y
                    );
                }
                x += run.len() as f64;
            }
        }
        svg
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scan::{self, ScanConfig};

    #[test]
    fn the_picture_shows_what_the_scan_sees() {
        let drawing = ["#".repeat(40), format!("#{}#", ".".repeat(38)), "#".repeat(40)].join("\n");
        let grid = OccupancyGrid::from_ascii(0.1, &drawing);
        let cell = Cell::new(5, 1);
        let png = scan_png(&grid, cell, &scan::cast(&grid, cell, &ScanConfig::default()));
        let picture = image::load_from_memory(&png).unwrap();
        assert_eq!((picture.width(), picture.height()), (1000, 75));
    }

    #[test]
    fn walls_of_many_rows_have_no_seams() {
        // 21 x 67 cells in 1000 pixels: a row is 14.93 pixels high.
        let row = format!("#{}#", "#".repeat(8) + &".".repeat(11));
        let wall = "#".repeat(21);
        let drawing: Vec<&str> = (0..67).map(|y| if y % 66 == 0 { &wall } else { &row }.as_str()).collect();
        let grid = OccupancyGrid::from_ascii(0.1, &drawing.join("\n"));
        let cell = Cell::new(15, 30);
        let png = scan_png(&grid, cell, &scan::cast(&grid, cell, &ScanConfig::default()));
        let picture = image::load_from_memory(&png).unwrap().to_rgb8();
        // In the middle of the thick wall every pixel has its color.
        let column = picture.width() * 4 / 21;
        let colors: std::collections::BTreeSet<[u8; 3]> =
            (20..picture.height() - 20).map(|y| picture.get_pixel(column, y).0).collect();
        assert_eq!(colors.into_iter().collect::<Vec<_>>(), [[0x34, 0x3a, 0x46]]);
    }
}
