//! Doors: enough of them that every space can be reached, and some more.

use crate::dice::Dice;
use crate::plan::{Contact, Opening, OpeningKind, Plan, STRAIGHT, Usage};
use crate::shape::{Axis, Rect, Stand, across, heading};
use crate::style::{Extras, Recipe, Style};
use placegraph::geom::Point2;

/// Thickness of a door's leaf, in meters.
const LEAF_M: f64 = 0.045;
/// Nothing wider counts as a doorway, unless it was made to be one.
const WIDEST_DOORWAY_M: f64 = 2.0;
/// Widths of the widest doors, which have two leaves.
const WIDE_M: (f64, f64) = (1.6, 2.6);

/// How the doors of one building are.
struct Doors {
    width: (f64, f64),
    double: f64,
    /// Share of doors without a leaf, or with one that slid into the wall.
    bare: f64,
    closed: f64,
    ajar: f64,
    wide: f64,
    extras: Option<Extras>,
}

/// Opens walls until everything that can be is connected, and drops what is not.
pub(super) fn connect(plan: &mut Plan, style: Style, recipe: &Recipe, dice: &mut Dice) {
    let width = dice.within(recipe.door);
    let mut doors = Doors {
        width: (width - 0.05, width + 0.08),
        double: recipe.double_doors,
        bare: dice.pick(&[0.1, 0.5, 1.0]),
        closed: dice.pick(&[0.0, 0.0, 0.08, 0.25]),
        ajar: dice.pick(&[0.0, 0.1, 0.3]),
        wide: if matches!(style, Style::Home | Style::Flat) { 0.3 } else { 0.1 },
        extras: recipe.extras,
    };
    if let Some(extras) = recipe.extras {
        doors.ajar = extras.ajar * dice.pick(&[0.3, 1.0, 2.0]);
    }
    let mut contacts = plan.contacts();
    contacts.retain(|contact| {
        let [a, b] = contact.tiles.map(|tile| plan.tiles[tile].space);
        a != b && contact.along.1 - contact.along.0 > 0.9
    });
    dice.shuffle(&mut contacts);
    contacts.sort_by_key(|contact| std::cmp::Reverse(corridors_at(plan, contact)));

    let mut group: Vec<usize> = (0..plan.spaces.len()).collect();
    for pass in 0..2 {
        for contact in &contacts {
            let spaces = contact.tiles.map(|tile| plan.tiles[tile].space);
            let joins = group[spaces[0]] != group[spaces[1]];
            let wanted = if pass == 0 { joins } else { !joins && wants_more(plan, contact, recipe, dice) };
            if wanted && add_opening(plan, contact, &doors, dice) && joins {
                let [keep, lose] = spaces.map(|space| group[space]);
                group.iter_mut().filter(|g| **g == lose).for_each(|g| *g = keep);
            }
        }
    }
    let count = |g: usize| group.iter().filter(|&&other| other == g).count();
    let largest = (0..group.len()).max_by_key(|&g| (count(g), std::cmp::Reverse(g))).unwrap_or(0);
    let keep: Vec<bool> = group.iter().map(|&g| g == largest).collect();
    plan.retain_spaces(&keep);
}

fn corridors_at(plan: &Plan, contact: &Contact) -> usize {
    contact.tiles.iter().filter(|&&tile| plan.spaces[plan.tiles[tile].space].is_corridor()).count()
}

/// Whether two spaces that can be reached from each other get another door here.
fn wants_more(plan: &Plan, contact: &Contact, recipe: &Recipe, dice: &mut Dice) -> bool {
    let usages = contact.tiles.map(|tile| plan.spaces[plan.tiles[tile].space].usage);
    if usages.iter().any(|usage| matches!(usage, Usage::Bath | Usage::Toilet | Usage::Cubicle)) {
        return false;
    }
    let length = contact.along.1 - contact.along.0;
    match corridors_at(plan, contact) {
        0 => dice.chance(recipe.inner_doors),
        1 => length > 6.0 && dice.chance(0.35),
        _ => false,
    }
}

/// Puts an opening somewhere into the wall of `contact`; false if there is no place for one.
fn add_opening(plan: &mut Plan, contact: &Contact, doors: &Doors, dice: &mut Dice) -> bool {
    let spaces = contact.tiles.map(|tile| plan.tiles[tile].space);
    let usages = spaces.map(|space| plan.spaces[space].usage);
    let (lo, hi) = contact.along;
    let room = hi - lo - 0.16;
    let between_corridors = corridors_at(plan, contact) == 2;
    let is_large = |usage| matches!(usage, Usage::Hall | Usage::OpenPlan | Usage::Warehouse | Usage::Living);
    let is_cubicle = usages.contains(&Usage::Cubicle);
    let is_bath = usages.iter().any(|usage| matches!(usage, Usage::Bath | Usage::Toilet | Usage::Storage));
    let passage =
        is_cubicle || (!is_bath && usages.iter().copied().any(is_large) && dice.chance(2.5 * doors.wide));
    let has = |share: fn(&Extras) -> f64, dice: &mut Dice| {
        doors.extras.is_some_and(|extras| dice.chance(share(&extras)))
    };
    let is_front = !is_cubicle
        && !is_bath
        && usages.iter().copied().any(|usage| is_large(usage) || usage == Usage::Meeting)
        && has(|extras| extras.open_fronts, dice);
    let is_wide_door = !is_front && !is_cubicle && !is_bath && room > 3.0 && has(|extras| extras.wide, dice);
    let width = if is_front {
        room.min(12.0)
    } else if is_wide_door {
        dice.within(WIDE_M)
    } else if is_cubicle {
        room.min(dice.between(0.8, 1.8))
    } else if between_corridors {
        room.min(dice.between(1.2, 2.0))
    } else if passage {
        room.min(dice.between(1.1, 3.5))
    } else if dice.chance(doors.double) && room > 2.0 && !is_bath {
        dice.between(1.3, 1.9)
    } else {
        (dice.within(doors.width) - if is_bath { 0.08 } else { 0.0 }).max(0.7).min(room)
    };
    if width < 0.68 {
        return false;
    }
    let is_flush = !is_front && has(|extras| extras.flush, dice);
    let passage = is_front || (passage && !is_wide_door);
    for _ in 0..8 {
        let slack = room - width;
        let at = lo
            + 0.08
            + slack
                * match dice.below(10) {
                    0..4 => dice.between(0.0, 0.3_f64.min(0.5 / slack.max(0.5))),
                    4..8 => 1.0 - dice.between(0.0, 0.3_f64.min(0.5 / slack.max(0.5))),
                    _ => dice.between(0.0, 1.0),
                };
        let at = if between_corridors { lo + 0.08 + 0.5 * slack } else { at };
        let at = match is_flush {
            true if dice.chance(0.5) => lo,
            true => hi - width,
            false => at,
        };
        let gap = Rect::along(contact.wall, (at, at + width), contact.across);
        let is_wide = is_cubicle || (passage && width > 1.6) || (width > WIDEST_DOORWAY_M && !is_wide_door);
        let mut opening = Opening {
            spaces: if first_is_below(plan, contact) { spaces } else { [spaces[1], spaces[0]] },
            kind: if is_wide { OpeningKind::Passage } else { OpeningKind::Doorway },
            wall: contact.wall,
            gap,
            turn: STRAIGHT,
            leaves: Vec::new(),
            closed: false,
        };
        let strip = opening.strip().grown(0.1);
        if plan.openings.iter().any(|other| other.strip().overlaps(&strip)) {
            continue;
        }
        if !passage && !dice.chance(doors.bare) {
            opening.closed = !between_corridors && dice.chance(doors.closed);
            let hinge_first = dice.chance(0.5);
            let first_is_corridor = plan.spaces[plan.tiles[contact.tiles[0]].space].is_corridor();
            let into_room = dice.chance(0.85);
            let swings_up = (first_is_below(plan, contact) == first_is_corridor) == into_room;
            hang_leaves(&mut opening, hinge_first, swings_up, doors.ajar, dice);
        } else if !passage && !between_corridors && dice.chance(0.5 * doors.closed) {
            opening.closed = true;
            opening.leaves.push(opening.solid(middle_of(&opening)));
        }
        plan.openings.push(opening);
        return true;
    }
    false
}

/// Whether the first tile of `contact` lies on the lower side of the wall.
fn first_is_below(plan: &Plan, contact: &Contact) -> bool {
    let first = plan.tiles[contact.tiles[0]].inner.span(across(contact.wall));
    first.0.midpoint(first.1) < contact.across.0.midpoint(contact.across.1)
}

/// The gap as thin as a leaf.
pub(crate) fn middle_of(opening: &Opening) -> Rect {
    let (from, to) = opening.gap.span(across(opening.wall));
    let middle = from.midpoint(to);
    let half = (0.5 * LEAF_M).min(0.5 * (to - from));
    Rect::along(opening.wall, opening.gap.span(opening.wall), (middle - half, middle + half))
}

/// Hangs one or two leaves that swing to the upper or lower side of the wall, mostly open; `ajar` is the share of those
/// that are hardly.
pub(crate) fn hang_leaves(
    opening: &mut Opening,
    hinge_first: bool,
    swings_up: bool,
    ajar: f64,
    dice: &mut Dice,
) {
    let width = opening.width_m();
    let n_leaves = if width > 1.25 { 2 } else { 1 };
    let (from, to) = opening.gap.span(across(opening.wall));
    let face = if swings_up { to } else { from };
    let (lo, hi) = opening.gap.span(opening.wall);
    for leaf in 0..n_leaves {
        let at_lo = (leaf == 0) == hinge_first;
        let angle_deg = if opening.closed {
            0.0
        } else if dice.chance(ajar) {
            dice.between(15.0, 75.0)
        } else {
            dice.pick(&[85.0, 92.0, 100.0, 115.0, 140.0, 165.0]) + dice.between(-8.0, 8.0)
        };
        let turn = heading(angle_deg.to_radians());
        // Along the wall away from the hinge, then across it towards the swing side.
        let (along, over) = (if at_lo { turn.x } else { -turn.x }, if swings_up { turn.y } else { -turn.y });
        let hinge = if at_lo { lo } else { hi };
        let (at, forward) = match opening.wall {
            Axis::X => (Point2::new(hinge, face), (along, over)),
            Axis::Y => (Point2::new(face, hinge), (over, along)),
        };
        let stand = Stand { at, forward: placegraph::geom::Vec2::new(forward.0, forward.1) };
        let length = width / f64::from(n_leaves);
        let leaf = stand.rect(Rect::new(0.0, -0.5 * LEAF_M, length, 0.5 * LEAF_M));
        let leaf = opening.put_in_plan(leaf);
        opening.leaves.push(leaf);
    }
}
