//! Walls: thickness, glass, pillars, cut corners.

use crate::dice::Dice;
use crate::plan::{Plan, Usage};
use crate::shape::{Axis, Rect, Solid, across};
use crate::style::{Recipe, Style};
use placegraph::geom::Point2;

const AXES: [Axis; 2] = [Axis::X, Axis::Y];

/// Draws the thickness of all walls and moves the faces of the tiles there.
pub(super) fn build(plan: &mut Plan, style: Style, recipe: &Recipe, dice: &mut Dice) {
    let partition = dice.between(0.08, 0.2);
    let corridor_wall = partition + if dice.chance(0.5) { dice.between(0.0, 0.25) } else { 0.0 };
    let corridor_wall = match recipe.extras {
        Some(extras) if dice.chance(extras.deep_walls) => dice.between(0.4, 0.9),
        _ => corridor_wall,
    };
    plan.outer_wall_m = dice.between(0.15, 0.4);
    let thick = if matches!(style, Style::Home | Style::Flat) { 0.05 } else { 0.12 };
    for index in 0..plan.tiles.len() {
        let tile = &plan.tiles[index];
        let is_corridor = plan.spaces[tile.space].is_corridor();
        let is_cubicle = plan.spaces[tile.space].usage == Usage::Cubicle;
        let insets = [(Axis::X, 0), (Axis::X, 1), (Axis::Y, 0), (Axis::Y, 1)].map(|(run, end)| {
            let near = neighbors(plan, index, run, end == 1);
            let other = |space: usize| space != tile.space;
            if near.is_empty() {
                return 0.0;
            }
            if !near.iter().any(|&(space, _)| other(space)) && near.iter().map(|n| n.1).sum::<f64>() > 0.99 {
                return 0.0;
            }
            let beside_corridor =
                near.iter().any(|&(space, _)| other(space) && plan.spaces[space].is_corridor());
            let half = if is_cubicle {
                0.03
            } else if is_corridor || beside_corridor {
                0.5 * corridor_wall
            } else {
                0.5 * partition
            };
            half + if !is_corridor && !is_cubicle && dice.chance(thick) {
                dice.between(0.05, 0.4)
            } else {
                0.0
            }
        });
        let Rect { min, max } = plan.tiles[index].outer;
        plan.tiles[index].inner =
            Rect::new(min.x + insets[0], min.y + insets[2], max.x - insets[1], max.y - insets[3]);
    }
}

/// The spaces behind one side of a tile, each with the share of the side it covers. The side is the one
/// across `run`, at its far end or at its near end.
fn neighbors(plan: &Plan, index: usize, run: Axis, at_far_end: bool) -> Vec<(usize, f64)> {
    let tile = &plan.tiles[index];
    let (near, far) = tile.outer.span(run);
    let (lo, hi) = tile.outer.span(across(run));
    let others = plan.tiles.iter().enumerate().filter(|&(other, _)| other != index);
    others
        .filter_map(|(_, other)| {
            let (other_near, other_far) = other.outer.span(run);
            let gap = if at_far_end { other_near - far } else { near - other_far };
            let (other_lo, other_hi) = other.outer.span(across(run));
            let shared = (hi.min(other_hi) - lo.max(other_lo)) / (hi - lo);
            (gap.abs() < 1e-6 && shared > 1e-6).then_some((other.space, shared))
        })
        .collect()
}

/// Puts panes of glass into outer walls, and into walls between corridors and rooms.
pub(super) fn glaze(plan: &mut Plan, style: Style, dice: &mut Dice) {
    let windows = dice.pick(&[0.0, 0.0, 0.0, 0.06, 0.15, 0.4]);
    let glass_fronts = if matches!(style, Style::Office | Style::School | Style::Campus | Style::OpenOffice) {
        dice.pick(&[0.0, 0.0, 0.08, 0.3])
    } else {
        0.0
    };
    for index in 0..plan.tiles.len() {
        for (run, at_far_end) in AXES.into_iter().flat_map(|run| [(run, false), (run, true)]) {
            let share =
                if plan.spaces[plan.tiles[index].space].is_corridor() { 0.4 * windows } else { windows };
            if neighbors(plan, index, run, at_far_end).is_empty() && dice.chance(share) {
                let tile = &plan.tiles[index];
                let (near, far) = tile.inner.span(run);
                let face = if at_far_end {
                    (far, far + plan.outer_wall_m)
                } else {
                    (near - plan.outer_wall_m, near)
                };
                let along = tile.inner.span(across(run));
                add_panes(plan, across(run), along, face, dice);
            }
        }
    }
    for contact in plan.contacts() {
        let spaces = contact.tiles.map(|tile| plan.tiles[tile].space);
        let corridors = spaces.iter().filter(|&&space| plan.spaces[space].is_corridor()).count();
        if spaces[0] != spaces[1] && corridors == 1 && dice.chance(glass_fronts) {
            add_panes(plan, contact.wall, contact.along, contact.across, dice);
        }
    }
}

/// Panes side by side along a wall, with posts between them.
fn add_panes(plan: &mut Plan, wall: Axis, (lo, hi): (f64, f64), face: (f64, f64), dice: &mut Dice) {
    let (pane, post) = (dice.between(0.7, 2.0), dice.between(0.05, 0.6));
    let mut at = lo + dice.between(0.1, 0.5);
    let missing = dice.between(0.0, 0.8);
    while at + pane < hi - 0.1 {
        if !dice.chance(missing) {
            plan.panes.push(Rect::along(wall, (at, at + pane), face));
        }
        at += pane + post;
    }
}

/// Pillars in large rooms, pilasters and cut corners in others, radiators nowhere.
pub(super) fn add_fixtures(plan: &mut Plan, dice: &mut Dice) {
    let pilasters = dice.pick(&[0.0, 0.05, 0.2]);
    for index in 0..plan.tiles.len() {
        let Rect { min, max } = plan.tiles[index].inner;
        let (width, height) = (max.x - min.x, max.y - min.y);
        let is_corridor = plan.spaces[plan.tiles[index].space].is_corridor();
        if !is_corridor && width.min(height) > 6.0 && dice.chance(0.5) {
            add_pillars(plan, index, dice);
        }
        if !is_corridor && dice.chance(pilasters) {
            // A shaft, a chimney or a column in a corner.
            let (w, h) = (dice.between(0.2, 0.9), dice.between(0.2, 0.9));
            if w < 0.35 * width && h < 0.35 * height {
                let x = dice.pick(&[min.x, max.x - w]);
                let y = dice.pick(&[min.y, max.y - h]);
                add_clear_of_doors(plan, Solid::rect(Rect::new(x, y, x + w, y + h)));
            }
        }
        if !is_corridor && dice.chance(0.03) && width.min(height) > 3.0 {
            let cut = dice.between(0.8, 0.5 * width.min(height));
            let (x, y) = (dice.pick(&[-1.0, 1.0]), dice.pick(&[-1.0, 1.0]));
            add_clear_of_doors(plan, cut_corner(&plan.tiles[index].inner, cut, x, y));
        }
    }
}

fn add_pillars(plan: &mut Plan, index: usize, dice: &mut Dice) {
    let Rect { min, max } = plan.tiles[index].inner;
    let (step, half, is_round) = (dice.between(3.5, 7.0), dice.between(0.12, 0.35), dice.chance(0.3));
    let n = |length: f64| (length / step).floor().max(1.0) as usize;
    let (nx, ny) = (n(max.x - min.x), n(max.y - min.y));
    for (i, j) in (1..nx).flat_map(|i| (1..ny.max(2)).map(move |j| (i, j))) {
        let center = Point2::new(
            min.x + (max.x - min.x) * i as f64 / nx as f64,
            min.y + (max.y - min.y) * j as f64 / ny.max(2) as f64,
        );
        let pillar = if is_round {
            Solid::Disc { center, radius_m: half }
        } else {
            Solid::rect(Rect { min: center, max: center }.grown(half))
        };
        add_clear_of_doors(plan, pillar);
    }
}

/// The triangle that cuts the corner on side (`x`, `y`) of `room`, each −1 or 1.
fn cut_corner(room: &Rect, cut: f64, x: f64, y: f64) -> Solid {
    let corner = Point2::new(
        if x < 0.0 { room.min.x } else { room.max.x },
        if y < 0.0 { room.min.y } else { room.max.y },
    );
    let a = Point2::new(corner.x - x * cut, corner.y);
    let b = Point2::new(corner.x, corner.y - y * cut);
    Solid::Convex(if x * y > 0.0 { vec![corner, b, a] } else { vec![corner, a, b] })
}

pub(super) fn add_clear_of_doors(plan: &mut Plan, fixture: Solid) {
    let bounds = fixture.bounds().grown(0.3);
    if !plan.openings.iter().any(|opening| opening.strip().overlaps(&bounds)) {
        plan.fixtures.push(fixture);
    }
}
