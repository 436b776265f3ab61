//! Homes without bands: a rectangle that is split again and again.

use super::add;
use crate::dice::Dice;
use crate::plan::{Plan, Usage};
use crate::shape::{Axis, Rect, across};
use crate::style::Recipe;

/// A flat whose rooms open into each other or into a small hall.
pub(super) fn rooms_in_rooms(plan: &mut Plan, recipe: &Recipe, dice: &mut Dice) {
    let (width, height) = (dice.between(7.0, 14.0), dice.between(5.5, 11.0));
    let mut rooms = Vec::new();
    match dice.below(3) {
        0 => split(Rect::new(0.0, 0.0, width, height), &mut rooms, dice),
        1 => {
            // A hallway from the entrance inward, with rooms on three sides.
            let hall = dice.within(recipe.corridor);
            let from = width * dice.between(0.25, 0.6);
            let length = height * dice.between(0.5, 0.85);
            add(plan, Usage::Corridor, Rect::new(from, 0.0, from + hall, length));
            split(Rect::new(0.0, 0.0, from, length), &mut rooms, dice);
            split(Rect::new(from + hall, 0.0, width, length), &mut rooms, dice);
            split(Rect::new(0.0, length, width, height), &mut rooms, dice);
        }
        _ => {
            // A hallway along the middle that ends at the living room.
            let hall = dice.within(recipe.corridor);
            let from = height * dice.between(0.35, 0.55);
            let length = width * dice.between(0.45, 0.75);
            add(plan, Usage::Corridor, Rect::new(0.0, from, length, from + hall));
            split(Rect::new(0.0, 0.0, length, from), &mut rooms, dice);
            split(Rect::new(0.0, from + hall, length, height), &mut rooms, dice);
            split(Rect::new(length, 0.0, width, height), &mut rooms, dice);
        }
    }
    rooms.sort_by(|a, b| b.area().total_cmp(&a.area()));
    for (rank, room) in rooms.iter().enumerate() {
        // A missing room makes an L of the outline.
        if rank > 2 && dice.chance(0.05) {
            continue;
        }
        let usage = match rank {
            0 => Usage::Living,
            _ if room.area() < 3.0 => Usage::Storage,
            _ if room.area() < 7.0 => dice.pick(&[Usage::Bath, Usage::Bath, Usage::Storage, Usage::Kitchen]),
            1 => dice.pick(&[Usage::Bedroom, Usage::Kitchen, Usage::Living]),
            _ => dice.pick(&[Usage::Bedroom, Usage::Bedroom, Usage::Kitchen, Usage::Office]),
        };
        add(plan, usage, *room);
    }
}

/// Splits `rect` across its longer side until the parts are rooms.
fn split(rect: Rect, rooms: &mut Vec<Rect>, dice: &mut Dice) {
    let run = if rect.width() > rect.height() { Axis::X } else { Axis::Y };
    let (lo, hi) = rect.span(run);
    let small = rect.area() < 9.0 || (rect.area() < 24.0 && dice.chance(0.35));
    if small || hi - lo < 3.2 {
        rooms.push(rect);
        return;
    }
    let margin = (0.3 * (hi - lo)).max(1.5);
    let cut = dice.between(lo + margin, hi - margin);
    let side = rect.span(across(run));
    split(Rect::along(run, (lo, cut), side), rooms, dice);
    split(Rect::along(run, (cut, hi), side), rooms, dice);
}
