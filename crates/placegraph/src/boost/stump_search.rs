//! The best decision stump of a round: every threshold of every feature, exactly (algorithm of Fig. 4.2, step
//! "select the hypothesis with the largest |r|").
//!
//! Let S be the sum of D(n) y(n) over the values below a threshold and S_all the sum over all. The stump "below" has
//! r = S − (S_all − S), the stump "above" has −r. The search takes two steps:
//!
//! 1. Sums over the bins of a column give r at every threshold between bins. One pass over the examples in the order in
//!    which they lie in memory, O(L n).
//! 2. A threshold inside a bin has S between the sum before the bin less the bin's negative part and that sum plus its
//!    positive part. Where this allows an |r| as large as the best one known, the examples of the bin are searched in sorted order. Few bins are.
//!
//! Weights are integers, multiples of 2⁻⁶⁰: their sums are exact, so equal splits tie exactly and the result depends
//! neither on the order of the sums, nor on the bins, nor on the number of threads. Four classes share a pass.
#![expect(clippy::inline_always, reason = "only what is inlined is compiled for several instruction sets")]

use std::ops::Range;
use std::sync::atomic::{AtomicI64, Ordering::Relaxed};

use rayon::prelude::*;

use super::sorted_examples::{MAX_BINS, NEW_VALUE, SortedExamples};
use super::stump::{DecisionStump, Polarity};
use crate::scan::Instructions;

/// Classes that share a pass.
pub(super) const LANES: usize = 4;
/// Columns that a thread sums together, and examples between which it changes from column to column: these weights are
/// fetched from memory once and stay in cache.
const COLUMNS: usize = 8;
const EXAMPLES: usize = 2048;
/// Sums of every bin, used in turn: one need not wait for the last.
const COPIES: usize = 2;

/// The integer that stands for weight 1.
const ONE: f64 = (1u64 << 60) as f64;

/// D(n) y(n) of one example for four classes, in units of 2⁻⁶⁰, or sums of them; |Σ| ≤ 2⁶⁰.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(32))]
struct SignedWeights([i64; LANES]);

/// `weight` in units of 2⁻⁶⁰.
#[inline(always)]
pub(super) fn to_units(weight: f64) -> i64 {
    (weight * ONE + 0.5) as i64
}

/// The number that `units` stand for.
#[inline(always)]
pub(super) fn from_units(units: i64) -> f64 {
    units as f64 / ONE
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

/// The weights D(n) of the examples for up to four classes that share a pass; `None` for a class that is done.
#[derive(Debug)]
pub(super) struct Group<'a> {
    /// The first of the classes.
    pub(super) first_class: usize,
    pub(super) weights: Vec<Option<&'a [f64]>>,
}

/// For each class of a group the stump with the largest |r|; ties go to the first column, then to the lowest threshold.
/// `None` where no stump has another r than 0.
pub(super) fn best_stumps(examples: &SortedExamples<'_>, group: &Group<'_>) -> Vec<Option<BestStump>> {
    let signed = signed_weights(examples, group);
    let weights = side_by_side(examples.n_examples(), &signed);
    let n_columns = examples.table().columns().len();
    let first_columns: Vec<usize> = (0..n_columns).step_by(COLUMNS).collect();
    let of_columns = |&first: &usize| {
        let columns = first..n_columns.min(first + COLUMNS);
        Instructions::default().run(
            #[inline(always)]
            || column_sums(examples, &weights, group.first_class, columns.clone()),
        )
    };
    let columns: Vec<ColumnSums> = first_columns.par_iter().flat_map_iter(of_columns).collect();
    drop(weights);
    let search = Search { examples, signed, columns };
    let of_columns = search.largest_of_columns();
    let best = |lane: usize| {
        let largest = of_columns.iter().map(|r| r[lane]).max().filter(|&r| r > 0)?;
        let column = of_columns.iter().position(|r| r[lane] == largest)?;
        let stump = search.first_with(column, lane, largest)?;
        Some(BestStump { column, stump, edge: from_units(largest) })
    };
    (0..group.weights.len()).map(best).collect()
}

/// D(n) y(n) of all examples for each class of a group, in units of 2⁻⁶⁰; nothing for a class that is done.
fn signed_weights(examples: &SortedExamples<'_>, group: &Group<'_>) -> Vec<Vec<i64>> {
    let of_class = |(lane, weights): (usize, Option<&[f64]>)| {
        let positive = &examples.of_class()[group.first_class + lane];
        let signed = |(example, &weight): (usize, &f64)| {
            let units = to_units(weight);
            if positive.contains(&example) { units } else { -units }
        };
        weights.unwrap_or_default().par_iter().enumerate().map(signed).collect()
    };
    group.weights.iter().copied().enumerate().map(of_class).collect()
}

/// The numbers of up to four classes side by side.
fn side_by_side(n_examples: usize, signed: &[Vec<i64>]) -> Vec<SignedWeights> {
    let mut weights = vec![SignedWeights::default(); n_examples];
    weights.par_chunks_mut(EXAMPLES).enumerate().for_each(|(chunk, weights)| {
        for (lane, signed) in signed.iter().enumerate().filter(|(_, signed)| !signed.is_empty()) {
            for (weights, &signed) in weights.iter_mut().zip(&signed[chunk * EXAMPLES..]) {
                weights.0[lane] = signed;
            }
        }
    });
    weights
}

/// Sums over the examples of one bin.
#[derive(Clone, Copy, Debug, Default)]
struct BinSums {
    /// Σ D y.
    all: SignedWeights,
    /// Σ D over the positive examples.
    positive: SignedWeights,
}

/// The sums of all bins of a column.
struct ColumnSums {
    bins: Vec<BinSums>,
    total: [i64; LANES],
}

/// Sums of up to 256 bins while they are made.
struct Histogram {
    all: [[SignedWeights; MAX_BINS]; COPIES],
    positive: [SignedWeights; MAX_BINS],
}

/// The sums of some columns.
#[inline(always)]
fn column_sums(
    examples: &SortedExamples<'_>,
    weights: &[SignedWeights],
    first_class: usize,
    columns: Range<usize>,
) -> Vec<ColumnSums> {
    let mut histograms: Vec<Histogram> = columns.clone().map(|_| Histogram::new()).collect();
    for (class, of_class) in examples.of_class().iter().enumerate() {
        // What a class adds to the sums of its own lane is positive.
        let lane = class.checked_sub(first_class).filter(|&lane| lane < LANES);
        for histogram in &mut histograms {
            histogram.add_to_positive(lane, -1);
        }
        for first in of_class.clone().step_by(EXAMPLES) {
            let chunk = first..of_class.end.min(first + EXAMPLES);
            for (column, histogram) in columns.clone().zip(&mut histograms) {
                histogram.add(&examples.codes(column)[chunk.clone()], &weights[chunk.clone()]);
            }
        }
        for histogram in &mut histograms {
            histogram.add_to_positive(lane, 1);
        }
    }
    columns.zip(&histograms).map(|(column, histogram)| histogram.sums(examples.bins(column).len())).collect()
}

impl Histogram {
    fn new() -> Self {
        let zero = SignedWeights::default();
        Self { all: [[zero; MAX_BINS]; COPIES], positive: [zero; MAX_BINS] }
    }

    /// Adds examples, given by their bins and weights.
    #[inline(always)]
    fn add(&mut self, codes: &[u8], weights: &[SignedWeights]) {
        let (codes, last_codes) = codes.as_chunks::<COPIES>();
        let (weights, last_weights) = weights.as_chunks::<COPIES>();
        for (codes, weights) in codes.iter().zip(weights) {
            for copy in 0..COPIES {
                self.all[copy][usize::from(codes[copy])].add(&weights[copy]);
            }
        }
        for (&code, weight) in last_codes.iter().zip(last_weights) {
            self.all[0][usize::from(code)].add(weight);
        }
    }

    /// Adds `sign` times the present sums of one class to its positive part.
    fn add_to_positive(&mut self, lane: Option<usize>, sign: i64) {
        let Some(lane) = lane else { return };
        for (bin, positive) in self.positive.iter_mut().enumerate() {
            positive.0[lane] += sign * self.all.iter().map(|copy| copy[bin].0[lane]).sum::<i64>();
        }
    }

    fn sums(&self, n_bins: usize) -> ColumnSums {
        let mut total = SignedWeights::default();
        let sums = |bin: usize| {
            let mut all = SignedWeights::default();
            self.all.iter().for_each(|copy| all.add(&copy[bin]));
            total.add(&all);
            BinSums { all, positive: self.positive[bin] }
        };
        let bins = (0..n_bins).map(sums).collect();
        ColumnSums { bins, total: total.0 }
    }
}

impl SignedWeights {
    #[inline(always)]
    fn add(&mut self, other: &Self) {
        for lane in 0..LANES {
            // Σ D = 1 is 2⁶⁰ units: no sum wraps.
            self.0[lane] = self.0[lane].wrapping_add(other.0[lane]);
        }
    }
}

/// The second step of the search.
struct Search<'a> {
    examples: &'a SortedExamples<'a>,
    /// As of [`signed_weights`].
    signed: Vec<Vec<i64>>,
    columns: Vec<ColumnSums>,
}

impl Search<'_> {
    /// For each class the largest |r| of every column, exact where it is the largest of all columns, else a lower bound.
    fn largest_of_columns(&self) -> Vec<[i64; LANES]> {
        let between: Vec<[i64; LANES]> = self.columns.iter().map(largest_between_bins).collect();
        let largest: [AtomicI64; LANES] =
            std::array::from_fn(|lane| AtomicI64::new(between.iter().map(|r| r[lane]).max().unwrap_or(0)));
        // Good columns first: what they add to `largest` spares the others a search.
        let gap = |column: &usize| {
            (0..LANES).map(|lane| largest[lane].load(Relaxed) - between[*column][lane]).min()
        };
        let mut good_first: Vec<usize> = (0..self.columns.len()).collect();
        good_first.sort_by_cached_key(gap);
        let inside =
            good_first.par_iter().map(|&column| (column, self.largest_inside_bins(column, &largest)));
        let mut of_columns = between.clone();
        for (column, inside) in inside.collect::<Vec<_>>() {
            for lane in 0..LANES {
                of_columns[column][lane] = of_columns[column][lane].max(inside[lane]);
            }
        }
        of_columns
    }

    /// The largest |r| of the thresholds inside the bins of a column that may reach `largest`, which rises to it.
    fn largest_inside_bins(&self, column: usize, largest: &[AtomicI64; LANES]) -> [i64; LANES] {
        let ColumnSums { bins, total } = &self.columns[column];
        let mut found = [0; LANES];
        let mut before = SignedWeights::default();
        for (sums, places) in bins.iter().zip(self.examples.bins(column)) {
            for lane in 0..self.signed.len() {
                let bound = sums.largest_r_inside(lane, before.0[lane], total[lane]);
                if bound > 0 && bound >= largest[lane].load(Relaxed) {
                    self.thresholds_inside(column, lane, places, before.0[lane], |_, part| {
                        found[lane] = found[lane].max(r(part, total[lane]).abs());
                    });
                    largest[lane].fetch_max(found[lane], Relaxed);
                }
            }
            before.add(&sums.all);
        }
        found
    }

    /// The stump of `column` with the lowest threshold whose |r| is `largest`.
    fn first_with(&self, column: usize, lane: usize, largest: i64) -> Option<DecisionStump> {
        let ColumnSums { bins, total } = &self.columns[column];
        let total = total[lane];
        let mut before = 0;
        for (sums, places) in bins.iter().zip(self.examples.bins(column)) {
            let mut found = None;
            let mut visit = |place, part| {
                if found.is_none() && r(part, total).abs() == largest {
                    found = Some((place, r(part, total)));
                }
            };
            if places.start > 0 {
                visit(places.start, before);
            }
            if sums.largest_r_inside(lane, before, total) >= largest {
                self.thresholds_inside(column, lane, places, before, visit);
            }
            if let Some((place, r)) = found {
                let polarity = if r >= 0 { Polarity::Below } else { Polarity::Above };
                return Some(stump_at(self.examples, column, place, polarity));
            }
            before += sums.all.0[lane];
        }
        None
    }

    /// Calls `visit` for every threshold inside a bin, in ascending order, with its place and the sum below it;
    /// `places` are those of the bin, `before` is the sum of the bins below.
    fn thresholds_inside(
        &self,
        column: usize,
        lane: usize,
        places: &Range<usize>,
        before: i64,
        mut visit: impl FnMut(usize, i64),
    ) {
        let signed = self.signed[lane].as_slice();
        let mut part = before;
        for (place, &marked) in places.clone().zip(&self.examples.order(column)[places.clone()]) {
            if marked & NEW_VALUE != 0 && place > places.start {
                visit(place, part);
            }
            part += signed[(marked & !NEW_VALUE) as usize];
        }
    }
}

/// r = S − (S_all − S).
fn r(part: i64, total: i64) -> i64 {
    part - (total - part)
}

/// For each class the largest |r| of the thresholds between bins; 0 if there is one bin.
fn largest_between_bins(sums: &ColumnSums) -> [i64; LANES] {
    let mut largest = [0; LANES];
    let mut part = SignedWeights::default();
    for bin in &sums.bins[..sums.bins.len() - 1] {
        part.add(&bin.all);
        for lane in 0..LANES {
            largest[lane] = largest[lane].max(r(part.0[lane], sums.total[lane]).abs());
        }
    }
    largest
}

impl BinSums {
    /// No threshold inside the bin has a larger |r|; `before` is the sum over the bins below.
    fn largest_r_inside(&self, lane: usize, before: i64, total: i64) -> i64 {
        let (all, positive) = (self.all.0[lane], self.positive.0[lane]);
        let (least, most) = (before + (all - positive), before + positive);
        r(least, total).abs().max(r(most, total).abs())
    }
}

/// The stump that splits a sorted column before `place`: its threshold is the midpoint of the two values there.
fn stump_at(examples: &SortedExamples<'_>, column: usize, place: usize, polarity: Polarity) -> DecisionStump {
    let (low, high) = (examples.sorted_value(column, place - 1), examples.sorted_value(column, place));
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
    DecisionStump { feature: examples.table().columns()[column], threshold, polarity }
}
