//! Straight lines that the robot can drive, instead of a path from cell to cell.

use super::Walks;
use crate::geom::Point2;
use crate::grid::Cell;
use crate::regions::RegionId;
use crate::topology::segment::all_touched;

/// How many cells beyond the last visible one are tried before a corner is set.
const GIVE_UP: usize = 16;

impl Walks<'_> {
    /// The corners that remain when `path` is replaced by straight lines as long as these touch only cells of
    /// `regions`, none nearer to a wall than the cells they replace. In cells.
    pub(super) fn pulled_straight(&self, path: &[usize], regions: &[RegionId]) -> Vec<Point2> {
        let center = |position: usize| self.graph.cell(path[position]).center();
        let mut line = vec![center(0)];
        let mut corner = 0;
        while corner + 1 < path.len() {
            let mut reach = corner + 1;
            // The last cell that was looked at, and the least clearance of the path from the corner to it.
            let mut position = reach;
            let mut tightest = self.clearance[path[corner]].min(self.clearance[path[reach]]);
            // In strides that double while cells are visible and halve where one is not.
            let mut stride = 1;
            while position + 1 < path.len() {
                let next = (position + stride).min(path.len() - 1);
                let between = path[position + 1..=next].iter().map(|&node| self.clearance[node]);
                let tightest_to_next = between.fold(tightest, u8::min);
                let is_visible = all_touched(center(corner), center(next), |x, y| {
                    self.node_in(regions, x, y).is_some_and(|node| self.clearance[node] >= tightest_to_next)
                }) && self.keeps_radius(center(corner), center(next));
                if !is_visible && stride > 1 {
                    stride /= 2;
                    continue;
                }
                (position, tightest) = (next, tightest_to_next);
                if is_visible {
                    reach = position;
                    stride *= 2;
                } else if position > reach + GIVE_UP {
                    break;
                }
            }
            line.push(center(reach));
            corner = reach;
        }
        line
    }

    /// Whether the robot has what it needs all along the line.
    pub(super) fn keeps_radius(&self, a: Point2, b: Point2) -> bool {
        self.passable.is_none() || self.body.clearance(&[a, b], self.radius + 1.0) >= self.radius - 1e-9
    }

    /// The node in column `x` and row `y` if it belongs to one of `regions`.
    pub(super) fn node_in(&self, regions: &[RegionId], x: i64, y: i64) -> Option<usize> {
        let cell = Cell::new(u32::try_from(x).ok()?, u32::try_from(y).ok()?);
        let inside = cell.x < self.graph.width() && cell.y < self.graph.height();
        let node = if inside { self.graph.node_at(cell)? } else { return None };
        regions.contains(&self.regions.region_of[node]).then_some(node)
    }
}
