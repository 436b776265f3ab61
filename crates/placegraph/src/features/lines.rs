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
    let mut widest = (n - 1, distance2(points[n - 1], points[0]));
    for (index, pair) in points.windows(2).enumerate() {
        let step2 = distance2(pair[0], pair[1]);
        if step2 > widest.1 {
            widest = (index, step2);
        }
    }
    let (widest, is_ring) = (widest.0, widest.1 <= (GAP_M + TOLERANCE_M).powi(2));
    points.rotate_left((widest + 1) % n);
    let mut on_line = [false; N_BEAMS + 1];
    if is_ring {
        // The start is both ends of the ring, and its chord a point.
        points.push(points[0]);
        let opposite = farthest(points).0;
        mark_lines(&points[..=opposite], &mut on_line[..=opposite]);
        mark_lines(&points[opposite..], &mut on_line[opposite..=n]);
        on_line[0] |= on_line[n];
    } else {
        let mut start = 0;
        for end in 1..=n {
            if end == n || distance2(points[end - 1], points[end]) > (GAP_M + TOLERANCE_M).powi(2) {
                mark_lines(&points[start..end], &mut on_line[start..end]);
                start = end;
            }
        }
    }
    on_line[..n].iter().filter(|&&marked| marked).count()
}

fn distance2(p: Point2, q: Point2) -> f64 {
    (q - p).dot(q - p)
}

/// Splits the arc of `points` until its parts are straight, and marks those that are lines.
fn mark_lines(points: &[Point2], on_line: &mut [bool]) {
    let n = points.len();
    if n < N_MIN || distance2(points[0], points[n - 1]) < (CHORD_MIN_M - TOLERANCE_M).powi(2) {
        return;
    }
    let (index, distance) = farthest(points);
    if distance > FARTHEST_M + TOLERANCE_M {
        mark_lines(&points[..=index], &mut on_line[..=index]);
        mark_lines(&points[index..], &mut on_line[index..]);
    } else {
        on_line.fill(true);
    }
}

/// The point farthest from the line through the first and the last, or from them if they are the same.
fn farthest(points: &[Point2]) -> (usize, f64) {
    let (first, last) = (points[0], points[points.len() - 1]);
    let chord = last - first;
    let length2 = chord.dot(chord);
    // Squared distance, times the squared length of the chord if it has one.
    let distance2 = |point: Point2| {
        let step = point - first;
        if length2 > 0.0 { step.cross(chord) * step.cross(chord) } else { step.dot(step) }
    };
    let mut best = (0, 0.0);
    for (index, &point) in points.iter().enumerate() {
        let here = distance2(point);
        if here > best.1 {
            best = (index, here);
        }
    }
    (best.0, (if length2 > 0.0 { best.1 / length2 } else { best.1 }).sqrt())
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
