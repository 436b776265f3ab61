//! The trained model and its file.

#[cfg(feature = "default-model")]
mod builtin;
mod file;
mod hash;
mod network;
mod record;

use crate::boost::{DecisionList, WeightedStump};
use crate::labels::LabelSet;
use crate::regions::Thresholds;
use crate::relax::{Compatibility, RelaxConfig};
use crate::scan::ScanConfig;

pub use file::{FORMAT, MAX_BYTES, ModelError, VERSION};
pub use hash::sha256_hex;
pub use network::{NetworkModel, log_confidences};
pub use record::{
    ChoiceRecord, MapRecord, NetworkRecord, OrderRecord, TrainingRecord, TrainingSettings, ValidationRecord,
};

/// Everything that is needed to label a map.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// The classes.
    pub label_set: LabelSet,
    /// The scan that the model's features are computed from.
    pub scan: ScanConfig,
    /// How cells are labeled.
    pub method: Method,
    /// What painted doorways added to what the program knows of gates: stumps over their figures
    /// ([`heed_doorways`](crate::training::heed_doorways)).
    pub doorways: Vec<WeightedStump>,
    /// When a region is too small for its class.
    pub thresholds: Thresholds,
    /// Where the model comes from.
    pub record: TrainingRecord,
}

#[cfg(not(feature = "default-model"))]
impl Model {
    /// Without a built-in model, none labels cells as it does.
    pub(crate) const fn labels_as_builtin(&self) -> bool {
        false
    }
}

/// How cells are labeled.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Method {
    /// Boosted stumps in a decision list, then relaxation (Sect. 4.3 to 4.5).
    Boosted(BoostedModel),
    /// Instance-based associative Markov network (Sect. 4.6).
    Iamn(NetworkModel),
}

impl Method {
    /// Name for people and files.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Boosted(_) => "boosted",
            Self::Iamn(_) => "iamn",
        }
    }
}

/// Boosted stumps in a decision list, and the relaxation that follows.
#[derive(Clone, Debug, PartialEq)]
pub struct BoostedModel {
    /// The classifier.
    pub list: DecisionList,
    /// The relaxation's length.
    pub relaxation: RelaxConfig,
    /// Which labels go together in neighboring cells of [`TrainingRecord::resolution_m`].
    pub compatibility: Compatibility,
}
