//! From labeled maps to a model.

mod config;
mod dataset;
mod error;
mod folds;
mod gates;
mod labeled_map;
mod network;
mod train;
mod validate;

pub use config::{Choice, TrainConfig};
pub use dataset::{Dataset, Example};
pub use error::TrainError;
pub use folds::assign_folds;
pub use gates::{GateExample, gate_examples, learn_gates};
pub use labeled_map::{LabeledMap, Window};
pub use network::{ListReport, NetworkConfig, NetworkReport, NodeScores, TrainedNetwork, train_network};
pub use train::{FeatureVote, Trained, TrainingReport, train};
pub use validate::{RoundsScore, Validation};
