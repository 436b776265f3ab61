//! Open floors around a core: the rooms that need no window stand in the middle, desks all around them.

use super::{add, blocks, extend};
use crate::dice::Dice;
use crate::plan::{Plan, Usage};
use crate::shape::Rect;
use crate::style::Recipe;

/// A core of rooms, an open floor around it, mostly a row of rooms along a facade, now and then a corridor beside the core.
pub(super) fn around_core(plan: &mut Plan, recipe: &Recipe, dice: &mut Dice) {
    let (width, height) = (dice.between(20.0, 42.0), dice.between(15.0, 28.0));
    let (core_width, core_height) = (dice.between(0.3, 0.55) * width, dice.between(5.0, 0.5 * height));
    let left = 0.5 * (width - core_width) * dice.between(0.7, 1.3);
    let below = 0.5 * (height - core_height) * dice.between(0.8, 1.2);
    let (right, above) = (left + core_width, below + core_height);
    let corridor = if dice.chance(0.5) { dice.within(recipe.corridor) } else { 0.0 };
    if corridor > 0.0 {
        add(plan, Usage::Corridor, Rect::new(left, below - corridor, right, below));
    }
    let floor = add(plan, Usage::OpenPlan, Rect::new(0.0, 0.0, width, below - corridor));
    if corridor > 0.0 {
        extend(plan, floor, Rect::new(0.0, below - corridor, left, below));
        extend(plan, floor, Rect::new(right, below - corridor, width, below));
    }
    extend(plan, floor, Rect::new(0.0, below, left, above));
    extend(plan, floor, Rect::new(right, below, width, above));
    extend(plan, floor, Rect::new(0.0, above, width, height));

    let middle = below + core_height * dice.between(0.4, 0.6);
    let (lower, upper) = (Rect::new(left, below, right, middle), Rect::new(left, middle, right, above));
    blocks::row_of_rooms(plan, &lower, blocks::Side::Bottom, recipe, dice);
    blocks::row_of_rooms(plan, &upper, blocks::Side::Top, recipe, dice);
    if dice.chance(0.7) {
        let facade = Rect::new(0.0, height, width, height + dice.within(recipe.depth));
        blocks::row_of_rooms(plan, &facade, blocks::Side::Bottom, recipe, dice);
    }
    if dice.chance(0.4) {
        let facade = Rect::new(width, 0.0, width + dice.within(recipe.depth), height);
        blocks::row_of_rooms(plan, &facade, blocks::Side::Left, recipe, dice);
    }
}
