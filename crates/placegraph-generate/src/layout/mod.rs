//! Layouts: which space is where. A layout tiles the floor up to the middle of the walls; the walls and
//! the openings follow from which tiles touch.

mod blocks;
mod corridor_fixtures;
mod corridors;
mod home;
mod open_floor;
mod openings;
mod walls;

pub(crate) use openings::{hang_leaves, middle_of};

use crate::dice::Dice;
use crate::plan::{Plan, Space, Tile, Usage};
use crate::shape::Rect;
use crate::style::{Recipe, Style};

/// A floor plan without furniture, with all its spaces reachable.
pub(crate) fn lay_out(style: Style, dice: &mut Dice) -> Plan {
    let recipe = Recipe::of(style);
    loop {
        let mut plan = Plan::default();
        match style {
            Style::Home if dice.chance(0.6) => home::rooms_in_rooms(&mut plan, &recipe, dice),
            Style::Warehouse => hall_with_offices(&mut plan, &recipe, dice),
            Style::OpenOffice => open_floor::around_core(&mut plan, &recipe, dice),
            _ => corridors::blocks_on_corridors(&mut plan, &recipe, dice),
        }
        corridors::add_fire_doors(&mut plan, dice);
        walls::build(&mut plan, style, &recipe, dice);
        openings::connect(&mut plan, style, &recipe, dice);
        if (3..250).contains(&plan.spaces.len()) && corridor_share(&plan) < 0.42 {
            walls::glaze(&mut plan, style, dice);
            walls::add_fixtures(&mut plan, dice);
            if let Some(extras) = &recipe.extras {
                corridor_fixtures::add(&mut plan, extras, dice);
            }
            return plan;
        }
    }
}

/// Share of the floor that is corridor.
fn corridor_share(plan: &Plan) -> f64 {
    let area = |tiles: &mut dyn Iterator<Item = &Tile>| tiles.map(|tile| tile.inner.area()).sum::<f64>();
    let corridors = area(&mut plan.tiles.iter().filter(|tile| plan.spaces[tile.space].is_corridor()));
    corridors / area(&mut plan.tiles.iter())
}

/// A large hall; along one side rooms, often behind a corridor.
fn hall_with_offices(plan: &mut Plan, recipe: &Recipe, dice: &mut Dice) {
    let (width, height) = (dice.within(recipe.wing), dice.between(12.0, 26.0));
    add(plan, Usage::Warehouse, Rect::new(0.0, 0.0, width, height));
    let corridor = if dice.chance(0.6) { dice.within(recipe.corridor) } else { 0.0 };
    let length = if dice.chance(0.5) { width } else { width * dice.between(0.5, 0.9) };
    if corridor > 0.0 {
        add(plan, Usage::Corridor, Rect::new(0.0, -corridor, length, 0.0));
    }
    let depth = dice.within(recipe.depth);
    let rooms = Rect::new(0.0, -corridor - depth, length, -corridor);
    blocks::row_of_rooms(plan, &rooms, blocks::Side::Top, recipe, dice);
    if dice.chance(0.35) {
        let side = Rect::new(width, 0.0, width + dice.within(recipe.depth), height);
        blocks::row_of_rooms(plan, &side, blocks::Side::Left, recipe, dice);
    }
}

/// Adds a space of one tile.
fn add(plan: &mut Plan, usage: Usage, outer: Rect) -> usize {
    plan.spaces.push(Space { usage });
    extend(plan, plan.spaces.len() - 1, outer)
}

/// Adds a tile to `space`.
fn extend(plan: &mut Plan, space: usize, outer: Rect) -> usize {
    plan.tiles.push(Tile { space, outer, inner: outer });
    space
}
