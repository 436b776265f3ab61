//! Features of a scan: set A from the raw beams, set B from the polygon of their end points (appendices A
//! and B of the book).

pub mod select;
mod table;

pub use table::{FeatureId, FeatureTable};
