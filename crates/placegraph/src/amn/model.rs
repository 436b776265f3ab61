//! The associative Markov network: log-linear potentials whose edges reward equal labels (Sect. 4.6, Eq. 4.9).

use serde::{Deserialize, Serialize};

use crate::cuts::{Potentials, agreeing_edges};
use crate::grid::{CellGraph, Connectivity};
use crate::labels::Label;

/// Weights w of Eq. (4.9). The edge features x_ij are 1, so an edge weight is the reward of two neighbors with the
/// same label.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Weights {
    /// w_n, label-major: per label one weight for every node feature, then that of the constant 1.
    pub node: Vec<f64>,
    /// w_e, one per label, none negative.
    pub edge: Vec<f64>,
}

impl Weights {
    /// Zero weights for `n_labels` labels and `n_features` node features.
    pub fn zero(n_labels: usize, n_features: usize) -> Self {
        Self { node: vec![0.0; n_labels * (n_features + 1)], edge: vec![0.0; n_labels] }
    }

    /// Number of labels K.
    pub fn n_labels(&self) -> usize {
        self.edge.len()
    }

    /// Number of node features, without the constant.
    pub fn n_features(&self) -> usize {
        self.node.len() / self.n_labels() - 1
    }

    /// Node potentials w_n(k) · (x_i, 1) of the rows of `features`, and edge potentials: the logarithms of Eq. (4.9).
    pub fn potentials(&self, features: &[f32], connectivity: Connectivity) -> Potentials {
        let n_features = self.n_features();
        let mut node = Vec::with_capacity(features.len() / n_features * self.n_labels());
        for x in features.chunks_exact(n_features) {
            node.extend(self.node.chunks_exact(n_features + 1).map(|weights| {
                let products = weights.iter().zip(x).map(|(w, &x)| w * x as f64);
                products.sum::<f64>() + weights[n_features]
            }));
        }
        Potentials { node, edge: self.edge.clone(), connectivity }
    }
}

/// ψ(y): the sums by which the weights are multiplied in the score of `labeling`, in the layout of node and edge
/// weights.
pub fn sufficient_statistics(
    graph: &CellGraph,
    features: &[f32],
    labeling: &[Label],
    n_labels: usize,
    connectivity: Connectivity,
) -> Weights {
    let n_features = features.len() / labeling.len().max(1);
    let mut sums = Weights::zero(n_labels, n_features);
    for (x, label) in features.chunks_exact(n_features.max(1)).zip(labeling) {
        let row = &mut sums.node[label.index() * (n_features + 1)..(label.index() + 1) * (n_features + 1)];
        for (sum, &x) in row.iter_mut().zip(x) {
            *sum += x as f64;
        }
        row[n_features] += 1.0;
    }
    let edges = agreeing_edges(graph, connectivity, labeling, n_labels);
    sums.edge = edges.iter().map(|&n| n as f64).collect();
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::OccupancyGrid;

    #[test]
    fn eq_4_9_score_of_three_cells() {
        let graph = CellGraph::new(&OccupancyGrid::from_ascii(1.0, "...").cells);
        // Label 0 earns 2 x + 1, label 1 earns −x; equal neighbors earn 3 or 5.
        let weights = Weights { node: vec![2.0, 1.0, -1.0, 0.0], edge: vec![3.0, 5.0] };
        let features = [1.0, 0.5, 2.0];
        let labeling = [Label(0), Label(1), Label(1)];
        let score = weights.potentials(&features, Connectivity::Eight).score(&graph, &labeling);
        assert!((score - (3.0 - 0.5 - 2.0 + 5.0)).abs() < 1e-12);
        let psi = sufficient_statistics(&graph, &features, &labeling, 2, Connectivity::Eight);
        assert_eq!(psi, Weights { node: vec![1.0, 1.0, 2.5, 2.0], edge: vec![0.0, 1.0] });
    }
}
