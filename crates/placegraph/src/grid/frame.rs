//! The georeference of a grid: cells to meters and back, in one place.

use serde::Serialize;

use super::Cell;
use crate::geom::{Point2, Pose2};

/// Size of a cell and pose of the grid in the map frame.
///
/// The origin is the outer corner of the lower left cell, not its center (ROS `MapMetaData`).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MapFrame {
    resolution_m: f64,
    map_from_grid: Pose2,
}

/// Why a resolution or an origin cannot georeference a grid.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FrameError {
    /// The resolution is no positive finite number.
    #[error("expected a resolution above 0 meters per cell, found {found}")]
    Resolution {
        /// The value found.
        found: f64,
    },
    /// The origin has a coordinate that is not finite.
    #[error("expected three finite numbers as origin, found [{}, {}, {}]", found.x, found.y, found.yaw_rad)]
    Origin {
        /// The value found.
        found: Pose2,
    },
}

impl MapFrame {
    /// A frame with cells of `resolution_m` meters whose lower left corner stands at `map_from_grid`.
    ///
    /// # Errors
    /// If the resolution is not above 0 and finite, or the origin is not finite.
    pub fn new(resolution_m: f64, map_from_grid: Pose2) -> Result<Self, FrameError> {
        if !(resolution_m.is_finite() && resolution_m > 0.0) {
            return Err(FrameError::Resolution { found: resolution_m });
        }
        if ![map_from_grid.x, map_from_grid.y, map_from_grid.yaw_rad].iter().all(|v| v.is_finite()) {
            return Err(FrameError::Origin { found: map_from_grid });
        }
        Ok(Self { resolution_m, map_from_grid })
    }

    /// Side of a cell, in meters.
    pub fn resolution_m(&self) -> f64 {
        self.resolution_m
    }

    /// Area of a cell, in square meters.
    pub fn cell_area_m2(&self) -> f64 {
        self.resolution_m * self.resolution_m
    }

    /// Pose of the grid's lower left corner in the map frame.
    pub fn map_from_grid(&self) -> Pose2 {
        self.map_from_grid
    }

    /// A frame of the same resolution whose lower left corner stands at `map_from_grid`.
    pub(super) fn moved_to(self, map_from_grid: Pose2) -> Self {
        Self { map_from_grid, ..self }
    }

    /// Takes a point given in cells from the lower left corner of the grid to meters in the map frame.
    pub fn map_from_cells(&self, point: Point2) -> Point2 {
        self.map_from_grid.apply(Point2::new(point.x * self.resolution_m, point.y * self.resolution_m))
    }

    /// Takes a point in meters of the map frame to cells from the lower left corner of the grid.
    pub fn cells_from_map(&self, point: Point2) -> Point2 {
        let in_grid = self.map_from_grid.apply_inverse(point);
        Point2::new(in_grid.x / self.resolution_m, in_grid.y / self.resolution_m)
    }

    /// Center of `cell`, in meters of the map frame.
    pub fn center(&self, cell: Cell) -> Point2 {
        self.map_from_cells(Point2::new(cell.x as f64 + 0.5, cell.y as f64 + 0.5))
    }

    /// The cell that contains `point` of the map frame, if column and row are not negative.
    pub fn cell_at(&self, point: Point2) -> Option<Cell> {
        let Point2 { x, y } = self.cells_from_map(point);
        let whole = |v: f64| (v >= 0.0 && v < u32::MAX as f64).then_some(v as u32);
        Some(Cell::new(whole(x)?, whole(y)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_origin_is_a_corner_and_yaw_turns_about_it() {
        let frame = MapFrame::new(0.5, Pose2::new(1.0, 2.0, std::f64::consts::FRAC_PI_2)).unwrap();
        // One cell to the right of the first is up in the map.
        let center = frame.center(Cell::new(1, 0));
        assert!(center.distance(Point2::new(0.75, 2.75)) < 1e-12);
        assert_eq!(frame.cell_at(center), Some(Cell::new(1, 0)));
        assert_eq!(frame.cell_at(Point2::new(1.1, 1.9)), None);
    }

    #[test]
    fn zero_nan_and_infinite_are_refused() {
        for bad in [0.0, -0.05, f64::NAN, f64::INFINITY] {
            assert!(MapFrame::new(bad, Pose2::default()).is_err());
        }
        assert!(MapFrame::new(0.05, Pose2::new(f64::NAN, 0.0, 0.0)).is_err());
    }
}
