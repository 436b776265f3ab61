//! The topological map: places, doorways and how they connect (Sect. 4.7).

mod build;
mod clearance;
mod map;
mod opening;
mod outline;
mod paths;

pub use crate::geom::EllipseAxes;
pub use build::build;
pub use map::{Connection, Doorway, Place, PlaceId, PolygonWithHoles, TopologicalMap};
