//! Types to bytes: label images, topology, pictures.

mod json;
mod json_layout;
mod overlay;
mod overview;
mod page;
mod raster;

pub use json::{FORMAT, MapInfo, ModelInfo, ProgramInfo, TopologyDocument, TopologyError, VERSION};
pub use overlay::{View, overlay_svg};
pub use overview::overview_png;
