//! Pieces of furniture as a laser sees them a few decimeters above the floor: legs, pedestals, fronts.
//!
//! A piece stands with the middle of its back at (0, 0), its width along x and its depth along +y.

use crate::dice::Dice;
use crate::shape::{Rect, Solid, Stand};

/// A part of a piece, in the piece's own frame.
#[derive(Clone, Debug)]
pub(super) enum Part {
    Block(Rect),
    Post { x: f64, y: f64, radius_m: f64 },
}

impl Part {
    /// The part where the piece stands.
    pub(super) fn placed(&self, stand: &Stand) -> Solid {
        match *self {
            Self::Block(rect) => stand.rect(rect),
            Self::Post { x, y, radius_m } => stand.disc(x, y, radius_m),
        }
    }
}

/// A piece of furniture and the floor that it needs, in meters.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub(super) width_m: f64,
    pub(super) depth_m: f64,
    pub(super) parts: Vec<Part>,
}

/// A closed box.
fn closed(width_m: f64, depth_m: f64) -> Piece {
    let parts = vec![Part::Block(Rect::new(-0.5 * width_m, 0.0, 0.5 * width_m, depth_m))];
    Piece { width_m, depth_m, parts }
}

/// Four legs at the corners of a rectangle.
fn legs(rect: &Rect, radius_m: f64) -> impl Iterator<Item = Part> {
    rect.grown(-radius_m).corners().into_iter().map(move |corner| Part::Post {
        x: corner.x,
        y: corner.y,
        radius_m,
    })
}

/// The legs of a chair around (`x`, `y`).
fn chair_at(x: f64, y: f64, dice: &mut Dice) -> Vec<Part> {
    let (x, y) = (x + 0.06 * dice.normal(), y + 0.06 * dice.normal());
    if dice.chance(0.5) {
        return legs(&Rect::new(x - 0.22, y - 0.22, x + 0.22, y + 0.22), 0.02).collect();
    }
    // An office chair: the column, and the castors if the laser is low.
    let mut parts = vec![Part::Post { x, y, radius_m: 0.04 }];
    if dice.chance(0.5) {
        parts.extend((0..5).map(|k| {
            let arm = crate::shape::heading(f64::from(k) * std::f64::consts::TAU / 5.0);
            Part::Post { x: x + 0.27 * arm.x, y: y + 0.27 * arm.y, radius_m: 0.025 }
        }));
    }
    parts
}

pub(super) fn chair(dice: &mut Dice) -> Piece {
    Piece { width_m: 0.55, depth_m: 0.6, parts: chair_at(0.0, 0.3, dice) }
}

/// A desk on legs or panels, often with a pedestal and a chair.
pub(super) fn desk(dice: &mut Dice) -> Piece {
    let (w, d) = (dice.between(1.2, 1.9), dice.between(0.65, 0.9));
    let top = Rect::new(-0.5 * w, 0.0, 0.5 * w, d);
    let mut parts: Vec<Part> = if dice.chance(0.6) {
        legs(&top, 0.03).collect()
    } else {
        vec![
            Part::Block(Rect::new(-0.5 * w, 0.0, -0.5 * w + 0.04, d)),
            Part::Block(Rect::new(0.5 * w - 0.04, 0.0, 0.5 * w, d)),
        ]
    };
    if dice.chance(0.6) {
        let x = if dice.chance(0.5) { -0.5 * w + 0.05 } else { 0.5 * w - 0.47 };
        parts.push(Part::Block(Rect::new(x, 0.1, x + 0.42, 0.65)));
    }
    if dice.chance(0.25) {
        parts.push(Part::Block(Rect::new(-0.1, 0.1, 0.1, 0.55)));
    }
    if dice.chance(0.8) {
        let x = dice.between(-0.2, 0.2);
        parts.extend(chair_at(x, d + 0.2, dice));
    }
    Piece { width_m: w, depth_m: d + 0.55, parts }
}

/// Two rows of desks face to face.
pub(super) fn desk_island(dice: &mut Dice) -> Piece {
    let (n, w, d) = (dice.count(1, 4), dice.between(1.4, 1.8), dice.between(0.7, 0.85));
    let width_m = n as f64 * w;
    let mut parts = Vec::new();
    for k in 0..n {
        let x = -0.5 * width_m + k as f64 * w;
        for y in [0.7, 0.7 + d] {
            parts.extend(legs(&Rect::new(x, y, x + w, y + d), 0.03));
            if dice.chance(0.5) {
                parts.push(Part::Block(Rect::new(x + 0.1, y + 0.1, x + 0.5, y + 0.6)));
            }
        }
        parts.extend(chair_at(x + 0.5 * w, 0.4, dice));
        parts.extend(chair_at(x + 0.5 * w, 1.0 + 2.0 * d, dice));
    }
    Piece { width_m, depth_m: 2.0 * d + 1.4, parts }
}

/// Two rows of booths back to back, as partitions.
pub(super) fn cubicles(dice: &mut Dice) -> Piece {
    let (n, w, d) = (dice.count(1, 4), dice.between(1.8, 2.6), dice.between(1.7, 2.4));
    let (width_m, half) = (n as f64 * w, 0.03);
    let entry = dice.between(0.0, 0.6);
    let mut parts = vec![Part::Block(Rect::new(-0.5 * width_m, d - half, 0.5 * width_m, d + half))];
    for k in 0..=n {
        let x = -0.5 * width_m + k as f64 * w;
        parts.push(Part::Block(Rect::new(x - half, 0.0, x + half, 2.0 * d)));
        if k == n {
            break;
        }
        for (front, inward) in [(0.0, 1.0), (2.0 * d, -1.0)] {
            let (from, to) = (front - half * inward, front + half * inward);
            parts.push(Part::Block(Rect::new(x, from.min(to), x + entry * w, from.max(to))));
            let desk = front + inward * (d - 0.75);
            parts.push(Part::Block(Rect::new(
                x + 0.1,
                desk.min(desk + 0.6 * inward),
                x + 0.5,
                desk.max(desk + 0.6 * inward),
            )));
            parts.extend(chair_at(x + 0.6 * w, front + inward * (d - 1.0), dice));
        }
    }
    Piece { width_m: width_m + 2.0 * half, depth_m: 2.0 * d, parts }
}

/// A table of the given top with chairs around it.
pub(super) fn table(w: f64, d: f64, dice: &mut Dice) -> Piece {
    let edge = 0.55;
    let mut parts: Vec<Part> = Vec::new();
    if dice.chance(0.12) {
        parts.push(Part::Block(Rect::new(-0.3 * w, edge + 0.3 * d, 0.3 * w, edge + 0.7 * d)));
    } else {
        let n = (w / 1.6).ceil();
        for k in 0..n as usize {
            let x = -0.5 * w + w * k as f64 / n;
            parts.extend(legs(&Rect::new(x, edge, x + w / n, edge + d), 0.03));
        }
    }
    let taken = dice.between(0.5, 1.0);
    for k in 0..(w / 0.7) as usize {
        let x = -0.5 * w + 0.35 + 0.7 * k as f64;
        for y in [edge - 0.15, edge + d + 0.15] {
            if dice.chance(taken) {
                parts.extend(chair_at(x, y, dice));
            }
        }
    }
    Piece { width_m: w + 0.5, depth_m: d + 2.0 * edge, parts }
}

/// Four chairs at a small table.
pub(super) fn cafe_table(dice: &mut Dice) -> Piece {
    let side = dice.between(0.7, 1.0);
    table(side + 0.4, side, dice)
}

pub(super) fn school_desk(dice: &mut Dice) -> Piece {
    let w = dice.pick(&[0.7, 1.3]);
    let mut parts: Vec<Part> = legs(&Rect::new(-0.5 * w, 0.5, 0.5 * w, 1.0), 0.02).collect();
    for k in 0..if w > 1.0 { 2 } else { 1 } {
        let x = if w > 1.0 { -0.32 + 0.64 * f64::from(k) } else { 0.0 };
        parts.extend(legs(&Rect::new(x - 0.19, 0.05, x + 0.19, 0.43), 0.02));
    }
    Piece { width_m: w, depth_m: 1.0, parts }
}

pub(super) fn cabinet(dice: &mut Dice) -> Piece {
    closed(dice.between(0.4, 1.3), dice.between(0.35, 0.6))
}

pub(super) fn bookshelf(dice: &mut Dice) -> Piece {
    closed(dice.between(0.8, 3.2), dice.between(0.28, 0.45))
}

pub(super) fn wardrobe(dice: &mut Dice) -> Piece {
    closed(dice.between(1.0, 2.4), dice.between(0.55, 0.65))
}

pub(super) fn counter(dice: &mut Dice) -> Piece {
    closed(dice.between(1.2, 3.0), 0.6)
}

pub(super) fn basin(dice: &mut Dice) -> Piece {
    closed(dice.between(0.4, 0.7), dice.between(0.35, 0.5))
}

pub(super) fn tub(dice: &mut Dice) -> Piece {
    if dice.chance(0.5) { closed(dice.between(1.4, 1.7), 0.7) } else { closed(0.85, 0.85) }
}

pub(super) fn toilet(_: &mut Dice) -> Piece {
    let parts =
        vec![Part::Block(Rect::new(-0.2, 0.0, 0.2, 0.2)), Part::Post { x: 0.0, y: 0.4, radius_m: 0.18 }];
    Piece { width_m: 0.7, depth_m: 0.65, parts }
}

/// A toilet between two partitions.
pub(super) fn stall(dice: &mut Dice) -> Piece {
    let (w, d) = (dice.between(0.85, 1.1), dice.between(1.3, 1.6));
    let mut parts = toilet(dice).parts;
    parts.push(Part::Block(Rect::new(-0.5 * w, 0.0, -0.5 * w + 0.03, d)));
    parts.push(Part::Block(Rect::new(0.5 * w - 0.03, 0.0, 0.5 * w, d)));
    if dice.chance(0.3) {
        parts.push(Part::Block(Rect::new(-0.5 * w, d - 0.03, 0.5 * w, d)));
    }
    Piece { width_m: w, depth_m: d, parts }
}

/// A bed with its head at the wall; some stand on legs.
pub(super) fn bed(dice: &mut Dice) -> Piece {
    let (w, d) = (dice.pick(&[0.9, 1.0, 1.4, 1.6, 1.8]), 2.05);
    let mut piece = closed(w, d);
    if dice.chance(0.4) {
        piece.parts = legs(&Rect::new(-0.5 * w, 0.0, 0.5 * w, d), 0.035).collect();
    }
    if dice.chance(0.6) {
        piece.parts.push(Part::Block(Rect::new(0.5 * w + 0.05, 0.0, 0.5 * w + 0.5, 0.4)));
        piece.width_m += 1.0;
    }
    piece
}

/// A bed on castors with room on both sides.
pub(super) fn hospital_bed(dice: &mut Dice) -> Piece {
    let frame = Rect::new(-0.5, 0.1, 0.5, 2.2);
    let mut parts: Vec<Part> = legs(&frame, 0.05).collect();
    if dice.chance(0.6) {
        parts.push(Part::Block(Rect::new(-0.35, 0.5, 0.35, 1.7)));
    }
    parts.push(Part::Block(Rect::new(0.65, 0.0, 1.1, 0.5)));
    Piece { width_m: 2.2, depth_m: 2.25, parts }
}

pub(super) fn sofa(dice: &mut Dice) -> Piece {
    closed(dice.between(0.8, 2.5), dice.between(0.8, 1.0))
}

/// A work bench, closed or on legs.
pub(super) fn bench(dice: &mut Dice) -> Piece {
    let (w, d) = (dice.between(1.5, 3.6), dice.between(0.7, 1.5));
    let mut piece = closed(w, d);
    if dice.chance(0.5) {
        let n = (w / 1.2).ceil();
        piece.parts.clear();
        for k in 0..n as usize {
            let x = -0.5 * w + w * k as f64 / n;
            piece.parts.extend(legs(&Rect::new(x, 0.0, x + w / n, d), 0.03));
        }
    }
    if dice.chance(0.6) {
        let x = dice.between(-0.3, 0.3) * w;
        piece.parts.extend(chair_at(x, d + 0.25, dice));
    }
    piece.depth_m += 0.4;
    piece
}

/// A rack for pallets: uprights, mostly with goods on the lowest level.
pub(super) fn rack(dice: &mut Dice) -> Piece {
    let (n, bay, d) = (dice.count(2, 6), dice.between(1.8, 2.8), dice.between(0.8, 1.2));
    let width_m = n as f64 * bay;
    let mut parts = Vec::new();
    for k in 0..n {
        let x = -0.5 * width_m + k as f64 * bay;
        parts.extend(legs(&Rect::new(x, 0.0, x + bay, d), 0.05));
        if dice.chance(0.7) {
            let (from, to) = (dice.between(0.08, 0.6), dice.between(0.08, 0.6));
            parts.push(Part::Block(Rect::new(x + from, 0.05, x + bay - to, d - dice.between(0.02, 0.2))));
        }
    }
    Piece { width_m, depth_m: d, parts }
}

pub(super) fn pallet(dice: &mut Dice) -> Piece {
    closed(dice.between(0.8, 1.2), dice.between(0.8, 1.2))
}

/// What stands in corridors: a bin, a plant, a copier, a bench, a locker.
pub(super) fn corridor_item(dice: &mut Dice) -> Piece {
    match dice.below(5) {
        0 => {
            let radius_m = dice.between(0.14, 0.25);
            let parts = vec![Part::Post { x: 0.0, y: radius_m, radius_m }];
            Piece { width_m: 2.0 * radius_m, depth_m: 2.0 * radius_m, parts }
        }
        1 => closed(dice.between(0.5, 1.1), dice.between(0.45, 0.65)),
        2 => Piece {
            width_m: 1.5,
            depth_m: 0.45,
            parts: legs(&Rect::new(-0.75, 0.02, 0.75, 0.42), 0.025).collect(),
        },
        3 => closed(dice.between(0.8, 2.4), dice.between(0.3, 0.5)),
        _ => closed(dice.between(0.25, 0.4), dice.between(0.25, 0.4)),
    }
}

/// A thing left somewhere: a box, a bag, a bin, a chair.
pub(super) fn clutter(dice: &mut Dice) -> Piece {
    match dice.below(3) {
        0 => chair(dice),
        1 => closed(dice.between(0.15, 0.6), dice.between(0.15, 0.5)),
        _ => {
            let radius_m = dice.between(0.03, 0.2);
            Piece {
                width_m: 2.0 * radius_m,
                depth_m: 2.0 * radius_m,
                parts: vec![Part::Post { x: 0.0, y: radius_m, radius_m }],
            }
        }
    }
}
