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

/// Smallest side of a cell, in meters.
pub const MIN_RESOLUTION_M: f64 = 1e-6;
/// Largest side of a cell, in meters: what is computed from it stays finite.
pub const MAX_RESOLUTION_M: f64 = 1e6;
/// Largest coordinate of an origin, in meters and radians; a larger one could not resolve a tenth of a micrometer.
pub const MAX_ORIGIN: f64 = 1e9;

/// Why a resolution or an origin cannot georeference a grid.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FrameError {
    /// The resolution is not a valid length of a cell.
    #[error(
        "expected a resolution above 0 meters per cell, {MIN_RESOLUTION_M} to {MAX_RESOLUTION_M}, found {found}"
    )]
    Resolution {
        /// The value found.
        found: f64,
    },
    /// The origin has a coordinate that is not finite, or so large that meters are lost.
    #[error(
        "expected three numbers up to {MAX_ORIGIN} as origin, found [{}, {}, {}]",
        found.x, found.y, found.yaw_rad
    )]
    Origin {
        /// The value found.
        found: Pose2,
    },
}

impl MapFrame {
    /// A frame with cells of `resolution_m` meters, whose lower left corner has the pose `map_from_grid`.
    ///
    /// # Errors
    /// If the resolution is not in [`MIN_RESOLUTION_M`]..=[`MAX_RESOLUTION_M`], or a coordinate of the origin is above
    /// [`MAX_ORIGIN`].
    pub fn new(resolution_m: f64, map_from_grid: Pose2) -> Result<Self, FrameError> {
        if !(MIN_RESOLUTION_M..=MAX_RESOLUTION_M).contains(&resolution_m) {
            return Err(FrameError::Resolution { found: resolution_m });
        }
        let Pose2 { x, y, yaw_rad } = map_from_grid;
        if ![x, y, yaw_rad].iter().all(|v| v.abs() <= MAX_ORIGIN) {
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

    /// Transforms a point in cells from the lower left corner of the grid to meters in the map frame.
    pub fn map_from_cells(&self, point: Point2) -> Point2 {
        self.map_from_grid.apply(Point2::new(point.x * self.resolution_m, point.y * self.resolution_m))
    }

    /// Transforms a point in meters in the map frame to cells from the lower left corner of the grid.
    pub fn cells_from_map(&self, point: Point2) -> Point2 {
        let in_grid = self.map_from_grid.apply_inverse(point);
        Point2::new(in_grid.x / self.resolution_m, in_grid.y / self.resolution_m)
    }

    /// Center of `cell`, in meters in the map frame.
    pub fn center(&self, cell: Cell) -> Point2 {
        self.map_from_cells(cell.center())
    }

    /// The cell that contains `point` in the map frame, unless its column or row is negative.
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
        for bad in [0.0, -0.05, 1e-300, 1e300, f64::NAN, f64::INFINITY] {
            assert!(MapFrame::new(bad, Pose2::default()).is_err());
        }
        for bad in [f64::NAN, f64::INFINITY, -1e300] {
            for pose in [Pose2::new(bad, 0.0, 0.0), Pose2::new(0.0, bad, 0.0), Pose2::new(0.0, 0.0, bad)] {
                assert!(MapFrame::new(0.05, pose).is_err());
            }
        }
    }
}
