//! One scan: a range for every beam.

use super::{N_BEAMS, beam_direction};
use crate::geom::Point2;

/// [`N_BEAMS`] ranges in meters, finite and not negative; beam i points
/// [`beam_angle_rad`](super::beam_angle_rad)`(i)` counter-clockwise from the grid's +x axis.
#[derive(Clone, Debug, PartialEq)]
pub struct RangeScan {
    ranges_m: Vec<f64>,
}

impl RangeScan {
    /// The scan with these ranges, in meters.
    ///
    /// # Panics
    /// If there are not [`N_BEAMS`], or one is negative or not finite.
    pub fn new(ranges_m: Vec<f64>) -> Self {
        assert_eq!(ranges_m.len(), N_BEAMS, "one range per beam");
        assert!(ranges_m.iter().all(|range| range.is_finite() && *range >= 0.0), "ranges are lengths");
        Self { ranges_m }
    }

    /// The ranges, in meters, by beam.
    pub fn ranges_m(&self) -> &[f64] {
        &self.ranges_m
    }

    /// End point of `beam`, in meters from the robot along the grid's axes.
    pub fn end_point(&self, beam: usize) -> Point2 {
        let direction = beam_direction(beam);
        Point2::new(self.ranges_m[beam] * direction.x, self.ranges_m[beam] * direction.y)
    }
}
