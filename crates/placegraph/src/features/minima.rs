//! A9 and A10: the two deepest local minima of a scan, in a doorway its two jambs.
//!
//! **Deviations.** The author's program looks for runs of beams from a start beam and so depends on where the
//! robot looks. Here the scan is a circle: a minimum counts if the range rises by [`PROMINENCE_M`] on both
//! sides before it falls below the minimum; several equal beams are represented by the middle of the first
//! and the last; of equally deep minima those farthest apart are taken.

use super::families::Measure as M;
use super::lanes::{Lanes, Singles, WIDTH};
use super::values::{Ranges, Values};
use crate::scan::{N_BEAMS, beam_direction};

/// Rise on both sides of a minimum, in meters: two cells of 5 cm (δ of the book, for which no value is known).
const PROMINENCE_M: f32 = 0.1;

/// A local minimum: its range, and twice its position in beams.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Minimum {
    range: f32,
    half_beams: usize,
}

/// A9 and A10.
pub(super) fn minima(d: &Ranges, values: &mut Values) {
    let (mut distance, mut angle): (Singles, Singles) = (Lanes::all(0.0), Lanes::all(0.0));
    let mut scan = [0.0; N_BEAMS];
    let mut found = Vec::new();
    for lane in 0..WIDTH {
        for (range, lanes) in scan.iter_mut().zip(d) {
            *range = lanes.0[lane];
        }
        local_minima(&scan, &mut found);
        if let Some((one, other)) = two_deepest(&found) {
            let (p, q) = (end_point(&scan, one.half_beams), end_point(&scan, other.half_beams));
            distance.0[lane] = (p.0 - q.0).hypot(p.1 - q.1) as f32;
            angle.0[lane] = apart(one, other) as f32 * (180.0 / N_BEAMS as f32);
        }
    }
    values.set(M::MinimaDistance, distance);
    values.set(M::MinimaAngle, angle);
}

/// Fills `found` with the minima of the circular scan that rise by the prominence on both sides.
///
/// Goes around once from the longest beam, and in turn follows a descent until it has risen by the prominence
/// from its lowest beam, and a rise until it has fallen by the prominence from its highest.
fn local_minima(scan: &[f32; N_BEAMS], found: &mut Vec<Minimum>) {
    found.clear();
    let start = (1..N_BEAMS).fold(0, |best, i| if scan[i] > scan[best] { i } else { best });
    let (mut highest, mut lowest) = (scan[start], f32::INFINITY);
    let (mut first, mut last) = (0, 0);
    let mut descending = false;
    for beam in start..=start + N_BEAMS {
        let range = scan[beam % N_BEAMS];
        if !descending {
            highest = highest.max(range);
            if range > highest - PROMINENCE_M {
                continue;
            }
            descending = true;
            lowest = f32::INFINITY;
        }
        if range < lowest {
            (lowest, first) = (range, beam);
        }
        if range <= lowest {
            last = beam;
        }
        if range >= lowest + PROMINENCE_M {
            found.push(Minimum { range: lowest, half_beams: (first + last) % (2 * N_BEAMS) });
            descending = false;
            highest = range;
        }
    }
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
fn apart(one: Minimum, other: Minimum) -> usize {
    let steps = one.half_beams.abs_diff(other.half_beams);
    steps.min(2 * N_BEAMS - steps)
}

/// The end point of a beam, or half way between those of two neighbors; in meters from the robot.
fn end_point(scan: &[f32; N_BEAMS], half_beams: usize) -> (f64, f64) {
    let point = |beam: usize| {
        let (direction, range) = (beam_direction(beam % N_BEAMS), f64::from(scan[beam % N_BEAMS]));
        (direction.x * range, direction.y * range)
    };
    let (p, q) = (point(half_beams / 2), point(half_beams.div_ceil(2)));
    (0.5 * (p.0 + q.0), 0.5 * (p.1 + q.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn minima_of(changes: &[(usize, f32)]) -> Vec<Minimum> {
        let mut scan = [2.0; N_BEAMS];
        for &(beam, range) in changes {
            scan[beam] = range;
        }
        let mut found = Vec::new();
        local_minima(&scan, &mut found);
        found
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
