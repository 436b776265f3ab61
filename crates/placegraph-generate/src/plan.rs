//! The floor plan: what there is, before anybody maps it. Everything is in meters of the plan frame.

use crate::shape::{Axis, Rect, Solid, across};

/// What a space is used for; decides its furniture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Usage {
    /// One moves on.
    Corridor,
    /// One to four desks.
    Office,
    /// Many desks, with or without partitions.
    OpenPlan,
    /// One booth of a bank of cubicles.
    Cubicle,
    /// A large table.
    Meeting,
    /// Benches and cabinets.
    Laboratory,
    /// Shelves and boxes.
    Storage,
    /// Stalls and basins.
    Toilet,
    /// A counter along the walls.
    Kitchen,
    /// A bed and a wardrobe.
    Bedroom,
    /// Sofa and table.
    Living,
    /// Basin, toilet, shower.
    Bath,
    /// Beds side by side.
    Ward,
    /// Rows of desks.
    Classroom,
    /// A wide room with few things in it.
    Hall,
    /// Racks with aisles.
    Warehouse,
}

/// A room or a corridor.
#[derive(Clone, Debug, PartialEq)]
pub struct Space {
    /// What it is used for; a corridor is of class corridor, everything else a room.
    pub usage: Usage,
}

impl Space {
    /// Whether the space is of class corridor.
    pub fn is_corridor(&self) -> bool {
        self.usage == Usage::Corridor
    }
}

/// A rectangular part of a space.
#[derive(Clone, Debug, PartialEq)]
pub struct Tile {
    /// Index of its space.
    pub space: usize,
    /// Up to the middle of the walls.
    pub outer: Rect,
    /// Up to the faces of the walls.
    pub inner: Rect,
}

/// What an opening is, for the labels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OpeningKind {
    /// A doorway, with or without a leaf.
    Doorway,
    /// Too wide or too much part of its spaces to be a doorway: its cells are ambiguous.
    Passage,
}

/// An opening in the wall between two spaces.
#[derive(Clone, Debug, PartialEq)]
pub struct Opening {
    /// Indices of the two spaces, first the one at the lower coordinates.
    pub spaces: [usize; 2],
    /// What it is.
    pub kind: OpeningKind,
    /// Direction of the wall.
    pub wall: Axis,
    /// From jamb to jamb and from wall face to wall face.
    pub gap: Rect,
    /// The door's leaves where they stand.
    pub leaves: Vec<Solid>,
    /// A closed door keeps its leaf in the gap; nobody passes.
    pub closed: bool,
}

impl Opening {
    /// How far a doorway reaches into the spaces beyond the faces of the wall, in meters.
    pub const REACH_M: f64 = 0.25;

    /// Clear width in meters.
    pub fn width_m(&self) -> f64 {
        let (lo, hi) = self.gap.span(self.wall);
        hi - lo
    }

    /// The doorway as it is labeled: the gap and [`Opening::REACH_M`] on either side of the wall.
    pub fn strip(&self) -> Rect {
        let (from, to) = self.gap.span(across(self.wall));
        Rect::along(self.wall, self.gap.span(self.wall), (from - Self::REACH_M, to + Self::REACH_M))
    }
}

/// A floor plan.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan {
    /// Rooms and corridors.
    pub spaces: Vec<Space>,
    /// The parts of the spaces; walls stand where two tiles of different spaces meet.
    pub tiles: Vec<Tile>,
    /// Thickness of the walls to the outside.
    pub outer_wall_m: f64,
    /// Doors and passages.
    pub openings: Vec<Opening>,
    /// Rectangles where a wall is replaced by a pane of glass.
    pub panes: Vec<Rect>,
    /// Pillars, stubs of walls, cut corners and door frames.
    pub fixtures: Vec<Solid>,
    /// Everything that is not part of the building.
    pub furniture: Vec<Solid>,
}

/// A stretch of wall that two tiles share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contact {
    pub(crate) tiles: [usize; 2],
    pub(crate) wall: Axis,
    /// Where both tiles have floor, along the wall.
    pub(crate) along: (f64, f64),
    /// From the face in the first tile to the face in the second, in ascending order.
    pub(crate) across: (f64, f64),
}

impl Plan {
    /// The rectangle around all tiles and outer walls.
    pub fn bounds(&self) -> Rect {
        let all = self.tiles.iter().map(|tile| tile.outer).reduce(|a, b| {
            Rect::new(a.min.x.min(b.min.x), a.min.y.min(b.min.y), a.max.x.max(b.max.x), a.max.y.max(b.max.y))
        });
        all.unwrap_or(Rect::new(0.0, 0.0, 1.0, 1.0)).grown(self.outer_wall_m)
    }

    /// All stretches of wall (or of open floor, within one space) between two tiles, in the order of tiles.
    pub(crate) fn contacts(&self) -> Vec<Contact> {
        let mut contacts = Vec::new();
        for (first, a) in self.tiles.iter().enumerate() {
            for (second, b) in self.tiles.iter().enumerate().skip(first + 1) {
                contacts.extend([Axis::X, Axis::Y].into_iter().filter_map(|wall| {
                    let (along, across) = contact(a, b, wall)?;
                    Some(Contact { tiles: [first, second], wall, along, across })
                }));
            }
        }
        contacts
    }

    /// Keeps the spaces marked in `keep` with their tiles and openings, and renumbers them.
    pub(crate) fn retain_spaces(&mut self, keep: &[bool]) {
        let mut next = 0;
        let number: Vec<usize> = keep
            .iter()
            .map(|&kept| {
                next += usize::from(kept);
                next.wrapping_sub(1)
            })
            .collect();
        let mut index = 0;
        self.spaces.retain(|_| {
            index += 1;
            keep[index - 1]
        });
        self.tiles.retain(|tile| keep[tile.space]);
        self.tiles.iter_mut().for_each(|tile| tile.space = number[tile.space]);
        self.openings.retain(|opening| opening.spaces.iter().all(|&space| keep[space]));
        self.openings
            .iter_mut()
            .for_each(|opening| opening.spaces = opening.spaces.map(|space| number[space]));
    }
}

/// Where tiles `a` and `b` touch in a wall that runs along `wall`: along and across it.
fn contact(a: &Tile, b: &Tile, wall: Axis) -> Option<((f64, f64), (f64, f64))> {
    let touching =
        |from: &Rect, to: &Rect| (from.span(across(wall)).1 - to.span(across(wall)).0).abs() < 1e-6;
    let (below, above) = if touching(&a.outer, &b.outer) {
        (a, b)
    } else if touching(&b.outer, &a.outer) {
        (b, a)
    } else {
        return None;
    };
    let (a_span, b_span) = (a.inner.span(wall), b.inner.span(wall));
    let along = (a_span.0.max(b_span.0), a_span.1.min(b_span.1));
    let faces = (below.inner.span(across(wall)).1, above.inner.span(across(wall)).0);
    (along.1 > along.0).then_some((along, faces))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tile(space: usize, outer: Rect, inner: Rect) -> Tile {
        Tile { space, outer, inner }
    }

    #[test]
    fn a_contact_runs_where_both_tiles_have_floor() {
        let plan = Plan {
            tiles: vec![
                tile(0, Rect::new(0.0, 0.0, 4.0, 3.0), Rect::new(0.0, 0.0, 4.0, 2.9)),
                tile(1, Rect::new(1.0, 3.0, 6.0, 5.0), Rect::new(1.2, 3.05, 6.0, 5.0)),
            ],
            ..Plan::default()
        };
        let contacts = plan.contacts();
        assert_eq!(contacts.len(), 1);
        assert_eq!(contacts[0].wall, Axis::X);
        assert_eq!((contacts[0].along, contacts[0].across), ((1.2, 4.0), (2.9, 3.05)));
    }

    #[test]
    fn a_doorway_reaches_a_quarter_meter_beyond_both_faces() {
        let opening = Opening {
            spaces: [0, 1],
            kind: OpeningKind::Doorway,
            wall: Axis::Y,
            gap: Rect::new(5.0, 1.0, 5.2, 1.9),
            leaves: Vec::new(),
            closed: false,
        };
        assert!((opening.width_m() - 0.9).abs() < 1e-12);
        assert_eq!(opening.strip(), Rect::new(4.75, 1.0, 5.45, 1.9));
    }

    #[test]
    fn spaces_that_go_leave_no_gap_in_the_numbers() {
        let space = |usage| Space { usage };
        let here = Rect::new(0.0, 0.0, 1.0, 1.0);
        let mut plan = Plan {
            spaces: vec![space(Usage::Office), space(Usage::Bath), space(Usage::Corridor)],
            tiles: vec![tile(0, here, here), tile(1, here, here), tile(2, here, here)],
            ..Plan::default()
        };
        plan.retain_spaces(&[false, true, true]);
        assert_eq!(plan.spaces, [space(Usage::Bath), space(Usage::Corridor)]);
        assert_eq!(plan.tiles.iter().map(|tile| tile.space).collect::<Vec<_>>(), [0, 1]);
    }
}
