//! The settings of a simulated scan.

use serde::{Deserialize, Serialize};

/// Beams of a scan, one per degree.
pub const N_BEAMS: usize = 360;

/// Angle of `beam` from the grid's +x axis, counter-clockwise, in radians.
pub fn beam_angle_rad(beam: usize) -> f64 {
    beam as f64 * std::f64::consts::TAU / N_BEAMS as f64
}

/// What a beam does in a cell that was never observed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum UnknownCells {
    /// It ends there, as at a wall.
    #[default]
    Stop,
    /// It passes, as through a free cell.
    Pass,
}

/// How scans are simulated. Stored in the model, because features depend on it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScanConfig {
    /// Longest range, in meters; a beam that meets nothing ends there. Default 80.
    pub range_max_m: f64,
    /// How an unknown cell affects a beam. Default: the beam ends there. The border of the map always ends a beam.
    pub unknown: UnknownCells,
    /// Every range is multiplied by this after casting: the building at another scale (Sect. 4.8.2).
    /// Default 1.
    pub range_scale: f64,
    /// Beams pass through free-standing obstacles that are at most this long and wide, in meters, such as the legs of
    /// tables and chairs, or noise. Default 0: beams end at all obstacles.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub max_speck_m: f64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
fn is_zero(value: &f64) -> bool {
    *value <= 0.0
}

impl ScanConfig {
    /// Largest [`ScanConfig::range_max_m`]. Features are of 32 bits: powers of a range up to the sixth stay finite.
    pub const MAX_RANGE_M: f64 = 1e4;
    /// Largest [`ScanConfig::range_scale`].
    pub const MAX_SCALE: f64 = 100.0;
    /// Largest [`ScanConfig::max_speck_m`].
    pub const MAX_SPECK_M: f64 = 2.0;

    /// Whether ranges and scale are above 0 and small enough for features to be finite, and the size of specks is
    /// valid.
    ///
    /// # Errors
    /// If one is not: the first.
    pub fn check(&self) -> Result<(), OutOfRange> {
        let checked = |holds: bool, field, expected, found| {
            if holds { Ok(()) } else { Err(OutOfRange { field, expected, found }) }
        };
        let up_to = |value: f64, max: f64| value > 0.0 && value <= max;
        let Self { range_max_m, range_scale, max_speck_m, unknown: _ } = *self;
        let has_range = up_to(range_max_m, Self::MAX_RANGE_M);
        checked(has_range, "range_max_m", "a number above 0 to 10000", range_max_m)?;
        let has_scale = up_to(range_scale, Self::MAX_SCALE);
        checked(has_scale, "range_scale", "a number above 0 to 100", range_scale)?;
        let has_speck = (0.0..=Self::MAX_SPECK_M).contains(&max_speck_m);
        checked(has_speck, "max_speck_m", "a number from 0 to 2", max_speck_m)
    }
}

/// A number of a [`ScanConfig`] that makes no scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutOfRange {
    /// Which one.
    pub field: &'static str,
    /// The numbers that do.
    pub expected: &'static str,
    /// The number.
    pub found: f64,
}

impl Default for ScanConfig {
    fn default() -> Self {
        Self { range_max_m: 80.0, unknown: UnknownCells::Stop, range_scale: 1.0, max_speck_m: 0.0 }
    }
}
