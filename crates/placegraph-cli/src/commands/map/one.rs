//! One map: its findings, a line about its result, and what changed since an earlier one.

use std::path::Path;
use std::time::Duration;

use anyhow::Result;
use placegraph::geom::Pose2;
use placegraph::progress::Stage;
use placegraph::topology::align::Alignment;
use placegraph::topology::identity::Change;
use placegraph::topology::{PlaceId, TopologicalMap};

use super::jobs::Job;
use super::result::{self, Labeled, summary};
use super::setup::Setup;
use crate::commands::Outcome;
use crate::output::{complain, print};
use crate::progress::Watch;
use crate::read;

/// Labels the map and writes its result.
pub(super) fn run(job: &Job, setup: &Setup<'_>, verbose: bool) -> Result<Outcome> {
    let map = read::map(&job.map, &setup.args.read)?;
    let context = setup.context(job)?;
    let watch = Watch::start(&map.name);
    let Labeled { mut document, analysis, timings } = result::label(&map, setup, &context, &watch)?;
    let files = result::files(&map, &mut document, &analysis, setup)?;
    for finding in result::remarks(&document) {
        complain(&format!("{}: {finding}", job.map.display()));
    }
    let written = files.commit(&job.folder)?;
    if verbose {
        tell_timings(&timings);
    }
    tell_result(&job.map, &summary(&document), written.len(), &job.folder);
    for (outcome, n) in analysis.edit_outcomes.iter().zip(1..) {
        if let Ok(applied) = outcome {
            complain(&format!("edit {n}: {applied}"));
        }
    }
    if let Some(found) = analysis.frames.and_then(|frames| frames.alignment).filter(Alignment::is_certain) {
        let Pose2 { x, y, yaw_rad } = found.new_from_old;
        let turn_deg = yaw_rad.sin().atan2(yaw_rad.cos()).to_degrees();
        complain(&format!("earlier result turned by {turn_deg:.2} degrees, shifted by {x:.2} {y:.2} m"));
    }
    for change in &analysis.changes {
        print(&format!("{}\n", in_words(change, &analysis.topology)))?;
    }
    Ok(result::outcome(&document))
}

fn tell_result(map: &Path, summary: &str, n_files: usize, folder: &Path) {
    complain(&format!("{}: {summary}; {n_files} files in {}", map.display(), folder.display()));
}

/// A line per stage, with the time it took.
pub(super) fn tell_timings(timings: &[(Stage, Duration)]) {
    for (stage, time) in timings {
        complain(&format!("{:<10} {:>8.1} ms", stage.name(), time.as_secs_f64() * 1e3));
    }
}

/// A line for people: new places by name and number, earlier ones by number.
fn in_words(change: &Change, map: &TopologicalMap) -> String {
    let new = |id: &PlaceId| match map.place(*id) {
        Some(place) => format!("{} ({})", place.name, id.0),
        None => id.0.to_string(),
    };
    let join = |ids: Vec<String>| ids.join(", ");
    match change {
        Change::Appeared { place } => format!("appeared: {}", new(place)),
        Change::Vanished { place, name } => format!("vanished: {name} ({})", place.0),
        Change::Split { from, into } => {
            format!("split: {} into {}", from.0, join(into.iter().map(new).collect()))
        }
        Change::Merged { from, into } => {
            let from = from.iter().map(|id| id.0.to_string()).collect();
            format!("merged: {} into {}", join(from), new(into))
        }
        other => format!("changed: {other:?}"),
    }
}
