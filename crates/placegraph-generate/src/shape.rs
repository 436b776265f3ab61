//! Rectangles and solids of a floor plan, in meters.

use placegraph::geom::{Point2, Vec2};

/// Direction in which a wall runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Along x.
    X,
    /// Along y.
    Y,
}

/// A rectangle with sides along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// Corner with the smallest coordinates.
    pub min: Point2,
    /// Corner with the largest coordinates.
    pub max: Point2,
}

impl Rect {
    /// The rectangle `x0..x1` by `y0..y1`.
    pub const fn new(x0: f64, y0: f64, x1: f64, y1: f64) -> Self {
        Self { min: Point2::new(x0, y0), max: Point2::new(x1, y1) }
    }

    /// A rectangle given along a wall (`lo..hi`) and across it (`from..to`).
    pub(crate) fn along(axis: Axis, (lo, hi): (f64, f64), (from, to): (f64, f64)) -> Self {
        match axis {
            Axis::X => Self::new(lo, from, hi, to),
            Axis::Y => Self::new(from, lo, to, hi),
        }
    }

    /// Extent along `axis`.
    pub fn span(&self, axis: Axis) -> (f64, f64) {
        match axis {
            Axis::X => (self.min.x, self.max.x),
            Axis::Y => (self.min.y, self.max.y),
        }
    }

    /// Length along x.
    pub fn width(&self) -> f64 {
        self.max.x - self.min.x
    }

    /// Length along y.
    pub fn height(&self) -> f64 {
        self.max.y - self.min.y
    }

    /// Area in square meters.
    pub fn area(&self) -> f64 {
        self.width() * self.height()
    }

    /// The middle.
    pub fn center(&self) -> Point2 {
        self.min.midpoint(self.max)
    }

    /// Grown by `margin` on all sides; shrunk if it is negative.
    pub fn grown(&self, margin: f64) -> Self {
        Self::new(self.min.x - margin, self.min.y - margin, self.max.x + margin, self.max.y + margin)
    }

    /// Whether the interiors meet.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.min.x < other.max.x
            && other.min.x < self.max.x
            && self.min.y < other.max.y
            && other.min.y < self.max.y
    }

    /// Whether `other` lies inside.
    pub fn contains(&self, other: &Self) -> bool {
        self.min.x <= other.min.x
            && self.min.y <= other.min.y
            && self.max.x >= other.max.x
            && self.max.y >= other.max.y
    }

    /// The four corners, counter-clockwise.
    pub(crate) fn corners(&self) -> Vec<Point2> {
        vec![self.min, Point2::new(self.max.x, self.min.y), self.max, Point2::new(self.min.x, self.max.y)]
    }
}

/// The axis across `axis`.
pub(crate) const fn across(axis: Axis) -> Axis {
    match axis {
        Axis::X => Axis::Y,
        Axis::Y => Axis::X,
    }
}

/// A thing with a footprint.
#[derive(Clone, Debug, PartialEq)]
pub enum Solid {
    /// A convex polygon, counter-clockwise.
    Convex(Vec<Point2>),
    /// A disc.
    Disc {
        /// Its center.
        center: Point2,
        /// Its radius.
        radius_m: f64,
    },
}

impl Solid {
    /// The rectangle as a solid.
    pub(crate) fn rect(rect: Rect) -> Self {
        Self::Convex(rect.corners())
    }

    /// Whether `point` lies inside.
    pub fn contains(&self, point: Point2) -> bool {
        match self {
            Self::Disc { center, radius_m } => {
                let offset = point - *center;
                offset.dot(offset) <= radius_m * radius_m
            }
            Self::Convex(corners) => corners
                .iter()
                .zip(corners.iter().cycle().skip(1))
                .all(|(&from, &to)| (to - from).cross(point - from) >= 0.0),
        }
    }

    /// The smallest rectangle around it.
    pub fn bounds(&self) -> Rect {
        match self {
            Self::Disc { center, radius_m } => Rect { min: *center, max: *center }.grown(*radius_m),
            Self::Convex(corners) => {
                corners.iter().fold(Rect { min: corners[0], max: corners[0] }, |Rect { min, max }, corner| {
                    Rect::new(
                        min.x.min(corner.x),
                        min.y.min(corner.y),
                        max.x.max(corner.x),
                        max.y.max(corner.y),
                    )
                })
            }
        }
    }
}

/// A place to put things: `at`, with local +x along `forward` and +y to the left of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stand {
    pub(crate) at: Point2,
    pub(crate) forward: Vec2,
}

impl Stand {
    /// The local point (`u`, `v`) in the plan.
    pub(crate) fn point(&self, u: f64, v: f64) -> Point2 {
        self.at + self.forward * u + Vec2::new(-self.forward.y, self.forward.x) * v
    }

    /// The local rectangle in the plan.
    pub(crate) fn rect(&self, local: Rect) -> Solid {
        Solid::Convex(local.corners().iter().map(|corner| self.point(corner.x, corner.y)).collect())
    }

    /// A disc at the local point.
    pub(crate) fn disc(&self, u: f64, v: f64, radius_m: f64) -> Solid {
        Solid::Disc { center: self.point(u, v), radius_m }
    }
}

/// The unit vector at `angle_rad`, with the same bits on every platform.
pub(crate) fn heading(angle_rad: f64) -> Vec2 {
    Vec2::new(libm::cos(angle_rad), libm::sin(angle_rad))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_square_contains_its_center_and_not_its_old_corner() {
        let stand = Stand { at: Point2::new(1.0, 1.0), forward: heading(std::f64::consts::FRAC_PI_4) };
        let solid = stand.rect(Rect::new(-1.0, -1.0, 1.0, 1.0));
        assert!(solid.contains(Point2::new(1.0, 1.0)) && solid.contains(Point2::new(2.3, 1.0)));
        assert!(!solid.contains(Point2::new(1.95, 1.95)));
        assert!((solid.bounds().width() - 8.0_f64.sqrt()).abs() < 1e-12);
    }
}
