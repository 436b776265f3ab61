//! Connected regions of equal label, their properties and the two corrections by size (Sect. 4.7).

mod adjacency;
mod components;
mod correction;
mod disjoint_sets;
mod islands;
mod properties;
mod region;
mod runs;

pub use adjacency::{Contact, contacts};
pub(crate) use components::components;
pub use components::{DiagonalSteps, connected};
pub use correction::{Corrected, Relabeled, Thresholds, correct};
pub use islands::{islands, label_islands};
pub use properties::{RegionProperties, properties};
pub use region::{Region, RegionId, RegionMap};
pub(crate) use runs::Runs;
