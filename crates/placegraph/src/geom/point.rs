//! Positions and displacements as different types, and the rigid transform between two frames.

use std::ops::{Add, Mul, Neg, Sub};

use serde::{Deserialize, Serialize};

/// A position in the plane, in meters (or in cells if the name of a value says so).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Point2 {
    /// First coordinate.
    pub x: f64,
    /// Second coordinate, pointing up.
    pub y: f64,
}

/// A displacement in the plane, in the unit of the points it lies between.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Vec2 {
    /// First component.
    pub x: f64,
    /// Second component, pointing up.
    pub y: f64,
}

/// A rigid transform of the plane: rotate by `yaw_rad`, then move by (`x`, `y`).
///
/// As `map_from_grid` it takes coordinates of the grid to coordinates of the map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pose2 {
    /// Translation along the first axis, in meters.
    pub x: f64,
    /// Translation along the second axis, in meters.
    pub y: f64,
    /// Counter-clockwise rotation, in radians.
    pub yaw_rad: f64,
}

impl Point2 {
    /// The point at (`x`, `y`).
    pub const fn new(x: f64, y: f64) -> Self {
        Self { x, y }
    }

    /// Euclidean distance to `other`.
    pub fn distance(self, other: Self) -> f64 {
        (other - self).length()
    }

    /// The midpoint between this point and `other`.
    pub fn midpoint(self, other: Self) -> Self {
        self + (other - self) * 0.5
    }
}

impl Vec2 {
    /// The displacement (`x`, `y`).
    pub const fn new(x: f64, y: f64) -> Self {
        Self { x, y }
    }

    /// Euclidean length.
    pub fn length(self) -> f64 {
        // A square root has the same bits on every machine, `hypot` has not.
        self.dot(self).sqrt()
    }

    /// Scalar product.
    pub fn dot(self, other: Self) -> f64 {
        self.x * other.x + self.y * other.y
    }

    /// Third component of the vector product: positive when `other` lies counter-clockwise of `self`.
    pub fn cross(self, other: Self) -> f64 {
        self.x * other.y - self.y * other.x
    }

    /// The displacement turned counter-clockwise by `angle_rad`.
    pub fn rotated(self, angle_rad: f64) -> Self {
        // Exact for the quarter turns that robot maps use most.
        let (sin, cos) = if angle_rad == 0.0 { (0.0, 1.0) } else { angle_rad.sin_cos() };
        Self::new(self.x * cos - self.y * sin, self.x * sin + self.y * cos)
    }
}

impl Pose2 {
    /// The transform that rotates by `yaw_rad` and then moves by (`x`, `y`).
    pub const fn new(x: f64, y: f64, yaw_rad: f64) -> Self {
        Self { x, y, yaw_rad }
    }

    /// Transforms `point` from the inner frame to the outer one.
    pub fn apply(self, point: Point2) -> Point2 {
        let turned = Vec2::new(point.x, point.y).rotated(self.yaw_rad);
        Point2::new(self.x + turned.x, self.y + turned.y)
    }

    /// Transforms `point` from the outer frame back to the inner one.
    pub fn apply_inverse(self, point: Point2) -> Point2 {
        let turned = (point - Point2::new(self.x, self.y)).rotated(-self.yaw_rad);
        Point2::new(turned.x, turned.y)
    }
}

impl Sub for Point2 {
    type Output = Vec2;
    fn sub(self, other: Self) -> Vec2 {
        Vec2::new(self.x - other.x, self.y - other.y)
    }
}

impl Add<Vec2> for Point2 {
    type Output = Point2;
    fn add(self, step: Vec2) -> Point2 {
        Point2::new(self.x + step.x, self.y + step.y)
    }
}

impl Sub<Vec2> for Point2 {
    type Output = Point2;
    fn sub(self, step: Vec2) -> Point2 {
        Point2::new(self.x - step.x, self.y - step.y)
    }
}

impl Add for Vec2 {
    type Output = Vec2;
    fn add(self, other: Self) -> Vec2 {
        Vec2::new(self.x + other.x, self.y + other.y)
    }
}

impl Sub for Vec2 {
    type Output = Vec2;
    fn sub(self, other: Self) -> Vec2 {
        Vec2::new(self.x - other.x, self.y - other.y)
    }
}

impl Neg for Vec2 {
    type Output = Vec2;
    fn neg(self) -> Vec2 {
        Vec2::new(-self.x, -self.y)
    }
}

impl Mul<f64> for Vec2 {
    type Output = Vec2;
    fn mul(self, factor: f64) -> Vec2 {
        Vec2::new(self.x * factor, self.y * factor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_turn_and_back() {
        let map_from_grid = Pose2::new(10.0, -2.0, std::f64::consts::FRAC_PI_2);
        let in_map = map_from_grid.apply(Point2::new(3.0, 1.0));
        assert!(in_map.distance(Point2::new(9.0, 1.0)) < 1e-12);
        assert!(map_from_grid.apply_inverse(in_map).distance(Point2::new(3.0, 1.0)) < 1e-12);
    }

    #[test]
    fn cross_is_positive_counter_clockwise() {
        assert!(Vec2::new(1.0, 0.0).cross(Vec2::new(0.0, 1.0)) > 0.0);
    }
}
