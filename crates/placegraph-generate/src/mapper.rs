//! From scans to an occupancy grid: hits and passes are counted in every cell, as most grid mappers do, from
//! poses that are a little wrong.

use std::num::NonZeroUsize;

use placegraph::geom::{Point2, Vec2};
use placegraph::grid::{Grid, Occupancy};

use crate::dice::Dice;
use crate::laser::{Beam, Laser};
use crate::plan::Plan;
use crate::ray::walk;
use crate::scene::Scene;
use crate::shape::heading;
use crate::tour::{Tour, drive};

/// How one robot maps.
#[derive(Clone, Debug)]
struct Mapper {
    /// Distance between scans.
    step_m: f64,
    /// Standard deviation of the slow pose error, and of the error of each scan.
    drift_m: f64,
    drift_rad: f64,
    jitter_m: f64,
    jitter_rad: f64,
    /// A beam without return clears this far.
    clears_m: f64,
    /// Beams are used up to here.
    used_m: f64,
    /// A hit counts in this many more cells behind it, which makes walls thick.
    thickness_cells: f64,
    /// Occupied from this share of hits on.
    threshold: f64,
    /// Unknown below this number of beams.
    fewest: u32,
}

/// Hits and passes of every cell.
struct Counts {
    origin: Point2,
    cell_m: f64,
    hits: Grid<u32>,
    passes: Grid<u32>,
}

impl Mapper {
    fn draw(laser: &Laser, cell_m: f64, dice: &mut Dice) -> Self {
        let care = dice.between(0.15, 1.0);
        Self {
            step_m: dice.between(0.2, 0.5),
            drift_m: care * 0.04,
            drift_rad: care * 0.005,
            jitter_m: care * 0.012,
            jitter_rad: care * 0.003,
            clears_m: if dice.chance(0.3) { dice.between(2.0, 8.0).min(laser.range_m) } else { 0.0 },
            used_m: dice.pick(&[laser.range_m, laser.range_m, laser.range_m.min(12.0)]),
            thickness_cells: dice.between(0.0, 0.09) / cell_m,
            threshold: dice.between(0.1, 0.35),
            fewest: if cell_m > 0.04 { dice.pick(&[1, 1, 2, 3]) } else { 1 },
        }
    }
}

/// What a robot knows of a scene, in cells over the same ground.
pub(crate) struct Explored {
    /// In the end.
    pub(crate) map: Grid<Occupancy>,
    /// After every so many scans, if asked for.
    pub(crate) growing: Vec<Grid<Occupancy>>,
}

/// The map that a robot makes of `scene`, in cells of `cell_m`; also after every `every` scans. That changes nothing of the map.
pub(crate) fn explore(
    plan: &Plan,
    scene: &Scene,
    cell_m: f64,
    every: Option<NonZeroUsize>,
    dice: &mut Dice,
) -> Explored {
    let laser = Laser::draw(dice);
    let mapper = Mapper::draw(&laser, cell_m, dice);
    let explored = dice.pick(&[1.0, 1.0, 0.9, 0.75, 0.4]);
    let tour = drive(plan, scene, explored, dice);
    let n = |cells: u32| ((f64::from(cells) * scene.cell_m) / cell_m).ceil() as u32;
    let (width, height) = (n(scene.surface.width()), n(scene.surface.height()));
    let mut counts = Counts {
        origin: scene.origin,
        cell_m,
        hits: Grid::filled(width, height, 0),
        passes: Grid::filled(width, height, 0),
    };
    let mut drift = [0.0; 3];
    let mut growing = Vec::new();
    for (n_scans, (at, forward)) in (1..).zip(poses(&tour, &laser, mapper.step_m)) {
        let beams = laser.scan(scene, at, forward, dice);
        // A random walk that loop closures keep pulling back.
        let pull = 0.96_f64;
        let noise = (1.0 - pull * pull).sqrt();
        for (error, sigma) in drift.iter_mut().zip([mapper.drift_m, mapper.drift_m, mapper.drift_rad]) {
            *error = pull * *error + noise * sigma * dice.normal();
        }
        let offset =
            Vec2::new(drift[0] + mapper.jitter_m * dice.normal(), drift[1] + mapper.jitter_m * dice.normal());
        let turn = heading(drift[2] + mapper.jitter_rad * dice.normal());
        counts.insert(at + offset, turn, &beams, &mapper);
        if every.is_some_and(|every| n_scans % every == 0) {
            growing.push(counts.threshold(&mapper));
        }
    }
    Explored { map: counts.threshold(&mapper), growing }
}

/// The length of `v`, to the same bits on every platform: square roots are rounded alike everywhere, `hypot` is not.
fn length_of(v: Vec2) -> f64 {
    v.dot(v).sqrt()
}

/// Where the robot scans: along the tour, and around at its stops.
fn poses(tour: &Tour, laser: &Laser, step_m: f64) -> Vec<(Point2, Vec2)> {
    let mut poses = Vec::new();
    let mut last = None;
    let mut stops = tour.stops.iter().copied().peekable();
    for (k, &point) in tour.points.iter().enumerate() {
        let ahead = tour.points[(k + 4).min(tour.points.len() - 1)] - tour.points[k.saturating_sub(4)];
        let length = length_of(ahead);
        let forward = if length > 1e-9 { ahead * (1.0 / length) } else { Vec2::new(1.0, 0.0) };
        if last.is_none_or(|last: Point2| length_of(point - last) >= step_m) {
            poses.push((point, forward));
            last = Some(point);
        }
        if stops.next_if_eq(&k).is_some() {
            for turn in 0..laser.turns() {
                let around = heading(std::f64::consts::TAU * turn as f64 / laser.turns() as f64);
                let turned = Vec2::new(
                    forward.x * around.x - forward.y * around.y,
                    forward.x * around.y + forward.y * around.x,
                );
                poses.push((point, turned));
            }
        }
    }
    poses
}

impl Counts {
    /// Counts the beams of a scan from `at`, each turned by the error `turn`.
    fn insert(&mut self, at: Point2, turn: Vec2, beams: &[Beam], mapper: &Mapper) {
        let from = Point2::new((at.x - self.origin.x) / self.cell_m, (at.y - self.origin.y) / self.cell_m);
        let (width, height) = (self.hits.width(), self.hits.height());
        let (hits, passes) = (self.hits.values_mut(), self.passes.values_mut());
        for beam in beams {
            let toward = Vec2::new(
                beam.toward.x * turn.x - beam.toward.y * turn.y,
                beam.toward.x * turn.y + beam.toward.y * turn.x,
            );
            let (length_m, is_hit) = match beam.range_m {
                Some(range) if range <= mapper.used_m => (range, true),
                Some(_) => (mapper.used_m, false),
                None if mapper.clears_m > 0.0 => (mapper.clears_m, false),
                None => continue,
            };
            let length = length_m / self.cell_m;
            let behind = if is_hit { mapper.thickness_cells } else { 0.0 };
            // The cell that holds the end point, and those behind it, count as hit.
            let end = from + toward * length;
            let mut has_ended = false;
            walk(from, toward, length + behind, (width, height), |x, y, _| {
                let index = y as usize * width as usize + x as usize;
                has_ended |= is_hit && x == end.x as u32 && y == end.y as u32;
                if has_ended {
                    hits[index] += 1;
                } else {
                    passes[index] += 1;
                }
                true
            });
        }
    }

    fn threshold(&self, mapper: &Mapper) -> Grid<Occupancy> {
        let values = self.hits.values().iter().zip(self.passes.values()).map(|(&hits, &passes)| {
            let seen = hits + passes;
            if seen < mapper.fewest {
                Occupancy::Unknown
            } else if f64::from(hits) >= mapper.threshold * f64::from(seen) {
                Occupancy::Occupied
            } else {
                Occupancy::Free
            }
        });
        Grid::from_rows(self.hits.width(), self.hits.height(), values.collect())
    }
}
