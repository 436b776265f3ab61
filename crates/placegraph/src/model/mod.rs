//! The trained model and its file.

mod file;
mod hash;
mod record;

use crate::boost::DecisionList;
use crate::features::FeatureId;
use crate::labels::LabelSet;
use crate::regions::Thresholds;
use crate::relax::{Compatibility, RelaxConfig};
use crate::scan::ScanConfig;

pub use file::{FORMAT, MAX_BYTES, ModelError, VERSION};
pub use hash::sha256_hex;
pub use record::{MapRecord, OrderRecord, TrainingRecord, ValidationRecord};

/// All that labeling a map needs to know.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// The classes.
    pub label_set: LabelSet,
    /// The scan whose features the model knows.
    pub scan: ScanConfig,
    /// How cells are labeled.
    pub method: Method,
    /// When a region is too small for its class.
    pub thresholds: Thresholds,
    /// Where the model comes from.
    pub record: TrainingRecord,
}

/// How cells are labeled.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Method {
    /// Boosted stumps in a decision list, then relaxation (Sect. 4.3 to 4.5).
    Boosted(BoostedModel),
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

impl BoostedModel {
    /// The features that any stump looks at, in ascending order.
    pub fn columns(&self) -> Vec<FeatureId> {
        let stumps = self.list.classifiers.iter().flat_map(|classifier| &classifier.stumps);
        let mut columns: Vec<FeatureId> = stumps.map(|w| w.stump.feature).collect();
        columns.sort_unstable();
        columns.dedup();
        columns
    }
}
