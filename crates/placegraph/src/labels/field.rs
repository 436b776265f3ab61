//! A probability distribution over the classes for every node.

use super::{Label, Labeling};

/// `n × K` probabilities, node-major: row i is the distribution of node i.
///
/// Stored as `f32`: a field over 100 M cells and three classes is 1.2 GB instead of 2.4, and the relaxation
/// moves half the memory (`docs/method.md`, deviations). Rows sum to 1 within
/// [`LabelField::SUM_TOLERANCE`].
#[derive(Clone, Debug, PartialEq)]
pub struct LabelField {
    n_labels: usize,
    values: Vec<f32>,
}

impl LabelField {
    /// Tolerance of the sum of a row, which is 1.
    pub const SUM_TOLERANCE: f32 = 1e-6 * 4.0;

    /// Makes a field from `values`, `n_labels` per node.
    ///
    /// # Panics
    /// If the length is no multiple of `n_labels`; in debug builds also if a row is no distribution.
    pub fn from_rows(n_labels: usize, values: Vec<f32>) -> Self {
        assert!(n_labels > 0 && values.len().is_multiple_of(n_labels), "n_labels values per node");
        debug_assert!(values.chunks(n_labels).all(|row| {
            row.iter().all(|&p| p >= 0.0) && (row.iter().sum::<f32>() - 1.0).abs() <= Self::SUM_TOLERANCE
        }));
        Self { n_labels, values }
    }

    /// Number of labels K.
    pub fn n_labels(&self) -> usize {
        self.n_labels
    }

    /// Number of nodes n.
    pub fn n_nodes(&self) -> usize {
        self.values.len() / self.n_labels
    }

    /// The distribution of `node`.
    pub fn row(&self, node: usize) -> &[f32] {
        &self.values[node * self.n_labels..(node + 1) * self.n_labels]
    }

    /// All probabilities, node-major.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// All probabilities, to be changed in place: rows must stay distributions.
    pub(crate) fn values_mut(&mut self) -> &mut [f32] {
        &mut self.values
    }

    /// The most probable label of every node; ties go to the lower label.
    pub fn most_likely(&self) -> Labeling {
        self.values.chunks_exact(self.n_labels).map(arg_max).collect()
    }
}

/// The first largest entry of `row`.
fn arg_max(row: &[f32]) -> Label {
    let mut best = 0;
    for (k, &p) in row.iter().enumerate() {
        if p > row[best] {
            best = k;
        }
    }
    Label(best as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ties_go_to_the_lower_label() {
        let field = LabelField::from_rows(2, vec![0.5, 0.5, 0.25, 0.75]);
        assert_eq!(field.most_likely(), [Label(0), Label(1)]);
    }
}
