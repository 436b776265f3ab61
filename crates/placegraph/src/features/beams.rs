//! Set A: features of the raw beams (appendix A of the book).
//!
//! **Deviations.** Relations divide the shorter beam by the longer (A11, A12, A15): the printed d_i / d_{i+1}
//! is unbounded and not mirror symmetric. Kurtosis is not reduced by 3. Standard deviations divide by n.
//! None of these makes a difference to a stump, except the first, which is that of the author's program.

use super::families::Measure as M;
use super::values::Values;
use crate::scan::lanes::{Lanes, Singles, TINY, ZERO, beams, mean_and_sd, sum};
use crate::scan::{N_BEAMS, Ranges};

/// Members of A3 and A4: cut at 1, 2, …, 10 m.
const N_CLIPS: usize = 10;
/// Members of A7 and f33: gaps above 0.5, 1, …, 10 m.
const N_GAPS: usize = 20;
/// Members of A15 and f34: relations below 0.1, 0.2, …, 1.
const N_RELATIONS: usize = 10;
/// Beams whose sums and extremes are taken together: what none of them reaches is skipped.
const TOGETHER: usize = 8;
/// A16 of a scan whose beams differ by less than this is 0.
const SD_MIN_M: f32 = 1e-9;
/// From this share of the mean square on, a variance comes from the sums of values and squares: at most one digit is lost.
const VARIANCE_MIN: f32 = 1.0 / 16.0;

/// Sums of values that are not below 0, and of their squares.
#[derive(Clone, Copy)]
struct Sums {
    values: Singles,
    squares: Singles,
}

impl Sums {
    const ZERO: Self = Self { values: ZERO, squares: ZERO };

    #[inline(always)]
    fn of(values: &[Singles; TOGETHER]) -> Self {
        let mut sums = Self::ZERO;
        for &value in values {
            sums = sums.plus(Self { values: value, squares: value * value });
        }
        sums
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self { values: self.values + other.values, squares: self.squares + other.squares }
    }

    /// Mean and population standard deviation of the values of all beams, which `value` gives once more where their spread
    /// is small compared with them.
    #[inline(always)]
    fn mean_and_sd(self, value: impl Fn(usize) -> Singles) -> (Singles, Singles) {
        let (mean, square) = (self.values * (1.0 / N_BEAMS as f32), self.squares * (1.0 / N_BEAMS as f32));
        let variance = square - mean * mean;
        let is_small = variance.zip(square, |variance, square| u32::from(variance < square * VARIANCE_MIN));
        let sd = variance.max(ZERO).sqrt();
        if !is_small.is_any() {
            return (mean, sd);
        }
        let (exact_mean, exact_sd) = mean_and_sd(N_BEAMS, value);
        (is_small.choose(exact_mean, mean), is_small.choose(exact_sd, sd))
    }
}

/// The requested features that come from differences of consecutive beams, in addition to A1 and A2.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Differences {
    /// A3 and A4.
    pub(super) clipped: bool,
    /// A7 and f33.
    pub(super) gaps: bool,
}

/// A1 to A4, A7 and f33.
///
/// Beams that none is longer than a limit of A3 differ as if not cut, and beams that all are longer do not differ: mostly
/// one or two limits lie between the shortest and the longest of neighbors.
#[inline(always)]
pub(super) fn differences(d: &Ranges, wanted: Differences, values: &mut Values) {
    let mut uncut = Sums::ZERO;
    let mut cut = [Sums::ZERO; N_CLIPS];
    let mut gaps = [ZERO; N_GAPS];
    for start in beams(N_BEAMS, TOGETHER) {
        let mut differences = [ZERO; TOGETHER];
        for (difference, i) in differences.iter_mut().zip(start..) {
            *difference = (d[i] - d[i + 1]).abs();
        }
        let here = Sums::of(&differences);
        uncut = uncut.plus(here);
        if wanted.clipped {
            let neighbors = &d[start..=start + TOGETHER];
            let shortest = neighbors.iter().fold(d[start], |a, &b| a.min(b)).smallest();
            let longest = neighbors.iter().fold(d[start], |a, &b| a.max(b)).largest();
            for (sums, member) in cut.iter_mut().zip(1..) {
                let limit = member as f32;
                if limit >= longest {
                    *sums = sums.plus(here);
                } else if limit > shortest {
                    let mut differences = [ZERO; TOGETHER];
                    for (difference, i) in differences.iter_mut().zip(start..) {
                        *difference = clipped_difference(d, limit, i);
                    }
                    *sums = sums.plus(Sums::of(&differences));
                }
            }
        }
        if wanted.gaps {
            let largest = differences.iter().fold(ZERO, |a, &b| a.max(b)).largest();
            for (member, count) in gaps.iter_mut().enumerate() {
                let limit = (member + 1) as f32 / 2.0;
                if largest <= limit {
                    break;
                }
                for difference in differences {
                    *count += difference.above(limit);
                }
            }
        }
    }
    let (mean, sd) = uncut.mean_and_sd(
        #[inline(always)]
        |i| (d[i] - d[i + 1]).abs(),
    );
    values.set(M::MeanDifference, mean);
    values.set(M::SdDifference, sd);
    if wanted.clipped {
        for (member, sums) in cut.into_iter().enumerate() {
            let (mean, sd) = sums.mean_and_sd(
                #[inline(always)]
                |i| clipped_difference(d, (member + 1) as f32, i),
            );
            values.set_member(M::MeanClippedDifference, member, mean);
            values.set_member(M::SdClippedDifference, member, sd);
        }
    }
    if wanted.gaps {
        for (member, count) in gaps.into_iter().enumerate() {
            values.set_member(M::Gaps, member, count);
            values.set_member(M::GapFraction, member, count * (1.0 / (N_BEAMS - 1) as f32));
        }
    }
}

#[inline(always)]
fn clipped_difference(d: &Ranges, limit: f32, i: usize) -> Singles {
    let limit = Lanes::all(limit);
    (d[i].min(limit) - d[i + 1].min(limit)).abs()
}

/// A5, A6, A13, A14 and A16.
#[inline(always)]
pub(super) fn lengths(d: &Ranges, values: &mut Values) {
    let (mean, sd) = mean_and_sd(
        N_BEAMS,
        #[inline(always)]
        |i| d[i],
    );
    let longest = d.iter().fold(Lanes::all(TINY), |a, &b| a.max(b));
    values.set(M::MeanLength, mean);
    values.set(M::SdLength, sd);
    values.set(M::MeanNormalizedLength, mean / longest);
    values.set(M::SdNormalizedLength, sd / longest);
    // Fourth powers of deviations in units of the standard deviation.
    let per_sd = Lanes::all(1.0) / sd.max(Lanes::all(SD_MIN_M));
    let fourth = sum(
        N_BEAMS,
        #[inline(always)]
        |i| {
            let deviation = (d[i] - mean) * per_sd;
            let square = deviation * deviation;
            square * square
        },
    );
    let kurtosis = fourth * (1.0 / N_BEAMS as f32);
    values.set(M::Kurtosis, kurtosis.zip(sd, |kurtosis, sd| if sd < SD_MIN_M { 0.0 } else { kurtosis }));
}

/// A11, A12, A15 and f34.
#[inline(always)]
pub(super) fn relations(d: &Ranges, values: &mut Values) {
    let one = Lanes::all(1.0);
    // What is left to 1 is small, and its square smaller: nothing of the spread is lost.
    let mut left = Sums::ZERO;
    let mut counts = [ZERO; N_RELATIONS];
    for start in beams(N_BEAMS, TOGETHER) {
        let (mut relations, mut left_here) = ([ZERO; TOGETHER], [ZERO; TOGETHER]);
        let mut smallest = one;
        for (i, (relation, left)) in relations.iter_mut().zip(&mut left_here).enumerate() {
            *relation = relation_of(d, start + i);
            *left = one - *relation;
            smallest = smallest.min(*relation);
        }
        left = left.plus(Sums::of(&left_here));
        let smallest = smallest.smallest();
        for (member, count) in counts.iter_mut().enumerate().rev() {
            let limit = (member + 1) as f32 / 10.0;
            if smallest >= limit {
                break;
            }
            for relation in relations {
                *count += relation.below(limit);
            }
        }
    }
    let (mean, sd) = left.mean_and_sd(
        #[inline(always)]
        |i| one - relation_of(d, i),
    );
    values.set(M::MeanRelation, one - mean);
    values.set(M::SdRelation, sd);
    for (member, &count) in counts.iter().enumerate() {
        values.set_member(M::RelativeGaps, member, count);
        values.set_member(M::RelativeGapFraction, member, count * (1.0 / (N_BEAMS - 1) as f32));
    }
}

/// The shorter of two consecutive beams over the longer.
#[inline(always)]
fn relation_of(d: &Ranges, i: usize) -> Singles {
    let tiny = Lanes::all(TINY);
    (d[i].min(d[i + 1]) + tiny) / (d[i].max(d[i + 1]) + tiny)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The squares of beams around 100 m are told to a millimeter: their spread of half a millimeter is not.
    #[test]
    fn a_spread_that_is_small_beside_the_values_is_measured_again() {
        let value = |beam: usize| Lanes::all(100.0 + 0.001 * (beam % 2) as f32);
        let sums = (0..N_BEAMS).fold(Sums::ZERO, |sums, beam| {
            sums.plus(Sums { values: value(beam), squares: value(beam) * value(beam) })
        });
        let (mean, sd) = sums.mean_and_sd(value);
        assert!((mean.0[0] - 100.0005).abs() < 5e-5 && (sd.0[0] - 0.0005).abs() < 5e-5, "{mean:?} {sd:?}");
    }
}
