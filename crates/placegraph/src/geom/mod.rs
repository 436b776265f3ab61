//! A small geometry vocabulary: positions, displacements and poses in the plane, in meters and radians.

mod ellipse;
mod point;

pub use ellipse::EllipseAxes;
pub use point::{Point2, Pose2, Vec2};
