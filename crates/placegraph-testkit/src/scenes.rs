//! Scans of walls that are exact line segments.

use placegraph::geom::{Point2, Vec2};
use placegraph::scan::{N_BEAMS, RangeScan, beam_angle_rad};

/// The scan of a robot at `at` among closed polylines of walls, in meters.
///
/// # Panics
/// If a beam meets no wall.
pub fn scan_of_walls(walls: &[Vec<Point2>], at: Point2) -> RangeScan {
    let ranges = (0..N_BEAMS).map(|beam| {
        let (sin, cos) = beam_angle_rad(beam).sin_cos();
        let hits = walls.iter().flat_map(|wall| {
            let ends = wall.iter().cycle().skip(1);
            wall.iter().zip(ends).filter_map(move |(&p, &q)| hit(at, Vec2::new(cos, sin), p, q))
        });
        hits.fold(f64::INFINITY, f64::min)
    });
    RangeScan::new(ranges.collect())
}

/// Distance from `at` along `direction` to the segment from `p` to `q`.
fn hit(at: Point2, direction: Vec2, p: Point2, q: Point2) -> Option<f64> {
    let (edge, to_p) = (q - p, p - at);
    let determinant = direction.cross(edge);
    let distance = to_p.cross(edge) / determinant;
    let along_edge = to_p.cross(direction) / determinant;
    (distance > 0.0 && (-1e-12..=1.0 + 1e-12).contains(&along_edge)).then_some(distance)
}

fn closed(corners: &[(f64, f64)]) -> Vec<Point2> {
    corners.iter().map(|&(x, y)| Point2::new(x, y)).collect()
}

/// A room of 6 × 4 m, the robot 1 m and 1.5 m from the lower left corner.
pub fn rectangle() -> RangeScan {
    let room = closed(&[(0.0, 0.0), (6.0, 0.0), (6.0, 4.0), (0.0, 4.0)]);
    scan_of_walls(&[room], Point2::new(1.0, 1.5))
}

/// Two rooms of 4 × 4 m that a doorway of 0.9 m joins through a wall of 0.2 m, the robot in the doorway.
pub fn doorway() -> RangeScan {
    let rooms = closed(&[
        (-4.1, -2.0),
        (-0.1, -2.0),
        (-0.1, -0.45),
        (0.1, -0.45),
        (0.1, -2.0),
        (4.1, -2.0),
        (4.1, 2.0),
        (0.1, 2.0),
        (0.1, 0.45),
        (-0.1, 0.45),
        (-0.1, 2.0),
        (-4.1, 2.0),
    ]);
    scan_of_walls(&[rooms], Point2::new(0.03, 0.02))
}
