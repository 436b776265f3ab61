//! Set A: features of the raw beams (appendix A of the book).
//!
//! **Deviations.** Relations divide the shorter beam by the longer (A11, A12, A15): the printed d_i / d_{i+1}
//! is unbounded and not mirror symmetric. Kurtosis is not reduced by 3. Standard deviations divide by n.
//! A stump cannot tell any of these from the printed form, except the first, which the author's program has.

use super::families::Measure as M;
use super::lanes::{Lanes, Singles, TINY, beams, mean, mean_and_sd, sum};
use super::values::{Ranges, Values};
use crate::scan::N_BEAMS;

/// Members of A3 and A4: cut at 1, 2, …, 10 m.
const N_CLIPS: usize = 10;
/// Members of A7 and f33: gaps above 0.5, 1, …, 10 m.
const N_GAPS: usize = 20;
/// Members of A15 and f34: relations below 0.1, 0.2, …, 1.
const N_RELATIONS: usize = 10;
/// Beams whose extreme is looked for together: the limits that none of them reaches are skipped.
const TOGETHER: usize = 8;
/// A16 of a scan whose beams differ by less than this is 0.
const SD_MIN_M: f32 = 1e-9;

/// A1 and A2.
#[inline(always)]
pub(super) fn differences(d: &Ranges, values: &mut Values) {
    let (mean, sd) = mean_and_sd(
        N_BEAMS,
        #[inline(always)]
        |i| (d[i] - d[i + 1]).abs(),
    );
    values.set(M::MeanDifference, mean);
    values.set(M::SdDifference, sd);
}

/// A3, and A4 if `with_sd`.
#[inline(always)]
pub(super) fn clipped_differences(d: &Ranges, with_sd: bool, values: &mut Values) {
    let longest = d.iter().fold(Lanes::all(0.0), |a, &b| a.max(b)).largest();
    let mut uncut = None;
    let mut differences = [Lanes::all(0.0); N_BEAMS];
    for member in 0..N_CLIPS {
        let limit = (member + 1) as f32;
        // Nothing is cut from here on: the same values again.
        let (mean, sd) = uncut.unwrap_or_else(
            #[inline(always)]
            || {
                let limit = Lanes::all(limit);
                if !with_sd {
                    let mean = mean(
                        N_BEAMS,
                        #[inline(always)]
                        |i| clipped_difference(d, limit, i),
                    );
                    return (mean, Lanes::all(0.0));
                }
                for start in beams(N_BEAMS, TOGETHER) {
                    for (difference, i) in differences[start..start + TOGETHER].iter_mut().zip(start..) {
                        *difference = clipped_difference(d, limit, i);
                    }
                }
                mean_and_sd(
                    N_BEAMS,
                    #[inline(always)]
                    |i| differences[i],
                )
            },
        );
        if limit >= longest {
            uncut = Some((mean, sd));
        }
        values.set_member(M::MeanClippedDifference, member, mean);
        values.set_member(M::SdClippedDifference, member, sd);
    }
}

#[inline(always)]
fn clipped_difference(d: &Ranges, limit: Singles, i: usize) -> Singles {
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

/// A7 and f33.
#[inline(always)]
pub(super) fn gaps(d: &Ranges, values: &mut Values) {
    let mut counts: [Singles; N_GAPS] = [Lanes::all(0.0); N_GAPS];
    for start in beams(N_BEAMS, TOGETHER) {
        let mut differences = [Lanes::all(0.0); TOGETHER];
        let mut largest = Lanes::all(0.0);
        for (difference, i) in differences.iter_mut().zip(start..) {
            *difference = (d[i] - d[i + 1]).abs();
            largest = largest.max(*difference);
        }
        let largest = largest.largest();
        for (member, count) in counts.iter_mut().enumerate() {
            let limit = (member + 1) as f32 / 2.0;
            if largest <= limit {
                break;
            }
            for difference in differences {
                *count += difference.above(limit);
            }
        }
    }
    for (member, &count) in counts.iter().enumerate() {
        values.set_member(M::Gaps, member, count);
        values.set_member(M::GapFraction, member, count * (1.0 / (N_BEAMS - 1) as f32));
    }
}

/// A11, A12, A15 and f34.
#[inline(always)]
pub(super) fn relations(d: &Ranges, values: &mut Values) {
    let mut counts: [Singles; N_RELATIONS] = [Lanes::all(0.0); N_RELATIONS];
    let mut relations = [Lanes::all(0.0); N_BEAMS];
    let tiny = Lanes::all(TINY);
    for start in beams(N_BEAMS, TOGETHER) {
        let together = &mut relations[start..start + TOGETHER];
        let mut smallest = Lanes::all(1.0);
        for (relation, i) in together.iter_mut().zip(start..) {
            *relation = (d[i].min(d[i + 1]) + tiny) / (d[i].max(d[i + 1]) + tiny);
            smallest = smallest.min(*relation);
        }
        let smallest = smallest.smallest();
        for (member, count) in counts.iter_mut().enumerate().rev() {
            let limit = (member + 1) as f32 / 10.0;
            if smallest >= limit {
                break;
            }
            for relation in &*together {
                *count += relation.below(limit);
            }
        }
    }
    let (mean, sd) = mean_and_sd(
        N_BEAMS,
        #[inline(always)]
        |i| relations[i],
    );
    values.set(M::MeanRelation, mean);
    values.set(M::SdRelation, sd);
    for (member, &count) in counts.iter().enumerate() {
        values.set_member(M::RelativeGaps, member, count);
        values.set_member(M::RelativeGapFraction, member, count * (1.0 / (N_BEAMS - 1) as f32));
    }
}
