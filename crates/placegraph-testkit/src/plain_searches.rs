//! The two features that search: A8 by marking beams, A9 and A10 by the definition of a minimum.

#![expect(clippy::unwrap_used, reason = "an oracle panics where a test would")]
#![expect(clippy::float_cmp, reason = "a plateau is of equal ranges")]

use placegraph::geom::Point2;
use placegraph::scan::N_BEAMS;

use crate::plain_features::vertices;

/// Walls of grid maps are whole cells apart, so limits are met exactly: they have a tolerance.
const TOLERANCE_M: f64 = 1e-4;

/// A8: beams below 6 m on lines.
pub fn beams_on_lines(d: &[f64]) -> f64 {
    let all = vertices(d);
    let mut points: Vec<Point2> = (0..N_BEAMS).filter(|&i| d[i] < 6.0).map(|i| all[i]).collect();
    let n = points.len();
    if n < 5 {
        return 0.0;
    }
    let is_gap = |p: Point2, q: Point2| p.distance(q) > 0.3 + TOLERANCE_M;
    let step = |points: &[Point2], i: usize| points[i].distance(points[(i + 1) % n]);
    let widest = (0..n).max_by(|&i, &j| step(&points, i).total_cmp(&step(&points, j))).unwrap();
    points.rotate_left((widest + 1) % n);
    let mut on_line = vec![false; n + 1];
    if is_gap(points[n - 1], points[0]) {
        let mut start = 0;
        for i in 0..n {
            if i + 1 == n || is_gap(points[i], points[i + 1]) {
                mark_lines(&points, start, i, &mut on_line);
                start = i + 1;
            }
        }
    } else {
        points.push(points[0]);
        let opposite = (0..n)
            .max_by(|&i, &j| points[0].distance(points[i]).total_cmp(&points[0].distance(points[j])))
            .unwrap();
        mark_lines(&points, 0, opposite, &mut on_line);
        mark_lines(&points, opposite, n, &mut on_line);
        on_line[0] |= on_line[n];
        on_line[n] = false;
    }
    on_line.iter().filter(|&&marked| marked).count() as f64
}

/// Marks the points `first..=last` that lie on lines.
fn mark_lines(points: &[Point2], first: usize, last: usize, on_line: &mut [bool]) {
    let chord = points[last] - points[first];
    if last - first + 1 < 5 || chord.length() < 0.4 - TOLERANCE_M {
        return;
    }
    let distance = |i: usize| (points[i] - points[first]).cross(chord).abs() / chord.length();
    let mut farthest = first;
    for i in first..=last {
        if distance(i) > distance(farthest) {
            farthest = i;
        }
    }
    if distance(farthest) > 0.1 + TOLERANCE_M {
        mark_lines(points, first, farthest, on_line);
        mark_lines(points, farthest, last, on_line);
    } else {
        on_line[first..=last].fill(true);
    }
}

/// A9 and A10: distance in meters and angle in degrees between the two deepest minima.
pub fn two_minima(d: &[f64]) -> (f64, f64) {
    let minima = minima(d);
    let mut pairs = Vec::new();
    for (i, &one) in minima.iter().enumerate() {
        for &other in &minima[i + 1..] {
            let steps = one.1.abs_diff(other.1);
            let apart = steps.min(2 * N_BEAMS - steps);
            pairs.push((one.0.min(other.0), one.0.max(other.0), apart, one.1, other.1));
        }
    }
    // The deepest, then the next deepest, then the widest angle.
    pairs.sort_by(|p, q| p.0.total_cmp(&q.0).then(p.1.total_cmp(&q.1)).then(q.2.cmp(&p.2)));
    let Some(&(_, _, apart, one, other)) = pairs.first() else { return (0.0, 0.0) };
    let all = vertices(d);
    let point = |half: usize| all[half / 2 % N_BEAMS].midpoint(all[half.div_ceil(2) % N_BEAMS]);
    (point(one).distance(point(other)), apart as f64 * 180.0 / N_BEAMS as f64)
}

/// Range and twice the position of every minimum.
fn minima(d: &[f64]) -> Vec<(f64, usize)> {
    let at = |i: usize| d[i % N_BEAMS];
    // Steps from beam i until the range has risen by the prominence, if it is never lower before.
    let rise = |i: usize, step: usize| {
        let ranges = (1..=N_BEAMS).map(|k| (k, at(i + k * step)));
        let end = ranges.into_iter().find(|&(_, range)| range < at(i) || range >= at(i) + 0.1f32 as f64);
        end.filter(|&(_, range)| range >= at(i) + 0.1f32 as f64).map(|(k, _)| k)
    };
    let mut found = Vec::new();
    for i in 0..N_BEAMS {
        let (Some(left), Some(right)) = (rise(i, N_BEAMS - 1), rise(i, 1)) else { continue };
        // The first of equal beams speaks for all up to the last.
        if (1..left).any(|k| at(i + N_BEAMS * N_BEAMS - k) == at(i)) {
            continue;
        }
        let last = (0..right).rfind(|&k| at(i + k) == at(i)).unwrap();
        found.push((at(i), (2 * i + last) % (2 * N_BEAMS)));
    }
    found
}
