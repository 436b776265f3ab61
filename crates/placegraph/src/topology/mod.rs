//! The topological map: places, doorways and how they connect (Sect. 4.7).

mod map;

pub use crate::geom::EllipseAxes;
pub use map::{Connection, Doorway, Place, PlaceId, PolygonWithHoles, TopologicalMap};
