//! Features of a scan: set A from the raw beams, set B from the polygon of their end points (appendices A
//! and B of the book).

#![expect(clippy::inline_always, reason = "only what is inlined is compiled for several instruction sets")]
#![expect(clippy::large_stack_arrays, reason = "buffers of 23 kB that stay in the first-level cache")]
#![expect(clippy::needless_range_loop, reason = "loops over lanes and beams index several arrays alike")]

mod beams;
mod engine;
mod families;
mod fourier;
mod lines;
mod markdown;
mod minima;
mod moments;
mod plan;
mod polygon;
mod registry;
pub mod select;
mod table;
mod values;

#[doc(hidden)]
pub use engine::{BlockValues, Job, evaluate};
pub use engine::{extract, of_scan};
pub use families::Scale;
pub use markdown::markdown;
pub use registry::{Feature, all, chapter183, freiburg203, lean120, old152, registry};
pub use table::{FeatureId, FeatureTable};
