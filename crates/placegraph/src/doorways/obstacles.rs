//! The obstacles of a map: groups of cells that are not free, and how large they are.

use crate::geom::Point2;
use crate::grid::{Cell, CellGraph, Grid};

/// The longer side of the bounding box of the obstacle that each cell belongs to, in cells: 0 where the cell is free,
/// [`Obstacles::ENDLESS`] for obstacles that reach the border of the map.
pub(super) struct Obstacles {
    length: Grid<u32>,
}

impl Obstacles {
    /// The length of what goes on beyond the map.
    pub(super) const ENDLESS: u32 = u32::MAX;

    /// Finds the 8-connected obstacles. Cost: linear in the cells of the map.
    pub(super) fn of(graph: &CellGraph) -> Self {
        let (width, height) = (graph.width(), graph.height());
        let mut length = Grid::filled(width, height, 0);
        // Cells of no obstacle yet.
        let mut is_open = Grid::filled(width, height, true);
        for cell in graph.cells_in_rows(0..height) {
            is_open[cell] = false;
        }
        for start in length.cells() {
            if !std::mem::take(&mut is_open[start]) {
                continue;
            }
            let mut members = vec![start];
            let (mut low, mut high) = (start, start);
            let mut next = 0;
            while let Some(&cell) = members.get(next) {
                next += 1;
                low = Cell::new(low.x.min(cell.x), low.y.min(cell.y));
                high = Cell::new(high.x.max(cell.x), high.y.max(cell.y));
                for around in around(cell, width, height) {
                    if std::mem::take(&mut is_open[around]) {
                        members.push(around);
                    }
                }
            }
            let is_cut = low.x == 0 || low.y == 0 || high.x + 1 == width || high.y + 1 == height;
            let longer = (high.x - low.x).max(high.y - low.y) + 1;
            for cell in members {
                length[cell] = if is_cut { Self::ENDLESS } else { longer };
            }
        }
        Self { length }
    }

    /// The map's free cells together with those of all obstacles of at most `length` cells.
    pub(super) fn cleared(&self, length: u32) -> CellGraph {
        let (width, height) = (self.length.width(), self.length.height());
        CellGraph::from_free(width, height, |index| self.length.values()[index] <= length)
    }

    /// The length of the longest obstacle in the 3 x 3 cells around `point`.
    pub(super) fn length_at(&self, point: Point2) -> u32 {
        let (width, height) = (self.length.width(), self.length.height());
        let is_inside = (0.0..width as f64).contains(&point.x) && (0.0..height as f64).contains(&point.y);
        if !is_inside {
            return Self::ENDLESS;
        }
        let cell = Cell::new(point.x as u32, point.y as u32);
        let around = around(cell, width, height).map(|cell| self.length[cell]);
        around.fold(self.length[cell], u32::max)
    }
}

/// The up to 8 cells around `cell`.
fn around(cell: Cell, width: u32, height: u32) -> impl Iterator<Item = Cell> {
    let range = |middle: u32, side: u32| middle.saturating_sub(1)..=(middle + 1).min(side - 1);
    range(cell.y, height)
        .flat_map(move |y| range(cell.x, width).map(move |x| Cell::new(x, y)))
        .filter(move |&next| next != cell)
}
