//! How certain each label is: the distribution of a cell's label given its neighbors' labels, softened to fit
//! held-out cells.
//!
//! Max-marginals would need a cut per cell and label. The conditional distribution costs one pass; what it cannot know
//! is that neighbors may be wrong together, which the temperature makes up for on average.

use crate::cuts::Potentials;
use crate::grid::CellGraph;
use crate::labels::{Label, LabelField};

/// θ_i(k) + Σ_j λ(k) [y_j = k] over the neighbors j, node-major: the score of every label if the rest of `labeling`
/// stays.
pub fn conditional_scores(graph: &CellGraph, potentials: &Potentials, labeling: &[Label]) -> Vec<f64> {
    let mut scores = potentials.node.clone();
    for (i, row) in scores.chunks_exact_mut(potentials.n_labels()).enumerate() {
        for j in graph.neighbors(i, potentials.connectivity) {
            let label = labeling[j].index();
            row[label] += potentials.edge[label];
        }
    }
    scores
}

/// The distribution ∝ exp(score / `temperature`) of every node.
pub fn field(scores: &[f64], n_labels: usize, temperature: f64) -> LabelField {
    let mut values = Vec::with_capacity(scores.len());
    for row in scores.chunks_exact(n_labels) {
        let largest = row.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b));
        let exponentials = row.iter().map(|score| ((score - largest) / temperature).exp());
        let sum: f64 = exponentials.clone().sum();
        values.extend(exponentials.map(|e| (e / sum) as f32));
    }
    LabelField::from_rows(n_labels, values)
}

/// Mean −ln p of the true labels, p floored at 1e-12.
pub fn log_loss(scores: &[f64], labels: &[Label], n_labels: usize, temperature: f64) -> f64 {
    let loss = |(row, label): (&[f64], &Label)| {
        let largest = row.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b));
        let sum: f64 = row.iter().map(|score| ((score - largest) / temperature).exp()).sum();
        (sum.ln() - (row[label.index()] - largest) / temperature).min(-(1e-12f64.ln()))
    };
    scores.chunks_exact(n_labels).zip(labels).map(loss).sum::<f64>() / labels.len().max(1) as f64
}

/// The temperature between e⁻⁶ and e⁸ with the smallest [`log_loss`], to a thousandth, by golden section.
pub fn fit_temperature(scores: &[f64], labels: &[Label], n_labels: usize) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let loss = |log_temperature: f64| log_loss(scores, labels, n_labels, log_temperature.exp());
    let (mut low, mut high) = (-6.0, 8.0);
    let (mut left, mut right) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
    let (mut loss_left, mut loss_right) = (loss(left), loss(right));
    while high - low > 1e-3 {
        if loss_left <= loss_right {
            (high, right, loss_right) = (right, left, loss_left);
            left = high - GOLDEN * (high - low);
            loss_left = loss(left);
        } else {
            (low, left, loss_left) = (left, right, loss_right);
            right = low + GOLDEN * (high - low);
            loss_right = loss(right);
        }
    }
    f64::midpoint(low, high).exp()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Connectivity, OccupancyGrid};

    #[test]
    fn neighbors_add_their_reward() {
        let graph = CellGraph::new(&OccupancyGrid::from_ascii(1.0, "...").cells);
        let potentials = Potentials {
            node: vec![1.0, 0.0, 0.0, 0.0, 0.0, 2.0],
            edge: vec![0.5, 0.25],
            connectivity: Connectivity::Four,
        };
        let scores = conditional_scores(&graph, &potentials, &[Label(0), Label(0), Label(1)]);
        assert_eq!(scores, [1.5, 0.0, 0.5, 0.25, 0.5, 2.0]);
        let field = field(&scores, 2, 0.5);
        assert!((field.row(1)[0] as f64 - 1.0 / (1.0 + (-0.5f64).exp())).abs() < 1e-6);
    }

    #[test]
    fn temperature_makes_scores_fit_frequencies() {
        // Three of four cells with a lead of 10 are right: T = 10 / ln 3.
        let scores = [10.0, 0.0].repeat(4);
        let labels = [Label(0), Label(0), Label(1), Label(0)];
        let temperature = fit_temperature(&scores, &labels, 2);
        assert!((temperature - 10.0 / 3f64.ln()).abs() < 0.02, "{temperature}");
    }
}
