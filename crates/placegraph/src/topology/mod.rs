//! The topological map: places, doorways and how they connect (Sect. 4.7).

mod map;

pub use map::{Connection, Doorway, EllipseAxes, Place, PlaceId, PolygonWithHoles, TopologicalMap};
