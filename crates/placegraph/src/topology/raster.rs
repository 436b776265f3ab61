//! The place of every cell, recovered from the outlines: for each row, the spans of cells whose centers lie inside
//! (even–odd rule).
//!
//! Outlines run along the sides of cells, so on the grid that they were made from the result is exact; on any
//! other grid it is the resampled map. Cost: `O(e log e)` for e crossings of outlines with rows; memory grows
//! with the outlines, not with the map.

use super::{PlaceId, TopologicalMap, all_touched};
use crate::geom::Point2;
use crate::grid::{Cell, GridShape};

/// Neighboring cells of a row that belong to one place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlaceSpan {
    /// Column of the leftmost cell.
    pub start: u32,
    /// Column after the rightmost cell.
    pub end: u32,
    /// The place.
    pub place: PlaceId,
}

/// The places as rows of cells.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaceRaster {
    shape: GridShape,
    /// Row of every span.
    rows: Vec<u32>,
    /// By row, then from the left.
    spans: Vec<PlaceSpan>,
}

/// Where an outline crosses the center line of a row.
struct Crossing {
    row: u32,
    place: PlaceId,
    x: f64,
}

impl PlaceRaster {
    /// The places of `map` on the grid `shape`.
    pub fn new(map: &TopologicalMap, shape: GridShape) -> Self {
        let mut crossings = crossings(map, &shape);
        crossings.sort_by(|a, b| (a.row, a.place).cmp(&(b.row, b.place)).then(a.x.total_cmp(&b.x)));
        // Row and span.
        let mut found: Vec<(u32, PlaceSpan)> = Vec::new();
        for pair in
            crossings.chunk_by(|a, b| (a.row, a.place) == (b.row, b.place)).flat_map(|c| c.chunks_exact(2))
        {
            // The first cell whose center lies right of x.
            let column = |x: f64| (x - 0.5).ceil().clamp(0.0, shape.width as f64) as u32;
            let span = PlaceSpan { start: column(pair[0].x), end: column(pair[1].x), place: pair[0].place };
            if span.start < span.end {
                found.push((pair[0].row, span));
            }
        }
        // Stable: spans of a row that start alike stay in the order of their places.
        found.sort_by_key(|&(row, span)| (row, span.start));
        let (rows, spans) = found.into_iter().unzip();
        Self { shape, rows, spans }
    }

    /// The grid.
    pub fn shape(&self) -> GridShape {
        self.shape
    }

    /// The spans of row `y`, from the left. Cost: logarithmic in all spans.
    pub fn row(&self, y: u32) -> &[PlaceSpan] {
        let start = self.rows.partition_point(|&row| row < y);
        let n = self.rows[start..].partition_point(|&row| row == y);
        &self.spans[start..start + n]
    }

    /// The place of `cell`. Cost: logarithmic in the spans.
    pub fn place_in(&self, cell: Cell) -> Option<PlaceId> {
        let row = self.row(cell.y);
        let after = row.partition_point(|span| span.start <= cell.x);
        let span = row[..after].last()?;
        (cell.x < span.end).then_some(span.place)
    }

    /// The place that contains `point` of the map frame.
    pub fn place_at(&self, point: Point2) -> Option<PlaceId> {
        self.place_in(self.shape.cell_at(point)?)
    }

    /// Whether all cells that the segment from `a` to `b` of the map frame touches belong to places.
    pub fn is_free_between(&self, a: Point2, b: Point2) -> bool {
        let [a, b] = [a, b].map(|point| self.shape.frame.cells_from_map(point));
        all_touched(a, b, |x, y| {
            let cell = u32::try_from(x).ok().zip(u32::try_from(y).ok());
            cell.is_some_and(|(x, y)| self.place_in(Cell::new(x, y)).is_some())
        })
    }
}

fn crossings(map: &TopologicalMap, shape: &GridShape) -> Vec<Crossing> {
    let mut crossings = Vec::new();
    for place in &map.places {
        for ring in place.rings() {
            let corners: Vec<Point2> =
                ring.iter().map(|&corner| shape.frame.cells_from_map(corner)).collect();
            for (index, &from) in corners.iter().enumerate() {
                let to = corners[(index + 1) % corners.len()];
                crossings.extend(row_crossings(from, to, shape.height).map(|(row, x)| Crossing {
                    row,
                    place: place.id,
                    x,
                }));
            }
        }
    }
    crossings
}

/// The rows below `height` whose center line the segment crosses, and where: those with a center in [low, high).
pub(crate) fn row_crossings(from: Point2, to: Point2, height: u32) -> impl Iterator<Item = (u32, f64)> {
    let (low, high) = if from.y <= to.y { (from, to) } else { (to, from) };
    let row = move |y: f64| (y - 0.5).ceil().clamp(0.0, height as f64) as u32;
    (row(low.y)..row(high.y)).map(move |row| {
        let t = (row as f64 + 0.5 - low.y) / (high.y - low.y);
        (row, low.x + t * (high.x - low.x))
    })
}
