//! `placegraph info`: what a map is, and the check of it.

use std::fmt::Write;

use anyhow::Result;
use placegraph::import::ros::Mode;
use placegraph::import::{Format, LoadedMap, MapCheck, Severity, Source, check};
use serde_json::{Value, json};

use super::Outcome;
use crate::args::InfoArgs;
use crate::hints;
use crate::output::{print, print_json};
use crate::read;

/// Prints what the map is and what to do about it. A map that cannot be labeled fails the check.
pub(crate) fn run(args: &InfoArgs) -> Result<Outcome> {
    let map = read::map(&args.map, &args.read)?;
    let check = check(&map);
    if args.json {
        print_json(&as_json(&map, &check))?;
    } else {
        print(&in_words(&map, &check))?;
    }
    let is_error = check.findings.iter().any(|finding| finding.severity() == Severity::Error);
    Ok(if is_error { Outcome::CheckFailed } else { Outcome::Done })
}

fn as_json(map: &LoadedMap, check: &MapCheck) -> Value {
    let (frame, cells) = (&map.grid.frame, &map.grid.cells);
    let Source { format, interpretation, .. } = &map.source;
    let findings = check.findings.iter().map(|finding| {
        let mut value = json!(finding);
        value["severity"] = json!(finding.severity());
        value["text"] = json!(hints::told(finding));
        value
    });
    json!({
        "name": map.name,
        "hash": map.hash,
        "format": format,
        "interpretation": interpretation,
        "width": cells.width(),
        "height": cells.height(),
        "resolution_m": frame.resolution_m(),
        "extent_m": extent_m(map),
        "origin": frame.map_from_grid(),
        "shares": check.shares,
        "n_parts": check.n_parts,
        "findings": findings.collect::<Vec<_>>(),
    })
}

fn extent_m(map: &LoadedMap) -> [f64; 2] {
    let cells = &map.grid.cells;
    [cells.width(), cells.height()].map(|n| f64::from(n) * map.grid.frame.resolution_m())
}

fn in_words(map: &LoadedMap, check: &MapCheck) -> String {
    let mut text = String::new();
    let cells = &map.grid.cells;
    let [width_m, height_m] = extent_m(map);
    let origin = map.grid.frame.map_from_grid();
    // To the millimeter: files of map savers have 16 digits, and the JSON has them too.
    let [x, y] = [origin.x, origin.y].map(|v| (v * 1e3).round() / 1e3 + 0.0);
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{}: {}", map.name, how(&map.source));
    let _ = writeln!(
        text,
        "{} x {} cells of {} m: {width_m:.1} m x {height_m:.1} m; lower left corner at ({x}, {y}), turned by {:.1}°",
        cells.width(),
        cells.height(),
        map.grid.frame.resolution_m(),
        origin.yaw_rad.to_degrees()
    );
    let parts = if check.n_parts == 1 { "part" } else { "parts" };
    let _ = writeln!(text, "{}; free space in {} {parts}", check.shares, check.n_parts);
    for finding in &check.findings {
        let _ = writeln!(text, "{}: {}", finding.severity(), hints::told(finding));
    }
    text
}

/// The format, and what a gray value was taken to mean.
fn how(source: &Source) -> String {
    let how = &source.interpretation;
    let mode = match how.mode {
        Mode::Trinary => "trinary",
        Mode::Scale => "scale",
        Mode::Raw => "raw",
    };
    let thresholds = format!("free up to {}, occupied from {}", how.free_thresh, how.occupied_thresh);
    let rules = format!("{:?}", how.rules).to_lowercase();
    let name = source.format.name();
    match source.format {
        Format::MapServer => {
            let negate = if how.negate { ", negated" } else { "" };
            format!("{name}, mode {mode}{negate}, {thresholds} (rules {rules})")
        }
        Format::Image => format!("{name}, {thresholds} (rules {rules})"),
        other if other.has_thresholds() => format!("{name}, {thresholds}"),
        _ => name.to_owned(),
    }
}
