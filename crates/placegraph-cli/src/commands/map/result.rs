//! A map and what was asked for in, the files of its result out.

use std::collections::BTreeMap;
use std::time::Duration;

use anyhow::{Result, bail};
use placegraph::export::{FRAME_ID, FileRecord, TopologyDocument};
use placegraph::import::{LoadedMap, check};
use placegraph::labels::LabelField;
use placegraph::pipeline::{self, Analysis};
use placegraph::progress::Stage;
use placegraph::result::{LabeledMap, check_size, seal};

use super::setup::{Context, Setup};
use crate::commands::Outcome;
use crate::document;
use crate::hints::Advice;
use crate::output::{Existing, OutputSet};
use crate::progress::Watch;

/// A labeled map whose files are not yet written.
#[derive(Debug)]
pub(super) struct Labeled {
    /// Everything but the pictures.
    pub(super) document: TopologyDocument,
    /// All results; of the smoothed field, only what the files need.
    pub(super) analysis: Analysis,
    /// How long each stage took.
    pub(super) timings: Vec<(Stage, Duration)>,
    /// The options that help about what was found.
    pub(super) advice: Advice,
}

/// Labels `map`.
pub(super) fn label(map: &LoadedMap, setup: &Setup<'_>, context: &Context, watch: &Watch) -> Result<Labeled> {
    let model = &setup.model.model;
    let n_labels = model.label_set.len();
    check_size(map, model, context.config.correction)?;
    if let Some(found) = context.previous_frame_id.as_ref().filter(|found| *found != FRAME_ID) {
        bail!("expected an earlier result in the frame {FRAME_ID:?}, found {found:?}");
    }
    let findings = check(map).findings;
    let mut analysis = pipeline::analyze(&map.grid, model, &context.config, watch);
    if !needs_probabilities(setup) {
        // Beside pictures, the largest block of all.
        analysis.smoothed = LabelField::from_rows(n_labels, Vec::new());
    }
    let timings = watch.finish();
    let labeled = LabeledMap { map, classes: &model.label_set, analysis: &analysis };
    let edits = context.edits.display().to_string();
    let mut document = labeled.document(setup.model.info(), &findings, &context.config.robot, &edits);
    document.program.options.clone_from(&context.options);
    if document::fixed_time().is_none() {
        let in_ms = |(stage, time): &(Stage, Duration)| (stage.name().to_owned(), time.as_secs_f64() * 1e3);
        document.timings_ms = timings.iter().map(in_ms).collect();
    }
    let advice = Advice::new(&findings, analysis.frames.as_ref());
    Ok(Labeled { document, analysis, timings, advice })
}

/// Whether a file of the result has more about a cell than its label.
fn needs_probabilities(setup: &Setup<'_>) -> bool {
    setup.args.stages || setup.args.probabilities || setup.formats.iter().any(|format| format.needs_cells)
}

/// The files of a result, the document last. A format that cannot hold the map is skipped, as the document says.
pub(super) fn files(
    map: &LoadedMap,
    document: &mut TopologyDocument,
    analysis: &Analysis,
    setup: &Setup<'_>,
    context: &Context,
) -> Result<OutputSet> {
    let labeled = LabeledMap { map, classes: &setup.model.model.label_set, analysis };
    let mut files = OutputSet::new(Existing::ReplaceResult);
    files.keep_inputs(&[map.files.as_slice(), &context.inputs].concat(), setup.args.force);
    files.extend(labeled.files(document, &setup.contents())?);
    Ok(files)
}

/// Adds the document, which lists the files that stay and all that were added before.
pub(crate) fn join(
    files: &mut OutputSet,
    mut added: Vec<(String, Vec<u8>)>,
    document: &mut TopologyDocument,
    kept: Vec<FileRecord>,
) -> Result<()> {
    files.keep_files(kept.iter().map(|file| file.name.clone()).collect());
    seal(document, &mut added, kept)?;
    files.extend(added);
    Ok(())
}

/// Whether the result has all that was asked for.
pub(super) fn outcome(document: &TopologyDocument) -> Outcome {
    let is_whole = document.errors.is_empty() && document.skipped.is_empty();
    if is_whole { Outcome::Done } else { Outcome::CheckFailed }
}

/// What people must know of a result.
pub(super) fn remarks(document: &TopologyDocument, advice: &Advice) -> Vec<String> {
    let findings = document.findings.iter().map(|finding| {
        let is_error = document.errors.contains(finding);
        format!("{}{}", if is_error { "error: " } else { "" }, advice.about(finding))
    });
    skipped(document).chain(findings).collect()
}

/// The formats that a result does not have, and why.
pub(super) fn skipped(document: &TopologyDocument) -> impl Iterator<Item = String> {
    document.skipped.iter().map(|skipped| format!("{} is skipped: {}", skipped.format, skipped.reason))
}

/// The number of places of each class that has any, and of connections, in words.
pub(super) fn summary(document: &TopologyDocument) -> String {
    let mut count: BTreeMap<&str, usize> = BTreeMap::new();
    for place in &document.places {
        *count.entry(place.class.as_str()).or_default() += 1;
    }
    let mut parts: Vec<String> = count.iter().map(|(class, &n)| counted(n, class)).collect();
    if parts.is_empty() {
        parts.push("no places".to_owned());
    }
    format!("{}; {}", parts.join(", "), counted(document.connections.len(), "connection"))
}

/// `n` things called `noun`.
fn counted(n: usize, noun: &str) -> String {
    format!("{n} {noun}{}", if n == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::counted;

    #[test]
    fn one_thing_has_no_plural() {
        assert_eq!([0, 1, 2].map(|n| counted(n, "room")), ["0 rooms", "1 room", "2 rooms"]);
    }
}
