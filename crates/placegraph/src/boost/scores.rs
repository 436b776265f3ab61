//! Scores F(x) of several strong classifiers at once (Fig. 4.2), over blocks of feature values.
//!
//! Cost: one comparison and one addition for every example and stump, over neighboring examples side by side.
//!
//! **Deviation**: votes and sums are `f32`, in the order of the stumps; a test bounds the difference from the sum in
//! `f64` (`tests/labeling/boost_oracle.rs`).

use rayon::prelude::*;

use super::stump::{Polarity, StrongClassifier};
use crate::features::{FeatureId, FeatureTable};
use crate::scan::Instructions;

/// Examples that [`table_scores`] evaluates together: their columns stay in cache.
const BLOCK: usize = 256;

/// A stump in the one form that the inner loop knows: `vote` where the value lies below `below`, `−vote` elsewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cut {
    column: u32,
    below: f32,
    vote: f32,
}

/// Strong classifiers prepared for the evaluation of many examples.
#[derive(Clone, Debug, PartialEq)]
pub struct CompiledClassifiers {
    columns: Vec<FeatureId>,
    cuts: Vec<Vec<Cut>>,
}

/// `n × K` scores, example-major: the scores F of all K classifiers for an example lie together.
#[derive(Clone, Debug, PartialEq)]
pub struct Scores {
    n_classes: usize,
    values: Vec<f32>,
}

impl CompiledClassifiers {
    /// Prepares `classifiers`.
    pub fn new(classifiers: &[StrongClassifier]) -> Self {
        let stumps = classifiers.iter().flat_map(|classifier| &classifier.stumps);
        let mut columns: Vec<FeatureId> = stumps.map(|w| w.stump.feature).collect();
        columns.sort_unstable();
        columns.dedup();
        let cuts = classifiers.iter().map(|classifier| cuts_of(classifier, &columns)).collect();
        Self { columns, cuts }
    }

    /// The features that the stumps use, in ascending order.
    pub fn columns(&self) -> &[FeatureId] {
        &self.columns
    }

    /// Number of classifiers K.
    pub fn n_classes(&self) -> usize {
        self.cuts.len()
    }

    /// Writes the scores of a block of examples, example-major: `rows` has K for each.
    ///
    /// `column(c)` gives the values of [`CompiledClassifiers::columns`]`[c]`, one an example.
    ///
    /// # Panics
    /// If a column is shorter than the block, or `rows` has not K scores for each of its examples.
    pub(super) fn score_rows<'a>(&self, column: impl Fn(usize) -> &'a [f32], rows: &mut [f32]) {
        let n_classes = self.n_classes();
        let n = rows.len() / n_classes;
        assert_eq!(rows.len(), n * n_classes, "a score per example and class");
        let mut of_class = vec![0.0; n];
        for (class, cuts) in self.cuts.iter().enumerate() {
            of_class.fill(0.0);
            Instructions::default().run(
                #[inline(always)]
                || {
                    for &Cut { column: c, below, vote } in cuts {
                        // Fig. 4.2: F(x) = Σ α h(x).
                        for (score, &value) in of_class.iter_mut().zip(&column(c as usize)[..n]) {
                            *score += if value < below { vote } else { -vote };
                        }
                    }
                },
            );
            for (row, &score) in rows.chunks_exact_mut(n_classes).zip(&of_class) {
                row[class] = score;
            }
        }
    }
}

fn cuts_of(classifier: &StrongClassifier, columns: &[FeatureId]) -> Vec<Cut> {
    let cut_of = |w: &super::WeightedStump| {
        let column = columns.partition_point(|&id| id < w.stump.feature) as u32;
        let vote = w.alpha as f32;
        match w.stump.polarity {
            Polarity::Below => Cut { column, below: w.stump.threshold, vote },
            // Yes above θ is no below the next larger number.
            Polarity::Above => Cut { column, below: w.stump.threshold.next_up(), vote: -vote },
        }
    };
    classifier.stumps.iter().map(cut_of).collect()
}

impl Scores {
    /// Makes the table from `values`, `n_classes` per example.
    ///
    /// # Panics
    /// If the length is no multiple of `n_classes`.
    pub fn from_rows(n_classes: usize, values: Vec<f32>) -> Self {
        assert!(n_classes > 0 && values.len().is_multiple_of(n_classes), "n_classes values per example");
        Self { n_classes, values }
    }

    /// Number of classifiers K.
    pub fn n_classes(&self) -> usize {
        self.n_classes
    }

    /// Number of examples.
    pub fn n_examples(&self) -> usize {
        self.values.len() / self.n_classes
    }

    /// The scores of `example`.
    pub fn row(&self, example: usize) -> &[f32] {
        &self.values[example * self.n_classes..(example + 1) * self.n_classes]
    }

    /// All scores, example-major.
    pub fn values(&self) -> &[f32] {
        &self.values
    }
}

/// The scores of the examples in `rows` of `table`, which has all columns that the classifiers use.
///
/// # Panics
/// If a column is missing.
#[expect(clippy::expect_used, reason = "a documented panic")]
pub fn table_scores(table: &FeatureTable, rows: &[u32], classifiers: &CompiledClassifiers) -> Scores {
    let n_classes = classifiers.n_classes();
    let columns: Vec<&[f32]> =
        classifiers.columns.iter().map(|&id| table.values_of(id).expect("a column per feature")).collect();
    let mut values = vec![0.0; rows.len() * n_classes];
    values.par_chunks_mut(BLOCK * n_classes).zip(rows.par_chunks(BLOCK)).for_each(|(values, rows)| {
        let n = rows.len();
        let gathered: Vec<f32> =
            columns.iter().flat_map(|c| rows.iter().map(|&row| c[row as usize])).collect();
        classifiers.score_rows(|column| &gathered[column * n..(column + 1) * n], values);
    });
    Scores { n_classes, values }
}
