//! Lifts, as the navigation graph and the building file have them.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_saphyr::FlowSeq;

use super::{RmfBuilding, RmfLift, RmfStop};
use crate::export::yaml::tenth_mm;
use crate::geom::Point2;

/// Widest door of a cabin, in meters.
const MAX_DOOR_M: f64 = 0.9;

/// A lift of the navigation graph.
#[derive(Serialize)]
pub(super) struct NavLift {
    /// Middle of the cabin, and its direction.
    position: FlowSeq<[f64; 3]>,
    /// Along the direction of the cabin, and across.
    dims: FlowSeq<[f64; 2]>,
}

impl NavLift {
    pub(super) fn of(lift: &RmfLift) -> Option<Self> {
        let Cabin { at, yaw_rad } = Cabin::of(lift)?;
        Some(Self {
            position: FlowSeq([tenth_mm(at.x), tenth_mm(at.y), tenth_mm(yaw_rad)]),
            dims: FlowSeq(lift.size_m.map(tenth_mm)),
        })
    }
}

/// A lift of the building file.
#[derive(Serialize)]
pub(super) struct BuildingLift<'a> {
    depth: f64,
    doors: BTreeMap<&'static str, LiftDoor>,
    highest_floor: &'a str,
    initial_floor_name: &'a str,
    level_doors: BTreeMap<&'a str, FlowSeq<[&'static str; 1]>>,
    lowest_floor: &'a str,
    plugins: bool,
    reference_floor_name: &'a str,
    width: f64,
    x: f64,
    y: f64,
    yaw: f64,
}

#[derive(Serialize)]
struct LiftDoor {
    /// Double sliding, the only type that the editor builds.
    door_type: u8,
    motion_axis_orientation: f64,
    width: f64,
    x: f64,
    y: f64,
}

impl<'a> BuildingLift<'a> {
    pub(super) fn of(lift: &'a RmfLift, building: &'a RmfBuilding<'_>) -> Option<Self> {
        let Cabin { at, yaw_rad } = Cabin::of(lift)?;
        let mut doors = BTreeMap::new();
        let mut level_doors = BTreeMap::new();
        for stop in &lift.stops {
            let side = side_of(stop, yaw_rad);
            doors.insert(side.name(), side.door(lift.size_m));
            level_doors.insert(building.levels[stop.level].name.as_str(), FlowSeq([side.name()]));
        }
        let level = |stop: &RmfStop| &building.levels[stop.level];
        let by_height = |a: &&RmfStop, b: &&RmfStop| level(a).elevation_m.total_cmp(&level(b).elevation_m);
        let [lowest, highest] = [lift.stops.iter().min_by(by_height), lift.stops.iter().max_by(by_height)]
            .map(|stop| stop.map(level));
        let first = &level(lift.stops.first()?).name;
        Some(Self {
            depth: tenth_mm(lift.size_m[1]),
            doors,
            highest_floor: &highest?.name,
            initial_floor_name: first,
            level_doors,
            lowest_floor: &lowest?.name,
            plugins: true,
            reference_floor_name: first,
            width: tenth_mm(lift.size_m[0]),
            x: tenth_mm(at.x),
            y: tenth_mm(at.y),
            yaw: tenth_mm(yaw_rad),
        })
    }
}

/// Where the cabin stands: in its first stop, turned so that its front has the door there.
struct Cabin {
    at: Point2,
    yaw_rad: f64,
}

impl Cabin {
    fn of(lift: &RmfLift) -> Option<Self> {
        let stop = lift.stops.first()?;
        Some(Self { at: *stop.line.last()?, yaw_rad: out_of(stop) })
    }
}

/// The direction in which one leaves the cabin.
fn out_of(stop: &RmfStop) -> f64 {
    let Some(&at) = stop.line.last() else { return 0.0 };
    let before = stop.line.iter().rev().find(|point| point.distance(at) > 0.1);
    before.map_or(0.0, |&before| (before.y - at.y).atan2(before.x - at.x))
}

/// A side of the cabin: quarter turns counter-clockwise from its front.
#[derive(Clone, Copy)]
struct Side(usize);

fn side_of(stop: &RmfStop, yaw_rad: f64) -> Side {
    let turns = (out_of(stop) - yaw_rad) / std::f64::consts::FRAC_PI_2;
    Side((turns.round() as i64).rem_euclid(4) as usize)
}

impl Side {
    fn name(self) -> &'static str {
        ["front", "left", "back", "right"][self.0]
    }

    fn door(self, [length, width]: [f64; 2]) -> LiftDoor {
        let (x, y) = [(length, 0.0), (0.0, width), (-length, 0.0), (0.0, -width)][self.0];
        let is_across = self.0.is_multiple_of(2);
        LiftDoor {
            door_type: 2,
            motion_axis_orientation: if is_across { tenth_mm(std::f64::consts::FRAC_PI_2) } else { 0.0 },
            width: tenth_mm((0.9 * if is_across { width } else { length }).min(MAX_DOOR_M)),
            x: tenth_mm(0.5 * x),
            y: tenth_mm(0.5 * y),
        }
    }
}
