//! Where a model comes from, for people; programs use only the resolution.

use serde::{Deserialize, Serialize};

/// How a model was trained.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainingRecord {
    /// Version of the program that trained the model.
    pub program_version: String,
    /// The maps.
    pub maps: Vec<MapRecord>,
    /// Side of the cells for which the compatibilities hold, in meters.
    pub resolution_m: f64,
    /// Share of the training examples that the list labels wrongly.
    pub training_error: f64,
    /// Results on held-out examples; absent if no part of the maps could be held out.
    pub validation: Option<ValidationRecord>,
    /// Results of the network on held-out blocks; absent for other methods.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub network: Option<NetworkRecord>,
    /// The settings of training.
    pub settings: TrainingSettings,
}

/// The settings of training, as a JSON value for people.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct TrainingSettings(pub(crate) serde_json::Value);

impl TrainingSettings {
    /// The settings as JSON.
    pub fn to_json(&self) -> String {
        self.0.to_string()
    }
}

/// A map that a model was trained on.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MapRecord {
    /// Name, as given by the caller.
    pub name: String,
    /// SHA-256 of the map's cells and labels, in hexadecimal.
    pub sha256: String,
    /// Side of a cell, in meters.
    pub resolution_m: f64,
    /// Labeled free cells of each class.
    pub cells_per_class: Vec<u64>,
}

/// Results on held-out examples.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ValidationRecord {
    /// Number of parts that were held out, one after the other.
    pub n_folds: usize,
    /// Number of boosting rounds.
    pub n_rounds: usize,
    /// Temperature of the confidences.
    pub temperature: f64,
    /// Mean of −ln p(true class) under the list.
    pub log_loss: f64,
    /// The orders by falling accuracy; for more than four classes, the best 24.
    pub orders: Vec<OrderRecord>,
}

/// Results of a network on held-out blocks.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NetworkRecord {
    /// Number of neighbors per class, M.
    pub n_neighbors: usize,
    /// Cost of the slack, C.
    pub cost: f64,
    /// All pairs of M and C that were tried.
    pub choices: Vec<ChoiceRecord>,
}

/// The accuracy of one pair of M and C.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChoiceRecord {
    /// Number of neighbors per class, M.
    pub n_neighbors: usize,
    /// Cost of the slack, C.
    pub cost: f64,
    /// Share of cells labeled right.
    pub accuracy: f64,
    /// Mean of the classes' F1 values.
    pub macro_f1: f64,
}

/// The accuracy of one order of the decision list.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OrderRecord {
    /// Names of the classes, in the order of the list.
    pub order: Vec<String>,
    /// Share of cells labeled right.
    pub accuracy: f64,
    /// Mean of the classes' F1 values.
    pub macro_f1: f64,
}
