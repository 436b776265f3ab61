//! Classes, labels and distributions over labels.

mod confusion_matrix;
mod field;
mod label;

pub use confusion_matrix::ConfusionMatrix;
pub(crate) use confusion_matrix::ratio;
pub use field::LabelField;
pub use label::{Class, Held, Label, LabelCell, LabelSet, LabelSetError, Labeling, Role};
