//! Moves lines that were drawn by hand to the gap between walls that they mean.

use super::At;
use crate::geom::{Point2, Vec2};
use crate::grid::{Cell, CellGraph, MapFrame};
use crate::topology::opening::clear_distance;

/// How far from a wall a drawn line may end, in meters; a tenth of its length if that is more.
pub(super) const SNAP_M: f64 = 0.5;
/// The same as a part of the line's length.
const SNAP_FRAC: f64 = 0.1;
/// Largest turn of a drawn line, in degrees.
const MAX_TURN_DEG: i32 = 30;
/// Angle between two directions that are tried, in degrees.
const TURN_STEP_DEG: usize = 2;
/// A gap is as much worse than another as it is longer, and by this part of what its ends lie apart from the drawn ones.
const PER_MOVED: f64 = 0.5;

/// How far the ends of `line` may be moved, in meters.
pub(super) fn reach_m([a, b]: [At; 2]) -> f64 {
    SNAP_M.max(SNAP_FRAC * (b[0] - a[0]).hypot(b[1] - a[1]))
}

/// The gap that the line from `a` to `b` means, in cells: the line from wall to wall through free cells alone that is short and
/// whose ends are near to the drawn ones, at most `reach` away. `None` if there is none.
///
/// Cost: about the square of `reach` rays in every direction.
pub(super) fn gap(graph: &CellGraph, [a, b]: [Point2; 2], reach: f64) -> Option<[Point2; 2]> {
    let drawn = b - a;
    let length = drawn.length();
    // The ends of a gap lie on the map, and each at most `reach` from a drawn one.
    let longest = f64::from(graph.width()).hypot(f64::from(graph.height())) + 2.0 * reach;
    if !length.is_finite() || length < 1e-9 || length > longest {
        return None;
    }
    let along = drawn * (1.0 / length);
    let mut best: Option<(f64, [Point2; 2])> = None;
    for start in starts(graph, [a, b], reach) {
        for turn_deg in (-MAX_TURN_DEG..=MAX_TURN_DEG).step_by(TURN_STEP_DEG) {
            let direction = along.rotated(f64::from(turn_deg).to_radians());
            let limit = length + 2.0 * reach;
            let back = clear_distance(graph, start, -direction, limit);
            let ahead = clear_distance(graph, start, direction, limit);
            let ends = [start - direction * back, start + direction * ahead];
            let moved = [ends[0].distance(a), ends[1].distance(b)];
            if moved.iter().any(|&moved| moved > reach) {
                continue;
            }
            let cost = back + ahead + PER_MOVED * (moved[0] + moved[1]);
            // Equal within rounding: the first, which is nearer to the middle of the drawn line.
            if best.is_none_or(|(least, _)| cost < least - 1e-9) {
                best = Some((cost, ends));
            }
        }
    }
    best.map(|(_, ends)| ends)
}

/// Centers of free cells next to the middle of the line, those nearest to it first.
fn starts(graph: &CellGraph, [a, b]: [Point2; 2], reach: f64) -> Vec<Point2> {
    /// Parts of the line from its first end, the middle first.
    const PARTS: [f64; 5] = [0.5, 0.4, 0.6, 0.25, 0.75];
    let along = (b - a) * (1.0 / a.distance(b));
    let beside = Vec2::new(-along.y, along.x);
    let mut found: Vec<(f64, Cell)> = Vec::new();
    for part in PARTS {
        let on_line = a + (b - a) * part;
        for step in 0..=reach.ceil() as i32 {
            for side in [1.0, -1.0] {
                let point = on_line + beside * (side * f64::from(step));
                let inside = |v: f64, side: u32| (0.0..f64::from(side)).contains(&v);
                if inside(point.x, graph.width()) && inside(point.y, graph.height()) {
                    found.push((f64::from(step), Cell::new(point.x as u32, point.y as u32)));
                }
            }
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut seen = std::collections::BTreeSet::new();
    let is_new = |cell: &Cell| graph.node_at(*cell).is_some() && seen.insert((cell.x, cell.y));
    let cells = found.into_iter().map(|(_, cell)| cell).filter(is_new);
    cells.map(Cell::center).collect()
}

/// `line` in cells.
pub(super) fn in_cells(frame: &MapFrame, line: [At; 2]) -> [Point2; 2] {
    line.map(|[x, y]| frame.cells_from_map(Point2::new(x, y)))
}

/// A line in cells in meters of the map frame.
pub(super) fn in_map(frame: &MapFrame, line: [Point2; 2]) -> [At; 2] {
    line.map(|point| {
        let Point2 { x, y } = frame.map_from_cells(point);
        [x, y]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::OccupancyGrid;

    /// A gap of three cells in a wall of one.
    fn graph() -> CellGraph {
        let map = OccupancyGrid::from_ascii(
            1.0,
            "
            ..........
            ..........
            ..........
            ####...###
            ..........
            ..........
            ..........
            ",
        );
        CellGraph::new(&map.cells)
    }

    fn snapped(a: (f64, f64), b: (f64, f64)) -> Option<[Point2; 2]> {
        gap(&graph(), [Point2::new(a.0, a.1), Point2::new(b.0, b.1)], 2.0)
    }

    #[test]
    fn lines_beside_a_gap_are_moved_into_it() {
        for (a, b) in [
            ((4.0, 3.5), (7.0, 3.5)), // exact
            ((4.0, 2.4), (7.0, 2.6)), // a cell below
            ((4.0, 4.6), (7.0, 4.4)), // a cell above
            ((4.6, 3.5), (6.4, 3.5)), // too short
            ((2.6, 4.5), (7.2, 3.2)), // partly along the wall
            ((7.0, 4.0), (4.0, 3.0)), // from right to left
        ] {
            let [first, second] = snapped(a, b).unwrap_or_else(|| panic!("{a:?} {b:?}"));
            let (left, right) = if a.0 < b.0 { (first, second) } else { (second, first) };
            assert!(left.distance(Point2::new(4.0, 3.5)) < 0.6, "{a:?}: {left:?}");
            assert!(right.distance(Point2::new(7.0, 3.5)) < 0.6, "{a:?}: {right:?}");
        }
    }

    #[test]
    fn a_line_in_the_open_has_no_gap() {
        let map = OccupancyGrid::from_ascii(1.0, &"....................\n".repeat(20));
        let graph = CellGraph::new(&map.cells);
        let line = [Point2::new(8.0, 10.0), Point2::new(12.0, 10.0)];
        assert_eq!(gap(&graph, line, 3.0), None);
        assert_eq!(gap(&graph, [line[0]; 2], 3.0), None, "a point is not a line");
        for far in [1e9, 1e300, f64::INFINITY] {
            let line = [Point2::new(-far, 10.0), Point2::new(far, 10.0)];
            assert_eq!(gap(&graph, line, 0.2 * far), None, "far longer than the map: refused at once");
        }
        // The border of the map is a wall.
        let across = gap(&graph, [Point2::new(1.0, 10.2), Point2::new(18.5, 9.8)], 3.0).unwrap();
        assert!(across[0].x.abs() < 1e-9 && (across[1].x - 20.0).abs() < 1e-9, "{across:?}");
    }
}
