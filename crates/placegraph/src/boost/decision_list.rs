//! The probabilistic decision list: K − 1 of the K one-against-all classifiers in some order; the last class gets the
//! remainder (Sect. 4.3, Eq. 4.5). Cost: O(K) per example, given its scores.
//!
//! **Deviations**: probabilities are floored at 10⁻⁶, because the relaxation multiplies them and could never revive a
//! zero; a temperature softens the confidences (see [`super::confidence`]).

use rayon::prelude::*;

use super::scores::{CompiledClassifiers, Scores};
use super::stump::{StrongClassifier, confidence};
use crate::features::{FeatureId, Job, evaluate};
use crate::grid::{Cell, OccupancyGrid};
use crate::labels::{Label, LabelField, LabelSet};
use crate::progress::Progress;
use crate::scan::{Instructions, ScanConfig};

/// No class gets a smaller probability than this (before its row is scaled to sum 1).
pub const P_FLOOR: f64 = 1e-6;

/// Rows of scores that a thread takes at a time.
const BLOCK: usize = 4096;

/// A multi-class classifier made of binary ones.
#[derive(Clone, Debug, PartialEq)]
pub struct DecisionList {
    /// All K labels in the order of the list; the last is the remainder, whose classifier is not used.
    pub order: Vec<Label>,
    /// The classifier of every class, in the order of the labels.
    pub classifiers: Vec<StrongClassifier>,
    /// Divides the scores before they become confidences, above 0; 1 is the chapter's confidence.
    pub temperature: f64,
}

impl DecisionList {
    /// The features that the stumps use, in ascending order.
    pub fn columns(&self) -> Vec<FeatureId> {
        CompiledClassifiers::new(&self.classifiers).columns().to_vec()
    }

    /// The distribution over the classes for an example with `scores`, one per class.
    pub fn probabilities(&self, scores: &[f32]) -> [f64; LabelSet::MAX] {
        let mut p = [0.0; LabelSet::MAX];
        let mut remaining = 1.0;
        for (k, label) in self.order.iter().enumerate() {
            let last = k + 1 == self.order.len();
            let (yes, no) =
                if last { (1.0, 0.0) } else { confidence(scores[label.index()].into(), self.temperature) };
            // Eq. (4.5): p_k = C_k⁺ Π_{j<k} (1 − C_j⁺).
            p[label.index()] = remaining * yes;
            remaining *= no;
        }
        let classes = &mut p[..self.order.len()];
        let sum: f64 = classes
            .iter_mut()
            .map(|p| {
                *p = p.max(P_FLOOR);
                *p
            })
            .sum();
        for p in classes {
            *p /= sum;
        }
        p
    }

    /// The distribution over the classes for every example of `scores`.
    pub fn classify(&self, scores: &Scores) -> LabelField {
        let n_labels = self.order.len();
        assert_eq!(scores.n_classes(), n_labels, "a score per class");
        let mut values = scores.values().to_vec();
        values.par_chunks_mut(BLOCK * n_labels).for_each(|rows| self.to_distributions(rows));
        LabelField::from_rows(n_labels, values)
    }

    /// Writes the distribution over the classes for `cells`, free cells of the map in row-major order: K numbers of
    /// `field` for each. Scans are cast, measured and dropped block by block.
    ///
    /// Cost: that of the features in use, and a comparison and an addition for every cell and stump.
    ///
    /// # Panics
    /// If `field` has not K numbers for each cell, or the cells are not in row-major order or lie outside the map.
    pub fn classify_cells(
        &self,
        grid: &OccupancyGrid,
        cells: &[Cell],
        config: &ScanConfig,
        progress: &dyn Progress,
        field: &mut [f32],
    ) {
        assert_eq!(field.len(), cells.len() * self.order.len(), "a number per cell and class");
        let classifiers = CompiledClassifiers::new(&self.classifiers);
        let instructions = Instructions::default();
        let job = Job { grid, cells, columns: classifiers.columns(), config, progress, instructions };
        evaluate(&job, field, |block, rows| {
            classifiers.score_rows(|column| block.column(column), rows);
            self.to_distributions(rows);
        });
    }

    /// Replaces scores by distributions, K numbers per example.
    fn to_distributions(&self, rows: &mut [f32]) {
        for row in rows.chunks_exact_mut(self.order.len()) {
            let p = self.probabilities(row);
            for (value, p) in row.iter_mut().zip(p) {
                *value = p as f32;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(order: &[u8], temperature: f64) -> DecisionList {
        let n = order.len();
        let order = order.iter().copied().map(Label).collect();
        DecisionList { order, classifiers: vec![StrongClassifier::default(); n], temperature }
    }

    /// Scores whose confidences are 4/5, 1/5 and 1/2.
    const SCORES: [f32; 3] = [std::f32::consts::LN_2, -std::f32::consts::LN_2, 0.0];

    fn close(found: &[f64], expected: &[f64]) -> bool {
        found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-7)
    }

    #[test]
    fn eq_4_5_two_classifiers_and_the_remainder() {
        let p = list(&[0, 1, 2], 1.0).probabilities(&SCORES);
        assert!(close(&p, &[0.8, 0.2 * 0.2, 0.2 * 0.8]), "{p:?}");
        let p = list(&[2, 1, 0], 1.0).probabilities(&SCORES);
        assert!(close(&p, &[0.5 * 0.8, 0.5 * 0.2, 0.5]), "{p:?}");
    }

    #[test]
    fn eq_4_5_with_two_classes_is_one_classifier() {
        let p = list(&[1, 0], 1.0).probabilities(&SCORES[..2]);
        assert!(close(&p, &[0.8, 0.2]), "{p:?}");
    }

    #[test]
    fn the_blocks_of_many_examples_end_between_two_of_them() {
        let list = list(&[0, 1, 2], 1.0);
        let n = 2 * BLOCK + 5;
        let field = list.classify(&Scores::from_rows(3, SCORES.repeat(n)));
        let one = list.classify(&Scores::from_rows(3, SCORES.to_vec()));
        assert!((0..n).all(|node| field.row(node) == one.row(0)));
    }

    #[test]
    fn a_temperature_divides_the_scores() {
        let halved = SCORES.map(|score| score / 2.0);
        let expected = list(&[0, 1, 2], 1.0).probabilities(&halved);
        assert!(close(&list(&[0, 1, 2], 2.0).probabilities(&SCORES), &expected));
    }

    #[test]
    fn no_class_is_ruled_out() {
        let p = list(&[0, 1, 2], 1.0).probabilities(&[500.0, 500.0, 500.0]);
        assert!(close(&p, &[1.0 / (1.0 + 2e-6), 1e-6, 1e-6]) && p[1] > 0.0 && p[2] > 0.0, "{p:?}");
        let field = list(&[0, 1, 2], 1.0).classify(&Scores::from_rows(3, vec![500.0; 6]));
        assert_eq!(field.most_likely(), [Label(0); 2]);
    }
}
