//! `placegraph site`: the floors of a site, and the lifts and stairs between them.

use std::fmt::Write;
use std::path::Path;

use anyhow::{Context, Result, bail};
use placegraph::site::{Floor, LabeledFloor, Leg, ShaftKind, SiteDocument, SiteFile, stops};
use placegraph::topology::Place;
use serde_json::{Value, json};

use super::Outcome;
use super::map::{Prepared, prepare, removal};
use super::route::{length, named};
use crate::args::{MapArgs, RouteArgs, SiteArgs};
use crate::document::DOCUMENT;
use crate::output::{Committed, Existing, OutputSet, complain, print, print_json};
use crate::read;

/// Labels all floors, joins them, and only then writes: the results of the floors first, the site last.
pub(crate) fn run(args: &SiteArgs, verbose: bool) -> Result<Outcome> {
    let text = read::text(&args.site, "site file")?;
    let in_file = || format!("in {}", args.site.display());
    let file = SiteFile::from_toml(&text).with_context(in_file)?;
    let mut prepared = Vec::new();
    let mut labeled = Vec::new();
    for floor in &file.floors {
        let on_floor = || format!("level {}", floor.level);
        let result = prepare(&map_args(args, floor)).with_context(on_floor)?;
        let stops = stops(&file, &floor.level, result.analysis(), args.robot_radius).with_context(in_file)?;
        labeled.push(LabeledFloor { document: result.document().clone(), stops });
        prepared.push(result);
    }
    let mut site = SiteDocument::join(&file, &labeled).with_context(in_file)?;
    let mut files = OutputSet::new(Existing::ReplaceResult);
    files.keep_inputs(std::slice::from_ref(&args.site), args.force);
    let n_errors = site.findings.len();
    files.extend(site.files()?);
    prepared.iter().try_for_each(Prepared::check)?;
    files.check(&args.out)?;
    let mut outcome = Outcome::Done;
    for result in prepared {
        if result.commit(verbose)? != Outcome::Done {
            outcome = Outcome::CheckFailed;
        }
    }
    let Committed { written, removed } = files.commit(&args.out)?;
    let name = args.site.display();
    for (number, finding) in site.findings.iter().enumerate() {
        // What follows on the errors is what a floor of one room cannot have.
        let is_error = number < n_errors;
        complain(&format!("{name}: {}{finding}", if is_error { "error: " } else { "" }));
        if is_error {
            outcome = Outcome::CheckFailed;
        }
    }
    let (n_floors, n_places) =
        (site.levels.len(), site.levels.iter().map(|level| level.places.len()).sum::<usize>());
    let n = |kind| site.shafts.iter().filter(|shaft| shaft.kind == kind).count();
    complain(&format!(
        "{name}: levels {n_floors}, places {n_places}, lifts {}, stairs {}; {} files in {}",
        n(ShaftKind::Lift),
        n(ShaftKind::Stairs),
        written.len(),
        args.out.display()
    ));
    if let Some(line) = removal(&removed) {
        complain(&format!("{name}: {line}"));
    }
    Ok(outcome)
}

/// What `placegraph map` would be asked for the map of `floor`.
fn map_args(args: &SiteArgs, floor: &Floor) -> MapArgs {
    let beside = |path: &String| args.site.parent().unwrap_or(Path::new("")).join(path);
    let earlier = || {
        let folder = args.previous.as_ref()?.join(&floor.level);
        folder.join(DOCUMENT).is_file().then_some(folder)
    };
    MapArgs {
        maps: vec![beside(&floor.map)],
        out: args.out.join(&floor.level),
        model: args.model.clone(),
        method: None,
        stages: false,
        probabilities: false,
        no_doorways: false,
        no_correction: false,
        export: args.export.clone(),
        masks: args.masks.clone(),
        georeference: None,
        robot_radius: args.robot_radius,
        from: None,
        previous: floor.previous.as_ref().map(beside).or_else(earlier),
        hold: false,
        align: false,
        edits: floor.edits.as_ref().map(beside),
        resume: false,
        force: args.force,
        read: args.read.clone(),
    }
}

/// Prints the places, doorways, lifts and stairs on the shortest route through a site, and its length.
pub(super) fn route(site: &SiteDocument, args: &RouteArgs) -> Result<Outcome> {
    let place =
        |name: &str| site.place_called(name).with_context(|| format!("in {}", args.topology.display()));
    let (from, to) = (place(&args.from)?, place(&args.to)?);
    let ends = [from, to].map(|(level, place)| (level, place.id));
    let Some(route) = site.route(ends[0], ends[1], args.stairs) else {
        let on_foot = if args.stairs { None } else { site.route(ends[0], ends[1], true) };
        let hint = if on_foot.is_some() { "; there is one by stairs: add --stairs" } else { "" };
        bail!("there is no route from {} to {}{hint}", from.1.name, to.1.name);
    };
    let legs = route.legs.iter();
    if args.json {
        let legs: Vec<Value> = legs.map(|leg| about(site, leg)).collect();
        print_json(&json!({ "legs": legs, "length_m": route.length_m() }))?;
        return Ok(Outcome::Done);
    }
    let mut text = String::new();
    for leg in legs {
        // Writing to a string cannot fail.
        let _ = match leg {
            Leg::Walk { level, .. } => places(site, leg)
                .iter()
                .try_for_each(|place| writeln!(text, "{}: {}", site.levels[*level].level, place.name)),
            Leg::Ride { shaft, levels } => {
                let [from, to] = levels.map(|level| &site.levels[level].level);
                writeln!(text, "{}: {from} to {to}", site.shafts[*shaft].name)
            }
        };
    }
    print(&format!("{text}{}\n", length(route.length_m())))?;
    Ok(Outcome::Done)
}

/// The places on a leg over a floor.
fn places<'a>(site: &'a SiteDocument, leg: &Leg) -> Vec<&'a Place> {
    match leg {
        Leg::Walk { level, way } => {
            way.places.iter().filter_map(|&id| site.levels[*level].place(id)).collect()
        }
        Leg::Ride { .. } => Vec::new(),
    }
}

fn about(site: &SiteDocument, leg: &Leg) -> Value {
    match leg {
        Leg::Walk { level, way } => {
            let places: Vec<Value> = places(site, leg).into_iter().map(named).collect();
            let level = &site.levels[*level].level;
            json!({ "level": level, "places": places, "length_m": way.length_m, "line": way.line })
        }
        Leg::Ride { shaft, levels } => {
            let shaft = &site.shafts[*shaft];
            let [from, to] = levels.map(|level| &site.levels[level].level);
            json!({ "by": shaft.name, "kind": shaft.kind, "from": from, "to": to })
        }
    }
}
