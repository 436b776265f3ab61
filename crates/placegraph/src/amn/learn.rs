//! Max-margin training of an associative Markov network (Sect. 4.6.2): weights for which the true labeling scores
//! higher than every other one, by the loss of the other one.
//!
//! One-slack cutting planes (Joachims, Finley and Yu, Machine Learning 2009): find the labeling that violates the
//! margin most, by inference with the loss added to the node potentials; add its plane; solve the small quadratic
//! program over all planes; stop when the next plane is violated no more than the tolerance. Cost: some tens of
//! inferences.
//!
//! **Deviation**: the chapter solves the quadratic program of Taskar, Chatalbashev and Koller with its variables for
//! every node and edge. The weights are few here, so planes need far less memory; for two labels both have the same
//! solution, for more the program relaxes the inference and the planes approximate it by α-expansion.

use super::model::{Weights, sufficient_statistics};
use super::working_set::{Plane, WorkingSet};
use crate::cuts::{Potentials, expand};
use crate::grid::{CellGraph, Connectivity};
use crate::labels::{Label, Labeling};

/// A labeled map, as the learner uses it.
#[derive(Clone, Copy, Debug)]
pub struct LabeledGraph<'a> {
    /// The labeled cells.
    pub graph: &'a CellGraph,
    /// Node features, one row per node, without the constant.
    pub features: &'a [f32],
    /// The true labels.
    pub labels: &'a [Label],
}

/// The cost of a wrong label.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Loss {
    /// Every wrong cell 1.
    #[default]
    Hamming,
    /// Every wrong cell N / (K N_ŷ), so that all classes weigh the same.
    Balanced,
    /// Every wrong cell √(N / (K N_ŷ)): rare classes weigh more, but not as much as the frequent ones.
    Root,
}

/// How the network is trained.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearnConfig {
    /// The cost of a wrong label.
    pub loss: Loss,
    /// Training ends when no plane is violated by more than this, in loss per cell. Default 1e-3.
    pub tolerance: f64,
    /// Training ends with this many planes at most. Default 300.
    pub max_planes: usize,
    /// Which cells share an edge. Default: eight neighbors.
    pub connectivity: Connectivity,
}

impl Default for LearnConfig {
    fn default() -> Self {
        Self { loss: Loss::Hamming, tolerance: 1e-3, max_planes: 300, connectivity: Connectivity::Eight }
    }
}

/// Why training ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// The next plane was violated within the tolerance.
    Converged,
    /// The number of planes was reached before.
    PlaneLimit,
}

/// Trained weights and how training ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Learned {
    /// The weights with the lowest objective seen.
    pub weights: Weights,
    /// Their objective ½‖w‖² + C ξ.
    pub objective: f64,
    /// A lower bound of the objective over all weights. Objective and gap are exact for two labels. With more labels,
    /// inference may miss the worst labeling, and the objective may be slightly higher.
    pub bound: f64,
    /// Planes in the working set.
    pub n_planes: usize,
    /// Why training ended.
    pub ended: Ended,
}

/// The planes found so far. They hold for every C, so a series of costs shares them.
#[derive(Clone, Debug)]
pub struct Learner<'a> {
    examples: Vec<LabeledGraph<'a>>,
    config: LearnConfig,
    n_nodes: f64,
    loss_of_class: Vec<f64>,
    truth: Vec<Weights>,
    latest: Vec<Labeling>,
    planes: WorkingSet,
}

impl<'a> Learner<'a> {
    /// A learner for `n_labels` labels, without planes.
    ///
    /// # Panics
    /// If an example has not one row of features and one label per node.
    pub fn new(examples: &[LabeledGraph<'a>], n_labels: usize, config: &LearnConfig) -> Self {
        let statistics = |e: &LabeledGraph<'_>| {
            assert_eq!(e.labels.len(), e.graph.n_nodes(), "a label per node");
            sufficient_statistics(e.graph, e.features, e.labels, n_labels, config.connectivity)
        };
        let truth: Vec<Weights> = examples.iter().map(statistics).collect();
        let n_nodes: usize = examples.iter().map(|e| e.labels.len()).sum();
        let n_node_weights = truth[0].node.len();
        Self {
            examples: examples.to_vec(),
            config: *config,
            n_nodes: n_nodes as f64,
            loss_of_class: loss_of_class(examples, n_labels, config.loss),
            truth,
            latest: examples.iter().map(|e| e.labels.to_vec()).collect(),
            planes: WorkingSet::new(n_node_weights + n_labels, n_node_weights),
        }
    }

    /// The weights that minimize ½‖w‖² + `cost` · ξ, where ξ is the largest loss less margin, per node.
    pub fn fit(&mut self, cost: f64) -> Learned {
        let mut best: Option<(f64, Weights)> = None;
        loop {
            let optimum = self.planes.solve(cost);
            let weights = self.weights(&optimum.weights);
            let plane = self.most_violated(&weights, optimum.slack);
            let violation = plane.loss - dot(&plane.gradient, &optimum.weights);
            let norm = dot(&optimum.weights, &optimum.weights);
            let objective = 0.5 * norm + cost * violation.max(optimum.slack);
            if best.as_ref().is_none_or(|(lowest, _)| objective < *lowest) {
                best = Some((objective, weights));
            }
            let ended = if violation <= optimum.slack + self.config.tolerance {
                Ended::Converged
            } else if self.planes.planes.len() >= self.config.max_planes {
                Ended::PlaneLimit
            } else {
                self.planes.planes.push(plane);
                continue;
            };
            let Some((objective, weights)) = best.take() else { continue };
            let n_planes = self.planes.planes.len();
            return Learned { weights, objective, bound: optimum.bound, n_planes, ended };
        }
    }

    fn weights(&self, all: &[f64]) -> Weights {
        let (node, edge) = all.split_at(self.truth[0].node.len());
        Weights { node: node.to_vec(), edge: edge.to_vec() }
    }

    /// The plane of the labeling with the largest loss less margin that α-expansion finds. Starts at the labeling
    /// found last; tries others only where that violates no more than `slack`.
    fn most_violated(&mut self, weights: &Weights, slack: f64) -> Plane {
        let augmented: Vec<Potentials> =
            self.examples.iter().map(|example| self.augment(example, weights)).collect();
        let from_latest: Vec<Labeling> = (0..self.examples.len())
            .map(|e| expand(self.examples[e].graph, &augmented[e], &self.latest[e]))
            .collect();
        self.latest = from_latest;
        let plane = self.plane();
        let flat: Vec<f64> = weights.node.iter().chain(&weights.edge).copied().collect();
        if weights.n_labels() == 2 || plane.loss - dot(&plane.gradient, &flat) > slack + self.config.tolerance
        {
            return plane;
        }
        for (e, example) in self.examples.iter().enumerate() {
            for start in [example.labels.to_vec(), augmented[e].best_alone()] {
                let labeling = expand(example.graph, &augmented[e], &start);
                let score = |y: &[Label]| augmented[e].score(example.graph, y);
                if score(&labeling) > score(&self.latest[e]) {
                    self.latest[e] = labeling;
                }
            }
        }
        self.plane()
    }

    /// S_w(y) + ℓ(y): the potentials with the loss of every wrong label added.
    fn augment(&self, example: &LabeledGraph<'_>, weights: &Weights) -> Potentials {
        let mut potentials = weights.potentials(example.features, self.config.connectivity);
        for (row, truth) in potentials.node.chunks_exact_mut(weights.n_labels()).zip(example.labels) {
            for (k, theta) in row.iter_mut().enumerate() {
                if k != truth.index() {
                    *theta += self.loss_of_class[truth.index()];
                }
            }
        }
        potentials
    }

    /// The plane of the latest labelings: g = (ψ(ŷ) − ψ(y)) / N, b = ℓ(y) / N.
    fn plane(&self) -> Plane {
        let n_labels = self.loss_of_class.len();
        let mut gradient = vec![0.0; self.truth[0].node.len() + n_labels];
        let mut loss = 0.0;
        for ((example, truth), labeling) in self.examples.iter().zip(&self.truth).zip(&self.latest) {
            let LabeledGraph { graph, features, labels } = *example;
            let found = sufficient_statistics(graph, features, labeling, n_labels, self.config.connectivity);
            let difference = truth.node.iter().zip(&found.node).chain(truth.edge.iter().zip(&found.edge));
            gradient
                .iter_mut()
                .zip(difference)
                .for_each(|(g, (truth, found))| *g += (truth - found) / self.n_nodes);
            let wrong = labels.iter().zip(labeling).filter(|(truth, found)| truth != found);
            loss += wrong.map(|(truth, _)| self.loss_of_class[truth.index()]).sum::<f64>() / self.n_nodes;
        }
        Plane { gradient, loss }
    }
}

fn loss_of_class(examples: &[LabeledGraph<'_>], n_labels: usize, loss: Loss) -> Vec<f64> {
    let mut counts = vec![0usize; n_labels];
    for label in examples.iter().flat_map(|e| e.labels) {
        counts[label.index()] += 1;
    }
    let total: usize = counts.iter().sum();
    let balanced = |&n: &usize| total as f64 / (n_labels * n.max(1)) as f64;
    match loss {
        Loss::Hamming => vec![1.0; n_labels],
        Loss::Balanced => counts.iter().map(balanced).collect(),
        Loss::Root => counts.iter().map(|n| balanced(n).sqrt()).collect(),
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
