//! Every feature of the registry as its formula in `f64`, one scan and one feature at a time.

#![expect(clippy::unwrap_used, reason = "an oracle panics where a test would")]

use std::f64::consts::{PI, TAU};

use placegraph::features::Feature;
use placegraph::geom::{Point2, Vec2};
use placegraph::scan::{N_BEAMS, beam_angle_rad};

use crate::plain_searches::{beams_on_lines, two_minima};

const N: f64 = N_BEAMS as f64;

/// The value of `feature` for a scan with ranges `d` in meters.
///
/// # Panics
/// If the feature is not known here.
pub fn plain_feature(feature: &Feature, d: &[f64]) -> f64 {
    let parameter = feature.parameter.unwrap_or_default();
    let name = feature.book.or(feature.code).unwrap();
    match name.chars().next() {
        Some('A') => beam_feature(name, parameter, d),
        Some('B') => polygon_feature(name, parameter, d),
        _ => match name {
            "f17_2" => 1.0 + descriptor_ratio(d),
            "f18_2" => (1.0 - descriptor_ratio(d)).abs(),
            "f19_2" => (1.0 - descriptor_ratio(d)).abs() / (1.0 + descriptor_ratio(d)),
            "f33" => gaps(d, parameter) / (N - 1.0),
            "f34" => relative_gaps(d, parameter) / (N - 1.0),
            _ => panic!("no formula for {name}"),
        },
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn sd(values: &[f64]) -> f64 {
    let mean = mean(values);
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
}

fn max(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

/// f of every pair of consecutive values, the last with the first.
fn pairs(values: &[f64], f: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    (0..values.len()).map(|i| f(values[i], values[(i + 1) % values.len()])).collect()
}

fn differences(d: &[f64]) -> Vec<f64> {
    pairs(d, |one, next| (one - next).abs())
}

fn relations(d: &[f64]) -> Vec<f64> {
    pairs(d, |one, next| one.min(next) / one.max(next))
}

fn gaps(d: &[f64], limit: f64) -> f64 {
    differences(d).iter().filter(|&&difference| difference > limit).count() as f64
}

fn relative_gaps(d: &[f64], limit: f64) -> f64 {
    relations(d).iter().filter(|&&relation| relation < limit).count() as f64
}

fn beam_feature(name: &str, parameter: f64, d: &[f64]) -> f64 {
    let clipped: Vec<f64> = d.iter().map(|range| range.min(parameter)).collect();
    let normalized: Vec<f64> = d.iter().map(|range| range / max(d)).collect();
    match name {
        "A1" => mean(&differences(d)),
        "A2" => sd(&differences(d)),
        "A3" => mean(&differences(&clipped)),
        "A4" => sd(&differences(&clipped)),
        "A5" => mean(d),
        "A6" => sd(d),
        "A7" => gaps(d, parameter),
        "A8" => beams_on_lines(d),
        "A9" => two_minima(d).0,
        "A10" => two_minima(d).1,
        "A11" => mean(&relations(d)),
        "A12" => sd(&relations(d)),
        "A13" => mean(&normalized),
        "A14" => sd(&normalized),
        "A15" => relative_gaps(d, parameter),
        "A16" if sd(d) < 1e-9 => 0.0,
        "A16" => mean(&d.iter().map(|range| (range - mean(d)).powi(4)).collect::<Vec<_>>()) / sd(d).powi(4),
        _ => panic!("no formula for {name}"),
    }
}

fn polygon_feature(name: &str, parameter: f64, d: &[f64]) -> f64 {
    let vertices = vertices(d);
    let area = area(&vertices);
    let perimeter: f64 = edges(&vertices).iter().map(|edge| edge.length()).sum();
    if area <= 1e-9 || perimeter <= 1e-9 {
        return 0.0;
    }
    let centroid = centroid(&vertices);
    let radii: Vec<f64> = vertices.iter().map(|vertex| vertex.distance(centroid)).collect();
    let normalized: Vec<f64> = radii.iter().map(|radius| radius / max(&radii)).collect();
    let c = |k| coefficient(&vertices, k).length();
    let (major, minor) = (|| c(1) + c(-1), || (c(1) - c(-1)).abs());
    let moment = |p, q| central_moment(&vertices, p, q);
    let spread = || moment(2, 0) + moment(0, 2);
    match name {
        "B1" => area,
        "B2" => perimeter,
        "B3" => area / perimeter,
        "B4" => mean(&radii),
        "B5" => sd(&radii),
        "B6" => c(parameter as i32) / c(1),
        "B7" => major(),
        "B8" => minor(),
        "B9" => minor() / major(),
        "B10" => decades(moment_invariant(&vertices, parameter as usize)),
        "B11" => area / spread(),
        "B12" => ((moment(2, 0) - moment(0, 2)).powi(2) + 4.0 * moment(1, 1).powi(2)).sqrt() / spread(),
        "B13" => 4.0 * PI * area / perimeter.sqrt(),
        "B14" => perimeter.powi(2) / area,
        "B15" => 4.0 * PI * area / perimeter.powi(2),
        "B16" => mean(&normalized),
        "B17" => sd(&normalized),
        _ => panic!("no formula for {name}"),
    }
}

/// End points of the beams, in meters from the robot.
pub fn vertices(d: &[f64]) -> Vec<Point2> {
    let point = |(beam, range): (usize, &f64)| {
        let angle = beam_angle_rad(beam);
        Point2::new(range * angle.cos(), range * angle.sin())
    };
    d.iter().enumerate().map(point).collect()
}

fn edges(vertices: &[Point2]) -> Vec<Vec2> {
    (0..vertices.len()).map(|i| vertices[(i + 1) % vertices.len()] - vertices[i]).collect()
}

/// x_i y_{i+1} − x_{i+1} y_i.
fn crosses(vertices: &[Point2]) -> Vec<f64> {
    let cross = |p: Point2, q: Point2| p.x * q.y - q.x * p.y;
    (0..vertices.len()).map(|i| cross(vertices[i], vertices[(i + 1) % vertices.len()])).collect()
}

fn area(vertices: &[Point2]) -> f64 {
    0.5 * crosses(vertices).iter().sum::<f64>()
}

fn centroid(vertices: &[Point2]) -> Point2 {
    let (mut x, mut y) = (0.0, 0.0);
    for (i, cross) in crosses(vertices).into_iter().enumerate() {
        let (p, q) = (vertices[i], vertices[(i + 1) % vertices.len()]);
        x += (p.x + q.x) * cross;
        y += (p.y + q.y) * cross;
    }
    Point2::new(x / (6.0 * area(vertices)), y / (6.0 * area(vertices)))
}

fn central_moment(vertices: &[Point2], p: i32, q: i32) -> f64 {
    let n = vertices.len() as f64;
    let mean_x = vertices.iter().map(|vertex| vertex.x).sum::<f64>() / n;
    let mean_y = vertices.iter().map(|vertex| vertex.y).sum::<f64>() / n;
    vertices.iter().map(|vertex| (vertex.x - mean_x).powi(p) * (vertex.y - mean_y).powi(q)).sum()
}

/// Hu's invariant φ with this number, of η_pq = μ_pq / n^(p+q+2).
pub fn moment_invariant(vertices: &[Point2], number: usize) -> f64 {
    let n = vertices.len() as f64;
    let eta = |p: i32, q: i32| central_moment(vertices, p, q) / n.powi(p + q + 2);
    let (n20, n02, n11) = (eta(2, 0), eta(0, 2), eta(1, 1));
    let (n30, n03, n21, n12) = (eta(3, 0), eta(0, 3), eta(2, 1), eta(1, 2));
    match number {
        1 => n20 + n02,
        2 => (n20 - n02).powi(2) + 4.0 * n11.powi(2),
        3 => (n30 - 3.0 * n12).powi(2) + (3.0 * n21 - n03).powi(2),
        4 => (n30 + n12).powi(2) + (n21 + n03).powi(2),
        5 => {
            (n30 - 3.0 * n12) * (n30 + n12) * ((n30 + n12).powi(2) - 3.0 * (n21 + n03).powi(2))
                + (3.0 * n21 - n03) * (n21 + n03) * (3.0 * (n30 + n12).powi(2) - (n21 + n03).powi(2))
        }
        6 => {
            (n20 - n02) * ((n30 + n12).powi(2) - (n21 + n03).powi(2)) + 4.0 * n11 * (n30 + n12) * (n21 + n03)
        }
        7 => {
            (3.0 * n21 - n03) * (n30 + n12) * ((n30 + n12).powi(2) - 3.0 * (n21 + n03).powi(2))
                + (3.0 * n12 - n30) * (n21 + n03) * (3.0 * (n30 + n12).powi(2) - (n21 + n03).powi(2))
        }
        _ => panic!("there are seven invariants"),
    }
}

/// The scale on which B10 is stored.
pub fn decades(phi: f64) -> f64 {
    phi.signum() * (1.0 + phi.abs() / 1e-40).log10()
}

/// The Fourier coefficient c_k of the closed polyline over its arc length, k ≠ 0.
pub fn coefficient(vertices: &[Point2], k: i32) -> Vec2 {
    let edges: Vec<Vec2> = edges(vertices).into_iter().filter(|edge| edge.length() > 0.0).collect();
    let length: f64 = edges.iter().map(|edge| edge.length()).sum();
    let unit = |i: usize| edges[i] * (1.0 / edges[i].length());
    let mut sum = Vec2::default();
    let mut t = 0.0;
    for (j, edge) in edges.iter().enumerate() {
        let turn = unit((j + edges.len() - 1) % edges.len()) - unit(j);
        sum = sum + turn.rotated(-TAU * f64::from(k) * t / length);
        t += edge.length();
    }
    sum * (length / (TAU * f64::from(k)).powi(2))
}

fn descriptor_ratio(d: &[f64]) -> f64 {
    let vertices = vertices(d);
    coefficient(&vertices, -1).length() / coefficient(&vertices, 1).length()
}
