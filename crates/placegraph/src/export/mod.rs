//! Types to bytes: label images, topology, pictures.

mod npy;
mod raster;

pub use npy::probability_npy;
pub use raster::{RasterError, label_png, raster_yaml, region_png};
