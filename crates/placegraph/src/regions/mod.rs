//! Connected regions of equal label, their properties and the two corrections by size (Sect. 4.7).

mod adjacency;
mod components;
mod correction;
mod islands;
mod properties;
mod region;

pub use crate::grid::DiagonalSteps;
pub use adjacency::{Contact, contacts};
pub use components::connected;
pub use correction::{Corrected, Relabeled, Thresholds, correct};
pub use islands::{islands, label_islands};
pub use properties::{RegionProperties, properties};
pub use region::{Region, RegionId, RegionMap};
