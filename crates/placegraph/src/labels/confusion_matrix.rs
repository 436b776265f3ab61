//! Counts of true and found labels.

use serde::Serialize;

use super::Label;

/// Counts of each pair of true and found label, and the rates that follow; `None` if a rate would be 0/0.
///
/// # Examples
/// ```
/// use placegraph::labels::{ConfusionMatrix, Label};
///
/// let (room, doorway) = (Label(0), Label(1));
/// let found = ConfusionMatrix::of(&[room, room, doorway], &[room, doorway, doorway], 2);
/// assert_eq!(found.accuracy(), Some(2.0 / 3.0));
/// assert_eq!((found.precision(doorway), found.recall(doorway)), (Some(0.5), Some(1.0)));
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ConfusionMatrix {
    /// Counts by true label (row) and found label (column). The last column counts cells for which no label was
    /// found; these are wrong.
    pub counts: Vec<Vec<u64>>,
}

impl ConfusionMatrix {
    /// An empty matrix for `n_labels` labels.
    pub fn new(n_labels: usize) -> Self {
        Self { counts: vec![vec![0; n_labels + 1]; n_labels] }
    }

    /// Counts `labels` against the labels `found` at the same positions.
    ///
    /// # Panics
    /// If a label is not below `n_labels`.
    pub fn of(labels: &[Label], found: &[Label], n_labels: usize) -> Self {
        let mut confusion = Self::new(n_labels);
        for (&label, &found) in labels.iter().zip(found) {
            confusion.count(label, Some(found));
        }
        confusion
    }

    /// Counts one more pair.
    ///
    /// # Panics
    /// If a label is not one of those counted.
    pub fn count(&mut self, label: Label, found: Option<Label>) {
        let column = found.map_or(self.counts.len(), Label::index);
        self.counts[label.index()][column] += 1;
    }

    /// Adds another matrix of the same labels.
    ///
    /// # Panics
    /// If the number of labels differs.
    pub fn add(&mut self, other: &Self) {
        assert_eq!(self.counts.len(), other.counts.len(), "the same labels");
        for (own, other) in self.counts.iter_mut().flatten().zip(other.counts.iter().flatten()) {
            *own += other;
        }
    }

    /// Number of all counts.
    pub fn total(&self) -> u64 {
        self.counts.iter().flatten().sum()
    }

    /// Number of correct ones.
    pub fn n_correct(&self) -> u64 {
        (0..self.counts.len()).map(|k| self.counts[k][k]).sum()
    }

    /// Number of those that truly have `label`.
    pub fn n_true(&self, label: Label) -> u64 {
        self.counts[label.index()].iter().sum()
    }

    /// Number of those that were found as `label`.
    pub fn n_found(&self, label: Label) -> u64 {
        self.counts.iter().map(|row| row[label.index()]).sum()
    }

    /// Accuracy: the share of correct ones.
    pub fn accuracy(&self) -> Option<f64> {
        ratio(self.n_correct(), self.total())
    }

    /// Precision: the share of correct ones among those found as `label`.
    pub fn precision(&self, label: Label) -> Option<f64> {
        ratio(self.hits(label), self.n_found(label))
    }

    /// Recall: the share of correct ones among those that truly have `label`.
    pub fn recall(&self, label: Label) -> Option<f64> {
        ratio(self.hits(label), self.n_true(label))
    }

    /// Harmonic mean of precision and recall, 2 tp / (2 tp + fp + fn).
    pub fn f1(&self, label: Label) -> Option<f64> {
        ratio(2 * self.hits(label), self.n_true(label) + self.n_found(label))
    }

    /// Intersection over union, tp / (tp + fp + fn).
    pub fn iou(&self, label: Label) -> Option<f64> {
        ratio(self.hits(label), self.n_true(label) + self.n_found(label) - self.hits(label))
    }

    /// Mean F1 of the labels that occur, as true or as found.
    pub fn macro_f1(&self) -> Option<f64> {
        let f1: Vec<f64> = (0..self.counts.len()).filter_map(|k| self.f1(Label(k as u8))).collect();
        (!f1.is_empty()).then(|| f1.iter().sum::<f64>() / f1.len() as f64)
    }

    /// True positives.
    fn hits(&self, label: Label) -> u64 {
        self.counts[label.index()][label.index()]
    }
}

/// `part / whole`, or `None` for 0/0.
pub(crate) fn ratio(part: u64, whole: u64) -> Option<f64> {
    (whole > 0).then(|| part as f64 / whole as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn macro_f1_by_hand() {
        // Class 0: 3 right, 1 missed; class 1: none found; F1 of 6/7 and 0. A class that never occurs does not count.
        let of = |counts: [[u64; 3]; 2]| {
            ConfusionMatrix { counts: counts.map(Vec::from).into() }.macro_f1().unwrap()
        };
        assert!((of([[3, 1, 0], [0, 0, 0]]) - 3.0 / 7.0).abs() < 1e-12);
        assert!((of([[3, 0, 0], [0, 0, 0]]) - 1.0).abs() < 1e-12);
        assert_eq!(ConfusionMatrix::new(2).macro_f1(), None);
    }
}
