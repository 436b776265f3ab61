//! Opens nav_graph.yaml and *.building.yaml with Open-RMF's own types, and compares the navigation graph that RMF
//! itself makes of the building file with the one exported.
//!
//! usage: cargo run --release -- DIR...      exit status: 1 if anything differs

use std::collections::BTreeSet;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use rmf_site_format::legacy::building_map::BuildingMap;
use rmf_site_format::legacy::nav_graph::{NavGraph, NavLevel};

fn main() -> ExitCode {
    let mut status = ExitCode::SUCCESS;
    for folder in std::env::args().skip(1) {
        match check(Path::new(&folder)) {
            Ok(found) => println!("ok    {folder}: {found}"),
            Err(error) => {
                status = ExitCode::FAILURE;
                println!("FAIL  {folder}: {error}");
            }
        }
    }
    status
}

fn check(folder: &Path) -> Result<String, Box<dyn Error>> {
    let exported: NavGraph = serde_yaml::from_slice(&std::fs::read(folder.join("nav_graph.yaml"))?)?;
    let building = BuildingMap::from_bytes(&std::fs::read(building_file(folder)?)?)?;
    let site = building.to_site().map_err(|error| format!("building file: {error}"))?;
    let [(_, made)] = NavGraph::from_site(&site).try_into().map_err(|_| "expected one navigation graph")?;
    let (mut n_vertices, mut n_lanes) = (0, 0);
    for (name, level) in &exported.levels {
        let made_level = made.levels.get(name).ok_or_else(|| format!("RMF's graph lacks the level {name}"))?;
        compare(level, made_level).map_err(|error| format!("level {name}: {error}"))?;
        n_vertices += level.vertices.len();
        n_lanes += level.lanes.len();
    }
    if made.levels.len() != exported.levels.len() {
        return Err("the levels are others".into());
    }
    let doors: BTreeSet<_> = exported.doors.keys().collect();
    if doors != made.doors.keys().collect() {
        return Err("the doors have other names".into());
    }
    for (name, lift) in &exported.lifts {
        let found = made.lifts.get(name).ok_or_else(|| format!("RMF's graph lacks {name}"))?;
        if !is_near(&lift.dims, &found.dims, ROUNDING_M) {
            return Err(format!("{name}: exported {:?}, RMF makes {:?}", lift.dims, found.dims).into());
        }
    }
    if made.lifts.len() != exported.lifts.len() {
        return Err("the lifts are others".into());
    }
    let (n_levels, n_doors, n_lifts) = (exported.levels.len(), doors.len(), exported.lifts.len());
    Ok(format!("{n_levels} levels, {n_vertices} vertices, {n_lanes} lanes, {n_doors} doors, {n_lifts} lifts"))
}

/// Lanes through a door that RMF would not see there, lanes that it lacks, and the reverse.
fn compare(level: &NavLevel, made: &NavLevel) -> Result<(), String> {
    let (exported, made) = (lanes(level), lanes(made));
    let mut left = made.clone();
    for (ends, what) in &exported {
        let found = left.iter().position(|(other, to)| to.1 == what.1 && is_same(ends, other, to));
        let found = found.ok_or_else(|| format!("RMF's graph lacks the lane {ends:?}"))?;
        let (_, other) = left.swap_remove(found);
        if other != *what {
            return Err(format!("lane {ends:?}: exported door and lifts {what:?}, RMF finds {other:?}"));
        }
    }
    if left.is_empty() { Ok(()) } else { Err(format!("{} lanes exported, RMF makes {}", exported.len(), made.len())) }
}

/// What rounding and the fit of the floors move a point, in meters.
const ROUNDING_M: f32 = 0.005;
/// How far this crate puts a cabin from where the building file has it, in meters: it measures from the door, and turns the cabin the
/// other way. A remark in its source says that this is not checked.
const CABIN_M: f32 = 2.5;

fn is_near(a: &[f32], b: &[f32], within_m: f32) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < within_m)
}

/// Whether two lanes begin and end at the same places.
fn is_same(a: &[f32; 4], b: &[f32; 4], (_, lifts): &What) -> bool {
    let within_m = |end: usize| if lifts[end].is_some() { CABIN_M } else { ROUNDING_M };
    is_near(&a[..2], &b[..2], within_m(0)) && is_near(&a[2..], &b[2..], within_m(1))
}

fn building_file(folder: &Path) -> Result<PathBuf, Box<dyn Error>> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.to_string_lossy().ends_with(".building.yaml") {
            return Ok(path);
        }
    }
    Err("expected a *.building.yaml".into())
}

/// A door, and the lifts at both ends.
type What = (Option<String>, [Option<String>; 2]);

/// Lanes by where they begin and end, for numbers of vertices differ, and what they lead through.
fn lanes(level: &NavLevel) -> Vec<([f32; 4], What)> {
    let lane = |lane: &rmf_site_format::legacy::nav_graph::NavLane| {
        let [a, b] = [lane.0, lane.1].map(|index| &level.vertices[index]);
        ([a.0, a.1, b.0, b.1], (lane.2.door_name.clone(), [a, b].map(|vertex| vertex.2.lift.clone())))
    };
    level.lanes.iter().map(lane).collect()
}
