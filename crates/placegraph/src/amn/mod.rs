//! Instance-based associative Markov networks (Sect. 4.6).

mod cells;
pub mod confidence;
mod iamn;
pub mod infer;
pub mod learn;
pub mod maxflow;
pub mod model;
mod model_file;
pub mod nearest;
mod train;
mod working_set;

pub use cells::{LabeledCells, TrainingMap};
pub use iamn::{IamnModel, NetworkLabels, Standardization, label, side_by_side};
pub use model_file::IamnFileError;
pub use train::{IamnConfig, IamnReport, Validated, train};
