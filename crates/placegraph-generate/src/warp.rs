//! How the straight floor plan lies in the world: sheared, bent along its length and turned.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use placegraph::geom::{Point2, Vec2};

use crate::dice::Dice;
use crate::shape::{Rect, heading};

/// A one-to-one map from plan coordinates to world coordinates, both in meters.
///
/// Small angles are the slow drift of a mapper, large ones are slanted and curved buildings.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Warp {
    /// x grows by this per meter of y.
    shear: f64,
    /// Where the spine begins to turn, and its height in the plan.
    bend_from: Point2,
    /// Length over which the spine turns.
    bend_length_m: f64,
    /// Radius of the turn, positive to the left, infinite for none.
    bend_radius_m: f64,
    /// Direction of the spine behind the turn.
    bend_heading: Vec2,
    /// Direction of the plan's x axis in the world.
    heading: Vec2,
}

impl Warp {
    /// A warp for a plan that fills `bounds`.
    pub(crate) fn draw(bounds: &Rect, dice: &mut Dice) -> Self {
        let quarter = FRAC_PI_2 * dice.below(4) as f64;
        let turn = match dice.below(20) {
            0..9 => 0.0,
            9..15 => dice.normal() * 0.03,
            _ => dice.between(-FRAC_PI_4, FRAC_PI_4),
        };
        let shear = if dice.chance(0.08) { dice.between(-0.3, 0.3) } else { dice.normal() * 0.004 };
        let length_m = bounds.width();
        let bend_length_m = dice.between(0.15, 0.7) * length_m;
        let angle: f64 = if dice.chance(0.12) { dice.between(-1.0, 1.0) } else { dice.normal() * 0.012 };
        let tightest_m = 0.75 * bounds.height() + 1.0;
        let angle = angle.clamp(-bend_length_m / tightest_m, bend_length_m / tightest_m);
        let start = bounds.min.x + dice.between(0.0, 1.0) * (length_m - bend_length_m);
        Self {
            shear,
            bend_from: Point2::new(start, bounds.center().y),
            bend_length_m,
            bend_radius_m: if angle.abs() < 1e-4 { f64::INFINITY } else { bend_length_m / angle },
            bend_heading: heading(angle),
            heading: if turn == 0.0 { quarter_heading(quarter) } else { heading(quarter + turn) },
        }
    }

    /// Leaves the plan as it is drawn.
    pub(crate) const fn none() -> Self {
        Self {
            shear: 0.0,
            bend_from: Point2::new(0.0, 0.0),
            bend_length_m: 0.0,
            bend_radius_m: f64::INFINITY,
            bend_heading: Vec2::new(1.0, 0.0),
            heading: Vec2::new(1.0, 0.0),
        }
    }

    /// Takes a point of the plan to the world.
    pub(crate) fn world_from_plan(&self, plan: Point2) -> Point2 {
        let from_bend =
            Vec2::new(plan.x + self.shear * plan.y, plan.y) - Vec2::new(self.bend_from.x, self.bend_from.y);
        let bent = if self.bend_radius_m.is_infinite() || from_bend.x <= 0.0 {
            from_bend
        } else if from_bend.x < self.bend_length_m {
            let around = heading(from_bend.x / self.bend_radius_m);
            let radius = self.bend_radius_m - from_bend.y;
            Vec2::new(radius * around.y, self.bend_radius_m - radius * around.x)
        } else {
            self.bend_end()
                + turned(Vec2::new(from_bend.x - self.bend_length_m, from_bend.y), self.bend_heading)
        };
        let world = turned(bent + Vec2::new(self.bend_from.x, self.bend_from.y), self.heading);
        Point2::new(world.x, world.y)
    }

    /// Takes a point of the world back to the plan.
    pub(crate) fn plan_from_world(&self, world: Point2) -> Point2 {
        let back = Vec2::new(self.heading.x, -self.heading.y);
        let bent = turned(Vec2::new(world.x, world.y), back) - Vec2::new(self.bend_from.x, self.bend_from.y);
        let from_bend =
            if self.bend_radius_m.is_infinite() || bent.x <= 0.0 { bent } else { self.unbent(bent) };
        let y = from_bend.y + self.bend_from.y;
        Point2::new(from_bend.x + self.bend_from.x - self.shear * y, y)
    }

    /// Takes a point behind the begin of the turn back to the straight plan.
    fn unbent(&self, bent: Vec2) -> Vec2 {
        let behind = turned(bent - self.bend_end(), Vec2::new(self.bend_heading.x, -self.bend_heading.y));
        if behind.x >= 0.0 {
            return Vec2::new(behind.x + self.bend_length_m, behind.y);
        }
        let side = self.bend_radius_m.signum();
        let from_center = Vec2::new(bent.x * side, (self.bend_radius_m - bent.y) * side);
        let along = libm::atan2(from_center.x, from_center.y) * self.bend_radius_m;
        if !(0.0..=self.bend_length_m).contains(&along) {
            // Beyond the center of the turn there is no plan.
            return Vec2::new(-1e6, -1e6);
        }
        Vec2::new(along, self.bend_radius_m - side * from_center.dot(from_center).sqrt())
    }

    /// Where the turn ends, seen from where it begins.
    fn bend_end(&self) -> Vec2 {
        Vec2::new(self.bend_radius_m * self.bend_heading.y, self.bend_radius_m * (1.0 - self.bend_heading.x))
    }
}

/// `v` in the frame whose x axis is `axis`.
fn turned(v: Vec2, axis: Vec2) -> Vec2 {
    Vec2::new(v.x * axis.x - v.y * axis.y, v.x * axis.y + v.y * axis.x)
}

/// The unit vector of a whole number of quarter turns, exactly.
fn quarter_heading(angle_rad: f64) -> Vec2 {
    let rough = heading(angle_rad);
    Vec2::new(rough.x.round(), rough.y.round())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_warp_and_its_inverse_cancel() {
        let bounds = Rect::new(-3.0, 2.0, 35.0, 19.0);
        let mut dice = Dice::new(5, 0, 0, 0);
        for _ in 0..400 {
            let warp = Warp::draw(&bounds, &mut dice);
            let point = Point2::new(dice.between(-3.0, 35.0), dice.between(2.0, 19.0));
            let back = warp.plan_from_world(warp.world_from_plan(point));
            assert!(back.distance(point) < 1e-9, "{warp:?} takes {point:?} back to {back:?}");
        }
    }
}
