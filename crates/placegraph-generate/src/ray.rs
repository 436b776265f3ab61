//! The cells along a ray, one after the other (Amanatides and Woo 1987).

use placegraph::geom::{Point2, Vec2};

/// Calls `visit(x, y, distance at which the ray enters the cell)` for the cells from `from` along the unit
/// vector `toward` up to `length`, all in cells, until it returns false or the ray leaves the
/// `width` by `height` grid. Cost: one call per cell.
pub(crate) fn walk(
    from: Point2,
    toward: Vec2,
    length: f64,
    (width, height): (u32, u32),
    mut visit: impl FnMut(u32, u32, f64) -> bool,
) {
    let (mut x, mut y) = (from.x.floor(), from.y.floor());
    let axis = |at: f64, cell: f64, slope: f64| {
        let step = if slope < 0.0 { -1.0 } else { 1.0 };
        let edge = if slope < 0.0 { cell } else { cell + 1.0 };
        let per_cell = if slope == 0.0 { f64::INFINITY } else { 1.0 / slope.abs() };
        let first = if slope == 0.0 { f64::INFINITY } else { (edge - at) / slope };
        (step, per_cell, first)
    };
    let (step_x, per_x, mut next_x) = axis(from.x, x, toward.x);
    let (step_y, per_y, mut next_y) = axis(from.y, y, toward.y);
    let mut entered = 0.0;
    while entered <= length
        && x >= 0.0
        && y >= 0.0
        && x < f64::from(width)
        && y < f64::from(height)
        && visit(x as u32, y as u32, entered)
    {
        if next_x < next_y {
            entered = next_x;
            next_x += per_x;
            x += step_x;
        } else {
            entered = next_y;
            next_y += per_y;
            y += step_y;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_visits_every_cell_it_crosses() {
        let mut cells = Vec::new();
        let toward = Vec2::new(0.8, 0.6);
        walk(Point2::new(0.5, 0.5), toward, 2.0, (9, 9), |x, y, _| {
            cells.push((x, y));
            true
        });
        // It leaves (0, 0) at x = 1 (t = 0.625), (1, 0) at y = 1 (t = 0.833), (1, 1) at x = 2 (t = 1.875).
        assert_eq!(cells, [(0, 0), (1, 0), (1, 1), (2, 1)]);
    }
}
