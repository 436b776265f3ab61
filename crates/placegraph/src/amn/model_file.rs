//! The form of an [`IamnModel`] in the model file: features by name, exemplars as base64 of little-endian `f32`.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::{Deserialize, Serialize};

use super::iamn::{IamnModel, Standardization};
use super::model::Weights;
use crate::features::FeatureId;
use crate::grid::Connectivity;
use crate::labels::{Label, LabelSet};

/// The model in the file's terms.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct IamnFile {
    features: Vec<String>,
    mean: Vec<f32>,
    deviation: Vec<f32>,
    n_neighbors: usize,
    n_adjacent: usize,
    weights: Weights,
    temperature: f64,
    /// One string per class: its exemplars row by row.
    exemplars: Vec<String>,
}

/// Why the network of a model file cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IamnFileError {
    /// A feature that this program cannot compute.
    #[error("the model uses the feature {name:?}, which this version of placegraph does not have")]
    Feature {
        /// The name found.
        name: String,
    },
    /// A list has another length than the rest of the file asks for.
    #[error("expected {expected} values in {field}, found {found}")]
    Length {
        /// Which list.
        field: &'static str,
        /// How many there should be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// A number is out of range.
    #[error("expected {expected} in {field}")]
    Value {
        /// Which field.
        field: &'static str,
        /// What it should hold.
        expected: &'static str,
    },
}

impl From<IamnModel> for IamnFile {
    fn from(model: IamnModel) -> Self {
        let n_features = model.standardization.features.len();
        let rows = || model.exemplars.chunks_exact(n_features).zip(&model.exemplar_labels);
        let encode = |class: usize| {
            let values = rows().filter(|(_, label)| label.index() == class).flat_map(|(row, _)| row);
            STANDARD.encode(values.flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>())
        };
        Self {
            exemplars: (0..model.weights.n_labels()).map(encode).collect(),
            features: model.standardization.features.iter().map(|id| id.feature().name.clone()).collect(),
            mean: model.standardization.mean,
            deviation: model.standardization.deviation,
            n_neighbors: model.n_neighbors,
            n_adjacent: model.connectivity.steps().len(),
            weights: model.weights,
            temperature: model.temperature,
        }
    }
}

impl TryFrom<IamnFile> for IamnModel {
    type Error = IamnFileError;

    fn try_from(file: IamnFile) -> Result<Self, IamnFileError> {
        file.check()?;
        let feature = |name: &String| {
            FeatureId::from_name(name).ok_or_else(|| IamnFileError::Feature { name: name.clone() })
        };
        let features = file.features.iter().map(feature).collect::<Result<Vec<_>, _>>()?;
        let (mut exemplars, mut exemplar_labels) = (Vec::new(), Vec::new());
        for (class, text) in file.exemplars.iter().enumerate() {
            let values = decode(text)?;
            if !values.len().is_multiple_of(features.len()) {
                let expected = values.len().next_multiple_of(features.len());
                return Err(IamnFileError::Length { field: "exemplars", expected, found: values.len() });
            }
            exemplar_labels.resize(exemplar_labels.len() + values.len() / features.len(), Label(class as u8));
            exemplars.extend(values);
        }
        Ok(Self {
            standardization: Standardization { features, mean: file.mean, deviation: file.deviation },
            n_neighbors: file.n_neighbors,
            exemplars,
            exemplar_labels,
            weights: file.weights,
            connectivity: if file.n_adjacent == 4 { Connectivity::Four } else { Connectivity::Eight },
            temperature: file.temperature,
        })
    }
}

/// Neighbors per class that a file may ask for.
const MAX_NEIGHBORS: usize = 1000;
/// Largest feature value; with the least deviation, squared distances over all features stay finite in 32 bits.
const MAX_VALUE: f32 = 1e8;
const LEAST_DEVIATION: f32 = 1e-8;
/// Largest weight: sums of weighted distances stay finite.
const MAX_WEIGHT: f64 = 1e12;

impl IamnFile {
    fn check(&self) -> Result<(), IamnFileError> {
        let value = |is_good: bool, field, expected| {
            if is_good { Ok(()) } else { Err(IamnFileError::Value { field, expected }) }
        };
        let length = |field, found: usize, expected: usize| {
            if found == expected { Ok(()) } else { Err(IamnFileError::Length { field, expected, found }) }
        };
        let (n_features, n_labels) = (self.features.len(), self.exemplars.len());
        let is_unique = |i: usize| !self.features[..i].contains(&self.features[i]);
        value(n_features > 0 && (0..n_features).all(is_unique), "features", "at least one, each once")?;
        value((LabelSet::MIN..=LabelSet::MAX).contains(&n_labels), "exemplars", "2 to 8 classes")?;
        value((1..=MAX_NEIGHBORS).contains(&self.n_neighbors), "n_neighbors", "1 to 1000")?;
        value([4, 8].contains(&self.n_adjacent), "n_adjacent", "4 or 8")?;
        length("mean", self.mean.len(), n_features)?;
        length("deviation", self.deviation.len(), n_features)?;
        length("weights.edge", self.weights.edge.len(), n_labels)?;
        // A weight per distance, one per score of another classifier, and that of the constant.
        let at_least = n_labels * (n_labels * self.n_neighbors + 1);
        if self.weights.node.len() < at_least || !self.weights.node.len().is_multiple_of(n_labels) {
            length("weights.node", self.weights.node.len(), at_least)?;
        }
        value(self.mean.iter().all(|v| v.abs() <= MAX_VALUE), "mean", "numbers up to 1e8")?;
        let deviations = LEAST_DEVIATION..=MAX_VALUE;
        value(
            self.deviation.iter().all(|v| deviations.contains(v)),
            "deviation",
            "numbers from 1e-8 to 1e8",
        )?;
        value(self.weights.node.iter().all(|v| v.abs() <= MAX_WEIGHT), "weights.node", "numbers up to 1e12")?;
        let rewards = 0.0..=MAX_WEIGHT;
        value(
            self.weights.edge.iter().all(|v| rewards.contains(v)),
            "weights.edge",
            "numbers from 0 to 1e12",
        )?;
        value((1e-12..=1e12).contains(&self.temperature), "temperature", "a number from 1e-12 to 1e12")
    }
}

fn decode(text: &str) -> Result<Vec<f32>, IamnFileError> {
    let refused =
        || IamnFileError::Value { field: "exemplars", expected: "base64 of 32-bit numbers up to 1e8" };
    let bytes = STANDARD.decode(text).map_err(|_| refused())?;
    let (words, rest) = bytes.as_chunks::<4>();
    let values: Vec<f32> = words.iter().map(|&word| f32::from_le_bytes(word)).collect();
    if rest.is_empty() && values.iter().all(|v| v.abs() <= MAX_VALUE) { Ok(values) } else { Err(refused()) }
}
