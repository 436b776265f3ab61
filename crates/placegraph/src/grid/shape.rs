//! A grid without its values: where its cells are and how many.

use super::{Cell, MapFrame, OccupancyGrid};
use crate::geom::{Point2, Pose2};

/// Frame and size of a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridShape {
    /// Where the cells are.
    pub frame: MapFrame,
    /// Number of columns, at least 1.
    pub width: u32,
    /// Number of rows, at least 1.
    pub height: u32,
}

impl GridShape {
    /// The shape of `map`.
    pub fn of(map: &OccupancyGrid) -> Self {
        Self { frame: map.frame, width: map.cells.width(), height: map.cells.height() }
    }

    /// The cell that contains `point` of the map frame, or `None` outside of the grid.
    pub fn cell_at(&self, point: Point2) -> Option<Cell> {
        self.frame.cell_at(point).filter(|cell| cell.x < self.width && cell.y < self.height)
    }

    /// The smallest grid of the same resolution, without rotation, that covers this one: consumers of costmap masks
    /// ignore a rotation.
    pub fn upright(&self) -> Self {
        let corner = |x: u32, y: u32| self.frame.map_from_cells(Point2::new(x as f64, y as f64));
        let corners =
            [(0, 0), (self.width, 0), (0, self.height), (self.width, self.height)].map(|(x, y)| corner(x, y));
        let low = corners.iter().fold(corners[0], |a, b| Point2::new(a.x.min(b.x), a.y.min(b.y)));
        let high = corners.iter().fold(corners[0], |a, b| Point2::new(a.x.max(b.x), a.y.max(b.y)));
        let resolution_m = self.frame.resolution_m();
        // A whole number of cells that rounding made a little larger stays that number.
        let n_cells = |length: f64| ((length / resolution_m - 1e-6).ceil() as u32).max(1);
        Self {
            frame: self.frame.moved_to(Pose2::new(low.x, low.y, 0.0)),
            width: n_cells(high.x - low.x),
            height: n_cells(high.y - low.y),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_upright_grid_stays_and_a_quarter_turn_swaps_the_sides() {
        let shape = |yaw_rad| GridShape {
            frame: MapFrame::new(0.05, Pose2::new(1.0, 2.0, yaw_rad)).unwrap(),
            width: 40,
            height: 20,
        };
        assert_eq!(shape(0.0).upright(), shape(0.0));
        let turned = shape(std::f64::consts::FRAC_PI_2).upright();
        assert_eq!((turned.width, turned.height), (20, 40));
        assert!((turned.frame.map_from_grid().x - 0.0).abs() < 1e-12);
        assert_eq!(turned.frame.map_from_grid().yaw_rad.to_bits(), 0.0f64.to_bits());
    }
}
