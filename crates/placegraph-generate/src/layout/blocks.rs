//! Blocks of rooms beside corridors.

use super::{add, extend};
use crate::dice::Dice;
use crate::plan::{Plan, Usage};
use crate::shape::{Axis, Rect, across};
use crate::style::Recipe;

/// A side of a rectangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Bottom,
    Left,
    Right,
    Top,
}

impl Side {
    const ALL: [Self; 4] = [Self::Bottom, Self::Left, Self::Right, Self::Top];

    /// Direction of the wall on this side.
    const fn wall(self) -> Axis {
        match self {
            Self::Bottom | Self::Top => Axis::X,
            Self::Left | Self::Right => Axis::Y,
        }
    }

    /// The part of `rect` from `from` to `to` meters behind this side.
    pub(super) fn layer(self, rect: &Rect, from: f64, to: f64) -> Rect {
        let (lo, hi) = rect.span(across(self.wall()));
        let span = match self {
            Self::Bottom | Self::Left => (lo + from, (lo + to).min(hi)),
            Self::Right | Self::Top => ((hi - to).max(lo), hi - from),
        };
        Rect::along(self.wall(), rect.span(self.wall()), span)
    }

    const fn opposite(self) -> Self {
        match self {
            Self::Bottom => Self::Top,
            Self::Left => Self::Right,
            Self::Right => Self::Left,
            Self::Top => Self::Bottom,
        }
    }
}

/// Fills `block` with rooms, a hall, cubicles or nothing.
pub(super) fn fill(plan: &mut Plan, block: &Rect, recipe: &Recipe, dice: &mut Dice) {
    let sides: Vec<Side> = Side::ALL.into_iter().filter(|&side| faces_corridor(plan, block, side)).collect();
    if sides.is_empty() || dice.chance(recipe.voids) {
        return;
    }
    if dice.chance(recipe.halls) && (30.0..400.0).contains(&block.area()) {
        let usage =
            dice.pick(&[Usage::OpenPlan, Usage::OpenPlan, Usage::Hall, Usage::Meeting, Usage::Laboratory]);
        add(plan, usage, *block);
        return;
    }
    let long_sides = sides.iter().copied().filter(|side| {
        let (lo, hi) = block.span(side.wall());
        let (from, to) = block.span(across(side.wall()));
        hi - lo >= 0.6 * (to - from)
    });
    let candidates: Vec<Side> = long_sides.collect();
    let side = dice.pick(if candidates.is_empty() { &sides } else { &candidates });
    let (from, to) = block.span(across(side.wall()));
    let depth = to - from;
    if sides.contains(&side.opposite()) && depth > 1.8 * recipe.depth.0 {
        let split = depth * dice.between(0.42, 0.58);
        let spare = if dice.chance(0.2) { dice.between(0.3, 1.2) } else { 0.0 };
        let (front, back) = (split - spare, depth - split - spare);
        row(plan, &side.layer(block, 0.0, front), side, recipe, dice);
        row(plan, &side.opposite().layer(block, 0.0, back), side.opposite(), recipe, dice);
    } else if depth > 1.4 * recipe.depth.1 {
        let front = dice.within(recipe.depth);
        row(plan, &side.layer(block, 0.0, front), side, recipe, dice);
        if dice.chance(0.5) {
            let back = front + dice.within(recipe.depth).min(depth - front);
            row_of_rooms(plan, &side.layer(block, front, back), side, recipe, dice);
        }
    } else {
        row(plan, block, side, recipe, dice);
    }
}

/// Whether most of this side of `block` lies on a corridor.
fn faces_corridor(plan: &Plan, block: &Rect, side: Side) -> bool {
    let edge = side.layer(block, -0.1, 0.1);
    let (lo, hi) = block.span(side.wall());
    let touched: f64 = plan
        .tiles
        .iter()
        .filter(|tile| plan.spaces[tile.space].is_corridor() && tile.outer.overlaps(&edge))
        .map(|tile| {
            let span = tile.outer.span(side.wall());
            (span.1.min(hi) - span.0.max(lo)).max(0.0)
        })
        .sum();
    touched > 0.5 * (hi - lo)
}

/// A row of rooms, or in offices now and then a bank of cubicles.
fn row(plan: &mut Plan, rect: &Rect, side: Side, recipe: &Recipe, dice: &mut Dice) {
    let is_office = recipe.rooms.iter().any(|room| room.0 == Usage::OpenPlan);
    if is_office && dice.chance(0.08) {
        bank_of_cubicles(plan, rect, side, dice);
    } else {
        row_of_rooms(plan, rect, side, recipe, dice);
    }
}

/// Booths that stand open to the corridor, in one row along it.
fn bank_of_cubicles(plan: &mut Plan, rect: &Rect, side: Side, dice: &mut Dice) {
    let (lo, hi) = rect.span(side.wall());
    let n = ((hi - lo) / dice.between(2.0, 3.0)).floor().max(1.0);
    let bank = side.layer(rect, 0.0, dice.between(1.9, 3.0));
    for booth in 0..n as usize {
        let at = |k: usize| lo + (hi - lo) * k as f64 / n;
        let across = bank.span(across(side.wall()));
        add(plan, Usage::Cubicle, Rect::along(side.wall(), (at(booth), at(booth + 1)), across));
    }
}

/// Rooms side by side, all with their `side` on the corridor.
pub(super) fn row_of_rooms(plan: &mut Plan, rect: &Rect, side: Side, recipe: &Recipe, dice: &mut Dice) {
    let (mut at, end) = rect.span(side.wall());
    let across = rect.span(across(side.wall()));
    let stepped = dice.chance(0.3);
    let uniform = dice.chance(0.35).then(|| draw_room(recipe, dice));
    while end - at > 1.0 {
        let room = match uniform {
            Some(room) if dice.chance(0.85) => room,
            _ => draw_room(recipe, dice),
        };
        let mut width = dice.within(room.1);
        if let (Some(_), true) = (uniform, dice.chance(0.8)) {
            width = room.1.0.midpoint(room.1.1);
        }
        if end - at - width < 0.7 * room.1.0.max(1.6) {
            width = end - at;
        }
        let slot = Rect::along(side.wall(), (at, at + width), across);
        at += width;
        place_room(plan, &slot, side, room.0, stepped, recipe, dice);
    }
}

fn draw_room(recipe: &Recipe, dice: &mut Dice) -> (Usage, (f64, f64)) {
    let choices: Vec<_> =
        recipe.rooms.iter().map(|&(usage, width, weight)| ((usage, width), weight)).collect();
    dice.weighted(&choices)
}

/// Puts a room (or what stands in its place: nothing, an alcove of the corridor) into `slot`.
fn place_room(
    plan: &mut Plan,
    slot: &Rect,
    side: Side,
    usage: Usage,
    stepped: bool,
    recipe: &Recipe,
    dice: &mut Dice,
) {
    let (from, to) = slot.span(across(side.wall()));
    let depth = to - from;
    let (lo, hi) = slot.span(side.wall());
    if dice.chance(0.03) {
        return;
    }
    let alcove = dice.chance(0.04) && hi - lo < 7.0;
    if let Some(corridor) = corridor_beside(plan, slot, side).filter(|_| alcove) {
        extend(plan, corridor, side.layer(slot, 0.0, depth * dice.between(0.3, 1.0)));
        return;
    }
    if let Some(extras) = recipe.extras {
        if hi - lo > 3.4
            && dice.chance(extras.stubs)
            && let Some(corridor) = corridor_beside(plan, slot, side)
        {
            let width = dice.between(1.1, 1.8);
            let (stub, rest) = if dice.chance(0.5) {
                ((lo, lo + width), (lo + width, hi))
            } else {
                ((hi - width, hi), (lo, hi - width))
            };
            let stub = Rect::along(side.wall(), stub, (from, to));
            extend(plan, corridor, side.layer(&stub, 0.0, depth * dice.between(0.3, 1.0)));
            add(plan, usage, Rect::along(side.wall(), rest, (from, to)));
            return;
        }
        if hi - lo > 2.6 && depth > 2.6 && dice.chance(extras.closets) {
            let (entrance, closet) = (dice.between(0.9, 1.5), dice.between(1.0, 1.4_f64.max(hi - lo - 1.3)));
            with_corner(plan, slot, side, [usage, Usage::Storage], [entrance, closet.min(2.2)], dice);
            return;
        }
    }
    let depth = if stepped && dice.chance(0.4) { depth - dice.between(0.0, 0.3) * depth } else { depth };
    let room = side.layer(slot, 0.0, depth);
    if dice.chance(recipe.baths) && hi - lo > 2.9 && depth > 4.2 {
        with_bath(plan, &room, side, usage, dice);
    } else if dice.chance(0.06) && depth > 5.5 {
        let split = depth * dice.between(0.35, 0.65);
        add(plan, usage, side.layer(&room, 0.0, split));
        add(plan, usage, side.layer(&room, split, depth));
    } else {
        add(plan, usage, room);
    }
}

/// A room with a bath beside its entrance.
fn with_bath(plan: &mut Plan, room: &Rect, side: Side, usage: Usage, dice: &mut Dice) {
    let (lo, hi) = room.span(side.wall());
    let entrance = dice.between(1.7, 2.6);
    let bath = dice.between(1.5, (hi - lo - 1.2).clamp(1.6, 2.5));
    with_corner(plan, room, side, [usage, Usage::Bath], [entrance, bath], dice);
}

/// A room and another one in its corner beside the entrance, so deep and so wide.
fn with_corner(
    plan: &mut Plan,
    room: &Rect,
    side: Side,
    [usage, corner_usage]: [Usage; 2],
    [depth_m, width_m]: [f64; 2],
    dice: &mut Dice,
) {
    let (lo, hi) = room.span(side.wall());
    let entrance = side.layer(room, 0.0, depth_m);
    let is_near = dice.chance(0.5);
    let split = if is_near { lo + width_m } else { hi - width_m };
    let depth = entrance.span(across(side.wall()));
    let (near, far) =
        (Rect::along(side.wall(), (lo, split), depth), Rect::along(side.wall(), (split, hi), depth));
    let (corner, vestibule) = if is_near { (near, far) } else { (far, near) };
    let space = add(plan, usage, vestibule);
    let (from, to) = room.span(across(side.wall()));
    extend(plan, space, side.layer(room, depth.1 - depth.0, to - from));
    add(plan, corner_usage, corner);
}

/// The corridor that lies along this side of `slot`.
fn corridor_beside(plan: &Plan, slot: &Rect, side: Side) -> Option<usize> {
    let edge = side.layer(slot, -0.1, 0.1);
    let tile = plan.tiles.iter().find(|tile| {
        plan.spaces[tile.space].is_corridor() && {
            let (lo, hi) = tile.outer.span(side.wall());
            let (slot_lo, slot_hi) = slot.span(side.wall());
            tile.outer.overlaps(&edge) && lo <= slot_lo && slot_hi <= hi
        }
    })?;
    Some(tile.space)
}
