//! The ellipse with given second moments, in closed form.

use std::f64::consts::{FRAC_PI_2, PI};

use serde::{Deserialize, Serialize};

use super::Vec2;

/// Axes of the ellipse with the same second moments as a region.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EllipseAxes {
    /// Full length of the major axis, in meters.
    pub major_m: f64,
    /// Full length of the minor axis, in meters.
    pub minor_m: f64,
    /// Direction of the major axis from the map's +x, counter-clockwise, in (−π/2, π/2].
    pub direction_rad: f64,
}

impl EllipseAxes {
    /// Axes of the uniform ellipse with central second moments `xx`, `xy`, `yy`, in m² (divided by the area).
    ///
    /// ```text
    /// λ± = (a + c ± sqrt((a − c)² + 4 b²)) / 2,  full axes 4 √λ±,  direction ½ atan2(2 b, a − c)
    /// ```
    /// with a = xx, b = xy, c = yy. Where the axes are equal the direction is 0.
    pub fn from_moments(xx: f64, xy: f64, yy: f64) -> Self {
        let spread = Vec2::new(xx - yy, 2.0 * xy).length();
        let axis = |lambda: f64| 4.0 * lambda.max(0.0).sqrt();
        Self {
            major_m: axis(0.5 * (xx + yy + spread)),
            minor_m: axis(0.5 * (xx + yy - spread)),
            direction_rad: 0.5 * (2.0 * xy).atan2(xx - yy),
        }
    }

    /// The axes turned counter-clockwise by `angle_rad`.
    pub fn rotated(self, angle_rad: f64) -> Self {
        let turned = (self.direction_rad + angle_rad).rem_euclid(PI);
        Self { direction_rad: if turned > FRAC_PI_2 { turned - PI } else { turned }, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disk_and_a_slanted_bar() {
        // A disk of radius 1 has second moments 1/4.
        let disk = EllipseAxes::from_moments(0.25, 0.0, 0.25);
        assert!((disk.major_m - 2.0).abs() < 1e-12 && (disk.minor_m - 2.0).abs() < 1e-12);
        // λ = 4 along 45 degrees, λ = 1 across: a = c = 2.5, b = 1.5.
        let bar = EllipseAxes::from_moments(2.5, 1.5, 2.5);
        assert!((bar.major_m - 8.0).abs() < 1e-12 && (bar.minor_m - 4.0).abs() < 1e-12);
        assert!((bar.direction_rad - PI / 4.0).abs() < 1e-12);
    }

    #[test]
    fn directions_stay_in_a_half_turn() {
        let up = EllipseAxes { major_m: 2.0, minor_m: 1.0, direction_rad: FRAC_PI_2 };
        assert!((up.rotated(0.2).direction_rad - (0.2 - FRAC_PI_2)).abs() < 1e-12);
        assert!((up.rotated(PI).direction_rad - FRAC_PI_2).abs() < 1e-12);
    }
}
