//! Flats as vectors, in the JSON that `FloorplanTransformation`'s annotations were turned into: a line each with `walls` and
//! `doors` as `[x0, y0, x1, y1]`, `rooms` and `fixtures` as `[x0, y0, x1, y1, "name"]`, in pixels, y down.
//!
//! There is no scale: the median door is taken to be 0.8 m wide. A room is a rectangle somewhere inside it.

use placegraph::geom::Point2;
use serde::Deserialize;

use super::{Outline, Survey, SurveyError, SurveyedDoor, SurveyedSpace};
use crate::plan::Usage;
use crate::shape::Rect;

const EXPECTED: &str = "a flat (JSON with walls, doors, rooms and fixtures)";

/// Width of the median door, in meters.
const MEDIAN_DOOR_M: f64 = 0.8;

#[derive(Deserialize)]
struct Flat {
    walls: Vec<[f64; 4]>,
    doors: Vec<[f64; 4]>,
    rooms: Vec<(f64, f64, f64, f64, String)>,
    fixtures: Vec<(f64, f64, f64, f64, String)>,
}

/// Reads one flat, a line of such a file.
///
/// # Errors
/// If `line` is no such flat, or its doors give it no scale of a building.
pub fn read_flat(line: &str) -> Result<Survey, SurveyError> {
    let flat: Flat = serde_json::from_str(line).map_err(|error| SurveyError::text(EXPECTED, &error))?;
    let length = |&[x0, y0, x1, y1]: &[f64; 4]| ((x1 - x0) * (x1 - x0) + (y1 - y0) * (y1 - y0)).sqrt();
    let mut lengths: Vec<f64> = flat.doors.iter().map(length).collect();
    lengths.sort_by(f64::total_cmp);
    let median = lengths.get(lengths.len() / 2).copied().filter(|&median| median > 0.0);
    let scale = MEDIAN_DOOR_M / median.ok_or(SurveyError::Scale { found: "no door".to_owned() })?;
    let at = |x: f64, y: f64| Point2::new(x * scale, -y * scale);
    let spaces = flat.rooms.iter().map(|&(x0, y0, x1, y1, ref name)| SurveyedSpace {
        usage: usage(name),
        outline: Outline::Around(at(x0, y0).midpoint(at(x1, y1))),
    });
    let doors = flat.doors.iter().map(|door @ &[x0, y0, x1, y1]| SurveyedDoor {
        at: at(x0, y0).midpoint(at(x1, y1)),
        along: super::direction(at(x0, y0), at(x1, y1)),
        width_m: Some(length(door) * scale),
        is_double: false,
        is_open: false,
    });
    let stands = |name: &str| matches!(name, "toilet" | "washing_basin" | "bathtub" | "cooking_counter");
    let furniture = flat.fixtures.iter().filter(|fixture| stands(&fixture.4)).map(|&(x0, y0, x1, y1, _)| {
        let (a, b) = (at(x0, y0), at(x1, y1));
        Rect::new(a.x.min(b.x), a.y.min(b.y), a.x.max(b.x), a.y.max(b.y))
    });
    Survey {
        spaces: spaces.collect(),
        walls: flat.walls.iter().map(|&[x0, y0, x1, y1]| [at(x0, y0), at(x1, y1)]).collect(),
        doors: doors.collect(),
        furniture: furniture.collect(),
        is_home: true,
    }
    .checked()
}

/// What a room of this name is used for; nobody enters balconies and shafts.
fn usage(name: &str) -> Option<Usage> {
    Some(match name {
        "balcony" | "PS" => return None,
        "corridor" => Usage::Corridor,
        "kitchen" => Usage::Kitchen,
        "living_room" => Usage::Living,
        "bathroom" | "restroom" | "washing_room" => Usage::Bath,
        "closet" => Usage::Storage,
        "stairs" => Usage::Stairs,
        "entrance" => Usage::Lobby,
        _ => Usage::Bedroom,
    })
}
