//! The topological map: places, doorways and how they connect (Sect. 4.7), routes between them, stable names, and
//! queries.

pub mod align;
mod body;
mod build;
mod clearance;
pub mod edits;
pub mod identity;
mod map;
mod names;
mod opening;
mod outline;
pub mod query;
mod raster;
pub mod reach;
mod routes;
mod segment;

pub use crate::geom::EllipseAxes;
pub use build::build;
pub(crate) use build::place_id;
pub use map::{Connection, Doorway, Place, PlaceId, PolygonWithHoles, Route, Shortcut, TopologicalMap};
pub use names::{MAX_NAME_CHARS, NameError, check_name};
#[doc(hidden)]
pub use outline::outlines;
#[cfg(feature = "import")]
pub(crate) use raster::row_crossings;
pub use raster::{PlaceRaster, PlaceSpan};
#[doc(hidden)]
pub use routes::lay_routes;
pub use routes::{Approach, COMFORT_M, approaches};
pub(crate) use segment::{all_touched, segments_cross};
