//! One map: its findings, a line about its result, and what changed since an earlier one.

use std::time::Duration;

use anyhow::Result;
use placegraph::export::TopologyDocument;
use placegraph::geom::Pose2;
use placegraph::pipeline::Analysis;
use placegraph::progress::Stage;
use placegraph::topology::align::Alignment;

use super::changes;
use super::jobs::Job;
use super::result::{self, Labeled, summary};
use super::setup::{Context, Setup};
use crate::commands::Outcome;
use crate::output::{Committed, OutputSet, complain, print};
use crate::progress::Watch;
use crate::read;

/// Labels the map and writes its result.
pub(super) fn run(job: &Job, setup: &Setup<'_>, verbose: bool) -> Result<Outcome> {
    Prepared::new(job, setup)?.commit(verbose)
}

/// A labeled map whose files are made but not yet written.
#[derive(Debug)]
pub(crate) struct Prepared {
    name: String,
    labeled: Labeled,
    files: OutputSet,
    context: Context,
}

impl Prepared {
    /// Labels the map.
    pub(super) fn new(job: &Job, setup: &Setup<'_>) -> Result<Self> {
        let map = read::map(&job.map, &setup.args.read)?;
        let context = setup.context(job)?;
        let watch = Watch::start(&map.name);
        let mut labeled = result::label(&map, setup, &context, &watch)?;
        let files = result::files(&map, &mut labeled.document, &labeled.analysis, setup, &context)?;
        Ok(Self { name: job.map.display().to_string(), labeled, files, context })
    }

    /// The document of the result.
    pub(crate) fn document(&self) -> &TopologyDocument {
        &self.labeled.document
    }

    /// What the document was made from.
    pub(crate) fn analysis(&self) -> &Analysis {
        &self.labeled.analysis
    }

    /// Refuses what [`Prepared::commit`] would refuse.
    pub(crate) fn check(&self) -> Result<()> {
        self.files.check(&self.context.folder)
    }

    /// Writes the result, and says what was found.
    pub(crate) fn commit(self, verbose: bool) -> Result<Outcome> {
        let Self { name, labeled: Labeled { document, analysis, timings, advice }, files, context } = self;
        for finding in result::remarks(&document, &advice) {
            complain(&format!("{name}: {finding}"));
        }
        let Committed { written, removed } = files.commit(&context.folder)?;
        if verbose {
            complain(&timing_lines(&timings));
        }
        let (n_files, folder) = (written.len(), context.folder.display());
        complain(&format!("{name}: {}; {n_files} files in {folder}", summary(&document)));
        if let Some(line) = removal(&removed) {
            complain(&format!("{name}: {line}"));
        }
        for (outcome, n) in analysis.edit_outcomes.iter().zip(1..) {
            if let Ok(applied) = outcome {
                complain(&format!("edit {n}: {applied}"));
            }
        }
        if let Some(found) = analysis.frames.and_then(|frames| frames.alignment).filter(Alignment::is_certain)
        {
            let Pose2 { x, y, yaw_rad } = found.new_from_old;
            let turn_deg = yaw_rad.sin().atan2(yaw_rad.cos()).to_degrees();
            complain(&format!("earlier result turned by {turn_deg:.2} degrees, shifted by {x:.2} {y:.2} m"));
        }
        for line in changes::lines(&analysis.changes, &analysis.topology, context.config.previous.as_ref()) {
            print(&format!("{line}\n"))?;
        }
        Ok(result::outcome(&document))
    }
}

/// A line per stage, with the time it took.
pub(super) fn timing_lines(timings: &[(Stage, Duration)]) -> String {
    let line = |(stage, time): &(Stage, Duration)| {
        format!("{:<10} {:>8.1} ms", stage.name(), time.as_secs_f64() * 1e3)
    };
    timings.iter().map(line).collect::<Vec<_>>().join("\n")
}

/// What is said of the files of an earlier result that are gone, if there are any.
pub(crate) fn removal(removed: &[String]) -> Option<String> {
    (!removed.is_empty()).then(|| format!("removed {} of the earlier result", removed.join(", ")))
}
