//! Probabilistic relaxation labeling over the 8-neighborhood (Sect. 4.5).

mod compatibility;
mod planes;
mod relaxation;
mod tile;

pub use compatibility::{Compatibility, CompatibilityError, LEAST_COMPATIBLE, PairCounts, with_walls};
pub use relaxation::{RelaxConfig, Relaxed, relax, relax_in_place};
