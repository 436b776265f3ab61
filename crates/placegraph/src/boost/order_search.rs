//! The order of the decision list: every one of the K! orders, scored on labeled examples that boosting did not see.
//!
//! The tree of prefixes is walked depth first, so that orders share the work of their common beginnings: cost
//! O(e K! n), a second for eight classes and ten thousand examples.
//!
//! **Deviation**: the chapter compares the orders on the test map (Table 4.1); here they are compared on held-out
//! parts of the training maps.

use rayon::prelude::*;

use super::scores::Scores;
use super::stump::confidence;
use crate::labels::Label;

/// Examples that are walked through the tree together: their state stays in cache.
const BLOCK: usize = 1024;

/// The accuracy of one order of the decision list.
#[derive(Clone, Debug, PartialEq)]
pub struct OrderScore {
    /// The labels in the order of the list.
    pub order: Vec<Label>,
    /// Share of examples whose most probable label is the true one.
    pub accuracy: f64,
    /// Mean of the F1 values of the classes that occur among the examples.
    pub macro_f1: f64,
}

/// Scores all K! orders, in lexicographic order; the best is the first with the largest accuracy.
///
/// `labels` are the true classes of the examples. An example of class k counts `weights[k]` times: it may stand for
/// others that were left out.
///
/// # Panics
/// If there is no example, or not one label per example and one weight per class.
pub fn search_order(scores: &Scores, labels: &[Label], weights: &[u32], temperature: f64) -> Vec<OrderScore> {
    let n_classes = scores.n_classes();
    assert!(!labels.is_empty() && scores.n_examples() == labels.len(), "one label per example");
    assert_eq!(weights.len(), n_classes, "one weight per class");
    let rows = scores.values().par_chunks(BLOCK * n_classes).zip(labels.par_chunks(BLOCK));
    // Counts are integers: they add up to the same in any order.
    let counts = rows
        .fold(Vec::new, |mut counts, (scores, labels)| {
            let mut walk = Walk::new(scores, labels, weights, temperature, &mut counts);
            walk.descend(&mut Vec::new());
            counts
        })
        .reduce(Vec::new, add_counts);
    let totals = totals(labels, weights);
    let mut orders = Vec::new();
    permutations(n_classes, &mut Vec::new(), &mut orders);
    orders.into_iter().zip(counts).map(|(order, counts)| counts.score(order, &totals)).collect()
}

/// Of the examples: those of each class that were found, and those called each class.
#[derive(Clone, Debug)]
struct Counts {
    right: Vec<u64>,
    called: Vec<u64>,
}

impl Counts {
    fn score(&self, order: Vec<Label>, totals: &[u64]) -> OrderScore {
        let accuracy = self.right.iter().sum::<u64>() as f64 / totals.iter().sum::<u64>() as f64;
        // F1 = 2 right / (called + total); classes that do not occur do not count.
        let f1 = |k: usize| 2.0 * self.right[k] as f64 / (self.called[k] + totals[k]) as f64;
        let present: Vec<usize> = (0..totals.len()).filter(|&k| totals[k] > 0).collect();
        let macro_f1 = present.iter().map(|&k| f1(k)).sum::<f64>() / present.len() as f64;
        OrderScore { order, accuracy, macro_f1 }
    }
}

fn totals(labels: &[Label], weights: &[u32]) -> Vec<u64> {
    let mut totals = vec![0; weights.len()];
    for label in labels {
        totals[label.index()] += u64::from(weights[label.index()]);
    }
    totals
}

fn add_counts(mut a: Vec<Counts>, b: Vec<Counts>) -> Vec<Counts> {
    if a.is_empty() {
        return b;
    }
    for (a, b) in a.iter_mut().zip(b) {
        a.right.iter_mut().zip(b.right).for_each(|(a, b)| *a += b);
        a.called.iter_mut().zip(b.called).for_each(|(a, b)| *a += b);
    }
    a
}

fn permutations(n: usize, prefix: &mut Vec<Label>, all: &mut Vec<Vec<Label>>) {
    if prefix.len() == n {
        all.push(prefix.clone());
    }
    for label in (0..n as u8).map(Label) {
        if !prefix.contains(&label) {
            prefix.push(label);
            permutations(n, prefix, all);
            prefix.pop();
        }
    }
}

/// What a prefix of an order has decided of an example.
#[derive(Clone, Copy, Debug)]
struct State {
    /// Π (1 − C_j⁺) over the prefix.
    remaining: f64,
    /// The largest probability so far, and whose it is.
    best_p: f64,
    best: Label,
}

/// A block of examples on its way through the tree of prefixes.
struct Walk<'a> {
    n_classes: usize,
    labels: &'a [Label],
    weights: &'a [u32],
    /// (C⁺, C⁻) of every class, a column of examples each.
    confidences: Vec<(f64, f64)>,
    /// The examples' states after 0, 1, … labels.
    states: Vec<Vec<State>>,
    counts: &'a mut Vec<Counts>,
    n_leaves: usize,
}

impl<'a> Walk<'a> {
    fn new(
        scores: &[f32],
        labels: &'a [Label],
        weights: &'a [u32],
        temperature: f64,
        counts: &'a mut Vec<Counts>,
    ) -> Self {
        let n_classes = weights.len();
        let column = |k: usize| scores.iter().skip(k).step_by(n_classes);
        let confidences =
            (0..n_classes).flat_map(|k| column(k).map(|&f| confidence(f.into(), temperature))).collect();
        let start = State { remaining: 1.0, best_p: -1.0, best: Label(0) };
        let states = vec![vec![start; labels.len()]; n_classes + 1];
        Self { n_classes, labels, weights, confidences, states, counts, n_leaves: 0 }
    }

    /// Appends every label that `prefix` lacks, in ascending order; counts at full length.
    fn descend(&mut self, prefix: &mut Vec<Label>) {
        if prefix.len() == self.n_classes {
            self.count();
            return;
        }
        for label in (0..self.n_classes as u8).map(Label) {
            if !prefix.contains(&label) {
                self.ask(label, prefix.len());
                prefix.push(label);
                self.descend(prefix);
                prefix.pop();
            }
        }
    }

    /// Takes all examples one label further (Eq. 4.5).
    fn ask(&mut self, label: Label, depth: usize) {
        let last = depth + 1 == self.n_classes;
        let n = self.labels.len();
        let confidences = &self.confidences[label.index() * n..(label.index() + 1) * n];
        let (before, after) = self.states.split_at_mut(depth + 1);
        for ((state, next), &(yes, no)) in before[depth].iter().zip(&mut after[0]).zip(confidences) {
            let p = state.remaining * if last { 1.0 } else { yes };
            let better = p > state.best_p || (p >= state.best_p && label < state.best);
            *next = State {
                remaining: state.remaining * no,
                best_p: if better { p } else { state.best_p },
                best: if better { label } else { state.best },
            };
        }
    }

    /// Adds the examples to the counts of the order at whose end they stand.
    fn count(&mut self) {
        if self.counts.len() == self.n_leaves {
            self.counts.push(Counts { right: vec![0; self.n_classes], called: vec![0; self.n_classes] });
        }
        let counts = &mut self.counts[self.n_leaves];
        for (state, &label) in self.states[self.n_classes].iter().zip(self.labels) {
            let n = u64::from(self.weights[label.index()]);
            counts.called[state.best.index()] += n;
            counts.right[label.index()] += if state.best == label { n } else { 0 };
        }
        self.n_leaves += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Class 2 is wrong about the first example: it is found only where class 0 is asked before class 2.
    #[test]
    fn the_order_matters_where_classifiers_disagree() {
        let scores = Scores::from_rows(3, vec![2.0, -2.0, 3.0, -2.0, 2.0, -3.0]);
        let found = search_order(&scores, &[Label(0), Label(1)], &[1; 3], 1.0);
        let orders: Vec<Vec<u8>> = found.iter().map(|s| s.order.iter().map(|l| l.0).collect()).collect();
        assert_eq!(orders[0], [0, 1, 2]);
        assert_eq!(orders[5], [2, 1, 0]);
        let accuracy: Vec<f64> = found.iter().map(|s| s.accuracy).collect();
        assert_eq!(accuracy, [1.0, 1.0, 1.0, 0.5, 0.5, 0.5]);
        // Where class 2 comes first, class 1 is found, F1 = 1, class 0 is not, F1 = 0; class 2 does not occur.
        assert!((found[4].macro_f1 - 0.5).abs() < 1e-15 && (found[0].macro_f1 - 1.0).abs() < 1e-15);
    }

    #[test]
    fn examples_count_as_often_as_the_cells_they_stand_for() {
        let scores = Scores::from_rows(2, vec![2.0, -2.0, 2.0, -2.0]);
        let found = search_order(&scores, &[Label(0), Label(1)], &[3, 1], 1.0);
        assert!((found[0].accuracy - 0.75).abs() < 1e-15);
        // F1 of class 0: 2 · 3 / (4 + 3); class 1 is never found.
        assert!((found[0].macro_f1 - 3.0 / 7.0).abs() < 1e-15);
    }

    #[test]
    fn many_examples_score_as_few_in_the_same_shares() {
        let rows = [2.0, -2.0, 3.0, -2.0, 2.0, -3.0];
        let few = search_order(&Scores::from_rows(3, rows.to_vec()), &[Label(0), Label(1)], &[1; 3], 1.0);
        let labels = [Label(0), Label(1)].repeat(10_000);
        let many = search_order(&Scores::from_rows(3, rows.repeat(10_000)), &labels, &[1; 3], 1.0);
        for (few, many) in few.iter().zip(&many) {
            assert_eq!(few.order, many.order);
            assert!((few.accuracy - many.accuracy).abs() + (few.macro_f1 - many.macro_f1).abs() < 1e-12);
        }
    }
}
