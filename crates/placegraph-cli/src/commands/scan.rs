//! `placegraph scan`: what a robot would see at one point, as numbers and as a picture.

use std::fmt::Write;

use anyhow::{Context, Result, ensure};
use placegraph::export::scan_png;
use placegraph::features;
use placegraph::geom::Point2;
use placegraph::scan;
use serde_json::json;

use super::Outcome;
use crate::args::ScanArgs;
use crate::model::NamedModel;
use crate::output::{print, print_json, write_file};
use crate::read;

/// Simulates the scan, prints it and its features, and draws it where asked.
pub(crate) fn run(args: &ScanArgs) -> Result<Outcome> {
    let map = read::map(&args.map, &args.read)?;
    let at = Point2::new(args.at.x, args.at.y);
    let cells = &map.grid.cells;
    let cell = map
        .grid
        .frame
        .cell_at(at)
        .filter(|cell| cell.x < cells.width() && cell.y < cells.height())
        .with_context(|| format!("expected a point inside the map, found ({}, {})", at.x, at.y))?;
    ensure!(map.grid.is_free(cell), "expected a free cell at ({}, {}), found {:?}", at.x, at.y, cells[cell]);
    let model = NamedModel::load(args.model.as_deref())?.model;
    let scan = scan::cast(&map.grid, cell, &model.scan);
    let columns = features::all();
    let values = features::of_scan(&scan, &columns);
    let named = columns.iter().map(|id| &id.feature().name).zip(&values);
    if let Some(path) = &args.output {
        write_file(path, &scan_png(&map.grid, cell, &scan), &map.files)?;
    }
    if args.json {
        let features: serde_json::Map<String, serde_json::Value> =
            named.map(|(name, value)| (name.clone(), json!(value))).collect();
        print_json(&json!({ "cell": [cell.x, cell.y], "ranges_m": scan.ranges_m(), "features": features }))?;
    } else {
        let mut text =
            format!("scan from the center of cell ({}, {}), counted from the lower left\n", cell.x, cell.y);
        for (beam, range) in scan.ranges_m().iter().enumerate().step_by(30) {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "  beam {beam:>3}  {range:>8.3} m");
        }
        for (name, value) in named {
            let _ = writeln!(text, "  {name:<10} {value}");
        }
        print(&text)?;
    }
    Ok(Outcome::Done)
}
