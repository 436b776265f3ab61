//! Many maps in one run: a line each, a table at the end, and what is done stays done.

use std::time::Duration;

use anyhow::{Result, ensure};
use placegraph::export::TopologyDocument;

use super::jobs::Job;
use super::result::{self, Labeled, remarks, summary};
use super::resume;
use super::setup::Setup;
use super::table::Table;
use crate::args::MapArgs;
use crate::commands::Outcome;
use crate::guard::guarded;
use crate::output::write_file;
use crate::progress::{MapCounter, Watch};
use crate::read;

/// A map that has its results.
pub(super) struct Done {
    /// How long its stages took, reading and writing files not among them; `None` if an earlier run labeled it.
    pub(super) time: Option<Duration>,
    pub(super) document: TopologyDocument,
}

/// Labels all maps into their folders and writes `summary.csv`; a map that fails does not stop the rest.
pub(super) fn run(jobs: &[Job], setup: &Setup<'_>, args: &MapArgs) -> Result<Outcome> {
    let counter = MapCounter::start(jobs.len());
    let classes = setup.classes();
    let mut table = Table::new(&classes);
    let (mut n_failed, mut n_incomplete) = (0, 0);
    for job in jobs {
        let name = job.map.display().to_string();
        counter.begin(&name);
        let result = guarded(|| label(job, setup, args));
        counter.end(&match &result {
            Ok(Done { time, document }) => {
                let kept = time.is_none().then(|| "kept".to_owned());
                let parts = kept.into_iter().chain([summary(document)]).chain(remarks(document));
                format!("{name}: {}", parts.collect::<Vec<_>>().join("; "))
            }
            Err(error) => format!("error: {name}: {error:#}"),
        });
        n_failed += usize::from(result.is_err());
        let is_incomplete = |done: &Done| result::outcome(&done.document) == Outcome::CheckFailed;
        n_incomplete += usize::from(result.as_ref().is_ok_and(is_incomplete));
        table.add(&name, &result);
    }
    drop(counter);
    write_file(&args.out.join("summary.csv"), table.text.as_bytes())?;
    ensure!(n_failed < jobs.len(), "none of the {n_failed} maps could be labeled");
    Ok(if n_failed + n_incomplete == 0 { Outcome::Done } else { Outcome::CheckFailed })
}

fn label(job: &Job, setup: &Setup<'_>, args: &MapArgs) -> Result<Done> {
    let map = read::map(&job.map, &args.read)?;
    let context = setup.context(job)?;
    if args.resume
        && let Some(document) = resume::kept(&map, &job.folder, setup, &context)
    {
        return Ok(Done { time: None, document });
    }
    let Labeled { mut document, analysis, timings } =
        result::label(&map, setup, &context, &Watch::without_bar())?;
    result::files(&map, &mut document, &analysis, setup)?.commit(&job.folder)?;
    Ok(Done { time: Some(timings.iter().map(|(_, time)| *time).sum()), document })
}
