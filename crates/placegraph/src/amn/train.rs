//! Labeled maps → instance-based network: selection of features, exemplars, the choice of M and C on held-out blocks,
//! and the weights (Sect. 4.6).
//!
//! Cost: cells × exemplars × features for the distances, once, whatever is validated; then some tens of inferences per
//! block, M and C, two fifths of them in parallel at best.
//!
//! **Deviations** from the chapter: a training cell's own exemplar and all within [`IamnConfig::exclusion_m`] do not
//! count as its neighbors. The cell itself would always be at distance 0, and cells beside it nearly so; the weights
//! would trust distances that no new map has. M and C, about which the chapter says nothing, are those with the best
//! macro-averaged F1 on blocks of columns left out in turn.

use rayon::prelude::*;

use super::cells::{LabeledCells, Part, TrainingCells};
use super::confidence;
use super::iamn::{IamnModel, Standardization};
use super::infer;
use super::learn::{Example, LearnConfig, Learned, Learner};
use super::model::Weights;
use crate::features::select::{self, SelectConfig, Selection};
use crate::labels::{Label, Labeling};
use crate::progress::{Progress, Stage};

/// How an instance-based network is trained.
#[derive(Clone, Debug, PartialEq)]
pub struct IamnConfig {
    /// Which features are selected.
    pub select: SelectConfig,
    /// Values of M to try. Default 1 alone.
    pub n_neighbors: Vec<usize>,
    /// Values of C to try, ascending, for losses per cell. Default 10 and 100.
    pub costs: Vec<f64>,
    /// Exemplars closer than this to a training cell, along both axes of its map, do not count for it. Default 1 m.
    pub exclusion_m: f64,
    /// Parts of every map that validation holds out in turn. Default 4.
    pub n_blocks: usize,
    /// Of a class with more cells, evenly many in map order become exemplars. Default 8000.
    pub max_exemplars_per_class: usize,
    /// How weights are learned.
    pub learn: LearnConfig,
}

impl Default for IamnConfig {
    fn default() -> Self {
        Self {
            select: SelectConfig::default(),
            n_neighbors: vec![1],
            costs: vec![10.0, 100.0],
            exclusion_m: 1.0,
            n_blocks: 4,
            max_exemplars_per_class: 8000,
            learn: LearnConfig::default(),
        }
    }
}

/// How training went.
#[derive(Clone, Debug, PartialEq)]
pub struct IamnReport {
    /// The features, with their scores.
    pub selection: Selection,
    /// What every M and C reached on held-out blocks.
    pub validation: Vec<Validated>,
    /// Which of them was taken.
    pub best: usize,
    /// The weights' objective and how learning ended.
    pub learned: Learned,
    /// Training cells by true (row) and found (column) label, K × K; near exemplars did not count for them.
    pub training_confusion: Vec<u64>,
}

/// What one choice of M and C reached on held-out blocks.
#[derive(Clone, Debug, PartialEq)]
pub struct Validated {
    /// M.
    pub n_neighbors: usize,
    /// C.
    pub cost: f64,
    /// Cells by true (row) and found (column) label, K × K.
    pub confusion: Vec<u64>,
    /// Mean F1 over the classes.
    pub macro_f1: f64,
}

/// Learns from `cells`.
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

    let whole: Vec<Part<'_>> = cells.parts(n_neighbors, |_| true, |_| true);
    let learned = Learner::new(&examples(&whole), n_labels, &config.learn).fit(cost);
    let on_training = label_parts(&whole, &learned.weights, config);
    let training_confusion = confusion(&on_training.labels, &on_training.found, n_labels);
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
            let confusion = confusion(&together.labels, &together.found, cells.n_labels);
            let macro_f1 = macro_f1(&confusion, cells.n_labels);
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
fn label_parts(parts: &[Part<'_>], weights: &Weights, config: &IamnConfig) -> HeldOut {
    let mut held_out = HeldOut::default();
    for Part { graph, features, labels, .. } in parts {
        let potentials = weights.potentials(features, config.learn.connectivity);
        let found = infer::expand(graph, &potentials, &potentials.best_alone());
        held_out.scores.extend(confidence::conditional_scores(graph, &potentials, &found));
        held_out.labels.extend(labels);
        held_out.found.extend(found);
    }
    held_out
}

fn confusion(labels: &[Label], found: &[Label], n_labels: usize) -> Vec<u64> {
    let mut counts = vec![0; n_labels * n_labels];
    for (label, found) in labels.iter().zip(found) {
        counts[label.index() * n_labels + found.index()] += 1;
    }
    counts
}

/// Mean over the classes of 2 TP / (2 TP + FP + FN); classes that do not occur are left out.
fn macro_f1(confusion: &[u64], n_labels: usize) -> f64 {
    let f1 = |k: usize| {
        let right = confusion[k * n_labels + k];
        let of_class: u64 = confusion[k * n_labels..(k + 1) * n_labels].iter().sum();
        let found: u64 = confusion.iter().skip(k).step_by(n_labels).sum();
        (of_class + found > 0).then(|| 2.0 * right as f64 / (of_class + found) as f64)
    };
    let present: Vec<f64> = (0..n_labels).filter_map(f1).collect();
    present.iter().sum::<f64>() / present.len().max(1) as f64
}

fn examples<'a>(parts: &'a [Part<'_>]) -> Vec<Example<'a>> {
    parts
        .iter()
        .map(|part| Example { graph: &part.graph, features: &part.features, labels: &part.labels })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn macro_f1_by_hand() {
        // Class 0: 3 right, 1 missed; class 1: none found; F1 of 6/7 and 0. A class that never occurs does not count.
        assert!((macro_f1(&[3, 1, 0, 0], 2) - 3.0 / 7.0).abs() < 1e-12);
        assert!((macro_f1(&[3, 0, 0, 0], 2) - 1.0).abs() < 1e-12);
    }
}
