//! `placegraph map`: labels, regions and the topological map of one or many maps.

use std::path::Path;

use anyhow::Result;
use placegraph::topology::identity::Change;
use placegraph::topology::{PlaceId, TopologicalMap};

use super::{Outcome, batch};
use crate::args::MapArgs;
use crate::labeling::{Setup, output_folders, summary};
use crate::output::{complain, print};
use crate::progress::Watch;
use crate::read;

/// Labels every map; with several, one that fails does not stop the rest. A format that cannot hold a map is left out of its
/// result, which fails the check.
pub(crate) fn run(args: &MapArgs, verbose: bool) -> Result<Outcome> {
    let setup = Setup::new(args)?;
    let folders = output_folders(&args.maps, &args.out)?;
    match (args.maps.as_slice(), folders.as_slice()) {
        ([map], [folder]) if !args.resume => label_one(map, folder, &setup, args, verbose),
        _ => batch::run(&folders, &setup, args),
    }
}

fn label_one(
    path: &Path,
    folder: &Path,
    setup: &Setup<'_>,
    args: &MapArgs,
    verbose: bool,
) -> Result<Outcome> {
    let map = read::map(path, &args.read)?;
    let mut labeled = setup.label(&map, &Watch::start(&map.name))?;
    let files = setup.files(&map, &mut labeled)?;
    let document = &labeled.document;
    for finding in &document.findings {
        complain(&format!("{}: {finding}", path.display()));
    }
    let written = files.commit(folder)?;
    if verbose {
        for (stage, time) in &labeled.timings {
            complain(&format!("{:<10} {:>8.1} ms", stage.name(), time.as_secs_f64() * 1e3));
        }
    }
    let n_files = written.len();
    let folder = folder.display();
    complain(&format!("{}: {}; {n_files} files in {folder}", path.display(), summary(document)));
    for change in &labeled.analysis.changes {
        print(&format!("{}\n", in_words(change, &labeled.analysis.topology)))?;
    }
    Ok(if labeled.left_out.is_empty() { Outcome::Done } else { Outcome::CheckFailed })
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
