//! From labeled maps to a model.

mod calibration;
mod config;
mod curve;
mod dataset;
mod error;
mod folds;
mod gates;
mod heed;
mod labeled_map;
mod network;
mod spaces;
mod train;
mod validate;

pub use config::{Choice, HoldOut, TrainConfig};
pub use curve::CurvePoint;
pub use dataset::{Dataset, Example, Seen};
pub use error::TrainError;
pub use folds::assign_folds;
pub use gates::{GateExample, gate_examples, learn_gates};
pub use heed::heed_doorways;
pub use labeled_map::{LabeledMap, Window};
pub use network::{ListReport, NetworkConfig, NetworkReport, NodeScores, TrainedNetwork, train_network};
pub use spaces::{SpaceExamples, learn_spaces, space_examples};
pub use train::{FeatureVote, Trained, TrainingReport, train};
pub use validate::{MapScore, ReliabilityBin, RoundsScore, Validation};
