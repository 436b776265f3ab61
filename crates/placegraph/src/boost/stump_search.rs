//! The best decision stump of a round: every threshold of every feature, exactly (algorithm of Fig. 4.2, step
//! "select the hypothesis with the largest |r|").
//!
//! Between the m-th and the next sorted value, the stump "below" has r = S_m − (S − S_m), where S_m is the sum of
//! D(n) y(n) over the m smallest values; the stump "above" has −r. So |r| is largest where S_m is largest or
//! smallest, and one pass over a sorted column finds both. Cost O(n) a column.
//!
//! Weights are integers, multiples of 2⁻⁶⁰: their sums are exact, so equal splits tie exactly and the result depends
//! neither on the order of the sum nor on the number of threads. Four classes share one pass, because fetching an
//! example's weights costs more than adding them. The pass keeps only the largest and smallest sum; where they stand
//! is looked up afterwards, in the one column that wins.
#![expect(clippy::inline_always, reason = "only what is inlined is compiled for several instruction sets")]

use rayon::prelude::*;

use super::sorted_table::{NEW_VALUE, SortedTable};
use super::stump::{DecisionStump, Polarity};
use crate::scan::Instructions;

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

/// For each of four classes the stump with the largest |r|; ties go to the first column, then to the lowest
/// threshold. `None` where no stump has another r than 0.
pub(super) fn best_stumps(sorted: &SortedTable<'_>, weights: &[SignedWeights]) -> [Option<BestStump>; LANES] {
    let n_columns = sorted.table().columns().len();
    let of_column = |column| {
        Instructions::default().run(
            #[inline(always)]
            || largest_r(sorted.order(column), weights),
        )
    };
    let of_columns: Vec<[i64; LANES]> = (0..n_columns).into_par_iter().map(of_column).collect();
    std::array::from_fn(|lane| {
        let mut best = (0, 0);
        for (column, r) in of_columns.iter().enumerate() {
            if r[lane] > best.1 {
                best = (column, r[lane]);
            }
        }
        let (column, r) = best;
        let stump = || stump_with(sorted, column, weights, lane, r);
        (r > 0).then(|| BestStump { column, stump: stump(), edge: r as f64 / ONE })
    })
}

/// The largest |r| of any split of a sorted column, for each class; 0 if the column is constant.
#[inline(always)]
fn largest_r(order: &[u32], weights: &[SignedWeights]) -> [i64; LANES] {
    let mut sum = [0i64; LANES];
    let mut largest = [i64::MIN; LANES];
    let mut smallest = [i64::MAX; LANES];
    for &marked in order {
        if marked & NEW_VALUE != 0 {
            for lane in 0..LANES {
                largest[lane] = largest[lane].max(sum[lane]);
                smallest[lane] = smallest[lane].min(sum[lane]);
            }
        }
        let example = &weights[(marked & !NEW_VALUE) as usize];
        for lane in 0..LANES {
            // Σ D = 1 is 2⁶⁰ units: no sum wraps.
            sum[lane] = sum[lane].wrapping_add(example.0[lane]);
        }
    }
    std::array::from_fn(|lane| {
        let constant = largest[lane] < smallest[lane];
        let r = |part: i64| (part - (sum[lane] - part)).abs();
        if constant { 0 } else { r(largest[lane]).max(r(smallest[lane])) }
    })
}

/// The stump of `column` with the lowest threshold whose |r| is `largest`, which one of them has.
fn stump_with(
    sorted: &SortedTable<'_>,
    column: usize,
    weights: &[SignedWeights],
    lane: usize,
    largest: i64,
) -> DecisionStump {
    let weight = |&marked: &u32| weights[(marked & !NEW_VALUE) as usize].0[lane];
    let order = sorted.order(column);
    let total: i64 = order.iter().map(weight).sum();
    let (mut place, mut part, mut r) = (0, 0, 0);
    while place < order.len() {
        r = part - (total - part);
        if order[place] & NEW_VALUE != 0 && r.abs() == largest {
            break;
        }
        part += weight(&order[place]);
        place += 1;
    }
    threshold_at(sorted, column, place, if r >= 0 { Polarity::Below } else { Polarity::Above })
}

/// The stump that splits a sorted column before `place`: its threshold is the midpoint of the two values there.
fn threshold_at(sorted: &SortedTable<'_>, column: usize, place: usize, polarity: Polarity) -> DecisionStump {
    let (low, high) = (sorted.sorted_value(column, place - 1), sorted.sorted_value(column, place));
    let midpoint = f64::midpoint(low.into(), high.into()) as f32;
    // The midpoint of neighbors in `f32` rounds onto one of them; then the one that the strict comparison of
    // Eq. (4.1) keeps on its side is the threshold.
    let threshold = match polarity {
        Polarity::Below => {
            if midpoint > low {
                midpoint
            } else {
                high
            }
        }
        Polarity::Above => {
            if midpoint < high {
                midpoint
            } else {
                low
            }
        }
    };
    DecisionStump { feature: sorted.table().columns()[column], threshold, polarity }
}
