//! Classes, labels and distributions over labels.

mod field;
mod label;

pub use field::LabelField;
pub use label::{Class, Label, LabelSet, LabelSetError, Labeling, Role};
