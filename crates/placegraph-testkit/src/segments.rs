//! The cells that a straight line touches, by clipping it against every cell of its bounding box.

use placegraph::geom::Point2;

/// The cells whose closed square, made smaller by `shrink` on all sides, meets the segment from `a` to `b`; in
/// cells from the lower left corner of the grid, row-major.
pub fn cells_on_segment(a: Point2, b: Point2, shrink: f64) -> Vec<(i64, i64)> {
    let bounds = |u: f64, v: f64| (u.min(v).floor() as i64 - 1)..=(u.max(v).floor() as i64 + 1);
    let mut cells = Vec::new();
    for y in bounds(a.y, b.y) {
        for x in bounds(a.x, b.x) {
            let low = (x as f64 + shrink, y as f64 + shrink);
            let high = (x as f64 + 1.0 - shrink, y as f64 + 1.0 - shrink);
            if meets_box(a, b, low, high) {
                cells.push((x, y));
            }
        }
    }
    cells
}

/// Liang and Barsky's clipping of a segment against a box.
fn meets_box(a: Point2, b: Point2, low: (f64, f64), high: (f64, f64)) -> bool {
    let (mut enter, mut leave) = (0.0f64, 1.0f64);
    for (start, step, low, high) in [(a.x, b.x - a.x, low.0, high.0), (a.y, b.y - a.y, low.1, high.1)] {
        if step == 0.0 {
            if start < low || start > high {
                return false;
            }
            continue;
        }
        let (first, second) = ((low - start) / step, (high - start) / step);
        enter = enter.max(first.min(second));
        leave = leave.min(first.max(second));
    }
    enter <= leave
}
