//! What makes corridors irregular: frames without a door, and walls that narrow them.

use super::walls::add_clear_of_doors;
use crate::dice::Dice;
use crate::plan::Plan;
use crate::shape::{Axis, Rect, Solid, across};
use crate::style::Extras;

/// Clear width that a frame or a wedge leaves, in meters.
const CLEAR_M: f64 = 1.2;

/// Puts frames into corridors and lets some of them taper.
pub(super) fn add(plan: &mut Plan, extras: &Extras, dice: &mut Dice) {
    for index in 0..plan.tiles.len() {
        let tile = &plan.tiles[index];
        if !plan.spaces[tile.space].is_corridor() {
            continue;
        }
        let inner = tile.inner;
        let run = if inner.width() > inner.height() { Axis::X } else { Axis::Y };
        let ((lo, hi), (from, to)) = (inner.span(run), inner.span(across(run)));
        let (length, spare) = (hi - lo, to - from - CLEAR_M);
        if length < 5.0 || spare < 0.2 {
            continue;
        }
        if dice.chance(extras.frames) {
            let at = dice.between(lo + 1.0, hi - 1.0);
            let span = (at, at + dice.between(0.1, 0.4));
            let share = dice.between(0.2, 0.8);
            let depth = spare.min(1.0) * dice.between(0.4, 1.0);
            let near = Rect::along(run, span, (from, from + share * depth));
            let far = Rect::along(run, span, (to - (1.0 - share) * depth, to));
            add_clear_of_doors(plan, Solid::rect(near));
            add_clear_of_doors(plan, Solid::rect(far));
        }
        if dice.chance(extras.tapers) {
            let wedge = wedge(run, (lo, hi), (from, to), spare.min(1.2) * dice.between(0.4, 1.0), dice);
            add_clear_of_doors(plan, wedge);
        }
    }
}

/// A wall along one side of a corridor that stands out by `depth` at one of its ends.
fn wedge(run: Axis, (lo, hi): (f64, f64), (from, to): (f64, f64), depth: f64, dice: &mut Dice) -> Solid {
    let length = (hi - lo) * dice.between(0.3, 0.9);
    let (thick, thin) = if dice.chance(0.5) { (lo, lo + length) } else { (hi, hi - length) };
    let (wall, inward) = if dice.chance(0.5) { (from, depth) } else { (to, -depth) };
    let corner = |along, over| Rect::along(run, (along, along), (over, over)).min;
    let (a, b, c) = (corner(thick, wall), corner(thin, wall), corner(thick, wall + inward));
    let is_left = (b - a).cross(c - a) > 0.0;
    Solid::Convex(if is_left { vec![a, b, c] } else { vec![a, c, b] })
}
