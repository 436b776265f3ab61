//! From a survey to a floor plan: walls get a thickness, doors a width, a depth and leaves.

use placegraph::geom::{Point2, Vec2};

use super::{Outline, Survey, SurveyError, SurveyedDoor};
use crate::dice::Dice;
use crate::floor::{FINE_M, Floor, Ground};
use crate::layout::{hang_leaves, middle_of};
use crate::plan::{Opening, OpeningKind, Plan, Space, Tile, Usage};
use crate::shape::{Axis, Rect, Solid};

/// How far from a door's middle its wall is looked for, and how thick that may be, in meters.
const DEEPEST_M: f64 = 0.9;
/// The narrowest door that is kept.
const NARROWEST_M: f64 = 0.55;
/// A wider door is a passage.
const WIDEST_DOORWAY_M: f64 = 2.6;
/// Without a door, two spaces are open to each other along all of a shared wall up to this long.
const WHOLE_M: f64 = 4.0;
/// How far beside its wall a door may be drawn.
const MISDRAWN_M: f64 = 0.12;
/// Distance of the points at which a wall is probed along its length.
const PROBE_M: f64 = 0.05;

/// How the doors of one building are.
struct Doors {
    single_m: f64,
    double_m: f64,
    /// Share of doors without a leaf.
    bare: f64,
    closed: f64,
    ajar: f64,
}

/// The floor plan of `survey`.
///
/// # Errors
/// If fewer than two spaces are connected.
pub(crate) fn lay_out(survey: &Survey, dice: &mut Dice) -> Result<Plan, SurveyError> {
    let wall_m = if survey.is_home { dice.between(0.08, 0.18) } else { dice.between(0.1, 0.3) };
    let outer_wall_m = dice.between(0.15, 0.4);
    let doors = Doors {
        single_m: if survey.is_home { dice.between(0.68, 0.85) } else { dice.between(0.8, 1.05) },
        double_m: dice.between(1.35, 1.9),
        bare: dice.pick(&[0.1, 0.5, 1.0]),
        closed: dice.pick(&[0.0, 0.0, 0.08, 0.2]),
        ajar: dice.pick(&[0.0, 0.1, 0.3]),
    };
    let (mut floor, mut usages) = draw(survey, wall_m, outer_wall_m)?;
    // Where a space of no use lies, nobody enters.
    let mut plan = Plan { outer_wall_m, ..Plan::default() };
    for door in &survey.doors {
        if let Some(opening) = place(door, &floor, &usages, &doors, dice) {
            let strip = opening.solid(opening.strip()).bounds();
            let is_clear = |other: &Opening| !other.solid(other.strip()).bounds().overlaps(&strip);
            if plan.openings.iter().all(is_clear) {
                plan.openings.push(opening);
            }
        }
    }
    keep_connected(&mut plan, &mut floor, &mut usages)?;
    plan.spaces = usages.iter().flatten().map(|&usage| Space { usage }).collect();
    for (space, rect) in floor.largest_rectangles(plan.spaces.len()).into_iter().enumerate() {
        plan.tiles.extend(rect.map(|rect| Tile { space, outer: rect, inner: rect }));
    }
    let is_inside = |rect: &&Rect| matches!(floor.at(rect.center()), Ground::Space(_));
    let stands_free = |rect: &&Rect| {
        !plan.openings.iter().any(|opening| opening.solid(opening.strip()).bounds().overlaps(rect))
    };
    plan.furniture = survey
        .furniture
        .iter()
        .filter(is_inside)
        .filter(stands_free)
        .map(|rect| Solid::rect(*rect))
        .collect();
    plan.floor = Some(floor);
    Ok(plan)
}

/// Spaces and walls, and what the spaces are used for; `None` for those that nobody enters.
fn draw(survey: &Survey, wall_m: f64, outer_wall_m: f64) -> Result<(Floor, Vec<Option<Usage>>), SurveyError> {
    let polygons = || {
        survey.spaces.iter().filter_map(|space| match &space.outline {
            Outline::Polygon(points) => Some(points),
            Outline::Around(_) => None,
        })
    };
    let points = polygons().flatten().chain(survey.walls.iter().flatten());
    let far = points.fold(Point2::new(0.0, 0.0), |far, p| Point2::new(far.x.max(p.x), far.y.max(p.y)));
    let bounds =
        Rect { min: Point2::new(0.0, 0.0), max: far }.grown(outer_wall_m + 0.5 * wall_m + 2.0 * FINE_M);
    let too_large = || SurveyError::Scale { found: format!("{} m x {} m", bounds.width(), bounds.height()) };
    let mut floor = Floor::over(&bounds).ok_or_else(too_large)?;

    let mut usages: Vec<Option<Usage>> = survey.spaces.iter().map(|space| space.usage).collect();
    for (space, surveyed) in survey.spaces.iter().enumerate() {
        if let Outline::Polygon(points) = &surveyed.outline {
            floor.fill(points, space);
        }
    }
    for points in polygons() {
        for (&a, &b) in points.iter().zip(points.iter().cycle().skip(1)) {
            floor.wall(a, b, wall_m);
        }
    }
    for &[a, b] in &survey.walls {
        floor.wall(a, b, wall_m);
    }
    for (space, surveyed) in survey.spaces.iter().enumerate() {
        if let Outline::Around(seed) = surveyed.outline {
            match floor.flood(seed, space) {
                Ground::Space(found) if found != space => {
                    usages[found] = joint_usage(usages[found], surveyed.usage);
                    usages[space] = None;
                }
                Ground::Space(_) => {}
                Ground::Outside | Ground::Wall => usages[space] = None,
            }
        }
    }
    floor.enclose(outer_wall_m);
    Ok((floor, usages))
}

/// What a space is used for that is two: neither corridor nor room if it is both.
fn joint_usage(first: Option<Usage>, second: Option<Usage>) -> Option<Usage> {
    let (Some(first), Some(second)) = (first, second) else { return first.or(second) };
    let class = |usage| Space { usage }.class();
    Some(match (first, second) {
        _ if class(first) != class(second) => Usage::Lobby,
        (Usage::Living, _) | (_, Usage::Living) => Usage::Living,
        _ => first,
    })
}

/// The opening for `door`, if there is a wall between two spaces.
fn place(
    door: &SurveyedDoor,
    floor: &Floor,
    usages: &[Option<Usage>],
    doors: &Doors,
    dice: &mut Dice,
) -> Option<Opening> {
    let forward = door.along;
    let across = Vec2::new(-forward.y, forward.x);
    // A door that was drawn beside its wall belongs into it.
    let middles = [0.0, MISDRAWN_M, -MISDRAWN_M].map(|off| door.at + across * off);
    let (middle, wall) = middles.into_iter().find_map(|at| Some((at, Crossing::at(floor, at, across)?)))?;
    if wall.spaces.iter().any(|&space| usages[space].is_none()) {
        return None;
    }
    // As far as the same two spaces lie on both sides, with a hand's breadth of jamb.
    let stretch = |side: f64| {
        let probes = (1..80).map(|k| f64::from(k) * PROBE_M);
        let same = |along: &f64| {
            let crossing = Crossing::at(floor, middle + forward * (side * along), across);
            crossing.is_some_and(|crossing| {
                crossing.spaces == wall.spaces && crossing.depth_m() < wall.depth_m() + 0.15
            })
        };
        probes.take_while(same).last().unwrap_or(0.0)
    };
    let (before, behind) = (stretch(-1.0), stretch(1.0));
    let room = before + behind;
    let wanted = match door.width_m {
        Some(width_m) => width_m,
        None if door.is_open && room <= WHOLE_M => room,
        None if door.is_open => dice.between(1.5, 3.5),
        None if door.is_double => doors.double_m + dice.between(-0.05, 0.05),
        None => doors.single_m + dice.between(-0.05, 0.08),
    };
    let width = wanted.min(room);
    if width < NARROWEST_M {
        return None;
    }
    // Rounding may leave no slack at all, not even none.
    let shift = 0.0_f64.max(0.5 * width - before).min(behind - 0.5 * width);
    let center = middle + forward * shift + across * wall.from.midpoint(wall.to);
    let half = 0.5 * wall.depth_m();
    let gap = Rect::new(center.x - 0.5 * width, center.y - half, center.x + 0.5 * width, center.y + half);
    let is_passage = door.is_open || width > WIDEST_DOORWAY_M;
    let mut opening = Opening {
        spaces: wall.spaces,
        kind: if is_passage { OpeningKind::Passage } else { OpeningKind::Doorway },
        wall: Axis::X,
        gap,
        turn: forward,
        leaves: Vec::new(),
        closed: false,
    };
    if !is_passage && !dice.chance(doors.bare) {
        opening.closed = dice.chance(doors.closed);
        let (hinge_first, swings_up) = (dice.chance(0.5), dice.chance(0.5));
        hang_leaves(&mut opening, hinge_first, swings_up, doors.ajar, dice);
    } else if !is_passage && dice.chance(0.5 * doors.closed) {
        opening.closed = true;
        let leaf = opening.solid(middle_of(&opening));
        opening.leaves.push(leaf);
    }
    Some(opening)
}

/// A wall that is crossed.
struct Crossing {
    /// The space behind, then the one ahead.
    spaces: [usize; 2],
    /// Where the floor behind ends and the one ahead begins, from the point of the crossing.
    from: f64,
    to: f64,
}

impl Crossing {
    /// The wall at `point` along `across`; `None` if no two spaces lie near.
    fn at(floor: &Floor, point: Point2, across: Vec2) -> Option<Self> {
        let first = |side: f64| {
            let steps = (0..).map(|k| f64::from(k) * 0.5 * FINE_M).take_while(|&far| far < DEEPEST_M);
            steps.map(|far| (far, floor.at(point + across * (side * far)))).find_map(|(far, ground)| {
                match ground {
                    Ground::Space(space) => Some((far, space)),
                    Ground::Wall | Ground::Outside => None,
                }
            })
        };
        let ((to, ahead), (from, behind)) = (first(1.0)?, first(-1.0)?);
        let crossing = Self { spaces: [behind, ahead], from: -from, to };
        (behind != ahead && crossing.depth_m() <= DEEPEST_M).then_some(crossing)
    }

    fn depth_m(&self) -> f64 {
        self.to - self.from
    }
}

/// Keeps the largest set of spaces that hang together by openings, and numbers them anew.
fn keep_connected(
    plan: &mut Plan,
    floor: &mut Floor,
    usages: &mut Vec<Option<Usage>>,
) -> Result<(), SurveyError> {
    let mut group: Vec<usize> = (0..usages.len()).collect();
    for opening in &plan.openings {
        let [keep, lose] = opening.spaces.map(|space| group[space]);
        group.iter_mut().filter(|group| **group == lose).for_each(|group| *group = keep);
    }
    let count = |g: usize| group.iter().filter(|&&other| other == g).count();
    let largest = (0..group.len()).max_by_key(|&g| (count(g), std::cmp::Reverse(g))).unwrap_or(0);
    let is_kept = |space: usize| group[space] == largest && usages[space].is_some();
    let mut next = 0;
    let number: Vec<Option<usize>> = (0..group.len())
        .map(|space| {
            next += usize::from(is_kept(space));
            is_kept(space).then(|| next - 1)
        })
        .collect();
    if next < 2 {
        return Err(SurveyError::Empty);
    }
    floor.renumber(&number);
    plan.openings.retain(|opening| opening.spaces.iter().all(|&space| number[space].is_some()));
    for opening in &mut plan.openings {
        opening.spaces = opening.spaces.map(|space| number[space].unwrap_or_default());
    }
    let kept = usages.iter().zip(&number).filter(|(_, number)| number.is_some()).map(|(usage, _)| *usage);
    *usages = kept.collect();
    Ok(())
}
