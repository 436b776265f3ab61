//! Exact distances from cells and lines to the walls.

use super::segment::for_each_touched_in;
use crate::geom::{Point2, Vec2};
use crate::grid::{Cell, CellGraph, squared_clearances};

/// What a body needs in free space. Lengths are in cells.
#[derive(Debug)]
pub(super) struct Body<'a> {
    pub(super) graph: &'a CellGraph,
}

impl Body<'_> {
    /// Whether a disc of `radius` around the center of each node is free, with what it takes to step from there to the next such
    /// node: between the centers of neighboring cells a wall can be nearer than at both, by less than half a cell.
    pub(super) fn passable(&self, radius: f64) -> Vec<bool> {
        // The height of a triangle whose sides are this and whose base is a diagonal step.
        let needed = (radius * radius + 0.5).sqrt();
        let mut passable = vec![false; self.graph.n_nodes()];
        squared_clearances(
            self.graph,
            |_, _| true,
            |first, run| {
                for (node, &squared) in (first..).zip(run) {
                    // From the center to a side or to a corner of the nearest cell.
                    let to_center = (squared as f64).sqrt();
                    let (least, most) = (to_center - std::f64::consts::FRAC_1_SQRT_2, to_center - 0.5);
                    passable[node] = least >= needed || (most >= needed && self.is_clear(node, needed));
                }
            },
        );
        passable
    }

    /// Whether a disc of `radius` around the center of `node` is free.
    fn is_clear(&self, node: usize, radius: f64) -> bool {
        let cell = self.graph.cell(node);
        let center = cell.center();
        self.near(cell, radius).all(|obstacle| distance_to_cell(center, obstacle) >= radius)
    }

    /// The cells that are not free in the square of `reach` cells around `cell`, also beyond the map.
    fn near(&self, cell: Cell, reach: f64) -> impl Iterator<Item = (i64, i64)> {
        let reach = reach.ceil() as i64;
        let (x, y) = (i64::from(cell.x), i64::from(cell.y));
        let square = (y - reach..=y + reach).flat_map(move |y| (x - reach..=x + reach).map(move |x| (x, y)));
        square.filter(|&(x, y)| !self.is_free(x, y))
    }

    fn is_free(&self, x: i64, y: i64) -> bool {
        let inside = (0..i64::from(self.graph.width())).contains(&x)
            && (0..i64::from(self.graph.height())).contains(&y);
        inside && self.graph.node_at(Cell::new(x as u32, y as u32)).is_some()
    }

    /// Distance from a line through free cells to the nearest cell that is not free, at most `most`.
    ///
    /// Cost: the cells that the line touches, each with those around it that are nearer than the answer so far.
    pub(super) fn clearance(&self, line: &[Point2], most: f64) -> f64 {
        let mut least = most;
        let size = (self.graph.width(), self.graph.height());
        for ends in line.windows(2) {
            for_each_touched_in(size, ends[0], ends[1], |x, y| {
                for obstacle in self.near(Cell::new(x, y), least) {
                    least = least.min(segment_to_cell(ends[0], ends[1], obstacle));
                }
            });
        }
        least
    }
}

/// Distance from a point to the nearest point of a cell.
fn distance_to_cell(point: Point2, (x, y): (i64, i64)) -> f64 {
    let beside = |v: f64, low: i64| (low as f64 - v).max(v - (low as f64 + 1.0)).max(0.0);
    Vec2::new(beside(point.x, x), beside(point.y, y)).length()
}

/// Distance from the segment between `a` and `b`, which does not enter the cell, to the nearest point of it: that of an end of
/// the segment to the cell, or of a corner of the cell to the segment.
fn segment_to_cell(a: Point2, b: Point2, cell: (i64, i64)) -> f64 {
    let (x, y) = (cell.0 as f64, cell.1 as f64);
    let corners = [(x, y), (x + 1.0, y), (x, y + 1.0), (x + 1.0, y + 1.0)];
    let to_corner = corners.map(|(x, y)| to_segment(Point2::new(x, y), a, b));
    let to_end = [a, b].map(|end| distance_to_cell(end, cell));
    to_corner.into_iter().chain(to_end).fold(f64::INFINITY, f64::min)
}

/// Distance from a point to the segment between `a` and `b`.
fn to_segment(point: Point2, a: Point2, b: Point2) -> f64 {
    let along = b - a;
    let squared = along.dot(along);
    let part = if squared > 0.0 { ((point - a).dot(along) / squared).clamp(0.0, 1.0) } else { 0.0 };
    point.distance(a + along * part)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::OccupancyGrid;

    #[test]
    fn a_disc_in_a_passage_of_five_cells() {
        let map = OccupancyGrid::from_ascii(
            1.0,
            &["#########", ".........", ".........", ".........", ".........", ".........", "#########"]
                .join("\n"),
        );
        let graph = CellGraph::new(&map.cells);
        let space = Body { graph: &graph };
        let passable = space.passable(2.0);
        let at = |x: u32, y: u32| passable[graph.node_at(Cell::new(x, y)).unwrap()];
        // The middle row is 2.5 from both walls; 2.12 are needed, also to the map's border.
        assert!((3..=5).all(|x| at(x, 3)) && !at(4, 2) && !at(1, 3) && at(2, 3));
        assert!(space.passable(2.5).iter().all(|&passable| !passable), "2.6 are needed");
    }

    #[test]
    fn clearance_of_a_line_past_a_pillar() {
        let map = OccupancyGrid::from_ascii(1.0, &format!("{0}.....#.....\n{0}", "...........\n".repeat(5)));
        let graph = CellGraph::new(&map.cells);
        let space = Body { graph: &graph };
        let clearance = |a: (f64, f64), b: (f64, f64)| {
            space.clearance(&[Point2::new(a.0, a.1), Point2::new(b.0, b.1)], 9.0)
        };
        // The pillar is the cell from (5, 5) to (6, 6).
        assert!((clearance((3.5, 3.5), (8.5, 3.5)) - 1.5).abs() < 1e-12);
        // The diagonal from (2.5, 5.5) to (5.5, 8.5) is x − y + 3 = 0; the corner (5, 6) is √2 off it.
        assert!((clearance((2.5, 5.5), (5.5, 8.5)) - 2f64.sqrt()).abs() < 1e-12);
        assert!((clearance((3.5, 5.5), (3.5, 5.5)) - 1.5).abs() < 1e-12);
        // The border of the map is a wall.
        assert!((clearance((0.5, 2.5), (0.5, 3.5)) - 0.5).abs() < 1e-12);
    }
}
