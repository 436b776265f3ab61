//! A8: beams on straight lines, by split and merge.
//!
//! Beams of 6 m and more are left out. Neighboring end points more than 0.3 m apart separate arcs; an arc is
//! split at the point farthest from its chord while that is more than 0.1 m away; what remains counts if it
//! has at least 5 points and a chord of at least 0.4 m.
//!
//! **Deviations** from the author's program: the scan is a circle, not a list with a first beam (a ring
//! without a gap is split at its start, which follows the widest step, and at the point farthest from it), and
//! a point where two lines meet counts once. Lengths are compared with a tolerance of 0.1 mm, because walls in
//! a grid are whole cells apart, and rounding would decide.

use super::families::Measure as M;
use super::lanes::{Lanes, Singles, WIDTH};
use super::values::{Ranges, Values};
use crate::scan::N_BEAMS;

const RANGE_MAX_M: f32 = 6.0;
const GAP_M: f64 = 0.3;
const CHORD_MIN_M: f64 = 0.4;
const FARTHEST_M: f64 = 0.1;
const N_MIN: usize = 5;
const TOLERANCE_M: f64 = 1e-4;

/// Points of a scan, twice around, so that any start can be first.
struct Points {
    x: [f64; 2 * N_BEAMS],
    y: [f64; 2 * N_BEAMS],
    /// Number of points once around.
    n: usize,
}

/// A number per point: squared lengths.
type Squares = [f64; N_BEAMS + 1];

/// A8.
#[inline(always)]
pub(super) fn lines(d: &Ranges, along: &[(f64, f64); N_BEAMS], values: &mut Values) {
    let mut counts: Singles = Lanes::all(0.0);
    let mut points = Points::none();
    for lane in 0..WIDTH {
        let mut n = 0;
        for (range, along) in d.iter().zip(along) {
            let range = range.0[lane];
            // Written in any case, kept if near: without a branch, which nobody could foresee.
            points.x[n] = along.0 * f64::from(range);
            points.y[n] = along.1 * f64::from(range);
            n += usize::from(range < RANGE_MAX_M);
        }
        points.n = n;
        counts.0[lane] = n_on_lines(&mut points) as f32;
    }
    values.set(M::BeamsOnLines, counts);
}

impl Points {
    fn none() -> Self {
        Self { x: [0.0; 2 * N_BEAMS], y: [0.0; 2 * N_BEAMS], n: 0 }
    }

    #[inline(always)]
    fn distance2(&self, one: usize, other: usize) -> f64 {
        let (x, y) = (self.x[other] - self.x[one], self.y[other] - self.y[one]);
        x * x + y * y
    }
}

/// Number of points on lines.
#[inline(always)]
fn n_on_lines(points: &mut Points) -> usize {
    let n = points.n;
    if n < N_MIN {
        return 0;
    }
    points.x.copy_within(..n, n);
    points.y.copy_within(..n, n);
    let mut squares = [0.0; N_BEAMS + 1];
    let widest = widest_step(points, &mut squares);
    let gap2 = (GAP_M + TOLERANCE_M).powi(2);
    let mut on_line = [false; 2 * N_BEAMS];
    // The points from `start` on, which follows the widest step.
    let start = (widest + 1) % n;
    if squares[widest] <= gap2 {
        // The start is both ends of the ring, and its chord a point.
        let opposite = farthest(points, start, start + n, &mut squares).0;
        mark_lines(points, start, opposite, &mut on_line, &mut squares);
        mark_lines(points, opposite, start + n, &mut on_line, &mut squares);
        on_line[start] |= on_line[start + n];
    } else {
        let steps = squares;
        let mut first = start;
        for last in start..start + n {
            if last + 1 == start + n || steps[if last < n { last } else { last - n }] > gap2 {
                mark_lines(points, first, last, &mut on_line, &mut squares);
                first = last + 1;
            }
        }
    }
    on_line[start..start + n].iter().filter(|&&marked| marked).count()
}

/// The point before the widest step; of equal ones, that before the first point, else the first.
#[inline(always)]
fn widest_step(points: &Points, steps2: &mut Squares) -> usize {
    let n = points.n;
    let (x, y) = (&points.x[..=n], &points.y[..=n]);
    for (i, step2) in steps2[..n].iter_mut().enumerate() {
        let (x, y) = (x[i + 1] - x[i], y[i + 1] - y[i]);
        *step2 = x * x + y * y;
    }
    let (first, largest) = largest(&steps2[..n]);
    if steps2[n - 1] >= largest { n - 1 } else { first }
}

/// Splits the arc from point `first` to `last` until its parts are straight, and marks those that are lines.
#[inline(always)]
fn mark_lines(
    points: &Points,
    first: usize,
    last: usize,
    on_line: &mut [bool; 2 * N_BEAMS],
    squares: &mut Squares,
) {
    let chord2 = (CHORD_MIN_M - TOLERANCE_M).powi(2);
    let mut parts = vec![(first, last)];
    while let Some((first, last)) = parts.pop() {
        if last + 1 - first < N_MIN || points.distance2(first, last) < chord2 {
            continue;
        }
        let (index, distance) = farthest(points, first, last, squares);
        if distance > FARTHEST_M + TOLERANCE_M {
            parts.extend([(first, index), (index, last)]);
        } else {
            on_line[first..=last].fill(true);
        }
    }
}

/// The point from `first` to `last` that is farthest from the line through these two, or from them if they are the
/// same.
#[inline(always)]
fn farthest(points: &Points, first: usize, last: usize, squares: &mut Squares) -> (usize, f64) {
    let (x, y) = (&points.x[first..=last], &points.y[first..=last]);
    let squares = &mut squares[..x.len()];
    let (x_0, y_0) = (x[0], y[0]);
    let chord = (points.x[last] - x_0, points.y[last] - y_0);
    let length2 = points.distance2(first, last);
    // Squared distance, times the squared length of the chord if it has one.
    if length2 > 0.0 {
        for ((square, x), y) in squares.iter_mut().zip(x).zip(y) {
            let cross = (x - x_0) * chord.1 - (y - y_0) * chord.0;
            *square = cross * cross;
        }
    } else {
        for ((square, x), y) in squares.iter_mut().zip(x).zip(y) {
            *square = (x - x_0) * (x - x_0) + (y - y_0) * (y - y_0);
        }
    }
    let (index, square) = largest(squares);
    (first + index, (if length2 > 0.0 { square / length2 } else { square }).sqrt())
}

/// The largest of numbers that are not negative, and where it first stands.
#[inline(always)]
fn largest(numbers: &[f64]) -> (usize, f64) {
    // In eight parts, which the compiler puts side by side.
    const PARTS: usize = 8;
    let (mut largest, mut chunk_of) = ([0.0; PARTS], [0u64; PARTS]);
    let (chunks, rest) = numbers.as_chunks::<PARTS>();
    for (number, chunk) in chunks.iter().enumerate() {
        for part in 0..PARTS {
            let larger = chunk[part] > largest[part];
            largest[part] = if larger { chunk[part] } else { largest[part] };
            chunk_of[part] = if larger { number as u64 } else { chunk_of[part] };
        }
    }
    let mut best = (0, 0.0);
    for part in 0..PARTS {
        let (index, number) = (chunk_of[part] as usize * PARTS + part, largest[part]);
        if number > best.1 || number >= best.1 && index < best.0 {
            best = (index, number);
        }
    }
    for (index, &number) in rest.iter().enumerate() {
        if number > best.1 {
            best = (chunks.len() * PARTS + index, number);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(of_points: impl Iterator<Item = (f64, f64)>) -> usize {
        let mut points = Points::none();
        for (x, y) in of_points {
            (points.x[points.n], points.y[points.n]) = (x, y);
            points.n += 1;
        }
        n_on_lines(&mut points)
    }

    #[test]
    fn a_rectangle_is_four_lines() {
        let side = |i: usize| 0.1 * i as f64;
        let corner = |i: usize| match i / 20 {
            0 => (side(i), 0.0),
            1 => (2.0, side(i % 20)),
            2 => (2.0 - side(i % 20), 2.0),
            _ => (0.0, 2.0 - side(i % 20)),
        };
        assert_eq!(count((0..80).map(corner)), 80);
        // Without one side and what is near it, three lines are left, and a gap.
        assert_eq!(count((0..60).map(corner)), 60);
    }

    #[test]
    fn scattered_points_are_no_line() {
        assert_eq!(count((0..20).map(|i| (i as f64, 0.0))), 0);
        assert_eq!(count(std::iter::empty()), 0);
    }
}
