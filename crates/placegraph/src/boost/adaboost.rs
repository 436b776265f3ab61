//! Generalized AdaBoost with decision stumps, one strong classifier per class against all others (Fig. 4.2).
//!
//! Cost O(L n log n) once to sort the columns, then O(L n) a round for every four classes; memory 5 bytes per example
//! and feature in addition to the table.
//!
//! **Deviations**: α has 10⁻⁷ added above and below, so that a perfect stump gets a finite vote; boosting stops
//! after such a stump and when no stump beats chance; both cases are open in Fig. 4.2.

use rayon::prelude::*;

use super::scores::{CompiledClassifiers, table_scores};
use super::sorted_examples::SortedExamples;
use super::stump::{StrongClassifier, WeightedStump};
use super::stump_search::{BestStump, Group, LANES, best_stumps, from_units, to_units};
use crate::features::FeatureTable;
use crate::labels::Label;
use crate::progress::Progress;

/// A stump with |r| below this carries no information; boosting stops before it.
pub const MIN_EDGE: f64 = 1e-9;
/// A stump with |r| of at least this makes no error; boosting stops after it.
pub const PERFECT_EDGE: f64 = 1.0 - 1e-12;
/// Added above and below in α, so that it stays finite at r = 1.
const ALPHA_GUARD: f64 = 1e-7;

/// Largest |F| of a base that weights follow: with more, a single example would have all of the weight.
const MAX_MARGIN: f64 = 8.0;

/// Why no classifier can be trained.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AdaBoostError {
    /// All examples are of one kind.
    #[error("expected examples of class {} and of others, found {positive} and {negative}", label.index())]
    OneSided {
        /// The class.
        label: Label,
        /// Its examples.
        positive: usize,
        /// All other examples.
        negative: usize,
    },
}

/// The distribution D over the examples that one class's classifier has come to.
struct Boosting {
    label: Label,
    weights: Vec<f64>,
    classifier: StrongClassifier,
    done: bool,
}

/// Trains a strong classifier of at most `n_rounds` stumps for each of `n_labels` classes.
///
/// Examples are the rows `rows` of `table`, of the classes `labels`. The classifiers are nested: the first t stumps are
/// what t rounds give.
///
/// # Errors
/// If a class has no example, or has all of them.
///
/// # Panics
/// If there is not one label per row.
pub fn adaboost(
    table: &FeatureTable,
    rows: &[u32],
    labels: &[Label],
    n_labels: usize,
    n_rounds: usize,
    progress: &dyn Progress,
) -> Result<Vec<StrongClassifier>, AdaBoostError> {
    boost_on(table, rows, labels, &vec![StrongClassifier::default(); n_labels], n_rounds, progress)
}

/// Goes on boosting from the classifiers `base`, one per class, as if they had been trained on these examples so far: every
/// example begins with the weight that the base leaves it, `e^(−y F)`. The stumps of the base come first in the result.
///
/// # Errors
/// As [`adaboost`].
///
/// # Panics
/// If there is not one label per row, or the table lacks a feature of the base.
pub fn boost_on(
    table: &FeatureTable,
    rows: &[u32],
    labels: &[Label],
    base: &[StrongClassifier],
    n_rounds: usize,
    progress: &dyn Progress,
) -> Result<Vec<StrongClassifier>, AdaBoostError> {
    let margins = |class: usize, rows: &[u32]| {
        let one = CompiledClassifiers::new(std::slice::from_ref(&base[class]));
        if base[class].stumps.is_empty() {
            Vec::new()
        } else {
            table_scores(table, rows, &one).values().to_vec()
        }
    };
    let mut found = boost_from(table, rows, labels, base.len(), &margins, n_rounds, progress)?;
    for (classifier, base) in found.iter_mut().zip(base) {
        classifier.stumps.splice(0..0, base.stumps.iter().copied());
    }
    Ok(found)
}

/// As [`boost_on`], from scores that something else gives: `margins` has the score of every row for a class, or nothing where
/// there is no earlier classifier. The result has the new stumps alone.
///
/// # Errors
/// As [`adaboost`].
///
/// # Panics
/// If there is not one label per row.
pub fn boost_from(
    table: &FeatureTable,
    rows: &[u32],
    labels: &[Label],
    n_labels: usize,
    margins: &dyn Fn(usize, &[u32]) -> Vec<f32>,
    n_rounds: usize,
    progress: &dyn Progress,
) -> Result<Vec<StrongClassifier>, AdaBoostError> {
    assert_eq!(rows.len(), labels.len(), "one label per row");
    let examples = SortedExamples::new(table, rows, labels, n_labels);
    let class = |label: Label| Boosting::new(label, &margins(label.index(), examples.rows()), &examples);
    let mut classes = (0..n_labels as u8).map(Label).map(class).collect::<Result<Vec<_>, _>>()?;
    for round in 0..n_rounds {
        for (group, classes) in classes.chunks_mut(LANES).enumerate() {
            let weights = classes.iter().map(|class| (!class.done).then_some(&*class.weights)).collect();
            let best = best_stumps(&examples, &Group { first_class: group * LANES, weights });
            classes.par_iter_mut().zip(best).filter(|(class, _)| !class.done).for_each(|(class, best)| {
                class.add(best, &examples);
            });
        }
        progress.advance(round + 1, n_rounds);
        if classes.iter().all(|class| class.done) {
            break;
        }
    }
    Ok(classes.into_iter().map(|class| class.classifier).collect())
}

impl Boosting {
    /// Weights that give half of the mass to the class and half to all others, then those that the `margins` leave.
    fn new(label: Label, margins: &[f32], examples: &SortedExamples<'_>) -> Result<Self, AdaBoostError> {
        let is_positive = &examples.of_class()[label.index()];
        let (positive, negative) = (is_positive.len(), examples.n_examples() - is_positive.len());
        if positive == 0 || negative == 0 {
            return Err(AdaBoostError::OneSided { label, positive, negative });
        }
        // Fig. 4.2: D_1(n) = 1 / 2l for the l positive examples, 1 / 2m for the m negative ones.
        let (of_positive, of_negative) = (0.5 / positive as f64, 0.5 / negative as f64);
        let weight = |n| if is_positive.contains(&n) { of_positive } else { of_negative };
        let mut weights: Vec<f64> = (0..examples.n_examples()).map(weight).collect();
        if !margins.is_empty() {
            for (n, (weight, &margin)) in weights.iter_mut().zip(margins).enumerate() {
                let y = if is_positive.contains(&n) { 1.0 } else { -1.0 };
                *weight *= libm::exp((-y * f64::from(margin)).clamp(-MAX_MARGIN, MAX_MARGIN));
            }
            let sum: f64 = weights.iter().sum();
            for weight in &mut weights {
                *weight /= sum;
            }
        }
        Ok(Self { label, weights, classifier: StrongClassifier::default(), done: false })
    }

    /// One round: takes the best stump into the vote and moves weight to the examples that it gets wrong.
    fn add(&mut self, best: Option<BestStump>, examples: &SortedExamples<'_>) {
        let Some(BestStump { column, stump, edge: r }) = best.filter(|best| best.edge >= MIN_EDGE) else {
            self.done = true;
            return;
        };
        // Fig. 4.2: α = ½ ln((1 + r) / (1 − r)).
        let alpha = 0.5 * libm::log((1.0 + r + ALPHA_GUARD) / (1.0 - r + ALPHA_GUARD));
        self.classifier.stumps.push(WeightedStump { stump, alpha });
        self.done = r >= PERFECT_EDGE;
        // Fig. 4.2: D_{t+1}(n) = D_t(n) e^(−α y h), then Σ D = 1.
        let (right, wrong) = (libm::exp(-alpha), libm::exp(alpha));
        let positive = &examples.of_class()[self.label.index()];
        for ((n, weight), value) in self.weights.iter_mut().enumerate().zip(examples.values(column)) {
            *weight *= if stump.says_yes(value) == positive.contains(&n) { right } else { wrong };
        }
        normalize(&mut self.weights);
    }
}

/// Σ D = 1.
fn normalize(weights: &mut [f64]) {
    let sum = from_units(weights.iter().map(|&weight| to_units(weight)).sum());
    for weight in weights {
        *weight /= sum;
    }
}

#[cfg(test)]
mod tests {
    use super::super::stump::{DecisionStump, Polarity};
    use super::*;
    use crate::features::{FeatureId, FeatureTable};
    use crate::progress::Silent;

    fn boost(table: &FeatureTable, labels: &[u8], n_rounds: usize) -> Vec<StrongClassifier> {
        let labels: Vec<Label> = labels.iter().copied().map(Label).collect();
        let rows: Vec<u32> = (0..labels.len() as u32).collect();
        adaboost(table, &rows, &labels, 2, n_rounds, &Silent).unwrap()
    }

    fn stump(threshold: f32, polarity: Polarity) -> DecisionStump {
        DecisionStump { feature: FeatureId(0), threshold, polarity }
    }

    /// Values 1 to 5, classes 0 0 1 1 0. D_1 = 1/6 for the three of class 0, 1/4 for the two of class 1.
    /// Round 1: "below 2.5" gets the last example wrong: r = 1 − 2/6 = 2/3, α = ½ ln 5.
    /// Then D = 1/6 / (5/6) / 2 = 1/10, 1/10, 3/20, 3/20, 1/2.
    /// Round 2: "above 4.5": wrong are the first two: r = 1 − 2 · 2/10 = 3/5, α = ½ ln 4.
    /// Then wrong ones get 1 / (2 · 0.2), right ones 1 / (2 · 0.8): D = 1/4, 1/4, 3/32, 3/32, 5/16.
    /// Round 3: "below 2.5" has r = 1 − 2 · 5/16 = 3/8; "below 3.5": 3/32 + 5/16 wrong, r = 3/16; "above 4.5": 0;
    /// yes everywhere would be best and is no stump: 3/8, α = ½ ln (11/5).
    #[test]
    fn fig_4_2_three_rounds_by_hand() {
        let table = FeatureTable::from_columns(vec![FeatureId(0)], 5, vec![1.0, 2.0, 3.0, 4.0, 5.0]);
        let class_0 = &boost(&table, &[0, 0, 1, 1, 0], 3)[0];
        let stumps: Vec<DecisionStump> = class_0.stumps.iter().map(|w| w.stump).collect();
        let below = stump(2.5, Polarity::Below);
        assert_eq!(stumps, [below, stump(4.5, Polarity::Above), below]);
        for (found, ratio) in class_0.stumps.iter().zip([5.0f64, 4.0, 11.0 / 5.0]) {
            assert!((found.alpha - 0.5 * ratio.ln()).abs() < 1e-6, "{} {ratio}", found.alpha);
        }
    }

    #[test]
    fn a_perfect_stump_ends_boosting_with_a_finite_vote() {
        let table = FeatureTable::from_columns(vec![FeatureId(0)], 4, vec![1.0, 2.0, 5.0, 6.0]);
        let classifiers = boost(&table, &[1, 1, 0, 0], 10);
        assert_eq!(classifiers[0].stumps.len(), 1);
        assert_eq!(classifiers[0].stumps[0].stump, stump(3.5, Polarity::Above));
        assert_eq!(classifiers[1].stumps[0].stump, stump(3.5, Polarity::Below));
        assert!((classifiers[0].stumps[0].alpha - 0.5 * (2.0f64 / 1e-7).ln()).abs() < 1e-6);
    }

    #[test]
    fn constant_features_give_no_stump() {
        let table = FeatureTable::from_columns(vec![FeatureId(0)], 3, vec![1.0; 3]);
        assert!(boost(&table, &[0, 1, 0], 10)[0].stumps.is_empty());
    }

    #[test]
    fn neighbors_in_f32_are_told_apart() {
        let (low, high) = (1.0f32, 1.0f32.next_up());
        let table = FeatureTable::from_columns(vec![FeatureId(0)], 2, vec![low, high]);
        for labels in [[0, 1], [1, 0]] {
            let classifiers = boost(&table, &labels, 1);
            let yes = |value| classifiers[0].stumps[0].stump.says_yes(value);
            assert_eq!([yes(low), yes(high)], labels.map(|y| y == 0));
        }
    }

    #[test]
    fn ties_go_to_the_first_column_and_the_lowest_threshold() {
        // Both columns split 0 1 0 at either side of the 1, with the same |r|.
        let columns = vec![FeatureId(0), FeatureId(1)];
        let table = FeatureTable::from_columns(columns, 3, vec![1.0, 2.0, 3.0, 3.0, 2.0, 1.0]);
        assert_eq!(boost(&table, &[0, 1, 0], 1)[0].stumps[0].stump, stump(1.5, Polarity::Below));
    }

    #[test]
    fn a_class_without_examples_is_refused() {
        let table = FeatureTable::from_columns(vec![FeatureId(0)], 2, vec![1.0, 2.0]);
        let found = adaboost(&table, &[0, 1], &[Label(0); 2], 2, 1, &Silent);
        assert_eq!(found, Err(AdaBoostError::OneSided { label: Label(0), positive: 2, negative: 0 }));
    }

    #[test]
    fn boosting_goes_on_from_where_it_stopped() {
        // Three columns of noise-like values decide together; classes are drawn so that no stump is perfect.
        let value = |row: u32, column: u32| ((row * 37 + column * 11 + row * row * 7) % 29) as f32;
        let columns: Vec<f32> =
            (0..3).flat_map(|column| (0..40).map(move |row| value(row, column))).collect();
        let table = FeatureTable::from_columns((0..3).map(FeatureId).collect(), 40, columns);
        let rows: Vec<u32> = (0..40).collect();
        let labels: Vec<Label> = rows
            .iter()
            .map(|&row| Label(u8::from(value(row, 0) + value(row, 1) < value(row, 2) + 12.0)))
            .collect();
        let silent = &crate::progress::Silent;
        let whole = adaboost(&table, &rows, &labels, 2, 12, silent).unwrap();
        let half = adaboost(&table, &rows, &labels, 2, 6, silent).unwrap();
        let on = boost_on(&table, &rows, &labels, &half, 6, silent).unwrap();
        for (whole, on) in whole.iter().zip(&on) {
            assert_eq!((whole.stumps.len(), on.stumps.len()), (12, 12));
            for (a, b) in whole.stumps.iter().zip(&on.stumps) {
                assert_eq!(a.stump, b.stump);
                assert!((a.alpha - b.alpha).abs() < 1e-5, "{} {}", a.alpha, b.alpha);
            }
        }
    }
}
