//! The best decision stump of a round: every threshold of every feature, exactly (algorithm of Fig. 4.2, step
//! "select the hypothesis with the largest |r|").
//!
//! Between the m-th and the next sorted value, the stump "below" has r = S_m − (S − S_m), where S_m is the sum of
//! D(n) y(n) over the m smallest values; the stump "above" has −r. So |r| is largest where S_m is largest or
//! smallest, and one pass over a sorted column finds both. Cost O(n) a column.
//!
//! Weights are integers, multiples of 2⁻⁶⁰: their sums are exact, so equal splits tie exactly and the result depends
//! neither on the order of the sum nor on the number of threads. Four classes share one pass, because fetching an
//! example's weights costs more than adding them.

use rayon::prelude::*;

use super::sorted_table::{NEW_VALUE, SortedTable};
use super::stump::{DecisionStump, Polarity};

/// Classes that share a pass.
pub(super) const LANES: usize = 4;

/// The integer that stands for weight 1.
const ONE: f64 = (1u64 << 60) as f64;

/// D(n) y(n) of one example for four classes, in units of 2⁻⁶⁰. Aligned so that it lies in one cache line.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(32))]
pub(super) struct SignedWeights(pub(super) [i64; LANES]);

/// `weight` in units of 2⁻⁶⁰.
pub(super) fn to_units(weight: f64) -> i64 {
    (weight * ONE).round() as i64
}

/// A stump and how well it does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BestStump {
    /// Column of the stump's feature.
    pub(super) column: usize,
    /// The stump.
    pub(super) stump: DecisionStump,
    /// r = Σ D(n) y(n) h(x(n)), not negative.
    pub(super) edge: f64,
}

/// A split of one column: the first `place` sorted examples against the rest.
#[derive(Clone, Copy, Debug)]
struct Split {
    place: usize,
    /// r of the stump that says yes below, in units.
    r: i64,
}

/// For each of four classes the stump with the largest |r|; ties go to the first column, then to the lowest
/// threshold. `None` where all features are constant.
pub(super) fn best_stumps(sorted: &SortedTable<'_>, weights: &[SignedWeights]) -> [Option<BestStump>; LANES] {
    let n_columns = sorted.table().columns().len();
    let splits: Vec<_> =
        (0..n_columns).into_par_iter().map(|column| best_splits(sorted.order(column), weights)).collect();
    std::array::from_fn(|lane| {
        let mut best: Option<(usize, Split)> = None;
        for (column, split) in splits.iter().enumerate().filter_map(|(c, s)| s[lane].map(|s| (c, s))) {
            if best.is_none_or(|(_, b)| split.r.abs() > b.r.abs()) {
                best = Some((column, split));
            }
        }
        best.map(|(column, split)| BestStump {
            column,
            stump: stump_at(sorted, column, split),
            edge: split.r.unsigned_abs() as f64 / ONE,
        })
    })
}

/// The split of a sorted column with the largest |r|, for each class.
fn best_splits(order: &[u32], weights: &[SignedWeights]) -> [Option<Split>; LANES] {
    let mut sum = [0i64; LANES];
    let mut largest = [i64::MIN; LANES];
    let mut smallest = [i64::MAX; LANES];
    let (mut at_largest, mut at_smallest) = ([0; LANES], [0; LANES]);
    for (place, &marked) in order.iter().enumerate() {
        if marked & NEW_VALUE != 0 {
            for lane in 0..LANES {
                if sum[lane] > largest[lane] {
                    (largest[lane], at_largest[lane]) = (sum[lane], place);
                }
                if sum[lane] < smallest[lane] {
                    (smallest[lane], at_smallest[lane]) = (sum[lane], place);
                }
            }
        }
        let example = &weights[(marked & !NEW_VALUE) as usize];
        for (sum, weight) in sum.iter_mut().zip(example.0) {
            *sum += weight;
        }
    }
    std::array::from_fn(|lane| {
        if at_largest[lane] == 0 {
            return None;
        }
        let r = |part: i64| part - (sum[lane] - part);
        let a = Split { place: at_largest[lane], r: r(largest[lane]) };
        let b = Split { place: at_smallest[lane], r: r(smallest[lane]) };
        let key = |split: &Split| (split.r.abs(), std::cmp::Reverse(split.place));
        Some(if key(&a) >= key(&b) { a } else { b })
    })
}

/// The stump of a split: its threshold is the midpoint of the two values that the split lies between.
fn stump_at(sorted: &SortedTable<'_>, column: usize, split: Split) -> DecisionStump {
    let feature = sorted.table().columns()[column];
    let (low, high) =
        (sorted.sorted_value(column, split.place - 1), sorted.sorted_value(column, split.place));
    let midpoint = f64::midpoint(low.into(), high.into()) as f32;
    // The midpoint of neighbors in `f32` rounds onto one of them; then the one that the strict comparison of
    // Eq. (4.1) keeps on its side is the threshold.
    if split.r >= 0 {
        let threshold = if midpoint > low { midpoint } else { high };
        DecisionStump { feature, threshold, polarity: Polarity::Below }
    } else {
        let threshold = if midpoint < high { midpoint } else { low };
        DecisionStump { feature, threshold, polarity: Polarity::Above }
    }
}
