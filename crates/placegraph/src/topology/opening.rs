//! The clear width of a doorway: the shortest line across it, from wall to wall.
//!
//! The way through leads from the border with one neighbor to the border with the other. From the doorway's cells on
//! it and next to it, lines are drawn in every direction within 60 degrees of straight across, and followed
//! exactly through the grid to the first cell on either side that is not free. The shortest is the opening.
//! It does not depend on how much of the opening carries the doorway label, on the direction of the walls or
//! on the corners of the neighboring rooms, which no such line can cut off.
//!
//! Cost per doorway: about depth · width · 350 steps in cells.

use crate::geom::{Point2, Vec2};
use crate::grid::{Cell, CellGraph};

/// Largest angle between the opening and straight across, in degrees.
const MAX_SLANT_DEG: u32 = 60;
/// Angle between two lines that are tried, in degrees: a line one degree off is longer by 1.5e-4.
const SLANT_STEP_DEG: usize = 2;

/// The narrowest line across a doorway, in cells from the lower left corner of the grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Opening {
    pub(super) width_cells: f64,
    /// Where it meets the walls.
    pub(super) jambs: [Point2; 2],
}

/// The narrowest line across the path from `from` to `to` through cells of the doorway, the nodes for which `is_own` holds. Where
/// that way leads through none of them, and where both ends are one point, lines start at the center `anchor` of one of its cells.
pub(super) fn opening(
    graph: &CellGraph,
    is_own: impl Fn(usize) -> bool,
    from: Point2,
    to: Point2,
    anchor: Point2,
) -> Opening {
    let way = to - from;
    let length = way.length();
    let (across, max_slant_deg) = if length > 1e-9 {
        (Vec2::new(-way.y, way.x) * (1.0 / length), MAX_SLANT_DEG)
    } else {
        (Vec2::new(1.0, 0.0), 90)
    };
    let mut starts = cells_along(graph, is_own, from, to);
    if starts.is_empty() {
        starts.push(anchor);
    }

    let mut best = Opening { width_cells: f64::INFINITY, jambs: [anchor; 2] };
    for slant_deg in (0..=max_slant_deg).step_by(SLANT_STEP_DEG) {
        for side in [1.0, -1.0] {
            let direction = across.rotated(side * (slant_deg as f64).to_radians());
            for &start in &starts {
                let left = clear_distance(graph, start, direction, best.width_cells);
                let right = clear_distance(graph, start, -direction, best.width_cells - left);
                // Equal within rounding: keep the line nearer to straight across, then to the middle.
                if left + right < best.width_cells - 1e-9 {
                    let jambs = [start + direction * left, start - direction * right];
                    best = Opening { width_cells: left + right, jambs };
                }
            }
        }
    }
    best
}

/// Centers of the doorway's cells that the way from `from` to `to` passes or touches, from the middle outwards.
fn cells_along(graph: &CellGraph, is_own: impl Fn(usize) -> bool, from: Point2, to: Point2) -> Vec<Point2> {
    let middle = from.midpoint(to);
    let n = (2.0 * from.distance(to)).ceil() as i32;
    let mut centers = Vec::new();
    for step in 0..=n {
        let on_way = from + (to - from) * (step as f64 / n.max(1) as f64);
        for (dx, dy) in [(-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5)] {
            let (x, y) = ((on_way.x + dx).floor(), (on_way.y + dy).floor());
            if node_at(graph, x as i64, y as i64).is_some_and(&is_own) {
                centers.push(Point2::new(x + 0.5, y + 0.5));
            }
        }
    }
    let key = |center: &Point2| (center.distance(middle), center.y, center.x);
    centers.sort_by(|a, b| {
        let (a, b) = (key(a), key(b));
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.total_cmp(&b.2))
    });
    centers.dedup();
    centers
}

/// The node in column `x` and row `y`, if that is a free cell.
fn node_at(graph: &CellGraph, x: i64, y: i64) -> Option<usize> {
    let inside = (0..graph.width() as i64).contains(&x) && (0..graph.height() as i64).contains(&y);
    inside.then(|| graph.node_at(Cell::new(x as u32, y as u32))).flatten()
}

/// Distance from the center `start` of a cell along the unit vector `direction` to the first cell that is not free, in cells; any
/// distance of at least `limit` if there is none before that [Amanatides and Woo 1987].
pub(super) fn clear_distance(graph: &CellGraph, start: Point2, direction: Vec2, limit: f64) -> f64 {
    let axis = |position: f64, speed: f64| {
        // The cell, the distance to its side and between sides, and the step.
        (position.floor() as i64, 0.5 / speed.abs(), 1.0 / speed.abs(), speed.signum() as i64)
    };
    let (mut x, mut next_x, delta_x, step_x) = axis(start.x, direction.x);
    let (mut y, mut next_y, delta_y, step_y) = axis(start.y, direction.y);
    loop {
        let distance = next_x.min(next_y);
        if next_x < next_y {
            x += step_x;
            next_x += delta_x;
        } else {
            y += step_y;
            next_y += delta_y;
        }
        if distance >= limit || node_at(graph, x, y).is_none() {
            return distance;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::OccupancyGrid;

    #[test]
    fn a_gap_of_three_cells() {
        let map = OccupancyGrid::from_ascii(
            1.0,
            "
            .........
            .........
            .........
            .........
            ???...???
            .........
            .........
            .........
            .........
            ",
        );
        let graph = CellGraph::new(&map.cells);
        // A slanted way still finds the straight line, in the row of the wall.
        let (from, to) = (Point2::new(4.0, 4.0), Point2::new(5.0, 5.0));
        let found = opening(&graph, |_| true, from, to, Point2::new(4.5, 4.5));
        assert!((found.width_cells - 3.0).abs() < 0.02, "{found:?}");
        let mut x = found.jambs.map(|jamb| jamb.x);
        x.sort_by(f64::total_cmp);
        assert!((x[0] - 3.0).abs() < 1e-9 && (x[1] - 6.0).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn a_gap_beside_the_doorway_is_not_its_opening() {
        // The way from left to right leads through the gap of one cell; the doorway is the three rows on top.
        let map = OccupancyGrid::from_ascii(
            1.0,
            "
            .....
            .....
            .....
            .???.
            .....
            .???.
            ",
        );
        let graph = CellGraph::new(&map.cells);
        let (from, to) = (Point2::new(0.5, 1.5), Point2::new(4.5, 1.5));
        let is_own = |node: usize| graph.cells()[node].y >= 3;
        let found = opening(&graph, is_own, from, to, Point2::new(2.5, 4.5));
        assert!((found.width_cells - 3.0).abs() < 0.02, "{found:?}");
        assert!(found.jambs.iter().all(|jamb| jamb.y > 2.9), "{found:?}");
    }

    #[test]
    fn rays_end_at_the_border_of_the_map() {
        let map = OccupancyGrid::from_ascii(1.0, "....\n");
        let graph = CellGraph::new(&map.cells);
        let start = Point2::new(1.5, 0.5);
        let along = |x, y| clear_distance(&graph, start, Vec2::new(x, y), f64::INFINITY);
        assert!((along(1.0, 0.0) - 2.5).abs() < 1e-12 && (along(-1.0, 0.0) - 1.5).abs() < 1e-12);
        assert!((along(0.6, 0.8) - 0.625).abs() < 1e-12);
    }
}
