//! Types to bytes: label images, topology, pictures.

mod canvas;
mod json;
mod json_layout;
mod npy;
mod overlay;
mod overview;
mod page;
mod raster;
mod scan_picture;

pub use json::{FORMAT, MapInfo, ModelInfo, ProgramInfo, TopologyDocument, TopologyError, VERSION};
pub use npy::probability_npy;
pub use overlay::{View, overlay_svg};
pub use overview::overview_png;
pub use raster::{RasterError, label_png, raster_yaml, region_png};
pub use scan_picture::scan_png;
