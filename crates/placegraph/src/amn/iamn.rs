//! The instance-based network in use: selected features → distances to exemplars → potentials → labeling (Sect.
//! 4.6.1, 4.6.4).
//!
//! Cost: queries × exemplars × features for the transform, then a few minimum cuts.
//!
//! **Deviations** from the chapter: features are standardized with the mean and deviation of the training cells, because
//! in raw units the area outweighs all others; a constant is added to the transform, because without it every node score
//! goes through the origin.

use serde::{Deserialize, Serialize};

use super::confidence;
use super::model::Weights;
use super::model_file::IamnFile;
use super::nearest::Exemplars;
use crate::cuts::{Potentials, expand_from_all};
use crate::features::{FeatureId, FeatureTable};
use crate::grid::{CellGraph, Connectivity};
use crate::labels::{Label, LabelField, Labeling};

/// A trained instance-based associative Markov network.
///
/// The edge weights hold for maps of the resolution of the training maps: finer cells have more neighbors of their own
/// class.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "IamnFile", into = "IamnFile")]
pub struct IamnModel {
    /// The features for distances.
    pub standardization: Standardization,
    /// M of Eq. (4.11): how many neighbors per class.
    pub n_neighbors: usize,
    /// Standardized features of the stored cells, one row per exemplar, class after class.
    pub exemplars: Vec<f32>,
    /// Class of every exemplar, ascending.
    pub exemplar_labels: Vec<Label>,
    /// Weights of Eq. (4.9); the node features are the K · M distances, then the scores of another classifier if there
    /// is one.
    pub weights: Weights,
    /// Which cells share an edge.
    pub connectivity: Connectivity,
    /// Temperature that softens confidences, see [`IamnModel::infer`].
    pub temperature: f64,
}

/// The features in use, and the means and deviations that standardize them.
#[derive(Clone, Debug, PartialEq)]
pub struct Standardization {
    /// The features.
    pub features: Vec<FeatureId>,
    /// Their means over the training cells.
    pub mean: Vec<f32>,
    /// Their standard deviations over the training cells, above 0.
    pub deviation: Vec<f32>,
}

/// Distance of a neighbor that does not exist: that between two independent standardized vectors, √(2 L).
pub(super) fn distance_of_missing(n_features: usize) -> f32 {
    (2.0 * n_features as f32).sqrt()
}

impl Standardization {
    /// Mean and deviation of `features` over all rows of `table`. A constant feature gets deviation 1.
    ///
    /// # Panics
    /// If the table lacks a feature.
    pub fn of(table: &FeatureTable, features: &[FeatureId]) -> Self {
        let moments = |&feature: &FeatureId| {
            let values = column(table, feature);
            let n = values.len() as f64;
            let mean = values.iter().map(|&v| v as f64).sum::<f64>() / n;
            let variance = values.iter().map(|&v| (v as f64 - mean).powi(2)).sum::<f64>() / n;
            (mean as f32, if variance > 0.0 { variance.sqrt() as f32 } else { 1.0 })
        };
        let (mean, deviation) = features.iter().map(moments).unzip();
        Self { features: features.to_vec(), mean, deviation }
    }

    /// The standardized features of all rows, row after row.
    ///
    /// # Panics
    /// If the table lacks a feature.
    pub fn rows(&self, table: &FeatureTable) -> Vec<f32> {
        let n_features = self.features.len();
        let mut rows = vec![0.0; table.n_rows() * n_features];
        for (f, &feature) in self.features.iter().enumerate() {
            let (mean, scale) = (self.mean[f], 1.0 / self.deviation[f]);
            for (row, &value) in rows.chunks_exact_mut(n_features).zip(column(table, feature)) {
                row[f] = (value - mean) * scale;
            }
        }
        rows
    }
}

fn column(table: &FeatureTable, feature: FeatureId) -> &[f32] {
    match table.values_of(feature) {
        Some(values) => values,
        None => panic!("the table has a column {}", feature.feature().name),
    }
}

impl IamnModel {
    /// Number of scores of another classifier that a node has in addition to its distances.
    pub fn n_scores(&self) -> usize {
        self.weights.n_features() - self.weights.n_labels() * self.n_neighbors
    }

    /// τ of every row of `table`, Eq. (4.11), or Eq. (4.10) with one neighbor: K · M distances, class by class, ascending.
    ///
    /// # Panics
    /// If the table lacks a feature of the model.
    pub fn transform(&self, table: &FeatureTable) -> Vec<f32> {
        let n_features = self.standardization.features.len();
        let groups: Vec<usize> = self.exemplar_labels.iter().map(|label| label.index()).collect();
        let exemplars = Exemplars::new(n_features, &self.exemplars, self.weights.n_labels(), &groups);
        let queries = self.standardization.rows(table);
        let mut distances = exemplars.nearest(&queries, self.n_neighbors, |_, _| true);
        let missing = distance_of_missing(n_features);
        for distance in &mut distances {
            *distance = if distance.is_finite() { distance.sqrt() } else { missing };
        }
        distances
    }

    /// The potentials of nodes whose node features are the rows of `features`.
    pub fn potentials(&self, features: &[f32]) -> Potentials {
        self.weights.potentials(features, self.connectivity)
    }

    /// Distribution of every node's label by its own potentials, p_i(k) ∝ exp(θ_i(k) / T).
    pub fn alone(&self, potentials: &Potentials) -> LabelField {
        confidence::field(&potentials.node, self.weights.n_labels(), self.temperature)
    }

    /// The labeling of `graph` that maximizes Eq. (4.9), and how certain each label is.
    ///
    /// The distribution of a node is that of its label given the labels found around it, p_i(k) ∝ exp((θ_i(k) + Σ_j λ(k)
    /// [y_j = k]) / T), with T fitted to held-out parts of the training maps. It is conditional, so it knows no doubt about a
    /// whole wrong region; its most probable label is the labeling's, save for ties.
    ///
    /// # Panics
    /// If potentials and nodes differ in number.
    pub fn infer(&self, graph: &CellGraph, potentials: &Potentials) -> (Labeling, LabelField) {
        let labeling = expand_from_all(graph, potentials);
        let scores = confidence::conditional_scores(graph, potentials, &labeling);
        let field = confidence::field(&scores, self.weights.n_labels(), self.temperature);
        (labeling, field)
    }
}

/// Distances and scores of every node side by side: the node features of Eq. (4.9). `distances` has `n_distances`
/// numbers per node, `scores` may be empty.
pub fn side_by_side(distances: Vec<f32>, n_distances: usize, scores: &[f32]) -> Vec<f32> {
    if scores.is_empty() {
        return distances;
    }
    let n_scores = scores.len() * n_distances / distances.len();
    let rows = distances.chunks_exact(n_distances).zip(scores.chunks_exact(n_scores));
    rows.flat_map(|(distances, scores)| distances.iter().chain(scores)).copied().collect()
}

/// Labels and probabilities that a network gives the nodes of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct NetworkLabels {
    /// The labeling that maximizes Eq. (4.9).
    pub labeling: Labeling,
    /// Distribution of every node by its own potentials, [`IamnModel::alone`].
    pub alone: LabelField,
    /// Distribution of every node given the labels found around it, [`IamnModel::infer`].
    pub field: LabelField,
}

/// Labels the nodes of `graph`, whose node features are the rows of `features`, and computes how certain each label
/// is.
///
/// # Panics
/// If rows and nodes differ in number.
pub fn label(graph: &CellGraph, features: &[f32], model: &IamnModel) -> NetworkLabels {
    let potentials = model.potentials(features);
    let (labeling, field) = model.infer(graph, &potentials);
    NetworkLabels { labeling, alone: model.alone(&potentials), field }
}
