//! Many maps in one run: a line each, tables that grow with them, and what is done stays done.

use std::time::Duration;

use anyhow::{Result, ensure};
use placegraph::export::TopologyDocument;
use placegraph::progress::Stage;

use super::changes;
use super::jobs::Job;
use super::one::{removal, timing_lines};
use super::result::{self, Labeled, summary};
use super::resume;
use super::setup::Setup;
use super::table::Table;
use crate::commands::Outcome;
use crate::document::fixed_time;
use crate::guard::guarded;
use crate::hints::Advice;
use crate::output::Committed;
use crate::progress::{MapCounter, Watch};
use crate::read;

/// A map that has its result.
pub(super) struct Done {
    /// How long its stages took, reading and writing files not among them; none if an earlier run labeled it.
    pub(super) timings: Vec<(Stage, Duration)>,
    pub(super) document: TopologyDocument,
    /// What changed since the earlier result, in words.
    pub(super) changes: Vec<String>,
    /// What was written and removed; `None` if nothing was.
    pub(super) changed: Option<Committed>,
}

impl Done {
    /// What became of the map.
    pub(super) fn status(&self) -> &'static str {
        match (&self.changed, self.timings.is_empty()) {
            (None, _) => "kept",
            (Some(_), true) => "extended",
            (Some(_), false) => "labeled",
        }
    }

    /// The time of its stages together; none if results must not depend on the clock.
    pub(super) fn seconds(&self) -> Option<f64> {
        let is_told = !self.timings.is_empty() && fixed_time().is_none();
        is_told.then(|| self.timings.iter().map(|(_, time)| time.as_secs_f64()).sum())
    }

    /// What people must know of the result and of what was removed.
    pub(super) fn remarks(&self) -> Vec<String> {
        let removed = self.changed.as_ref().and_then(|changed| removal(&changed.removed));
        result::remarks(&self.document, &Advice::default()).into_iter().chain(removed).collect()
    }
}

/// How many maps lack something.
#[derive(Debug, Default, PartialEq, Eq)]
struct Lacking {
    failed: usize,
    incomplete: usize,
}

/// Labels all maps into their folders and writes the tables; a map that fails does not stop the rest.
pub(super) fn run(jobs: &[Job], setup: &Setup<'_>, verbose: bool) -> Result<Outcome> {
    let classes = setup.classes();
    let mut table = Table::start(&setup.args.out, &classes, setup.args.force)?;
    let lacking = each(jobs, &mut table, verbose, |job| label(job, setup))?;
    ensure!(lacking.failed < jobs.len(), "none of the {} maps could be labeled", lacking.failed);
    Ok(if lacking == Lacking::default() { Outcome::Done } else { Outcome::CheckFailed })
}

/// Does `work` for every job. A panic is a bug that ends one map, not the run.
fn each(
    jobs: &[Job],
    table: &mut Table<'_>,
    verbose: bool,
    work: impl Fn(&Job) -> Result<Done>,
) -> Result<Lacking> {
    let counter = MapCounter::start(jobs.len());
    let mut lacking = Lacking::default();
    for job in jobs {
        let name = job.map.display().to_string();
        counter.begin(&name);
        let result = guarded(|| work(job));
        match &result {
            Ok(done) => {
                let is_whole = result::outcome(&done.document) == Outcome::Done;
                lacking.incomplete += usize::from(!is_whole);
                let unlabeled = Some(done.status()).filter(|status| *status != "labeled").map(str::to_owned);
                let parts = unlabeled.into_iter().chain([summary(&done.document)]).chain(done.remarks());
                let line = format!("{name}: {}", parts.collect::<Vec<_>>().join("; "));
                let times = Some(timing_lines(&done.timings)).filter(|times| !times.is_empty());
                let details = done.changes.iter().cloned().chain(times);
                let lines: Vec<String> = [line].into_iter().chain(details.take_while(|_| verbose)).collect();
                counter.end(&lines.join("\n"));
            }
            Err(error) => {
                lacking.failed += 1;
                counter.end(&format!("error: {name}: {error:#}"));
            }
        }
        table.add(job, &result)?;
    }
    Ok(lacking)
}

fn label(job: &Job, setup: &Setup<'_>) -> Result<Done> {
    let mut map = read::map(&job.map, &setup.args.read)?;
    if let Some(name) = &job.name {
        map.name.clone_from(name);
    }
    let context = setup.context(job)?;
    if setup.args.resume
        && let Some(resumed) = resume::resume(&map, setup, &context)?
    {
        return Ok(Done {
            timings: Vec::new(),
            document: resumed.document,
            changes: Vec::new(),
            changed: resumed.changed,
        });
    }
    let Labeled { mut document, analysis, timings, advice: _ } =
        result::label(&map, setup, &context, &Watch::without_bar())?;
    let files = result::files(&map, &mut document, &analysis, setup, &context)?;
    let changes = changes::lines(&analysis.changes, &analysis.topology, context.config.previous.as_ref());
    Ok(Done { timings, document, changes, changed: Some(files.commit(&context.folder)?) })
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;

    #[test]
    fn a_panic_ends_one_map_and_the_table_tells_it() {
        let out = tempfile::tempdir().unwrap();
        let job = |name: &str| Job { map: PathBuf::from(name), name: None, place: PathBuf::from(name) };
        let mut table = Table::start(out.path(), &[], false).unwrap();
        let jobs = ["first", "second", "third"].map(job);
        let lacking = each(&jobs, &mut table, false, |job| {
            assert!(job.map.as_os_str() != "second", "a bug, {}", job.map.display());
            anyhow::bail!("no map at all")
        });
        assert_eq!(lacking.unwrap(), Lacking { failed: 3, incomplete: 0 });
        let table = std::fs::read_to_string(out.path().join("summary.csv")).unwrap();
        let rows: Vec<&str> = table.lines().skip(1).collect();
        assert_eq!(rows.len(), 3, "{table}");
        assert!(rows[1].starts_with("second,failed,") && rows[1].contains("a bug, second"), "{table}");
        assert!(rows[2].contains("no map at all"), "{table}");
    }
}
