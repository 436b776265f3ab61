//! Furniture that fits the room: along the walls or in the middle, clear of the doors.

mod pieces;

use placegraph::geom::{Point2, Vec2};

use crate::dice::Dice;
use crate::plan::{Plan, Usage};
use crate::shape::{Rect, Solid, Stand};
use pieces::Piece;

/// How carefully a building is furnished.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Care {
    /// Floor that stays clear around the doorways as they are labeled.
    pub(crate) door_clearance_m: f64,
    /// Share of rooms that stay empty.
    pub(crate) empty: f64,
}

impl Care {
    /// Doors are kept clear, few rooms are empty.
    pub(crate) const PLAIN: Self = Self { door_clearance_m: 0.45, empty: 0.06 };

    /// Furniture may stand before doors.
    pub(crate) fn draw(dice: &mut Dice) -> Self {
        Self { door_clearance_m: dice.pick(&[0.45, 0.45, 0.15, 0.0]), empty: dice.pick(&[0.06, 0.2, 0.5]) }
    }
}

/// Fills all rooms of `plan`.
pub(crate) fn furnish(plan: &mut Plan, care: Care, dice: &mut Dice) {
    let clutter = dice.pick(&[0.0, 0.2, 0.5, 1.0]);
    let fill = dice.between(0.5, 1.3);
    let mut furniture = Vec::new();
    for space in 0..plan.spaces.len() {
        let tiles = plan.tiles.iter().filter(|tile| tile.space == space);
        let Some(tile) = tiles.max_by(|a, b| a.inner.area().total_cmp(&b.inner.area())) else { continue };
        let mut room = Room::new(plan, tile.inner, care.door_clearance_m, dice.chance(0.3));
        if dice.chance(care.empty) {
            continue;
        }
        furnish_room(&mut room, plan.spaces[space].usage, fill, dice);
        if plan.spaces[space].usage != Usage::Corridor {
            let n = (clutter * room.floor.area() * dice.between(0.0, 0.7)) as usize;
            for _ in 0..n.min(25) {
                let piece = pieces::clutter(dice);
                if dice.chance(0.5) {
                    room.place_at_wall(&piece, dice);
                } else {
                    room.place_anywhere(&piece, dice);
                }
            }
        }
        furniture.append(&mut room.furniture);
    }
    plan.furniture.append(&mut furniture);
}

/// A room while it is filled.
struct Room {
    floor: Rect,
    /// What must stay clear, and what is taken.
    taken: Vec<Rect>,
    furniture: Vec<Solid>,
    /// Pieces stand at right angles.
    is_askew: bool,
}

impl Room {
    fn new(plan: &Plan, floor: Rect, door_clearance_m: f64, is_askew: bool) -> Self {
        let strips = plan
            .openings
            .iter()
            .map(|opening| opening.solid(opening.strip()).bounds().grown(door_clearance_m));
        let fixtures = plan.fixtures.iter().chain(&plan.furniture).map(Solid::bounds);
        Self {
            floor,
            taken: strips.chain(fixtures).filter(|rect| rect.overlaps(&floor)).collect(),
            furniture: Vec::new(),
            is_askew,
        }
    }

    /// Puts `piece` with its back against a wall; false if eight tries found no room.
    fn place_at_wall(&mut self, piece: &Piece, dice: &mut Dice) -> bool {
        (0..8).any(|_| {
            let Rect { min, max } = self.floor;
            let gap = dice.between(0.0, 0.06);
            let forward = dice.pick(&[
                Vec2::new(1.0, 0.0),
                Vec2::new(0.0, 1.0),
                Vec2::new(-1.0, 0.0),
                Vec2::new(0.0, -1.0),
            ]);
            let half = 0.5 * piece.width_m;
            let free = if forward.x == 0.0 { max.x - min.x } else { max.y - min.y } - piece.width_m;
            let slide = match dice.below(3) {
                0 => 0.0,
                1 => free.max(0.0),
                _ => dice.between(0.0, free.max(0.0)),
            } + half;
            // Local +x runs along the wall, +y into the room.
            let stand = if forward.y > 0.5 {
                Stand { at: Point2::new(min.x + slide, min.y + gap), forward: Vec2::new(1.0, 0.0) }
            } else if forward.y < -0.5 {
                Stand { at: Point2::new(min.x + slide, max.y - gap), forward: Vec2::new(-1.0, 0.0) }
            } else if forward.x > 0.5 {
                Stand { at: Point2::new(min.x + gap, min.y + slide), forward: Vec2::new(0.0, -1.0) }
            } else {
                Stand { at: Point2::new(max.x - gap, min.y + slide), forward: Vec2::new(0.0, 1.0) }
            };
            free >= 0.0 && self.place(piece, &stand)
        })
    }

    /// Puts `piece` somewhere on the floor, turned at random.
    fn place_anywhere(&mut self, piece: &Piece, dice: &mut Dice) -> bool {
        let at = Point2::new(
            dice.between(self.floor.min.x, self.floor.max.x),
            dice.between(self.floor.min.y, self.floor.max.y),
        );
        let angle = dice.between(0.0, std::f64::consts::TAU);
        self.place(piece, &Stand { at, forward: crate::shape::heading(angle) })
    }

    /// Puts `piece` at `at` with its sides along the walls, nearly.
    fn place_in_line(&mut self, piece: &Piece, at: Point2, is_turned: bool, dice: &mut Dice) -> bool {
        let skew = if self.is_askew { dice.normal() * 0.06 } else { 0.0 };
        let forward = crate::shape::heading(skew + if is_turned { std::f64::consts::FRAC_PI_2 } else { 0.0 });
        self.place(piece, &Stand { at, forward })
    }

    fn place(&mut self, piece: &Piece, stand: &Stand) -> bool {
        let local = Rect::new(-0.5 * piece.width_m, 0.0, 0.5 * piece.width_m, piece.depth_m);
        let bounds = stand.rect(local).bounds();
        if !self.floor.grown(0.02).contains(&bounds) || self.taken.iter().any(|rect| rect.overlaps(&bounds)) {
            return false;
        }
        self.taken.push(bounds);
        self.furniture.extend(piece.parts.iter().map(|part| part.placed(stand)));
        true
    }
}

/// Draws a piece.
type Draw = fn(&mut Dice) -> Piece;

/// The furniture of one room: what stands in the middle, then what stands along the walls.
fn furnish_room(room: &mut Room, usage: Usage, fill: f64, dice: &mut Dice) {
    let area = room.floor.area();
    furnish_middle(room, usage, dice);
    for (draw, n) in along_walls(usage, area) {
        for _ in 0..(fill * n + dice.between(0.0, 1.0)) as usize {
            let piece = draw(dice);
            room.place_at_wall(&piece, dice);
        }
    }
}

/// What stands along the walls of a room of `area` square meters, and about how many of it.
fn along_walls(usage: Usage, area: f64) -> Vec<(Draw, f64)> {
    match usage {
        Usage::Corridor => vec![(pieces::corridor_item, area / 45.0)],
        Usage::Cubicle => vec![(pieces::desk, 1.3)],
        Usage::Office => vec![
            (pieces::desk, (area / 7.0).min(6.0)),
            (pieces::cabinet, (area / 5.0).min(7.0)),
            (pieces::bookshelf, 0.4),
            (pieces::clutter, area / 6.0),
        ],
        Usage::OpenPlan => vec![(pieces::cabinet, area / 14.0), (pieces::desk, area / 16.0)],
        Usage::Meeting => vec![(pieces::cabinet, area / 25.0)],
        Usage::Laboratory => vec![(pieces::bench, area / 9.0), (pieces::cabinet, area / 10.0)],
        Usage::Storage => vec![(pieces::bookshelf, area / 3.0), (pieces::clutter, area / 3.0)],
        Usage::Toilet => vec![(pieces::stall, area / 3.0), (pieces::basin, area / 5.0)],
        Usage::Kitchen => vec![(pieces::counter, 2.5), (pieces::cabinet, 1.0)],
        Usage::Bedroom => vec![
            (pieces::bed, 1.0 + area / 30.0),
            (pieces::wardrobe, 1.2),
            (pieces::cabinet, 1.3),
            (pieces::desk, 0.6),
        ],
        Usage::Living => vec![
            (pieces::sofa, 1.0 + area / 30.0),
            (pieces::cabinet, 1.5 + area / 15.0),
            (pieces::bookshelf, 0.7),
        ],
        Usage::Bath => vec![(pieces::toilet, 1.2), (pieces::basin, 1.0), (pieces::tub, 0.9)],
        Usage::Ward => vec![
            (pieces::hospital_bed, (area / 10.0).max(1.0)),
            (pieces::cabinet, 1.5),
            (pieces::chair, area / 12.0),
        ],
        Usage::Classroom => vec![(pieces::cabinet, 2.5)],
        Usage::Hall => vec![(pieces::corridor_item, area / 12.0)],
        Usage::Lobby => vec![(pieces::corridor_item, area / 30.0)],
        Usage::Stairs => Vec::new(),
        Usage::Warehouse => vec![(pieces::pallet, area / 40.0)],
    }
}

/// What stands free on the floor.
fn furnish_middle(room: &mut Room, usage: Usage, dice: &mut Dice) {
    let (draw, aisle_m): (Draw, f64) = match usage {
        Usage::Meeting | Usage::Living => return table_in_the_middle(room, dice),
        Usage::Kitchen if room.floor.area() > 9.0 => return table_in_the_middle(room, dice),
        Usage::OpenPlan if dice.chance(0.5) => (pieces::cubicles, 0.9),
        Usage::OpenPlan => (pieces::desk_island, dice.pick(&[1.2, 2.0])),
        Usage::Laboratory => (pieces::bench, 1.3),
        Usage::Classroom => (pieces::school_desk, 0.55),
        Usage::Hall if dice.chance(0.5) => (pieces::cafe_table, 1.5),
        Usage::Warehouse => (pieces::rack, 2.4),
        _ => return,
    };
    grid(room, draw, aisle_m, dice);
}

/// Equal pieces in rows and columns with aisles of `aisle_m` between them.
fn grid(room: &mut Room, draw: Draw, aisle_m: f64, dice: &mut Dice) {
    let model = draw(dice);
    let is_turned = dice.chance(0.5);
    let (w, d) = if is_turned { (model.depth_m, model.width_m) } else { (model.width_m, model.depth_m) };
    let (step_x, step_y) = (w + aisle_m * dice.between(0.6, 1.3), d + aisle_m * dice.between(0.9, 1.4));
    let Rect { min, max } = room.floor.grown(-0.5 * aisle_m.min(1.2));
    let (mut y, missing) = (min.y, dice.between(0.0, 0.3));
    while y + d < max.y {
        let mut x = min.x;
        while x + w < max.x {
            if !dice.chance(missing) {
                // A piece stands with the middle of its back at its origin.
                let at =
                    if is_turned { Point2::new(x + w, y + 0.5 * d) } else { Point2::new(x + 0.5 * w, y) };
                room.place_in_line(&model, at, is_turned, dice);
            }
            x += step_x;
        }
        y += step_y;
    }
}

/// One table with chairs around it.
fn table_in_the_middle(room: &mut Room, dice: &mut Dice) {
    let is_turned = room.floor.height() > room.floor.width();
    let (long, short) = if is_turned {
        (room.floor.height(), room.floor.width())
    } else {
        (room.floor.width(), room.floor.height())
    };
    let piece = pieces::table((long - 2.6).clamp(0.9, 5.0), (short - 2.6).clamp(0.7, 1.5), dice);
    let center = room.floor.center() + Vec2::new(dice.normal() * 0.2, dice.normal() * 0.2);
    let back = 0.5 * piece.depth_m;
    let at = if is_turned { center + Vec2::new(back, 0.0) } else { center - Vec2::new(0.0, back) };
    room.place_in_line(&piece, at, is_turned, dice);
}
