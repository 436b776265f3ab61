//! Polygons and masks on the cells of a map.

use crate::geom::Point2;
use crate::grid::{Cell, Grid};
use crate::labels::LabelCell;
use crate::topology::row_crossings;

/// The cells of a map while shapes are painted.
pub(super) struct Canvas {
    cells: Grid<LabelCell>,
    /// Where a row of the polygon at hand changes between outside and inside; a column more than the map has.
    turns: Vec<bool>,
}

impl Canvas {
    pub(super) fn new((width, height): (u32, u32)) -> Self {
        let n_turns = (width as usize + 1) * height as usize;
        Self { cells: Grid::filled(width, height, LabelCell::None), turns: vec![false; n_turns] }
    }

    pub(super) fn into_cells(self) -> Grid<LabelCell> {
        self.cells
    }

    /// Width and height in cells.
    pub(super) fn size(&self) -> (u32, u32) {
        (self.cells.width(), self.cells.height())
    }

    /// Paints the cells whose centers lie inside of an odd number of `rings`, whose points are in cells from the lower left corner
    /// of the map. Cost: the rows that each side crosses, and the cells of those rows.
    pub(super) fn fill(&mut self, rings: &[Vec<Point2>], cell: LabelCell) {
        let (width, height) = self.size();
        let stride = width as usize + 1;
        let (mut first_row, mut end_row) = (height, 0);
        for ring in rings.iter().filter(|ring| ring.iter().all(|p| p.x.is_finite() && p.y.is_finite())) {
            for (index, &from) in ring.iter().enumerate() {
                for (row, x) in row_crossings(from, ring[(index + 1) % ring.len()], height) {
                    // The first cell whose center does not lie left of x.
                    let column = (x - 0.5).ceil().clamp(0.0, width as f64) as usize;
                    self.turns[row as usize * stride + column] ^= true;
                    (first_row, end_row) = (first_row.min(row), end_row.max(row + 1));
                }
            }
        }
        for row in first_row..end_row {
            let turns = &mut self.turns[row as usize * stride..][..stride];
            let mut is_inside = false;
            for (column, turn) in turns.iter_mut().enumerate() {
                is_inside ^= std::mem::take(turn);
                if is_inside && column < width as usize {
                    self.cells[Cell::new(column as u32, row)] = cell;
                }
            }
        }
    }

    /// Paints the cell in column `x` of the `row`-th row from the top, if the map has it.
    pub(super) fn set_from_top(&mut self, x: i64, row: i64, cell: LabelCell) {
        let (width, height) = self.size();
        if (0..i64::from(width)).contains(&x) && (0..i64::from(height)).contains(&row) {
            self.cells[Cell::new(x as u32, height - 1 - row as u32)] = cell;
        }
    }

    /// A point of an image, from its upper left corner, in cells from the lower left corner of the map.
    pub(super) fn at_pixel(&self, [x, y]: [f64; 2]) -> Point2 {
        Point2::new(x, f64::from(self.cells.height()) - y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn painted(size: (u32, u32), rings: &[&[(f64, f64)]]) -> Vec<String> {
        let mut canvas = Canvas::new(size);
        let rings: Vec<Vec<Point2>> =
            rings.iter().map(|ring| ring.iter().map(|&(x, y)| Point2::new(x, y)).collect()).collect();
        canvas.fill(&rings, LabelCell::Ignore);
        let cells = canvas.into_cells();
        let mark = |cell: &LabelCell| if *cell == LabelCell::None { '.' } else { 'x' };
        (0..size.1).rev().map(|y| cells.row(y).iter().map(mark).collect()).collect()
    }

    #[test]
    fn centers_decide() {
        // Its lower border lies 0.4 below the centers of row 1, its upper one 0.1 above those of row 2.
        assert_eq!(
            painted((5, 4), &[&[(0.6, 1.1), (3.6, 1.1), (3.6, 2.6), (0.6, 2.6)]]),
            [".....", ".xxx.", ".xxx.", "....."]
        );
        // Through the centers: those on the left and the lower border belong to it, those on the others do not.
        assert_eq!(
            painted((4, 4), &[&[(0.5, 0.5), (2.5, 0.5), (2.5, 2.5), (0.5, 2.5)]]),
            ["....", "....", "xx..", "xx.."]
        );
    }

    #[test]
    fn holes_stay_empty_and_the_outside_is_cut_off() {
        let outer: &[(f64, f64)] = &[(-9.0, -9.0), (4.0, -9.0), (4.0, 99.0), (-9.0, 99.0)];
        let hole: &[(f64, f64)] = &[(1.0, 1.0), (3.0, 1.0), (3.0, 2.0), (1.0, 2.0)];
        assert_eq!(painted((5, 3), &[outer, hole]), ["xxxx.", "x..x.", "xxxx."]);
        assert_eq!(painted((2, 1), &[&[(f64::NAN, 0.0), (2.0, 0.0), (2.0, 2.0)]]), [".."]);
    }

    #[test]
    fn polygons_that_share_a_slanted_border_share_no_cell() {
        let left: &[(f64, f64)] = &[(0.0, 0.0), (2.3, 0.0), (4.9, 7.0), (0.0, 7.0)];
        let right: &[(f64, f64)] = &[(2.3, 0.0), (8.0, 0.0), (8.0, 7.0), (4.9, 7.0)];
        let [left, right] = [left, right].map(|ring| painted((8, 7), &[ring]).concat());
        assert!(left.chars().zip(right.chars()).all(|pair| pair == ('x', '.') || pair == ('.', 'x')));
    }
}
