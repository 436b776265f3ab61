//! `placegraph evaluate`: label images against the truth.

mod many;
mod pair;

use anyhow::{Result, ensure};
use placegraph::labels::LabelSet;

use self::pair::Pair;
use super::Outcome;
use crate::args::EvaluateArgs;
use crate::model::NamedModel;
use crate::output::{print, print_json};

/// Compares, prints, and checks the accuracy asked for.
pub(crate) fn run(args: &EvaluateArgs) -> Result<Outcome> {
    let label_set = match &args.model {
        Some(path) => NamedModel::load(Some(path))?.model.label_set,
        None => LabelSet::default(),
    };
    if let Some(resolution_m) = args.resolution {
        ensure!(
            resolution_m.is_finite() && resolution_m > 0.0,
            "expected a resolution above 0, found {resolution_m}"
        );
    }
    let is_complete = if args.labels.is_dir() { many::run(args, &label_set) } else { one(args, &label_set) }?;
    Ok(if is_complete { Outcome::Done } else { Outcome::CheckFailed })
}

/// Judges one image; false if it is not as good as was asked for.
fn one(args: &EvaluateArgs, label_set: &LabelSet) -> Result<bool> {
    ensure!(args.csv.is_none(), "expected folders for a table, found the image {}", args.labels.display());
    let pair = Pair {
        prediction: &args.prediction,
        labels: &args.labels,
        rooms: args.rooms.as_deref().zip(args.regions.as_deref()),
        crop: args.crop,
        resolution_m: args.resolution,
    };
    let report = pair.judge(label_set)?.report(label_set);
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
