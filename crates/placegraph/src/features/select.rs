//! Scalar feature selection: features that separate the classes and are not redundant (Sect. 4.6.3, Eq. 4.12, 4.13,
//! Fig. 4.6).
//!
//! Cost: the pre-filter compares every two columns, O(n L²); the choice of l features costs O(n L l).
//!
//! **Deviations** from the chapter: constant columns and columns that repeat an earlier one are dropped first,
//! because the Fisher ratio of two copies is the same and both would be taken. [`Weighing::Normalized`], the
//! default, centers the correlation and takes the ratio of every two classes as a share of the largest that any
//! feature has for them: as printed, the pair that is easiest to distinguish decides alone, the ratio outweighs any
//! correlation, and correlations of positive features are all close to 1. The sum in Fig. 4.6 runs over the l − 1
//! features chosen before.

use rayon::prelude::*;

use super::{FeatureId, FeatureTable};
use crate::labels::Label;

/// How the two criteria are weighed against each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Weighing {
    /// The Fisher ratio of every two classes in shares of the largest, averaged; the correlation of Pearson.
    #[default]
    Normalized,
    /// As printed: the Fisher ratio as it is, the correlation of values that are not centered.
    Printed,
}

/// How features are selected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SelectConfig {
    /// How many to select. Default 30, as in Sect. 4.8.4.
    pub n_features: usize,
    /// Weight w₁ of the Fisher ratio. Default 1.
    pub fisher_weight: f64,
    /// Weight w₂ of the mean correlation with the features chosen before. Default 1.
    pub correlation_weight: f64,
    /// How the two are made comparable.
    pub weighing: Weighing,
}

impl Default for SelectConfig {
    fn default() -> Self {
        Self { n_features: 30, fisher_weight: 1.0, correlation_weight: 1.0, weighing: Weighing::default() }
    }
}

/// One chosen feature and why.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chosen {
    /// The feature.
    pub feature: FeatureId,
    /// Its Fisher ratio S, Eq. (4.12).
    pub fisher_ratio: f64,
    /// Mean |ρ| with the features chosen before, Eq. (4.13); 0 for the first.
    pub mean_correlation: f64,
    /// What was maximal: w₁ S − w₂ mean |ρ|.
    pub score: f64,
}

/// Why a column was not considered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dropped {
    /// All values are the same.
    Constant(FeatureId),
    /// The first is a multiple of the second, but for a constant and rounding.
    Repeats(FeatureId, FeatureId),
}

/// The selected features and the columns left aside.
#[derive(Clone, Debug, PartialEq)]
pub struct Selection {
    /// The chosen features in the order of choice.
    pub chosen: Vec<Chosen>,
    /// The columns that were not considered.
    pub dropped: Vec<Dropped>,
}

/// Columns with a larger |ρ| are redundant.
pub const REPEATS_ABOVE: f64 = 0.9999;

/// The Fisher ratio of a feature that is constant within two classes and differs between them: a pole of Eq. (4.12).
pub const MAX_FISHER_RATIO: f64 = 1e12;

/// Selects features of `table` that distinguish the classes of `labels`, one label per row.
///
/// Ties go to the earlier column. Fewer than asked come back if the table has fewer distinct columns.
///
/// # Panics
/// If there is not one label per row.
pub fn select(table: &FeatureTable, labels: &[Label], config: &SelectConfig) -> Selection {
    assert_eq!(labels.len(), table.n_rows(), "a label per row");
    let (columns, dropped) = distinct_columns(table);
    let ids = table.columns();
    let ratios: Vec<Vec<f64>> = columns.par_iter().map(|&c| fisher_ratios(table.column(c), labels)).collect();
    let separation = match config.weighing {
        Weighing::Normalized => mean_shares(&ratios),
        Weighing::Printed => ratios.iter().map(|of_pairs| 2.0 * of_pairs.iter().sum::<f64>()).collect(),
    };
    let correlation = |a: &[f32], b: &[f32]| match config.weighing {
        Weighing::Normalized => pearson(a, b),
        Weighing::Printed => raw_correlation(a, b),
    };
    let mut correlations = vec![0.0; columns.len()];
    let mut is_open = vec![true; columns.len()];
    let mut chosen: Vec<Chosen> = Vec::new();
    while chosen.len() < config.n_features.min(columns.len()) {
        // Fig. 4.6: argmax of w₁ S(f) − w₂ / (l − 1) Σ_r |ρ(f_r, f)|
        let mean = |i: usize| correlations[i] / chosen.len().max(1) as f64;
        let score = |i: usize| config.fisher_weight * separation[i] - config.correlation_weight * mean(i);
        let open = (0..columns.len()).filter(|&i| is_open[i]);
        let Some(best) = open.reduce(|best, i| if score(i) > score(best) { i } else { best }) else { break };
        chosen.push(Chosen {
            feature: ids[columns[best]],
            fisher_ratio: 2.0 * ratios[best].iter().sum::<f64>(),
            mean_correlation: mean(best),
            score: score(best),
        });
        is_open[best] = false;
        let latest = table.column(columns[best]);
        correlations
            .par_iter_mut()
            .zip(&columns)
            .for_each(|(sum, &c)| *sum += correlation(latest, table.column(c)).abs());
    }
    Selection { chosen, dropped }
}

/// Numbers of the columns that are neither constant nor repeat an earlier one, and the others with the reason.
fn distinct_columns(table: &FeatureTable) -> (Vec<usize>, Vec<Dropped>) {
    let ids = table.columns();
    let (mut kept, mut dropped): (Vec<usize>, _) = (Vec::new(), Vec::new());
    for (c, &id) in ids.iter().enumerate() {
        let column = table.column(c);
        if column.iter().all(|value| value.to_bits() == column[0].to_bits()) {
            dropped.push(Dropped::Constant(id));
            continue;
        }
        let repeated =
            kept.par_iter().find_first(|&&k| pearson(table.column(k), column).abs() > REPEATS_ABOVE);
        match repeated {
            Some(&k) => dropped.push(Dropped::Repeats(id, ids[k])),
            None => kept.push(c),
        }
    }
    (kept, dropped)
}

/// S of Eq. (4.12): Σ_i Σ_{j≠i} (μ_i − μ_j)² / (σ_i + σ_j), where σ is the variance, as in the chapter.
pub fn fisher_ratio(values: &[f32], labels: &[Label]) -> f64 {
    2.0 * fisher_ratios(values, labels).iter().sum::<f64>()
}

/// (μ_i − μ_j)² / (σ_i + σ_j) of every two classes i < j that have rows.
fn fisher_ratios(values: &[f32], labels: &[Label]) -> Vec<f64> {
    let n_labels = labels.iter().map(|label| label.index() + 1).max().unwrap_or(0);
    let mut n = vec![0.0; n_labels];
    let mut mean = vec![0.0; n_labels];
    let mut variance = vec![0.0; n_labels];
    for (&value, label) in values.iter().zip(labels) {
        n[label.index()] += 1.0;
        mean[label.index()] += value as f64;
    }
    for (mean, &n) in mean.iter_mut().zip(&n) {
        *mean /= f64::max(n, 1.0);
    }
    for (&value, label) in values.iter().zip(labels) {
        variance[label.index()] += (value as f64 - mean[label.index()]).powi(2) / n[label.index()];
    }
    let present: Vec<usize> = (0..n_labels).filter(|&k| n[k] > 0.0).collect();
    let ratio = |i: usize, j: usize| {
        let between = (mean[i] - mean[j]).powi(2);
        // Equal means separate nothing, even where both variances are zero.
        if between > 0.0 { (between / (variance[i] + variance[j])).min(MAX_FISHER_RATIO) } else { 0.0 }
    };
    present
        .iter()
        .enumerate()
        .flat_map(|(a, &i)| present[a + 1..].iter().map(move |&j| (i, j)))
        .map(|(i, j)| ratio(i, j))
        .collect()
}

/// Mean over the pairs of classes of a feature's ratio divided by the largest of that pair.
fn mean_shares(ratios: &[Vec<f64>]) -> Vec<f64> {
    let n_pairs = ratios.first().map_or(0, Vec::len);
    let largest: Vec<f64> =
        (0..n_pairs).map(|pair| ratios.iter().fold(f64::MIN_POSITIVE, |a, r| a.max(r[pair]))).collect();
    let share =
        |of_pairs: &Vec<f64>| of_pairs.iter().zip(&largest).map(|(r, l)| r / l).sum::<f64>() / n_pairs as f64;
    ratios.iter().map(share).collect()
}

/// ρ of Eq. (4.13), centered; 0 if a column is constant.
pub fn pearson(a: &[f32], b: &[f32]) -> f64 {
    let n = a.len() as f64;
    let mean = |x: &[f32]| x.iter().map(|&v| v as f64).sum::<f64>() / n;
    correlation_about(a, mean(a), b, mean(b))
}

/// ρ as Eq. (4.13) prints it: Σ x y / √(Σ x² Σ y²); 0 if a column is zero.
pub fn raw_correlation(a: &[f32], b: &[f32]) -> f64 {
    correlation_about(a, 0.0, b, 0.0)
}

fn correlation_about(a: &[f32], center_a: f64, b: &[f32], center_b: f64) -> f64 {
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for (&a, &b) in a.iter().zip(b) {
        let (a, b) = (a as f64 - center_a, b as f64 - center_b);
        ab += a * b;
        aa += a * a;
        bb += b * b;
    }
    if aa * bb > 0.0 { ab / (aa * bb).sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LABELS: [Label; 4] = [Label(0), Label(0), Label(1), Label(1)];

    #[test]
    fn eq_4_12_fisher_ratio() {
        // Means 1 and 5, variances 1 and 1: both ordered pairs give 16 / 2.
        assert!((fisher_ratio(&[0.0, 2.0, 4.0, 6.0], &LABELS) - 16.0).abs() < 1e-12);
        assert_eq!(fisher_ratio(&[1.0, 1.0, 1.0, 1.0], &LABELS).to_bits(), 0.0f64.to_bits());
        assert!((fisher_ratio(&[1.0, 1.0, 2.0, 2.0], &LABELS) - 2.0 * MAX_FISHER_RATIO).abs() < 1.0);
    }

    #[test]
    fn eq_4_13_correlation_as_printed_and_centered() {
        let (a, b) = ([1.0, 2.0, 3.0, 4.0], [4.0, 3.0, 2.0, 1.0]);
        assert!((raw_correlation(&a, &b) - 20.0 / 30.0).abs() < 1e-12);
        assert!((pearson(&a, &b) + 1.0).abs() < 1e-12);
        assert!(pearson(&a, &[7.0; 4]).abs() < 1e-12);
    }

    #[test]
    fn fig_4_6_prefers_what_is_not_said_yet() {
        let good = [0.0, 2.0, 4.0, 6.0];
        let copy = good.map(|v| 3.0 * v + 1.0);
        let similar = [0.0, 2.2, 4.0, 6.2];
        let other = [1.0, -1.0, 2.0, 0.5];
        let values = [[5.0; 4], good, copy, similar, other].concat();
        let ids: Vec<FeatureId> = (0..5).map(FeatureId).collect();
        let table = FeatureTable::from_columns(ids.clone(), 4, values);
        let features = |config: &SelectConfig| -> Vec<FeatureId> {
            select(&table, &LABELS, config).chosen.iter().map(|c| c.feature).collect()
        };
        let two = SelectConfig { n_features: 2, ..SelectConfig::default() };
        assert_eq!(features(&two), [ids[1], ids[4]]);
        // As printed the ratio outweighs the correlation.
        assert_eq!(features(&SelectConfig { weighing: Weighing::Printed, ..two }), [ids[1], ids[3]]);
        let dropped = select(&table, &LABELS, &two).dropped;
        assert_eq!(dropped, [Dropped::Constant(ids[0]), Dropped::Repeats(ids[2], ids[1])]);
    }
}
