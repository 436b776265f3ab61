//! Where the robot drives: a tour of the rooms it explores, over a coarse grid of places where it fits.

use std::collections::VecDeque;

use placegraph::geom::Point2;
use placegraph::grid::{Cell, Grid};

use crate::dice::Dice;
use crate::plan::{Plan, Usage};
use crate::scene::{Scene, Surface};

/// Side of a coarse cell, in fine cells, and in meters at the usual 0.025.
const COARSE: u32 = 4;

/// Points that the robot passes, a coarse cell apart, in order; `stops` are the points where it looks around.
#[derive(Debug, Default)]
pub(crate) struct Tour {
    pub(crate) points: Vec<Point2>,
    pub(crate) stops: Vec<usize>,
}

/// Drives through the spaces; each room is explored with probability `share_explored`.
pub(crate) fn drive(plan: &Plan, scene: &Scene, share_explored: f64, dice: &mut Dice) -> Tour {
    let fits = where_it_fits(scene, dice.between(0.18, 0.3));
    let space_of = |index: usize| {
        let Cell { x, y } = fits.cell(index);
        let fine = Cell::new(x * COARSE + COARSE / 2, y * COARSE + COARSE / 2);
        scene.space[fine] as usize
    };
    let mut floor: Vec<Vec<usize>> = vec![Vec::new(); plan.spaces.len() + 1];
    for (index, _) in fits.values().iter().enumerate().filter(|(_, fits)| **fits) {
        floor[space_of(index)].push(index);
    }
    let mut is_target = vec![false; fits.values().len()];
    let start_space = (1..floor.len()).max_by_key(|&space| {
        (plan.spaces[space - 1].is_corridor(), floor[space].len(), std::cmp::Reverse(space))
    });
    let Some(start_space) = start_space.filter(|&space| !floor[space].is_empty()) else {
        return Tour::default();
    };
    let coarse_m = scene.cell_m * f64::from(COARSE);
    for (space, cells) in floor.iter().enumerate().skip(1).filter(|(_, cells)| !cells.is_empty()) {
        let usage = plan.spaces[space - 1].usage;
        let area = cells.len() as f64 * coarse_m * coarse_m;
        let stops = match usage {
            Usage::Corridor => 2.0 + area / 6.0,
            Usage::Bath | Usage::Toilet | Usage::Storage if dice.chance(0.5) => 0.0,
            _ if !dice.chance(share_explored) => 0.0,
            _ => 1.0 + (area / dice.between(5.0, 14.0)).min(20.0),
        };
        for _ in 0..stops as usize {
            is_target[cells[dice.below(cells.len())]] = true;
        }
    }
    let mut tour = Tour::default();
    let mut at = floor[start_space][dice.below(floor[start_space].len())];
    while let Some(way) = way_to_next(&fits, &is_target, at) {
        at = way[way.len() - 1];
        is_target[at] = false;
        tour.points.extend(way.iter().map(|&index| center(scene, fits.cell(index))));
        tour.stops.push(tour.points.len() - 1);
    }
    tour
}

fn center(scene: &Scene, coarse: Cell) -> Point2 {
    let side = scene.cell_m * f64::from(COARSE);
    Point2::new(
        scene.origin.x + (f64::from(coarse.x) + 0.5) * side,
        scene.origin.y + (f64::from(coarse.y) + 0.5) * side,
    )
}

/// The coarse cells whose center is farther than `radius_m` from everything.
fn where_it_fits(scene: &Scene, radius_m: f64) -> Grid<bool> {
    let (width, height) = (scene.surface.width() / COARSE, scene.surface.height() / COARSE);
    let mut fits = Grid::filled(width.max(1), height.max(1), true);
    let free = fits.map(|_| true);
    let mut blocked = free;
    for cell in fits.cells() {
        let fine = (0..COARSE * COARSE)
            .map(|k| Cell::new(cell.x * COARSE + k % COARSE, cell.y * COARSE + k / COARSE));
        blocked[cell] = fine.into_iter().any(|fine| {
            let index = scene.surface.index(fine);
            scene.surface.values()[index] != Surface::Open || !scene.is_floor(index)
        });
    }
    let reach = (radius_m / (scene.cell_m * f64::from(COARSE))).round() as i32;
    for cell in blocked.cells().filter(|&cell| blocked[cell]) {
        for (dx, dy) in (-reach..=reach).flat_map(|dx| (-reach..=reach).map(move |dy| (dx, dy))) {
            if let Some(near) = fits.offset(cell, (dx, dy)).filter(|_| dx * dx + dy * dy <= reach * reach) {
                fits[near] = false;
            }
        }
    }
    fits
}

/// The shortest way over coarse cells to the nearest target, without `from` itself.
fn way_to_next(fits: &Grid<bool>, is_target: &[bool], from: usize) -> Option<Vec<usize>> {
    let mut came_from = vec![usize::MAX; fits.values().len()];
    let mut queue = VecDeque::from([from]);
    came_from[from] = from;
    while let Some(index) = queue.pop_front() {
        if is_target[index] {
            let mut way = vec![index];
            let mut at = index;
            while came_from[at] != from {
                at = came_from[at];
                way.push(at);
            }
            way.reverse();
            return Some(way);
        }
        let cell = fits.cell(index);
        for step in [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)] {
            let Some(next) = fits.offset(cell, step).filter(|&next| fits[next]) else { continue };
            let next = fits.index(next);
            if came_from[next] == usize::MAX {
                came_from[next] = index;
                queue.push_back(next);
            }
        }
    }
    None
}
