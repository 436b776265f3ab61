//! Straight lines: the cells that they touch, and whether they cross.

use std::ops::RangeInclusive;

use crate::geom::{Point2, Vec2};

/// A line that comes nearer to a cell than this touches it, in cells. Covers what exporters round away and the
/// way to the map frame and back.
const TOUCH: f64 = 1e-2;

/// Whether `accept` holds for every cell that the segment from `a` to `b` touches, all in cells from the lower
/// left corner of the grid. A line through a corner touches all four cells there, a line along a side the
/// cells on both of its sides.
///
/// Cost: linear in the cells touched; stops at the first that is not accepted.
pub(crate) fn all_touched(a: Point2, b: Point2, mut accept: impl FnMut(i64, i64) -> bool) -> bool {
    let line = Line::new(a, b);
    line.columns().all(|column| line.rows(column).all(|row| accept(column, row)))
}

/// Calls `visit` for every cell of a grid of `width` by `height` cells that the segment from `a` to `b` touches,
/// however long it is.
pub(crate) fn for_each_touched_in(
    (width, height): (u32, u32),
    a: Point2,
    b: Point2,
    mut visit: impl FnMut(u32, u32),
) {
    let within = |range: RangeInclusive<i64>, side: u32| {
        let (first, last) = (*range.start().max(&0), *range.end().min(&(i64::from(side) - 1)));
        (first..=last).map(|v| v as u32)
    };
    let line = Line::new(a, b);
    for column in within(line.columns(), width) {
        for row in within(line.rows(column.into()), height) {
            visit(column, row);
        }
    }
}

/// A segment between two finite points.
struct Line {
    left: Point2,
    right: Point2,
    slope: f64,
}

fn cell(v: f64) -> i64 {
    v.floor() as i64
}

impl Line {
    fn new(a: Point2, b: Point2) -> Self {
        let (left, right) = if a.x <= b.x { (a, b) } else { (b, a) };
        Self { left, right, slope: (right.y - left.y) / (right.x - left.x) }
    }

    fn columns(&self) -> RangeInclusive<i64> {
        cell(self.left.x - TOUCH)..=cell(self.right.x + TOUCH)
    }

    /// The rows that the line touches in a column.
    fn rows(&self, column: i64) -> RangeInclusive<i64> {
        let ends = [column as f64 - TOUCH, column as f64 + 1.0 + TOUCH].map(|x| self.y_at(x));
        let (from, to) = match ends {
            [Some(from), Some(to)] => (from.min(to), from.max(to)),
            _ => (self.left.y.min(self.right.y), self.left.y.max(self.right.y)),
        };
        cell(from - TOUCH)..=cell(to + TOUCH)
    }

    fn y_at(&self, x: f64) -> Option<f64> {
        let Self { left, right, slope } = self;
        // A vertical line has no slope: its only column holds both ends.
        (right.x - left.x >= TOUCH).then(|| left.y + (x.max(left.x).min(right.x) - left.x) * slope)
    }
}

/// Whether the segments `a b` and `c d` cross. A `c` or `d` exactly on the line through `a b` counts as on its
/// left, so that a chain of cells crosses it once.
pub(crate) fn segments_cross(a: Point2, b: Point2, c: Point2, d: Point2) -> bool {
    let left = |from: Point2, along: Vec2, point: Point2| along.cross(point - from) >= 0.0;
    left(a, b - a, c) != left(a, b - a, d) && left(c, d - c, a) != left(c, d - c, b)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn touched(a: (f64, f64), b: (f64, f64)) -> Vec<(i64, i64)> {
        let mut cells = Vec::new();
        all_touched(Point2::new(a.0, a.1), Point2::new(b.0, b.1), |x, y| {
            cells.push((x, y));
            true
        });
        cells
    }

    #[test]
    fn straight_lines_between_centers() {
        assert_eq!(touched((0.5, 0.5), (2.5, 0.5)), [(0, 0), (1, 0), (2, 0)]);
        assert_eq!(touched((0.5, 2.5), (0.5, 0.5)), [(0, 0), (0, 1), (0, 2)]);
        assert_eq!(touched((0.5, 0.5), (0.5, 0.5)), [(0, 0)]);
    }

    #[test]
    fn a_line_through_a_corner_touches_all_four_cells() {
        assert_eq!(touched((0.5, 0.5), (1.5, 1.5)), [(0, 0), (0, 1), (1, 0), (1, 1)]);
        assert_eq!(touched((1.5, 0.5), (0.5, 1.5)), [(0, 0), (0, 1), (1, 0), (1, 1)]);
    }

    #[test]
    fn a_line_far_beyond_the_grid_visits_the_cells_of_the_grid() {
        let visited = |a: Point2, b: Point2| {
            let mut cells = Vec::new();
            for_each_touched_in((3, 2), a, b, |x, y| cells.push((x, y)));
            cells
        };
        let far = 1e300;
        assert_eq!(visited(Point2::new(-far, 0.5), Point2::new(far, 0.5)), [(0, 0), (1, 0), (2, 0)]);
        assert_eq!(visited(Point2::new(1.5, far), Point2::new(1.5, -far)), [(1, 0), (1, 1)]);
        assert_eq!(visited(Point2::new(4.0, 4.0), Point2::new(far, far)), []);
    }

    #[test]
    fn a_line_along_a_side_touches_both_sides() {
        assert_eq!(touched((0.5, 1.0), (1.5, 1.0)), [(0, 0), (0, 1), (1, 0), (1, 1)]);
    }

    #[test]
    fn segments_that_cross_and_that_do_not() {
        let at = Point2::new;
        assert!(segments_cross(at(0.0, 0.0), at(2.0, 2.0), at(0.0, 2.0), at(2.0, 0.0)));
        assert!(!segments_cross(at(0.0, 0.0), at(0.9, 0.9), at(0.0, 2.0), at(2.0, 0.0)));
        // A chain through a point of the line crosses it once.
        let [before, on, after] = [at(0.0, 1.0), at(1.0, 1.0), at(2.0, 1.0)];
        let crossings =
            [(before, on), (on, after)].map(|(c, d)| segments_cross(at(1.0, 0.0), at(1.0, 3.0), c, d));
        assert_eq!(crossings.iter().filter(|crosses| **crosses).count(), 1);
    }

    #[test]
    fn a_flat_diagonal() {
        // From (0.5, 0.5) to (3.5, 1.5): crosses y = 1 at x = 2.
        assert_eq!(touched((0.5, 0.5), (3.5, 1.5)), [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (3, 1)]);
    }
}
