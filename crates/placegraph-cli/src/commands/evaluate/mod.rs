//! `placegraph evaluate`: label images against the truth.

mod compare;
mod many;
mod pair;

use std::path::Path;

use anyhow::{Context, Result, ensure};
use placegraph::grid::MapFrame;
use placegraph::import::{self, ros};

use self::pair::Pair;
use super::Outcome;
use crate::args::EvaluateArgs;
use crate::classes::Classes;
use crate::model::NamedModel;
use crate::output::{print, print_json};

/// Compares, prints, and checks the accuracy asked for.
pub(crate) fn run(args: &EvaluateArgs) -> Result<Outcome> {
    if let Some(resolution_m) = args.resolution {
        ensure!(
            resolution_m.is_finite() && resolution_m > 0.0,
            "expected a resolution above 0, found {resolution_m}"
        );
    }
    let is_complete = if args.labels.is_dir() { many::run(args) } else { one(args) }?;
    Ok(if is_complete { Outcome::Done } else { Outcome::CheckFailed })
}

/// The classes of a label image: those asked for, or those that the files next to it name.
fn classes(args: &EvaluateArgs, prediction: &Path) -> Result<Classes> {
    match &args.model {
        Some(path) => Ok(NamedModel::load(Some(path))?.model.label_set.into()),
        None => Classes::of(args.classes.as_deref(), prediction),
    }
}

/// The frame of the map that the YAML file at `path` describes, if there is one.
fn frame(path: &Path) -> Result<Option<MapFrame>> {
    if !path.is_file() {
        return Ok(None);
    }
    let text = import::read(path, import::MAX_TEXT_BYTES)?;
    let map = ros::parse_yaml(&text).with_context(|| format!("in {}", path.display()))?;
    Ok(Some(map.frame))
}

/// Judges one image; false if it is not as good as was asked for.
fn one(args: &EvaluateArgs) -> Result<bool> {
    ensure!(args.csv.is_none(), "--csv works for folders, found the image {}", args.labels.display());
    ensure!(args.against.is_none(), "--against works for folders, found the image {}", args.labels.display());
    let classes = classes(args, &args.prediction)?;
    let pair = Pair {
        prediction: &args.prediction,
        labels: &args.labels,
        rooms: args.rooms.as_deref().zip(args.regions.as_deref()),
        crop: args.crop,
        resolution_m: args.resolution,
        frame: frame(&args.prediction.with_extension("yaml"))?,
    };
    let report = pair.judge(&classes)?.report(&classes.label_set);
    if args.json {
        print_json(&report)?;
    } else {
        print(&format!("{}\n", report.cells))?;
        if let Some(doors) = &report.doors {
            print(&format!("{doors}\n"))?;
        }
        if let Some(rooms) = &report.rooms {
            print(&format!("{rooms}\n"))?;
        }
    }
    Ok(args.min_accuracy.is_none_or(|least| report.cells.accuracy.is_some_and(|found| found >= least)))
}
