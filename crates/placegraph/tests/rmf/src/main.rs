//! Opens nav_graph.yaml and *.building.yaml with Open-RMF's own types, and compares the navigation graph that RMF
//! itself makes of the building file with the one exported.
//!
//! usage: cargo run --release -- DIR...      exit status: 1 if anything differs

use std::collections::{BTreeMap, BTreeSet};
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
    let [(name, level)] = <[_; 1]>::try_from(exported.levels.iter().collect::<Vec<_>>())
        .map_err(|_| "expected one level")?;
    let made_level = made.levels.get(name).ok_or("RMF's graph lacks the level")?;
    let (lanes, made_lanes) = (lanes_by_place(level), lanes_by_place(made_level));
    // Lanes through a door that RMF would not see there, and the reverse.
    for (ends, door) in &lanes {
        let found = made_lanes.get(ends).ok_or_else(|| format!("RMF's graph lacks the lane {ends:?}"))?;
        if found != door {
            return Err(format!("lane {ends:?}: exported door {door:?}, RMF finds {found:?}").into());
        }
    }
    if lanes.len() != made_lanes.len() {
        return Err(format!("{} lanes exported, RMF makes {}", lanes.len(), made_lanes.len()).into());
    }
    let doors: BTreeSet<_> = exported.doors.keys().collect();
    if doors != made.doors.keys().collect() {
        return Err("the doors have other names".into());
    }
    Ok(format!("{} vertices, {} lanes, {} doors", level.vertices.len(), lanes.len(), doors.len()))
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

/// Lanes by where they begin and end, in millimeters: numbers of vertices differ. With the door they lead through.
fn lanes_by_place(level: &NavLevel) -> BTreeMap<[i64; 4], Option<String>> {
    let mm = |v: f32| (v as f64 * 1e3).round() as i64;
    let lane = |lane: &rmf_site_format::legacy::nav_graph::NavLane| {
        let [a, b] = [lane.0, lane.1].map(|index| &level.vertices[index]);
        ([mm(a.0), mm(a.1), mm(b.0), mm(b.1)], lane.2.door_name.clone())
    };
    level.lanes.iter().map(lane).collect()
}
