//! The simulated laser scan (Sect. 4.4): 360 beams from the center of a free cell.

#![expect(clippy::inline_always, reason = "only what is inlined is compiled for several instruction sets")]
#![expect(clippy::needless_range_loop, reason = "loops over lanes and beams index several arrays alike")]

mod blocks;
mod cast;
mod caster;
mod changes;
mod config;
mod instructions;
pub(crate) mod lanes;
mod obstacles;
mod path;
#[expect(clippy::module_inception, reason = "the module's main type")]
mod scan;
mod walk;

#[doc(hidden)]
pub use blocks::{Block, Run};
pub use cast::cast;
pub(crate) use caster::Ranges;
#[doc(hidden)]
pub use caster::{BlockRanges, RayCaster};
pub(crate) use changes::{Stops, may_differ};
pub use config::{N_BEAMS, OutOfRange, ScanConfig, UnknownCells, beam_angle_rad};
pub use instructions::Instructions;
pub use path::beam_direction;
pub use scan::RangeScan;
