//! The floor plan: what there is, before anybody maps it. Everything is in meters of the plan frame.

use placegraph::geom::{Point2, Vec2};

use crate::floor::Floor;
use crate::shape::{Axis, Rect, Solid, Stand, across};

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
    /// A lobby or an open area that people call neither corridor nor room.
    Lobby,
    /// Stairs and elevators.
    Stairs,
}

/// What a space is for the labels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpaceClass {
    /// One moves on.
    Corridor,
    /// One stays.
    Room,
    /// Neither, or it is not known which.
    Ambiguous,
}

impl SpaceClass {
    /// Name for people and files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Corridor => "corridor",
            Self::Room => "room",
            Self::Ambiguous => "ambiguous",
        }
    }
}

/// A room or a corridor.
#[derive(Clone, Debug, PartialEq)]
pub struct Space {
    /// What it is used for.
    pub usage: Usage,
}

impl Space {
    /// Whether the space is of class corridor.
    pub fn is_corridor(&self) -> bool {
        self.usage == Usage::Corridor
    }

    /// What it is for the labels.
    pub fn class(&self) -> SpaceClass {
        match self.usage {
            Usage::Corridor => SpaceClass::Corridor,
            Usage::Lobby | Usage::Stairs => SpaceClass::Ambiguous,
            _ => SpaceClass::Room,
        }
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
    /// Direction of the wall in the opening's frame.
    pub wall: Axis,
    /// From jamb to jamb and from wall face to wall face, in the opening's frame.
    pub gap: Rect,
    /// Direction of the x axis of the opening's frame, which is turned about the middle of `gap`: [`STRAIGHT`] where
    /// walls run along the axes of the plan.
    pub turn: Vec2,
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

    /// Extent of the gap through the wall, in meters.
    pub fn depth_m(&self) -> f64 {
        let (from, to) = self.gap.span(across(self.wall));
        to - from
    }

    /// The middle of the gap's left and of its right end, along the wall, in the plan.
    pub fn line(&self) -> [Point2; 2] {
        let ((lo, hi), (from, to)) = (self.gap.span(self.wall), self.gap.span(across(self.wall)));
        let middle = from.midpoint(to);
        [lo, hi].map(|at| match self.wall {
            Axis::X => self.in_plan(Point2::new(at, middle)),
            Axis::Y => self.in_plan(Point2::new(middle, at)),
        })
    }

    /// Takes a point of the opening's frame to the plan.
    pub(crate) fn in_plan(&self, point: Point2) -> Point2 {
        if self.turn == STRAIGHT {
            return point;
        }
        let center = self.gap.center();
        let offset = point - center;
        Stand { at: center, forward: self.turn }.point(offset.x, offset.y)
    }

    /// Takes a point of the plan to the opening's frame.
    pub(crate) fn in_frame(&self, point: Point2) -> Point2 {
        if self.turn == STRAIGHT {
            return point;
        }
        let center = self.gap.center();
        let offset = point - center;
        center + Vec2::new(offset.dot(self.turn), self.turn.cross(offset))
    }

    /// A solid of the opening's frame, in the plan.
    pub(crate) fn put_in_plan(&self, solid: Solid) -> Solid {
        match solid {
            Solid::Convex(corners) => {
                Solid::Convex(corners.into_iter().map(|corner| self.in_plan(corner)).collect())
            }
            Solid::Disc { center, radius_m } => Solid::Disc { center: self.in_plan(center), radius_m },
        }
    }

    /// A rectangle of the opening's frame, in the plan.
    pub(crate) fn solid(&self, rect: Rect) -> Solid {
        self.put_in_plan(Solid::rect(rect))
    }
}

/// The turn of an opening in a wall that runs along an axis of the plan.
pub const STRAIGHT: Vec2 = Vec2::new(1.0, 0.0);

/// A floor plan.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan {
    /// Rooms and corridors.
    pub spaces: Vec<Space>,
    /// The parts of the spaces; walls stand where two tiles of different spaces meet. Of a surveyed building, the
    /// rectangles that are furnished.
    pub tiles: Vec<Tile>,
    /// Spaces and walls of a surveyed building; else both follow from `tiles`.
    pub floor: Option<Floor>,
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
        if let Some(floor) = &self.floor {
            return floor.bounds();
        }
        let all = self.tiles.iter().map(|tile| tile.outer).reduce(|a, b| {
            Rect::new(a.min.x.min(b.min.x), a.min.y.min(b.min.y), a.max.x.max(b.max.x), a.max.y.max(b.max.y))
        });
        all.unwrap_or(Rect::new(0.0, 0.0, 1.0, 1.0)).grown(self.outer_wall_m)
    }

    /// Area of all spaces that are not ambiguous, in square meters.
    pub(crate) fn floor_m2(&self) -> f64 {
        match &self.floor {
            Some(floor) => floor.area_m2(|space| self.spaces[space].class() != SpaceClass::Ambiguous),
            None => self.tiles.iter().map(|tile| tile.inner.area()).sum(),
        }
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
            turn: STRAIGHT,
            leaves: Vec::new(),
            closed: false,
        };
        assert!((opening.width_m() - 0.9).abs() < 1e-12);
        assert_eq!(opening.strip(), Rect::new(4.75, 1.0, 5.45, 1.9));
    }

    #[test]
    fn a_turned_doorway_lies_along_its_wall() {
        let opening = Opening {
            spaces: [0, 1],
            kind: OpeningKind::Doorway,
            wall: Axis::X,
            gap: Rect::new(1.0, 2.0, 3.0, 2.2),
            turn: Vec2::new(0.6, 0.8),
            leaves: Vec::new(),
            closed: false,
        };
        // The middle (2, 2.1), and a meter from it along (0.6, 0.8).
        let [a, b] = opening.line();
        assert!(a.distance(Point2::new(1.4, 1.3)) < 1e-12 && b.distance(Point2::new(2.6, 2.9)) < 1e-12);
        assert!(opening.in_frame(b).distance(Point2::new(3.0, 2.1)) < 1e-12);
        let gap = opening.solid(opening.gap);
        assert!(gap.contains(Point2::new(2.54, 2.82)) && !gap.contains(Point2::new(2.9, 2.1)));
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
