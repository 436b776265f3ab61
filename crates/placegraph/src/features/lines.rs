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
use crate::geom::{Point2, Vec2};
use crate::scan::{N_BEAMS, beam_direction};

const RANGE_MAX_M: f32 = 6.0;
const GAP_M: f64 = 0.3;
const CHORD_MIN_M: f64 = 0.4;
const FARTHEST_M: f64 = 0.1;
const N_MIN: usize = 5;
const TOLERANCE_M: f64 = 1e-4;

/// A8.
pub(super) fn lines(d: &Ranges, values: &mut Values) {
    let directions: Vec<Vec2> = (0..N_BEAMS).map(beam_direction).collect();
    let mut counts: Singles = Lanes::all(0.0);
    let mut points = Vec::with_capacity(N_BEAMS + 1);
    for lane in 0..WIDTH {
        points.clear();
        let near = d[..N_BEAMS].iter().zip(&directions).filter(|(range, _)| range.0[lane] < RANGE_MAX_M);
        points.extend(near.map(|(range, along)| Point2::default() + *along * f64::from(range.0[lane])));
        counts.0[lane] = n_on_lines(&mut points) as f32;
    }
    values.set(M::BeamsOnLines, counts);
}

/// Number of points on lines; turns the ring of `points` to start after its widest step.
fn n_on_lines(points: &mut Vec<Point2>) -> usize {
    let n = points.len();
    if n < N_MIN {
        return 0;
    }
    let step = |i: usize| points[i].distance(points[(i + 1) % n]);
    let widest = (1..n).fold(0, |best, i| if step(i) > step(best) { i } else { best });
    let is_ring = step(widest) <= GAP_M + TOLERANCE_M;
    points.rotate_left((widest + 1) % n);
    let mut count = Count { n: 0, last_end: usize::MAX };
    if is_ring {
        // The start is both ends of the ring; its chord is a point.
        points.push(points[0]);
        let opposite = farthest(points).0;
        count.split(&points[..=opposite], 0);
        count.split(&points[opposite..], opposite);
        return count.n.min(n);
    }
    let mut start = 0;
    for end in 1..=n {
        if end == n || points[end - 1].distance(points[end]) > GAP_M + TOLERANCE_M {
            count.split(&points[start..end], start);
            start = end;
        }
    }
    count.n
}

/// Points on accepted lines so far, and where the last line ended.
struct Count {
    n: usize,
    last_end: usize,
}

impl Count {
    /// Splits the arc of `points`, the first of which has number `start`, until its parts are straight.
    fn split(&mut self, points: &[Point2], start: usize) {
        let n = points.len();
        if n < N_MIN || points[0].distance(points[n - 1]) < CHORD_MIN_M - TOLERANCE_M {
            return;
        }
        let (index, distance) = farthest(points);
        if distance > FARTHEST_M + TOLERANCE_M {
            self.split(&points[..=index], start);
            self.split(&points[index..], start + index);
            return;
        }
        self.n += n - usize::from(self.last_end == start);
        self.last_end = start + n - 1;
    }
}

/// The point farthest from the line through the first and the last, or from them if they are the same.
fn farthest(points: &[Point2]) -> (usize, f64) {
    let (first, last) = (points[0], points[points.len() - 1]);
    let (chord, length) = (last - first, first.distance(last));
    let distance = |point: Point2| {
        let step = point - first;
        if length > 0.0 { step.cross(chord).abs() / length } else { step.length() }
    };
    let mut best = (0, 0.0);
    for (index, &point) in points.iter().enumerate() {
        let here = distance(point);
        if here > best.1 {
            best = (index, here);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_is_four_lines() {
        let mut points = Vec::new();
        for i in 0..20 {
            points.push(Point2::new(0.1 * i as f64, 0.0));
        }
        for i in 0..20 {
            points.push(Point2::new(2.0, 0.1 * i as f64));
        }
        for i in 0..20 {
            points.push(Point2::new(2.0 - 0.1 * i as f64, 2.0));
        }
        for i in 0..20 {
            points.push(Point2::new(0.0, 2.0 - 0.1 * i as f64));
        }
        assert_eq!(n_on_lines(&mut points), 80);
    }

    #[test]
    fn scattered_points_are_no_line() {
        let mut points: Vec<_> = (0..20).map(|i| Point2::new(i as f64, 0.0)).collect();
        assert_eq!(n_on_lines(&mut points), 0);
        assert_eq!(n_on_lines(&mut Vec::new()), 0);
    }
}
