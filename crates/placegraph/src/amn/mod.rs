//! Instance-based associative Markov networks (Sect. 4.6).

mod cells;
#[doc(hidden)]
pub mod confidence;
mod config;
mod iamn;
#[doc(hidden)]
pub mod learn;
#[doc(hidden)]
pub mod model;
mod model_file;
#[doc(hidden)]
pub mod nearest;
mod train;
mod working_set;

pub use cells::LabeledCells;
pub use config::IamnConfig;
pub use iamn::{IamnModel, NetworkLabels, Standardization, label, side_by_side};
pub use learn::{Ended, LearnConfig, Learned, Loss};
pub use model::Weights;
pub use model_file::IamnFileError;
pub use train::{IamnReport, Validated, train};
