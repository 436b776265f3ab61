//! Labeled maps → instance-based network: selection of features, exemplars, the choice of M and C on held-out blocks,
//! and the weights (Sect. 4.6).
//!
//! Cost: cells × exemplars × features for the distances, once, for any validation; then some tens of inferences per
//! block, M and C, two fifths of them in parallel at best.
//!
//! **Deviations** from the chapter: a training cell's own exemplar and all within [`IamnConfig::exclusion_m`] do not
//! count as its neighbors. The cell itself would always be at distance 0, and cells next to it nearly so; the weights
//! would trust distances that no new map has. M and C, about which the chapter says nothing, are those with the best
//! macro-averaged F1 on blocks of columns left out in turn.

use rayon::prelude::*;

use super::cells::{LabeledCells, MapPart, TrainingCells};
use super::confidence;
use super::config::IamnConfig;
use super::iamn::{IamnModel, Standardization};
use super::learn::{LabeledGraph, Learned, Learner};
use super::model::Weights;
use crate::cuts::expand;
use crate::features::select::{self, Selection};
use crate::labels::{ConfusionMatrix, Labeling};
use crate::progress::{Progress, Stage};

/// The training report.
#[derive(Clone, Debug, PartialEq)]
pub struct IamnReport {
    /// The features, with their scores.
    pub selection: Selection,
    /// The results of every M and C on held-out blocks.
    pub validation: Vec<Validated>,
    /// The chosen one.
    pub best: usize,
    /// The objective of the weights, and how training ended.
    pub learned: Learned,
    /// Training cells by true and found label; near exemplars did not count for them.
    pub training_confusion: ConfusionMatrix,
}

/// The result of one M and C on held-out blocks.
#[derive(Clone, Debug, PartialEq)]
pub struct Validated {
    /// M.
    pub n_neighbors: usize,
    /// C.
    pub cost: f64,
    /// Cells by true and found label.
    pub confusion: ConfusionMatrix,
    /// Mean F1 over the classes.
    pub macro_f1: f64,
}

/// Trains a network on `cells`.
///
/// # Panics
/// If rows, labels, scores and nodes differ in number, no map is given, or a list of the configuration is empty.
pub fn train(
    cells: &LabeledCells<'_>,
    config: &IamnConfig,
    progress: &dyn Progress,
) -> (IamnModel, IamnReport) {
    progress.begin(Stage::Select);
    let &LabeledCells { table, labels, n_labels, .. } = cells;
    let selection = select::select(table, labels, &config.select);
    let features: Vec<_> = selection.chosen.iter().map(|chosen| chosen.feature).collect();
    let standardization = Standardization::of(table, &features);
    let cells = TrainingCells::new(cells, &standardization, config);

    progress.begin(Stage::Learn);
    let (validation, held_out) = validate(&cells, config, progress);
    let best = (0..validation.len())
        .fold(0, |best, i| if validation[i].macro_f1 > validation[best].macro_f1 { i } else { best });
    let Validated { n_neighbors, cost, .. } = validation[best];
    let temperature = confidence::fit_temperature(&held_out[best].scores, &held_out[best].labels, n_labels);

    let whole: Vec<MapPart<'_>> = cells.parts(n_neighbors, |_| true, |_| true);
    let learned = Learner::new(&examples(&whole), n_labels, &config.learn).fit(cost);
    let on_training = label_parts(&whole, &learned.weights, config);
    let training_confusion = ConfusionMatrix::of(&on_training.labels, &on_training.found, n_labels);
    let model = IamnModel {
        n_neighbors,
        exemplars: cells.exemplar_rows,
        exemplar_labels: cells.exemplar_labels,
        weights: learned.weights.clone(),
        connectivity: config.learn.connectivity,
        temperature,
        standardization,
    };
    (model, IamnReport { selection, validation, best, learned, training_confusion })
}

/// What validation found for one M and C, over all held-out blocks.
#[derive(Clone, Debug, Default)]
struct HeldOut {
    scores: Vec<f64>,
    labels: Labeling,
    found: Labeling,
}

/// Every M and C, on every block in turn.
fn validate(
    cells: &TrainingCells<'_>,
    config: &IamnConfig,
    progress: &dyn Progress,
) -> (Vec<Validated>, Vec<HeldOut>) {
    let runs: Vec<(usize, usize)> =
        config.n_neighbors.iter().flat_map(|&m| (0..config.n_blocks).map(move |block| (m, block))).collect();
    let done = std::sync::atomic::AtomicUsize::new(0);
    let of_runs: Vec<Vec<HeldOut>> = runs
        .par_iter()
        .map(|&(n_neighbors, block)| {
            let found = hold_out(cells, n_neighbors, block, config);
            progress.advance(done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1, runs.len());
            found
        })
        .collect();
    let (mut validation, mut all) = (Vec::new(), Vec::new());
    for (of_blocks, &n_neighbors) in of_runs.chunks(config.n_blocks).zip(&config.n_neighbors) {
        for (c, &cost) in config.costs.iter().enumerate() {
            let mut together = HeldOut::default();
            for of_costs in of_blocks {
                together.scores.extend(&of_costs[c].scores);
                together.labels.extend(&of_costs[c].labels);
                together.found.extend(&of_costs[c].found);
            }
            let confusion = ConfusionMatrix::of(&together.labels, &together.found, cells.n_labels);
            let macro_f1 = confusion.macro_f1().unwrap_or(0.0);
            validation.push(Validated { n_neighbors, cost, confusion, macro_f1 });
            all.push(together);
        }
    }
    (validation, all)
}

/// Learns without `block` and labels it, for every cost; the costs share their planes.
fn hold_out(
    cells: &TrainingCells<'_>,
    n_neighbors: usize,
    block: usize,
    config: &IamnConfig,
) -> Vec<HeldOut> {
    let rest = cells.parts(n_neighbors, |b| b != block, |b| b != block);
    let tests = cells.parts(n_neighbors, |b| b == block, |b| b != block);
    let mut learner = Learner::new(&examples(&rest), cells.n_labels, &config.learn);
    let of_cost = |&cost: &f64| label_parts(&tests, &learner.fit(cost).weights, config);
    config.costs.iter().map(of_cost).collect()
}

/// Labels all `parts`.
fn label_parts(parts: &[MapPart<'_>], weights: &Weights, config: &IamnConfig) -> HeldOut {
    let mut held_out = HeldOut::default();
    for MapPart { graph, features, labels, .. } in parts {
        let potentials = weights.potentials(features, config.learn.connectivity);
        let found = expand(graph, &potentials, &potentials.best_alone());
        held_out.scores.extend(confidence::conditional_scores(graph, &potentials, &found));
        held_out.labels.extend(labels);
        held_out.found.extend(found);
    }
    held_out
}

fn examples<'a>(parts: &'a [MapPart<'_>]) -> Vec<LabeledGraph<'a>> {
    parts
        .iter()
        .map(|part| LabeledGraph { graph: &part.graph, features: &part.features, labels: &part.labels })
        .collect()
}
