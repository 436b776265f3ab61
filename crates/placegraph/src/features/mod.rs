//! Features of a scan: set A from the raw beams, set B from the polygon of their end points (appendices A
//! and B of the book).

mod beams;
mod engine;
mod families;
mod fourier;
mod lanes;
mod lines;
mod minima;
mod moments;
mod plan;
mod polygon;
mod registry;
pub mod select;
mod table;
mod values;

pub use engine::{BlockValues, Job, evaluate, extract, of_scan};
pub use registry::{Feature, Scale, all, chapter183, freiburg203, old152, registry};
pub use table::{FeatureId, FeatureTable};
