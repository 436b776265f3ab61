//! Connected regions of equal label, their properties and the two corrections by size (Sect. 4.7).

mod region;

pub use region::{Region, RegionId, RegionMap};
