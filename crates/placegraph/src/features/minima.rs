//! A9 and A10: the two deepest local minima of a scan; in a doorway, these are its two jambs.
//!
//! **Deviations.** The author's program looks for runs of beams from a start beam and so depends on where the
//! robot looks. Here the scan is a circle: a minimum counts if the range rises by [`PROMINENCE_M`] on both
//! sides before it falls below the minimum; several equal beams are represented by the middle of the first
//! and the last; of equally deep minima those farthest apart are taken.

use super::families::Measure as M;
use super::moments::Along;
use super::values::Values;
use crate::scan::lanes::{Lanes, Singles, WIDTH, ZERO};
use crate::scan::{N_BEAMS, Ranges};

/// Rise on both sides of a minimum, in meters: two cells of 5 cm (δ of the book, for which no value is known).
const PROMINENCE_M: f32 = 0.1;

/// Beams that are turned together.
const TOGETHER: usize = 8;
/// A turn in half beams.
const TURN: u32 = 2 * N_BEAMS as u32;
/// The sign of a descent: that of a negative number.
const DOWN: u32 = 1 << 31;
/// Most minima of a scan: between two of them a beam is longer.
const MAX_MINIMA: usize = N_BEAMS / 2;

/// A local minimum: its range, and twice its position in beams.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Minimum {
    range: f32,
    half_beams: u32,
}

/// The minima of every scan that may be one of the two deepest; after them there is room for one more.
pub(super) struct Found {
    minima: [[Minimum; MAX_MINIMA + 1]; WIDTH],
    n: [usize; WIDTH],
}

impl Found {
    pub(super) const NONE: Self =
        Self { minima: [[Minimum { range: 0.0, half_beams: 0 }; MAX_MINIMA + 1]; WIDTH], n: [0; WIDTH] };

    /// Adds a minimum of every scan where it is new.
    #[inline(never)]
    fn add(
        &mut self,
        range: &Singles,
        starts: &[u32; WIDTH],
        first: &[u32; WIDTH],
        last: &[u32; WIDTH],
        is_new: &Lanes<u32>,
    ) {
        for lane in 0..WIDTH {
            let half_beams = 2 * starts[lane] + first[lane] + last[lane];
            let half_beams = if half_beams < TURN { half_beams } else { half_beams - TURN };
            // Written in any case, kept if new: without a branch.
            self.minima[lane][self.n[lane]] = Minimum { range: range.0[lane], half_beams };
            self.n[lane] += is_new.0[lane] as usize;
        }
    }

    fn of_lane(&self, lane: usize) -> &[Minimum] {
        &self.minima[lane][..self.n[lane]]
    }
}

/// A9 and A10; `found` is where the minima are stored.
#[inline(always)]
pub(super) fn minima(d: &Ranges, along: &Along, found: &mut Found, values: &mut Values) {
    let (mut distance, mut angle): (Singles, Singles) = (Lanes::all(0.0), Lanes::all(0.0));
    deepest_minima(d, found);
    for lane in 0..WIDTH {
        if let Some((one, other)) = two_deepest(found.of_lane(lane)) {
            let point = |minimum: Minimum| end_point(d, lane, along, minimum.half_beams as usize);
            let (p, q) = (point(one), point(other));
            let (x, y) = (p.0 - q.0, p.1 - q.1);
            distance.0[lane] = (x * x + y * y).sqrt() as f32;
            angle.0[lane] = apart(one, other) as f32 * (180.0 / N_BEAMS as f32);
        }
    }
    values.set(M::MinimaDistance, distance);
    values.set(M::MinimaAngle, angle);
}

/// Finds the minima of every circular scan that rise by the prominence on both sides, without those that are higher than two
/// before them.
///
/// Goes around once from the longest beam, and in turn follows a descent until it has risen by the prominence from its
/// lowest beam, and a rise until it has fallen by the prominence from its highest. All scans take a step together.
#[inline(always)]
fn deepest_minima(d: &Ranges, found: &mut Found) {
    found.n = [0; WIDTH];
    // A sign turns descents into rises: with it, both are rises to an extreme.
    let (mut extreme, starts) = longest(d);
    let mut sign = Lanes::all(0u32);
    // The extreme without the prominence. It is kept separately, so that a step depends little on the one before.
    let prominence = Lanes::all(PROMINENCE_M);
    let mut limit = extreme - prominence;
    // The steps on which the extreme was reached.
    let (mut first, mut last) = (Lanes::all(0u32), Lanes::all(0u32));
    // The two deepest so far.
    let (mut deepest, mut next) = (Lanes::all(f32::INFINITY), Lanes::all(f32::INFINITY));
    // Once around, and the start again.
    for begin in (0..=N_BEAMS).step_by(TOGETHER) {
        let turned = from_starts(d, &starts, begin);
        for (range, step) in turned.iter().zip(begin..=N_BEAMS) {
            let range = range.zip(sign, |range, sign| f32::from_bits(range.to_bits() ^ sign));
            let turns = range.zip(limit, |range, limit| if range <= limit { DOWN } else { 0 });
            let rises = turns.zip(sign, |turns, sign| turns & sign);
            let minimum = rises.choose(-extreme, Lanes::all(f32::INFINITY));
            let is_new =
                minimum.zip(next, |minimum, next| u32::from(minimum <= next && minimum < f32::INFINITY));
            next = next.min(deepest.max(minimum));
            deepest = deepest.min(minimum);
            if is_new.is_any() {
                // Copies, so that what the loop works on stays in registers.
                let (minimum, first, last) = (minimum, first, last);
                found.add(&minimum, &starts, &first.0, &last.0, &is_new);
            }
            limit = turns.choose(-range - prominence, limit.max(range - prominence));
            sign = sign.zip(turns, |sign, turns| sign ^ turns);
            let further = range.zip(extreme, |range, extreme| if range > extreme { DOWN } else { 0 });
            let further = further.zip(turns, |further, turns| further | turns);
            let range = turns.choose(-range, range);
            extreme = further.choose(range, extreme);
            let step = Lanes::all(step as u32);
            first = further.choose(step, first);
            let is_last = range.zip(extreme, |range, extreme| if range >= extreme { DOWN } else { 0 });
            last = is_last.choose(step, last);
        }
    }
}

/// The longest range of every scan, and the first beam that has it.
#[inline(always)]
fn longest(d: &Ranges) -> (Singles, [u32; WIDTH]) {
    let (mut longest, mut beams) = (d[0], [0; WIDTH]);
    for (beam, ranges) in d[..N_BEAMS].iter().enumerate() {
        for lane in 0..WIDTH {
            let longer = ranges.0[lane] > longest.0[lane];
            beams[lane] = if longer { beam as u32 } else { beams[lane] };
            longest.0[lane] = if longer { ranges.0[lane] } else { longest.0[lane] };
        }
    }
    (longest, beams)
}

/// Some beams of every scan, from beam number `begin` after its start on.
#[inline(always)]
fn from_starts(d: &Ranges, starts: &[u32; WIDTH], begin: usize) -> [Singles; TOGETHER] {
    let mut turned = [ZERO; TOGETHER];
    for lane in 0..WIDTH {
        let first = (starts[lane] as usize + begin) % N_BEAMS;
        if let Some(ranges) = d[first..].first_chunk::<TOGETHER>() {
            for (turned, ranges) in turned.iter_mut().zip(ranges) {
                turned.0[lane] = ranges.0[lane];
            }
        } else {
            for (turned, beam) in turned.iter_mut().zip(first..) {
                turned.0[lane] = d[beam % N_BEAMS].0[lane];
            }
        }
    }
    turned
}

/// The deepest minimum and the next, farthest apart among equals.
fn two_deepest(minima: &[Minimum]) -> Option<(Minimum, Minimum)> {
    let deepest = minima.iter().map(|m| m.range).fold(f32::INFINITY, f32::min);
    let is_deepest = |m: &&Minimum| m.range <= deepest;
    let next = if minima.iter().filter(is_deepest).count() > 1 {
        deepest
    } else {
        minima.iter().filter(|m| m.range > deepest).map(|m| m.range).fold(f32::INFINITY, f32::min)
    };
    let mut best = None;
    for &one in minima.iter().filter(is_deepest) {
        for &other in minima.iter().filter(|m| m.range <= next && m.half_beams != one.half_beams) {
            if other.range >= next && best.is_none_or(|(a, b)| apart(one, other) > apart(a, b)) {
                best = Some((one, other));
            }
        }
    }
    best
}

/// Angle between two minima, in half beams, at most half a turn.
fn apart(one: Minimum, other: Minimum) -> u32 {
    let steps = one.half_beams.abs_diff(other.half_beams);
    steps.min(TURN - steps)
}

/// The end point of a beam, or half way between those of two neighbors; in meters from the robot.
fn end_point(d: &Ranges, lane: usize, along: &Along, half_beams: usize) -> (f64, f64) {
    let point = |beam: usize| {
        let beam = beam % N_BEAMS;
        let range = f64::from(d[beam].0[lane]);
        (along.x[beam] * range, along.y[beam] * range)
    };
    let (p, q) = (point(half_beams / 2), point(half_beams.div_ceil(2)));
    (0.5 * (p.0 + q.0), 0.5 * (p.1 + q.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn minima_of(changes: &[(usize, f32)]) -> Vec<Minimum> {
        let mut d = [Lanes::all(2.0); N_BEAMS + 1];
        for &(beam, range) in changes {
            // Another scan in the other lanes.
            d[beam].0[3] = range;
        }
        d[N_BEAMS] = d[0];
        let mut found = Found::NONE;
        deepest_minima(&d, &mut found);
        found.of_lane(3).to_vec()
    }

    #[test]
    fn a_shallow_dent_is_no_minimum() {
        let found = minima_of(&[(10, 1.0), (100, 1.95), (200, 1.5)]);
        assert_eq!(found.iter().map(|m| m.half_beams).collect::<Vec<_>>(), [20, 400]);
        assert!(minima_of(&[]).is_empty());
    }

    #[test]
    fn a_plateau_counts_once_in_its_middle_even_across_beam_0() {
        assert_eq!(minima_of(&[(359, 1.0), (0, 1.0)]), [Minimum { range: 1.0, half_beams: 719 }]);
    }

    #[test]
    fn equal_minima_farthest_apart_are_taken() {
        let found = minima_of(&[(0, 1.0), (100, 1.0), (190, 1.0), (300, 0.9)]);
        let (one, other) = two_deepest(&found).unwrap();
        assert_eq!((one.half_beams, other.half_beams), (600, 200));
    }
}
