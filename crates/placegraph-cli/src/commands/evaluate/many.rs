//! Many label images against their truths: a row per map, means, and everything together.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use placegraph::eval::{Confusion, DoorCounts, RoomScores};
use placegraph::labels::LabelSet;
use serde::Serialize;

use super::compare::Comparison;
use super::pair::{Judged, Pair, Report};
use crate::args::EvaluateArgs;
use crate::classes::Classes;
use crate::output::{complain, csv_row, print, print_json, write_file};

/// The measures in the columns of the table.
pub(super) const MEASURES: [&str; 8] = [
    "accuracy",
    "macro_f1",
    "door_recall",
    "door_precision",
    "room_recall",
    "room_precision",
    "room_iou",
    "cells",
];

/// The measures of one map, in the order of [`MEASURES`].
pub(super) type Row = [Option<f64>; MEASURES.len()];

#[derive(Serialize)]
struct MapReport<'a> {
    name: &'a str,
    #[serde(flatten)]
    report: Report,
}

#[derive(Serialize)]
struct ReportOfMany<'a> {
    maps: Vec<MapReport<'a>>,
    /// Means over the maps that have the measure.
    means: std::collections::BTreeMap<&'static str, Option<f64>>,
    /// All cells and all doors as if of one map.
    together: Report,
    /// Maps that have a truth and no prediction.
    missing: &'a [String],
    /// Against the results of another method.
    #[serde(skip_serializing_if = "Option::is_none")]
    comparison: Option<Comparison>,
}

/// Every map of a folder of truths that has a result, judged.
struct All {
    classes: Classes,
    names: Vec<String>,
    judged: Vec<Judged>,
    missing: Vec<String>,
}

impl All {
    fn of(results: &Path, args: &EvaluateArgs) -> Result<Self> {
        ensure!(results.is_dir(), "expected a folder of results, found {}", results.display());
        let mut all: Option<Self> = None;
        let mut missing = Vec::new();
        for (name, labels) in truths(args)? {
            let prediction = results.join(&name).join("labels.png");
            if !prediction.is_file() {
                missing.push(name);
                continue;
            }
            let classes = super::classes(args, &prediction)?;
            let all = all.get_or_insert_with(|| Self {
                classes: classes.clone(),
                names: Vec::new(),
                judged: Vec::new(),
                missing: Vec::new(),
            });
            ensure!(
                all.classes.label_set == classes.label_set,
                "{name} has other classes than {}: judge results of one model together",
                all.names[0]
            );
            let judged =
                judge(&prediction, &labels, args, &classes).with_context(|| format!("map {name}"))?;
            all.judged.push(judged);
            all.names.push(name);
        }
        let Some(all) = all else {
            bail!("expected results of the maps in {}, found none", args.labels.display())
        };
        for name in &missing {
            complain(&format!("{name}: no labels.png in {}", results.join(name).display()));
        }
        Ok(Self { missing, ..all })
    }

    fn reports(&self) -> Vec<Report> {
        self.judged.iter().map(|judged| judged.report(&self.classes.label_set)).collect()
    }
}

/// Judges every map of the folder of truths that has a prediction; false if one has none, or the mean accuracy is lower than
/// was asked for.
pub(super) fn run(args: &EvaluateArgs) -> Result<bool> {
    ensure!(
        args.crop.is_none() && args.rooms.is_none(),
        "--crop and --rooms work for one pair of images, not for folders"
    );
    let all = All::of(&args.prediction, args)?;
    let reports = all.reports();
    let rows: Vec<Row> = reports.iter().map(measures).collect();
    let means: Row = std::array::from_fn(|k| mean(rows.iter().filter_map(|row| row[k])));
    let comparison = match &args.against {
        None => None,
        Some(results) => {
            let others = All::of(results, args)?;
            let other_rows: Vec<Row> = others.reports().iter().map(measures).collect();
            Some(Comparison::of((&all.names, &rows), (&others.names, &other_rows))?)
        }
    };
    if let Some(path) = &args.csv {
        write_file(path, csv(&all.names, &rows).as_bytes(), &[])?;
    }
    let together = together(&all.judged, &all.classes.label_set);
    if args.json {
        let maps = all.names.iter().zip(reports).map(|(name, report)| MapReport { name, report }).collect();
        let means = MEASURES.into_iter().zip(means).filter(|(name, _)| *name != "cells").collect();
        print_json(&ReportOfMany { maps, means, together, missing: &all.missing, comparison })?;
    } else {
        print(&table(&all.names, &rows, &means))?;
        print(&format!("\nAll maps together\n\n{}\n", together.cells))?;
        if let Some(doors) = &together.doors {
            print(&format!("{doors}\n"))?;
        }
        if let Some(comparison) = comparison {
            print(&comparison.to_string())?;
        }
    }
    let is_enough = args.min_accuracy.is_none_or(|least| means[0].is_some_and(|found| found >= least));
    Ok(all.missing.is_empty() && is_enough)
}

/// The maps with a truth, by name, each with the image of its labels.
fn truths(args: &EvaluateArgs) -> Result<Vec<(String, PathBuf)>> {
    let could_not = || format!("could not read the folder {}", args.labels.display());
    let mut truths = Vec::new();
    for entry in fs::read_dir(&args.labels).with_context(could_not)? {
        let entry = entry.with_context(could_not)?;
        let labels = entry.path().join(&args.truth);
        if labels.is_file() {
            truths.push((entry.file_name().to_string_lossy().into_owned(), labels));
        }
    }
    truths.sort();
    ensure!(
        !truths.is_empty(),
        "expected folders with {} in {}, found none",
        args.truth.display(),
        args.labels.display()
    );
    Ok(truths)
}

/// Evaluates one map, with the files next to its truth and its prediction.
fn judge(prediction: &Path, labels: &Path, args: &EvaluateArgs, classes: &Classes) -> Result<Judged> {
    let (rooms, regions) = (labels.with_file_name("rooms.png"), prediction.with_file_name("regions.png"));
    let frame = super::frame(&labels.with_file_name("map.yaml"))?;
    let resolution_m = args.resolution.or(frame.map(|frame| frame.resolution_m()));
    let both = rooms.is_file() && regions.is_file();
    let rooms = both.then_some((rooms.as_path(), regions.as_path()));
    Pair { prediction, labels, rooms, crop: None, resolution_m, frame }.judge(classes)
}

/// Cells and doors of all maps as if they were one; rooms are not counted across maps.
fn together(judged: &[Judged], label_set: &LabelSet) -> Report {
    let mut cells = Confusion::none(label_set);
    let mut doors: Option<DoorCounts> = None;
    for map in judged {
        cells.add(&map.cells);
        if let Some(counts) = &map.doors {
            doors.get_or_insert_default().add(counts);
        }
    }
    Judged { cells, doors, rooms: None }.report(label_set)
}

fn measures(report: &Report) -> Row {
    let doors = report.doors.as_ref().map(|doors| doors.all);
    let rooms = |measure: fn(&RoomScores) -> Option<f64>| report.rooms.as_ref().and_then(measure);
    [
        report.cells.accuracy,
        report.cells.macro_f1,
        doors.and_then(|doors| doors.recall),
        doors.and_then(|doors| doors.precision),
        rooms(|rooms| rooms.recall),
        rooms(|rooms| rooms.precision),
        rooms(|rooms| rooms.mean_iou),
        Some(report.cells.n_cells as f64),
    ]
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (n, sum) = values.fold((0_u32, 0.0), |(n, sum), value| (n + 1, sum + value));
    (n > 0).then(|| sum / f64::from(n))
}

fn csv(names: &[String], rows: &[Row]) -> String {
    let header = csv_row(["map"].into_iter().chain(MEASURES).map(str::to_owned));
    let text = |value: &Option<f64>| value.map(|value| value.to_string()).unwrap_or_default();
    let rows = names
        .iter()
        .zip(rows)
        .map(|(name, row)| csv_row([name.clone()].into_iter().chain(row.iter().map(text))));
    std::iter::once(header).chain(rows).collect()
}

/// A row per map and the means, shares in percent.
fn table(names: &[String], rows: &[Row], means: &Row) -> String {
    let width = names.iter().map(|name| name.chars().count()).max().unwrap_or(0).max("mean".len());
    let row = |name: &str, row: &[Option<f64>]| {
        let (shares, n_cells) = row.split_at(MEASURES.len() - 1);
        let shares = shares.iter().map(|share| match share {
            Some(share) => format!("{:>15.2}", 100.0 * share),
            None => format!("{:>15}", "–"),
        });
        let n_cells = n_cells.iter().flatten().map(|n| format!("{n:>10.0}"));
        format!("{name:width$}{}\n", shares.chain(n_cells).collect::<String>())
    };
    let (last, shares) = ("cells", &MEASURES[..MEASURES.len() - 1]);
    let header: Vec<String> = shares.iter().map(|name| format!("{:>15}", name.replace('_', " "))).collect();
    let header = format!("{:width$}{}{last:>10}\n", "map", header.concat());
    let body = names.iter().zip(rows).map(|(name, values)| row(name, values));
    std::iter::once(header).chain(body).chain([row("mean", means)]).collect()
}
