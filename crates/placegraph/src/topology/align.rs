//! The turn and the shift between the frames of two maps of one building.
//!
//! Two mapping sessions begin in two places, so that their maps differ by a turn and a shift. For every turn, in steps of a
//! degree, the shifts are proposed by the projections of the free area on both axes, as in map merging by spectra
//! [Carpin 2008]; the best proposals by common area are then moved until the borders of the free area coincide. The
//! score is the share of both borders that then do, the harmonic mean of both ways (F1). A second solution that is nearly as good says
//! that the building looks the same from two sides: the answer is not certain.
//!
//! Cost: that of rasters of some hundred cells a side and some tens of millions of look-ups, a second at most, whatever the map.

use rayon::prelude::*;

use super::{PlaceRaster, TopologicalMap};
use crate::geom::{Point2, Pose2};
use crate::grid::{GridShape, MapFrame};

/// Least score of maps of one building.
pub const MIN_SCORE: f64 = 0.6;
/// Least difference to the score of the second solution.
pub const MIN_LEAD: f64 = 0.05;

/// Side of a cell of the rasters, in meters, and most cells of a side: of larger buildings the cells are larger.
const CELL_M: f64 = 0.1;
const MAX_SIDE: f64 = 1500.0;
/// Space around the rasters, in cells.
const MARGIN: f64 = 12.0;
/// Borders that are nearer than this coincide, in meters; twice a cell if that is more.
const ON_M: f64 = 0.2;
/// Most points of an area and of a border.
const MAX_AREA_POINTS: usize = 1000;
const MAX_BORDER_POINTS: usize = 1500;
/// Turns that are tried.
const N_TURNS: usize = 360;
/// Most bins of a projection.
const MAX_BINS: f64 = 256.0;
/// Shifts along an axis that are tried for a turn, and solutions that are refined.
const N_SHIFTS: usize = 4;
const N_REFINED: usize = 24;
/// Solutions are different that differ by more than this.
const APART_RAD: f64 = 0.1;
const APART_M: f64 = 1.0;

/// A turn and a shift, with the quality of their fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alignment {
    /// Transforms points from the old map's frame to the new one's.
    pub new_from_old: Pose2,
    /// Share of the borders that coincide, 0 to 1.
    pub score: f64,
    /// The score of the best other solution.
    pub runner_up: f64,
}

impl Alignment {
    /// Whether the maps show one building and coincide in one way only.
    pub fn is_certain(&self) -> bool {
        self.score >= MIN_SCORE && self.score - self.runner_up >= MIN_LEAD
    }
}

/// The turn and the shift that align `old` with `new` best; `None` if one of them has no place.
pub fn align(old: &TopologicalMap, new: &TopologicalMap) -> Option<Alignment> {
    let cell_m =
        [old, new].into_iter().filter_map(extent_m).fold(CELL_M, |cell, side| cell.max(side / MAX_SIDE));
    let (old, new) = (Sheet::of(old, cell_m)?, Sheet::of(new, cell_m)?);
    // Found as the way from new to old.
    let mut found: Vec<(f64, Pose2)> = proposals(&old, &new)
        .into_par_iter()
        .map(|pose| {
            let pose = refined(&old, &new, pose);
            (score(&old, &new, pose), pose)
        })
        .collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let &(best, pose) = found.first()?;
    let another = found.iter().find(|(_, other)| are_apart(pose, *other, new.center));
    let runner_up = another.map_or(0.0, |(score, _)| *score);
    Some(Alignment { new_from_old: inverse(pose), score: best, runner_up })
}

impl TopologicalMap {
    /// The map in another frame, to which `pose` transforms its points.
    pub fn moved(&self, pose: Pose2) -> Self {
        let mut map = self.clone();
        let point = |point: &mut Point2| *point = pose.apply(*point);
        for place in &mut map.places {
            point(&mut place.centroid);
            point(&mut place.anchor);
            let turned = place.axes.rotated(pose.yaw_rad);
            place.axes = turned;
            let rings = place
                .outline
                .iter_mut()
                .flat_map(|part| std::iter::once(&mut part.exterior).chain(&mut part.holes));
            rings.flatten().for_each(point);
            place.doorway.iter_mut().flat_map(|doorway| &mut doorway.jambs).for_each(point);
        }
        for connection in &mut map.connections {
            point(&mut connection.middle);
            connection.route.iter_mut().flat_map(|route| &mut route.line).for_each(point);
        }
        map.shortcuts.iter_mut().flat_map(|way| &mut way.route.line).for_each(point);
        map
    }
}

/// The pose of the other way.
fn inverse(pose: Pose2) -> Pose2 {
    let Point2 { x, y } = pose.apply_inverse(Point2::new(0.0, 0.0));
    Pose2::new(x, y, -pose.yaw_rad)
}

/// Lower left and upper right corner of all outlines.
fn bounds(map: &TopologicalMap) -> Option<[Point2; 2]> {
    let corners = map.places.iter().flat_map(|place| &place.outline).flat_map(|part| &part.exterior);
    corners.fold(None, |bounds, &Point2 { x, y }| {
        let [low, high] = bounds.unwrap_or([Point2::new(x, y); 2]);
        Some([Point2::new(low.x.min(x), low.y.min(y)), Point2::new(high.x.max(x), high.y.max(y))])
    })
}

/// The longer side of the bounds.
fn extent_m(map: &TopologicalMap) -> Option<f64> {
    bounds(map).map(|[low, high]| (high.x - low.x).max(high.y - low.y))
}

/// The free area of a map as a raster, with points of it and of its border.
struct Sheet {
    low: Point2,
    cell_m: f64,
    width: usize,
    height: usize,
    is_area: Vec<bool>,
    /// Distance of every cell to the nearest one of the border, in meters.
    to_border_m: Vec<f32>,
    area: Vec<Point2>,
    border: Vec<Point2>,
    /// Number of cells of the area.
    n_cells: usize,
    center: Point2,
    /// Half of the diagonal.
    radius_m: f64,
}

impl Sheet {
    fn of(map: &TopologicalMap, cell_m: f64) -> Option<Self> {
        let [low, high] = bounds(map)?;
        let side = |length: f64| (length / cell_m + 2.0 * MARGIN).ceil() as u32;
        let (columns, rows) = (side(high.x - low.x), side(high.y - low.y));
        let center = low.midpoint(high);
        let radius_m = 0.5 * low.distance(high);
        let low = Point2::new(low.x - MARGIN * cell_m, low.y - MARGIN * cell_m);
        let frame = MapFrame::new(cell_m, Pose2::new(low.x, low.y, 0.0)).ok()?;
        let raster = PlaceRaster::new(map, GridShape { frame, width: columns, height: rows });
        let (width, height) = (columns as usize, rows as usize);
        let mut is_area = vec![false; width * height];
        for y in 0..rows {
            for span in raster.row(y) {
                let start = y as usize * width;
                is_area[start + span.start as usize..start + span.end as usize].fill(true);
            }
        }
        let point = |index: usize| {
            frame.map_from_cells(Point2::new((index % width) as f64 + 0.5, (index / width) as f64 + 0.5))
        };
        // The margin keeps the area from the sides of the raster.
        let is_border = |&index: &usize| {
            is_area[index]
                && [index - 1, index + 1, index - width, index + width].iter().any(|&beside| !is_area[beside])
        };
        let inner: Vec<usize> = (0..is_area.len()).filter(|&index| is_area[index]).collect();
        let border: Vec<usize> = inner.iter().copied().filter(is_border).collect();
        let thinned = |all: &[usize], most: usize| -> Vec<Point2> {
            let stride = all.len().div_ceil(most).max(1);
            all.iter().step_by(stride).map(|&index| point(index)).collect()
        };
        let to_border_m =
            distances(width, height, &border).into_iter().map(|cells| cells * cell_m as f32).collect();
        let n_cells = inner.len();
        (n_cells > 0).then(|| Self {
            low,
            cell_m,
            width,
            height,
            to_border_m,
            area: thinned(&inner, MAX_AREA_POINTS),
            border: thinned(&border, MAX_BORDER_POINTS),
            is_area,
            n_cells,
            center,
            radius_m,
        })
    }

    fn index(&self, point: Point2) -> Option<usize> {
        let cell = |v: f64, low: f64, n: usize| {
            let cell = (v - low) / self.cell_m;
            (cell >= 0.0 && cell < n as f64).then_some(cell as usize)
        };
        Some(cell(point.y, self.low.y, self.height)? * self.width + cell(point.x, self.low.x, self.width)?)
    }

    fn is_area(&self, point: Point2) -> bool {
        self.index(point).is_some_and(|index| self.is_area[index])
    }

    fn to_border_m(&self, point: Point2) -> f64 {
        self.index(point).map_or(f64::INFINITY, |index| f64::from(self.to_border_m[index]))
    }
}

/// Distance of every cell to the nearest of `sources`, in cells: that of the shortest way in steps to the eight neighbors, by two
/// passes [Borgefors 1986]. Too long by a twelfth at most.
fn distances(width: usize, height: usize, sources: &[usize]) -> Vec<f32> {
    let mut distances = vec![f32::INFINITY; width * height];
    for &source in sources {
        distances[source] = 0.0;
    }
    let diagonal = std::f32::consts::SQRT_2;
    let mut relax = |x: usize, y: usize, steps: [(i64, i64, f32); 4]| {
        let mut nearest = distances[y * width + x];
        for (dx, dy, length) in steps {
            let (x, y) = (x as i64 + dx, y as i64 + dy);
            if (0..width as i64).contains(&x) && (0..height as i64).contains(&y) {
                nearest = nearest.min(distances[y as usize * width + x as usize] + length);
            }
        }
        distances[y * width + x] = nearest;
    };
    for y in 0..height {
        for x in 0..width {
            relax(x, y, [(-1, 0, 1.0), (0, -1, 1.0), (-1, -1, diagonal), (1, -1, diagonal)]);
        }
    }
    for y in (0..height).rev() {
        for x in (0..width).rev() {
            relax(x, y, [(1, 0, 1.0), (0, 1, 1.0), (1, 1, diagonal), (-1, 1, diagonal)]);
        }
    }
    distances
}

/// The most promising poses from new to old, all different.
fn proposals(old: &Sheet, new: &Sheet) -> Vec<Pose2> {
    let bin_m = (2.0 * old.radius_m.max(new.radius_m) / MAX_BINS).max(2.0 * old.cell_m);
    // Points by cell: projections of as many as stand for the area.
    let weight = new.n_cells as f64 / new.area.len() as f64 * old.area.len() as f64 / old.n_cells as f64;
    let of_old =
        [Projection::of(&old.area, bin_m, 1.0, |p| p.x), Projection::of(&old.area, bin_m, 1.0, |p| p.y)];
    let of_turn = |turn: usize| -> Vec<(f64, Pose2)> {
        let yaw_rad = turn as f64 * std::f64::consts::TAU / N_TURNS as f64;
        let turned: Vec<Point2> =
            new.area.iter().map(|&point| Pose2::new(0.0, 0.0, yaw_rad).apply(point)).collect();
        let shifts_x = of_old[0].best_shifts(&Projection::of(&turned, bin_m, weight, |p| p.x));
        let shifts_y = of_old[1].best_shifts(&Projection::of(&turned, bin_m, weight, |p| p.y));
        let poses = shifts_x.iter().flat_map(|&x| shifts_y.iter().map(move |&y| Pose2::new(x, y, yaw_rad)));
        poses.map(|pose| (common_share(old, new, pose), pose)).collect()
    };
    let mut found: Vec<(f64, Pose2)> = (0..N_TURNS).into_par_iter().flat_map_iter(of_turn).collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut kept: Vec<Pose2> = Vec::new();
    for (_, pose) in found {
        if kept.iter().all(|&other| are_apart(pose, other, new.center)) {
            kept.push(pose);
            if kept.len() == N_REFINED {
                break;
            }
        }
    }
    kept
}

/// Number of points by their position along an axis.
struct Projection {
    first: i64,
    bin_m: f64,
    counts: Vec<f64>,
}

impl Projection {
    fn of(points: &[Point2], bin_m: f64, weight: f64, along: impl Fn(&Point2) -> f64) -> Self {
        let bins: Vec<i64> = points.iter().map(|point| (along(point) / bin_m).floor() as i64).collect();
        let first = bins.iter().copied().min().unwrap_or(0);
        let last = bins.iter().copied().max().unwrap_or(0);
        let mut counts = vec![0.0; (last - first + 1) as usize];
        for bin in bins {
            counts[(bin - first) as usize] += weight;
        }
        Self { first, bin_m, counts }
    }

    /// The shifts, in meters, by which `other` has most in common with this one, each better than its neighbors.
    fn best_shifts(&self, other: &Self) -> Vec<f64> {
        let n = (self.counts.len() + other.counts.len() - 1) as i64;
        // Shift k lays the last bin of `other` on bin k of this one.
        let common: Vec<f64> = (0..n)
            .map(|k| {
                let offset = k - (other.counts.len() as i64 - 1);
                let (from, to) =
                    (offset.max(0), (offset + other.counts.len() as i64).min(self.counts.len() as i64));
                (from..to)
                    .map(|bin| self.counts[bin as usize].min(other.counts[(bin - offset) as usize]))
                    .sum()
            })
            .collect();
        let mut peaks: Vec<usize> = (0..common.len())
            .filter(|&k| {
                let beside = |k: Option<usize>| k.and_then(|k| common.get(k)).copied().unwrap_or(0.0);
                common[k] > beside(k.checked_sub(1)) && common[k] >= beside(Some(k + 1))
            })
            .collect();
        peaks.sort_by(|&a, &b| common[b].total_cmp(&common[a]).then(a.cmp(&b)));
        let shift = |k: usize| {
            let offset = k as i64 - (other.counts.len() as i64 - 1);
            (self.first + offset - other.first) as f64 * self.bin_m
        };
        peaks.into_iter().take(N_SHIFTS).map(shift).collect()
    }
}

/// Common area by the area of both together.
fn common_share(old: &Sheet, new: &Sheet, pose: Pose2) -> f64 {
    let n_common = new.area.iter().filter(|&&point| old.is_area(pose.apply(point))).count();
    let common = n_common as f64 / new.area.len() as f64 * new.n_cells as f64;
    common / (old.n_cells as f64 + new.n_cells as f64 - common)
}

/// `pose`, moved until the borders coincide: coarse steps first, then finer ones.
fn refined(old: &Sheet, new: &Sheet, pose: Pose2) -> Pose2 {
    let mut best = pose;
    for reach_m in [1.5, 0.75, 0.4, 0.2] {
        let mut step_m = 0.5 * reach_m;
        let mut value = nearness(old, new, best, reach_m);
        while step_m > reach_m / 20.0 {
            let turn_rad = step_m / new.radius_m.max(1.0);
            let moves = [
                (step_m, 0.0, 0.0),
                (-step_m, 0.0, 0.0),
                (0.0, step_m, 0.0),
                (0.0, -step_m, 0.0),
                (0.0, 0.0, turn_rad),
                (0.0, 0.0, -turn_rad),
            ];
            let tried = moves.map(|(x, y, turn)| {
                let moved = turned_about(best, turn, new.center);
                let moved = Pose2::new(moved.x + x, moved.y + y, moved.yaw_rad);
                (nearness(old, new, moved, reach_m), moved)
            });
            let better = tried
                .into_iter()
                .fold((value, best), |best, next| if next.0 > best.0 + 1e-12 { next } else { best });
            if better.0 > value {
                (value, best) = better;
            } else {
                step_m *= 0.5;
            }
        }
    }
    best
}

/// `pose` with a further turn that leaves where it takes `center`.
fn turned_about(pose: Pose2, turn_rad: f64, center: Point2) -> Pose2 {
    let fixed = pose.apply(center);
    let turned = Pose2::new(0.0, 0.0, pose.yaw_rad + turn_rad);
    let there = turned.apply(center);
    Pose2::new(fixed.x - there.x, fixed.y - there.y, turned.yaw_rad)
}

/// How near the borders are, 0 to 1: 1 where they coincide, 0 from `reach_m` on.
fn nearness(old: &Sheet, new: &Sheet, pose: Pose2, reach_m: f64) -> f64 {
    let near = |distance_m: f64| (1.0 - distance_m / reach_m).max(0.0);
    let [there, back] = both_ways(old, new, pose, near);
    0.5 * (there + back)
}

/// The share of the borders that coincide: the harmonic mean over both directions.
fn score(old: &Sheet, new: &Sheet, pose: Pose2) -> f64 {
    let on_m = ON_M.max(2.0 * old.cell_m);
    let [there, back] = both_ways(old, new, pose, |distance_m| f64::from(u8::from(distance_m <= on_m)));
    if there + back > 0.0 { 2.0 * there * back / (there + back) } else { 0.0 }
}

/// The mean of `value` of the distance over the points of the new border in the old map, and the other way round.
fn both_ways(old: &Sheet, new: &Sheet, pose: Pose2, value: impl Fn(f64) -> f64) -> [f64; 2] {
    let mean = |points: &[Point2], of: &dyn Fn(Point2) -> f64| {
        points.iter().map(|&point| value(of(point))).sum::<f64>() / points.len() as f64
    };
    [
        mean(&new.border, &|point| old.to_border_m(pose.apply(point))),
        mean(&old.border, &|point| new.to_border_m(pose.apply_inverse(point))),
    ]
}

/// Whether two solutions are different: by their turn, or by where they take `center`.
fn are_apart(a: Pose2, b: Pose2, center: Point2) -> bool {
    let turn = (a.yaw_rad - b.yaw_rad).rem_euclid(std::f64::consts::TAU);
    turn.min(std::f64::consts::TAU - turn) > APART_RAD || a.apply(center).distance(b.apply(center)) > APART_M
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three columns of points, of 2, 1 and 3, from `first` on.
    fn columns(first: f64) -> Projection {
        let points = [0.0, 0.0, 1.0, 2.0, 2.0, 2.0].map(|x| Point2::new(first + x + 0.5, 0.0));
        Projection::of(&points, 1.0, 1.0, |point| point.x)
    }

    #[test]
    fn the_best_shift_lays_equal_projections_on_one_another() {
        // Common points of shifts of -2 to 2 bins: min(2, 3) = 2, 1 + 1 = 2, all 6, 1 + 1 = 2, 2.
        for (old, new) in [(0.0, 0.0), (10.0, 3.0), (-4.0, 5.0)] {
            assert_eq!(columns(old).best_shifts(&columns(new))[0].to_bits(), f64::to_bits(old - new));
        }
    }
}
