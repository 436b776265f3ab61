//! Boosting by the book: every threshold tried by a sum over all examples.

use placegraph::boost::{DecisionStump, Polarity, StrongClassifier};
use placegraph::features::FeatureTable;

/// r = Σ D(n) y(n) h(x(n)) of one stump.
pub fn edge(table: &FeatureTable, stump: &DecisionStump, positive: &[bool], weights: &[f64]) -> f64 {
    let values = table.values_of(stump.feature).expect("the stump's column");
    let agrees = |n: usize| stump.says_yes(values[n]) == positive[n];
    (0..positive.len()).map(|n| if agrees(n) { weights[n] } else { -weights[n] }).sum()
}

/// The largest r of any stump: all columns, both polarities, thresholds between all pairs of different values.
pub fn largest_edge(table: &FeatureTable, positive: &[bool], weights: &[f64]) -> f64 {
    let mut largest = 0.0f64;
    for &feature in table.columns() {
        let mut values = table.values_of(feature).expect("a column").to_vec();
        values.sort_by(f32::total_cmp);
        for pair in values.windows(2).filter(|pair| pair[0] < pair[1]) {
            for polarity in [Polarity::Below, Polarity::Above] {
                let threshold = pair[0] + (pair[1] - pair[0]) / 2.0;
                let stump = DecisionStump { feature, threshold, polarity };
                largest = largest.max(edge(table, &stump, positive, weights));
            }
        }
    }
    largest
}

/// The rows of every column by ascending value.
pub fn sorted_columns(table: &FeatureTable) -> Vec<Vec<u32>> {
    let sorted = |values: &[f32]| {
        let mut rows: Vec<u32> = (0..values.len() as u32).collect();
        rows.sort_by(|&a, &b| values[a as usize].total_cmp(&values[b as usize]));
        rows
    };
    (0..table.columns().len()).map(|column| sorted(table.column(column))).collect()
}

/// [`largest_edge`] by one pass over each of the [`sorted_columns`], for larger tables.
pub fn largest_edge_by_sorting(
    table: &FeatureTable,
    sorted: &[Vec<u32>],
    positive: &[bool],
    weights: &[f64],
) -> f64 {
    let signed =
        |row: u32| if positive[row as usize] { weights[row as usize] } else { -weights[row as usize] };
    let total: f64 = (0..positive.len() as u32).map(signed).sum();
    let mut largest = 0.0f64;
    for (column, rows) in sorted.iter().enumerate() {
        let values = table.column(column);
        let mut below = 0.0;
        for pair in rows.windows(2) {
            below += signed(pair[0]);
            if values[pair[0] as usize] < values[pair[1] as usize] {
                largest = largest.max((below - (total - below)).abs());
            }
        }
    }
    largest
}

/// The weights D before each round that `classifier` was learned in, by Fig. 4.2.
pub fn weights_of_rounds(
    table: &FeatureTable,
    classifier: &StrongClassifier,
    positive: &[bool],
) -> Vec<Vec<f64>> {
    let n_positive = positive.iter().filter(|&&y| y).count() as f64;
    let n_negative = positive.len() as f64 - n_positive;
    let start = |&y: &bool| if y { 0.5 / n_positive } else { 0.5 / n_negative };
    let mut rounds: Vec<Vec<f64>> = vec![positive.iter().map(start).collect()];
    for w in &classifier.stumps {
        let values = table.values_of(w.stump.feature).expect("the stump's column");
        let h = |n: usize| if w.stump.says_yes(values[n]) { 1.0 } else { -1.0 };
        let y = |n: usize| if positive[n] { 1.0 } else { -1.0 };
        let last = &rounds[rounds.len() - 1];
        let next: Vec<f64> =
            (0..positive.len()).map(|n| last[n] * f64::exp(-w.alpha * y(n) * h(n))).collect();
        let sum: f64 = next.iter().sum();
        rounds.push(next.iter().map(|d| d / sum).collect());
    }
    rounds
}
