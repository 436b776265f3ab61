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
use super::moments::Along;
use super::values::Values;
use crate::scan::lanes::{Lanes, Singles, WIDTH, of_lane};
use crate::scan::{N_BEAMS, Ranges};

const RANGE_MAX_M: f32 = 6.0;
const GAP_M: f64 = 0.3;
const CHORD_MIN_M: f64 = 0.4;
const FARTHEST_M: f64 = 0.1;
const N_MIN: usize = 5;
const TOLERANCE_M: f64 = 1e-4;
/// Points that are looked at together: eight `f64`, one 512-bit register.
const TOGETHER: usize = 8;

/// Points of a scan, twice around, so that any start can be first.
struct Points {
    x: [f64; 2 * N_BEAMS],
    y: [f64; 2 * N_BEAMS],
    /// Number of points once around.
    n: usize,
}

/// A line through two points; all is measured from the first. Or that point alone, if they are the same.
#[derive(Clone, Copy)]
struct Chord {
    start: (f64, f64),
    along: (f64, f64),
    length2: f64,
}

/// The points on lines of neighboring arcs, from left to right.
struct Found {
    n_points: usize,
    /// Where the first line begins and the last one ends.
    ends: Option<(usize, usize)>,
}

/// A8.
#[inline(always)]
pub(super) fn lines(d: &Ranges, along: &Along, values: &mut Values) {
    let mut counts: Singles = Lanes::all(0.0);
    let mut points = Points { x: [0.0; 2 * N_BEAMS], y: [0.0; 2 * N_BEAMS], n: 0 };
    let mut ranges = [0.0; N_BEAMS];
    for lane in 0..WIDTH {
        of_lane(lane, &d[..N_BEAMS], &mut ranges);
        points.set(&ranges, along);
        counts.0[lane] = n_on_lines(&points) as f32;
    }
    values.set(M::BeamsOnLines, counts);
}

impl Points {
    /// The end points of the near beams, twice.
    #[inline(always)]
    fn set(&mut self, ranges: &[f32; N_BEAMS], along: &Along) {
        for beam in 0..N_BEAMS {
            self.x[beam] = along.x[beam] * f64::from(ranges[beam]);
            self.y[beam] = along.y[beam] * f64::from(ranges[beam]);
        }
        let mut n = 0;
        for start in (0..N_BEAMS).step_by(TOGETHER) {
            let near: [bool; TOGETHER] = std::array::from_fn(|i| ranges[start + i] < RANGE_MAX_M);
            if near.iter().all(|&near| near) {
                self.x.copy_within(start..start + TOGETHER, n);
                self.y.copy_within(start..start + TOGETHER, n);
                n += TOGETHER;
            } else {
                for (beam, near) in (start..).zip(near) {
                    (self.x[n], self.y[n]) = (self.x[beam], self.y[beam]);
                    n += usize::from(near);
                }
            }
        }
        self.n = n;
        self.repeat();
    }

    #[inline(always)]
    fn repeat(&mut self) {
        self.x.copy_within(..self.n, self.n);
        self.y.copy_within(..self.n, self.n);
    }

    #[inline(always)]
    fn chord(&self, first: usize, last: usize) -> Chord {
        let start = (self.x[first], self.y[first]);
        let along = (self.x[last] - start.0, self.y[last] - start.1);
        Chord { start, along, length2: along.0 * along.0 + along.1 * along.1 }
    }
}

/// Number of points on lines.
#[inline(always)]
fn n_on_lines(points: &Points) -> usize {
    let n = points.n;
    if n < N_MIN {
        return 0;
    }
    let mut steps2 = [0.0; N_BEAMS];
    let steps2 = &mut steps2[..n];
    let (x, y) = (&points.x[..=n], &points.y[..=n]);
    for (i, step2) in steps2.iter_mut().enumerate() {
        let (x, y) = (x[i + 1] - x[i], y[i + 1] - y[i]);
        *step2 = x * x + y * y;
    }
    let widest2 = largest(
        steps2,
        steps2,
        #[inline(always)]
        |step2, _| step2,
    );
    // Of equal ones, that before the first point, else the first.
    let widest = if steps2[n - 1] >= widest2 {
        n - 1
    } else {
        position(
            steps2,
            steps2,
            #[inline(always)]
            |step2, _| step2 >= widest2,
        )
    };
    let gap2 = (GAP_M + TOLERANCE_M).powi(2);
    // The points from `start` on, which follows the widest step.
    let start = (widest + 1) % n;
    let mut found = Found { n_points: 0, ends: None };
    if widest2 > gap2 {
        let mut gaps = [0u16; N_BEAMS];
        let mut n_gaps = 0;
        for (number, steps2) in steps2.chunks(TOGETHER).enumerate() {
            if steps2.iter().fold(0.0, |a: f64, &b| if a > b { a } else { b }) > gap2 {
                for (point, &step2) in (number * TOGETHER..).zip(steps2) {
                    gaps[n_gaps] = point as u16;
                    n_gaps += usize::from(step2 > gap2);
                }
            }
        }
        let mut first = start;
        let gaps = gaps[..n_gaps].iter().map(|&point| usize::from(point));
        let before_start = gaps.clone().filter(|&last| last < start).map(|last| last + n);
        for last in gaps.filter(|&last| last >= start).chain(before_start) {
            find_lines(points, first, last, &mut found);
            first = last + 1;
        }
    } else {
        // The start is both ends of the ring, and its chord a point.
        let opposite = points.chord(start, start + n).farthest(points, start, start + n);
        find_lines(points, start, opposite, &mut found);
        find_lines(points, opposite, start + n, &mut found);
        if found.ends == Some((start, start + n)) {
            found.n_points -= 1;
        }
    }
    found.n_points
}

/// Splits the arc from point `first` to `last` until its parts are straight, and counts the points of those that are
/// lines.
#[inline(always)]
fn find_lines(points: &Points, first: usize, last: usize, found: &mut Found) {
    let chord2 = (CHORD_MIN_M - TOLERANCE_M).powi(2);
    let farthest2 = (FARTHEST_M + TOLERANCE_M).powi(2);
    // What is left to do, the next part last.
    let mut parts = [(0u16, 0u16); N_BEAMS];
    parts[0] = (first as u16, last as u16);
    let mut n_parts = 1;
    while n_parts > 0 {
        n_parts -= 1;
        let (first, last) = (usize::from(parts[n_parts].0), usize::from(parts[n_parts].1));
        let chord = points.chord(first, last);
        if last + 1 - first < N_MIN || chord.length2 < chord2 {
            continue;
        }
        let square = chord.largest2(points, first, last);
        if square > farthest2 * chord.length2 {
            let index = chord.position(points, first, last, square);
            parts[n_parts] = (index as u16, last as u16);
            parts[n_parts + 1] = (first as u16, index as u16);
            n_parts += 2;
        } else {
            found.add(first, last);
        }
    }
}

impl Found {
    /// Counts the points of a line; one that the line before ends with counts once.
    #[inline(always)]
    fn add(&mut self, first: usize, last: usize) {
        let (begin, end) = self.ends.unwrap_or((first, usize::MAX));
        self.n_points += last - first + usize::from(end != first);
        self.ends = Some((begin, last));
    }
}

impl Chord {
    /// The point from `first` to `last` that is farthest away.
    #[inline(always)]
    fn farthest(self, points: &Points, first: usize, last: usize) -> usize {
        self.position(points, first, last, self.largest2(points, first, last))
    }

    /// The largest squared distance of points from the line, times the squared length of the chord if it has one.
    #[inline(always)]
    fn largest2(self, points: &Points, first: usize, last: usize) -> f64 {
        let (x, y) = (&points.x[first..=last], &points.y[first..=last]);
        if self.length2 > 0.0 {
            largest(
                x,
                y,
                #[inline(always)]
                |x, y| self.cross2(x, y),
            )
        } else {
            largest(
                x,
                y,
                #[inline(always)]
                |x, y| self.distance2(x, y),
            )
        }
    }

    /// The first point from `first` to `last` that is as far away as [`Chord::largest2`].
    #[inline(always)]
    fn position(self, points: &Points, first: usize, last: usize, square: f64) -> usize {
        let (x, y) = (&points.x[first..=last], &points.y[first..=last]);
        let index = if self.length2 > 0.0 {
            position(
                x,
                y,
                #[inline(always)]
                |x, y| self.cross2(x, y) >= square,
            )
        } else {
            position(
                x,
                y,
                #[inline(always)]
                |x, y| self.distance2(x, y) >= square,
            )
        };
        first + index
    }

    #[inline(always)]
    fn cross2(self, x: f64, y: f64) -> f64 {
        let cross = (x - self.start.0) * self.along.1 - (y - self.start.1) * self.along.0;
        cross * cross
    }

    #[inline(always)]
    fn distance2(self, x: f64, y: f64) -> f64 {
        (x - self.start.0) * (x - self.start.0) + (y - self.start.1) * (y - self.start.1)
    }
}

/// The largest f(x, y), which is not negative.
#[inline(always)]
fn largest(x: &[f64], y: &[f64], f: impl Fn(f64, f64) -> f64) -> f64 {
    let mut largest = [0.0; TOGETHER];
    let mut look_at = |x: &[f64; TOGETHER], y: &[f64; TOGETHER]| {
        for part in 0..TOGETHER {
            let value = f(x[part], y[part]);
            largest[part] = if value > largest[part] { value } else { largest[part] };
        }
    };
    for (x, y) in x.as_chunks().0.iter().zip(y.as_chunks().0) {
        look_at(x, y);
    }
    // The rest together with what is before it; twice does no harm.
    if let (Some(x), Some(y)) = (x.last_chunk(), y.last_chunk()) {
        look_at(x, y);
    } else {
        for (&x, &y) in x.iter().zip(y) {
            look_at(&[x; TOGETHER], &[y; TOGETHER]);
        }
    }
    largest.iter().fold(0.0, |a, &b| if a > b { a } else { b })
}

/// Where f first holds.
#[inline(always)]
fn position(x: &[f64], y: &[f64], f: impl Fn(f64, f64) -> bool) -> usize {
    let mut start = 0;
    for (x, y) in x.as_chunks::<TOGETHER>().0.iter().zip(y.as_chunks::<TOGETHER>().0) {
        if (0..TOGETHER).fold(false, |any, part| any | f(x[part], y[part])) {
            break;
        }
        start += TOGETHER;
    }
    let rest = x[start..].iter().zip(&y[start..]);
    start + rest.take_while(|(x, y)| !f(**x, **y)).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(of_points: impl Iterator<Item = (f64, f64)>) -> usize {
        let mut points = Points { x: [0.0; 2 * N_BEAMS], y: [0.0; 2 * N_BEAMS], n: 0 };
        for (x, y) in of_points {
            (points.x[points.n], points.y[points.n]) = (x, y);
            points.n += 1;
        }
        points.repeat();
        n_on_lines(&points)
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
    fn of_equal_points_the_first_is_found() {
        let ones = [1.0; 40];
        assert_eq!(position(&ones, &ones, |x, _| x >= 1.0), 0);
    }

    #[test]
    fn scattered_points_are_no_line() {
        assert_eq!(count((0..20).map(|i| (i as f64, 0.0))), 0);
        assert_eq!(count(std::iter::empty()), 0);
    }
}
