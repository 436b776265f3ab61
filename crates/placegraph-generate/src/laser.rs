//! The laser: ranges with noise, dropouts, glass, mixed pixels and people who walk by.

use std::f64::consts::PI;

use placegraph::geom::{Point2, Vec2};

use crate::dice::Dice;
use crate::ray::walk;
use crate::scene::{Scene, Surface};
use crate::shape::heading;

/// The properties of one laser, from the data sheets of common 2-D scanners.
#[derive(Clone, Debug)]
pub(crate) struct Laser {
    /// Directions of the beams in the robot's frame.
    beams: Vec<Vec2>,
    pub(crate) range_m: f64,
    sigma_m: f64,
    dropouts: f64,
    /// Share of beams that end somewhere between two surfaces.
    mixed: f64,
    /// Share of beams that pass a pane.
    transparency: f64,
    /// Share of scans with somebody near.
    people: f64,
}

/// One beam: where it points in the world, and what it measured, if anything was in reach.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Beam {
    pub(crate) toward: Vec2,
    pub(crate) range_m: Option<f64>,
}

/// A leg or a body.
struct Person {
    center: Point2,
    radius_m: f64,
}

impl Laser {
    pub(crate) fn draw(dice: &mut Dice) -> Self {
        let fov = dice.pick(&[PI, PI, 1.333 * PI, 1.5 * PI, 2.0 * PI, 2.0 * PI]);
        let step = dice.pick(&[0.5_f64, 0.5, 1.0, 0.7]).to_radians();
        let n = (fov / step).round() as usize;
        let angle = |k: usize| -0.5 * fov + fov * k as f64 / n as f64;
        Self {
            beams: (0..n).map(|k| heading(angle(k))).collect(),
            range_m: dice.pick(&[5.6, 8.0, 8.0, 12.0, 20.0, 30.0, 30.0]),
            sigma_m: dice.between(0.004, 0.025),
            dropouts: dice.between(0.0, 0.02),
            mixed: dice.between(0.0, 0.006),
            transparency: dice.pick(&[0.05, 0.2, 0.5, 0.9]),
            people: dice.pick(&[0.0, 0.03, 0.12]),
        }
    }

    /// How many turns it takes to look around.
    pub(crate) fn turns(&self) -> usize {
        let first = self.beams.first().map_or(1.0, |beam| beam.x);
        if first < -0.9 { 1 } else { 3 }
    }

    /// A scan from `at` with the robot looking along `forward`.
    pub(crate) fn scan(&self, scene: &Scene, at: Point2, forward: Vec2, dice: &mut Dice) -> Vec<Beam> {
        let mut people = Vec::new();
        if dice.chance(self.people) {
            let away = heading(dice.between(0.0, 2.0 * PI));
            let center = at + away * dice.between(0.8, 3.5);
            let stride = heading(dice.between(0.0, PI)) * dice.between(0.05, 0.25);
            people.push(Person { center: center + stride, radius_m: 0.07 });
            people.push(Person { center: center - stride, radius_m: 0.07 });
        }
        self.beams
            .iter()
            .filter_map(|beam| {
                if dice.chance(self.dropouts) {
                    return None;
                }
                let toward = Vec2::new(
                    forward.x * beam.x - forward.y * beam.y,
                    forward.x * beam.y + forward.y * beam.x,
                );
                Some(Beam { toward, range_m: self.measure(scene, at, toward, &people, dice) })
            })
            .collect()
    }

    fn measure(
        &self,
        scene: &Scene,
        at: Point2,
        toward: Vec2,
        people: &[Person],
        dice: &mut Dice,
    ) -> Option<f64> {
        let mut range = self.cast(scene, at, toward, dice);
        for person in people {
            if let Some(nearer) = person.hit(at, toward).filter(|&t| range.is_none_or(|range| t < range)) {
                range = Some(nearer);
            }
        }
        let range = range?;
        if dice.chance(self.mixed) {
            return Some((range + dice.between(-0.4, 0.2)).clamp(0.02, self.range_m));
        }
        Some((range + self.sigma_m * dice.normal()).clamp(0.02, self.range_m))
    }

    /// Distance to the first surface that does not let the beam pass.
    fn cast(&self, scene: &Scene, at: Point2, toward: Vec2, dice: &mut Dice) -> Option<f64> {
        let in_cells =
            Point2::new((at.x - scene.origin.x) / scene.cell_m, (at.y - scene.origin.y) / scene.cell_m);
        let (width, height) = (scene.surface.width(), scene.surface.height());
        let surface = scene.surface.values();
        let mut in_glass = false;
        let mut hit = None;
        walk(in_cells, toward, self.range_m / scene.cell_m, (width, height), |x, y, distance| {
            let stops = match surface[y as usize * width as usize + x as usize] {
                Surface::Open => {
                    in_glass = false;
                    false
                }
                Surface::Glass if in_glass => false,
                Surface::Glass => {
                    in_glass = true;
                    !dice.chance(self.transparency)
                }
                _ => true,
            };
            if stops {
                hit = Some((distance + 0.3) * scene.cell_m);
            }
            !stops
        });
        hit
    }
}

impl Person {
    /// Distance along the beam at which it meets the person.
    fn hit(&self, at: Point2, toward: Vec2) -> Option<f64> {
        let to_center = self.center - at;
        let along = to_center.dot(toward);
        let miss = to_center.cross(toward);
        let inside = self.radius_m * self.radius_m - miss * miss;
        (along > 0.0 && inside > 0.0).then(|| along - inside.sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{Plan, Space, Tile, Usage};
    use crate::shape::Rect;
    use crate::warp::Warp;

    /// A room of 4 m by 2 m with walls of 0.2 m.
    fn room() -> Scene {
        let floor = Rect::new(0.0, 0.0, 4.0, 2.0);
        let plan = Plan {
            spaces: vec![Space { usage: Usage::Office }],
            tiles: vec![Tile { space: 0, outer: floor, inner: floor }],
            outer_wall_m: 0.2,
            ..Plan::default()
        };
        Scene::paint(&plan, &Warp::none(), 0.025, 0.5)
    }

    #[test]
    fn a_laser_measures_the_distance_to_the_wall_within_its_noise() {
        let laser = Laser {
            beams: vec![Vec2::new(1.0, 0.0), Vec2::new(0.0, -1.0)],
            range_m: 8.0,
            sigma_m: 0.005,
            dropouts: 0.0,
            mixed: 0.0,
            transparency: 0.0,
            people: 0.0,
        };
        let scan =
            laser.scan(&room(), Point2::new(1.0, 1.5), Vec2::new(1.0, 0.0), &mut Dice::new(0, 0, 0, 0));
        for (beam, expected) in scan.iter().zip([3.0, 1.5]) {
            assert!((beam.range_m.unwrap() - expected).abs() < 0.05, "{beam:?}");
        }
    }

    #[test]
    fn a_person_hides_what_is_behind() {
        let person = Person { center: Point2::new(2.0, 0.05), radius_m: 0.13 };
        let hit = person.hit(Point2::new(0.0, 0.0), Vec2::new(1.0, 0.0)).unwrap();
        assert!((hit - 1.88).abs() < 1e-12);
        assert!(person.hit(Point2::new(0.0, 0.0), Vec2::new(0.0, 1.0)).is_none());
    }
}
