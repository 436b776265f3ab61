//! A map and what was asked for in, the files of its result out.

use std::collections::BTreeMap;
use std::time::Duration;

use anyhow::{Result, bail, ensure};
use placegraph::export::{
    Export, FileRecord, Format, MapInfo, SkippedFormat, TopologyDocument, label_png, overview_png,
    probability_npy, raster_yaml, region_png,
};
use placegraph::grid::{CellGraph, Grid, Occupancy};
use placegraph::import::{LoadedMap, Severity, check, has_memory};
use placegraph::labels::LabelField;
use placegraph::pipeline::{self, Analysis, Frames};
use placegraph::progress::Stage;
use placegraph::topology::reach::{self, GraphCheck};

use super::setup::{Context, Setup};
use crate::commands::Outcome;
use crate::document::{self, DOCUMENT};
use crate::hints;
use crate::output::{Existing, OutputSet};
use crate::progress::Watch;

/// What a run takes beside the map and what grows with it.
const BASE_BYTES: u64 = 64 << 20;

/// A labeled map whose files are not yet written.
#[derive(Debug)]
pub(super) struct Labeled {
    /// Everything but the pictures.
    pub(super) document: TopologyDocument,
    /// All results; of the smoothed field, only what the files need.
    pub(super) analysis: Analysis,
    /// How long each stage took.
    pub(super) timings: Vec<(Stage, Duration)>,
}

/// Labels `map`.
pub(super) fn label(map: &LoadedMap, setup: &Setup<'_>, context: &Context, watch: &Watch) -> Result<Labeled> {
    let model = &setup.model.model;
    let n_free = map.grid.count(Occupancy::Free) as u64;
    let n_labels = model.label_set.len();
    let n_cells = map.grid.cells.values().len() as u64;
    let check_memory = |n_places| {
        let n_bytes = BASE_BYTES + pipeline::memory_bytes(n_cells, n_free, n_labels, n_places);
        ensure!(has_memory(n_bytes), "not enough memory: labeling {n_free} free cells needs {n_bytes} bytes");
        Ok(())
    };
    check_memory(0)?;
    check_memory(pipeline::n_parts(&map.grid))?;
    let info = MapInfo::of(&map.grid, &map.name, &map.hash);
    if let Some(found) = context.previous_frame_id.as_ref().filter(|found| **found != info.frame_id) {
        bail!("expected an earlier result in the frame {:?}, found {found:?}", info.frame_id);
    }
    let findings = check(map).findings;
    let mut analysis = pipeline::analyze(&map.grid, model, &context.config, watch);
    if !needs_probabilities(setup) {
        // Beside pictures, the largest block of all.
        analysis.smoothed = LabelField::from_rows(n_labels, Vec::new());
    }
    let timings = watch.finish();
    let mut document =
        TopologyDocument::new(info, Some(setup.model.info()), &model.label_set, &analysis.topology);
    document.program.options.clone_from(&context.options);
    let mut unapplied = unapplied_edits(&analysis, context);
    unapplied.extend(analysis.frames.as_ref().filter(|frames| frames.disagree()).map(disagreement));
    let errors = findings.iter().filter(|finding| finding.severity() == Severity::Error);
    document.errors = errors.map(hints::told).chain(unapplied.iter().cloned()).collect();
    document.findings = findings.iter().map(hints::told).chain(unapplied).collect();
    let robot = &context.config.robot;
    document.graph = Some(GraphCheck::of(&analysis.topology, robot.radius_m));
    document.findings.extend(reach::remarks(&analysis.topology, robot));
    if document::fixed_time().is_none() {
        let in_ms = |(stage, time): &(Stage, Duration)| (stage.name().to_owned(), time.as_secs_f64() * 1e3);
        document.timings_ms = timings.iter().map(in_ms).collect();
    }
    Ok(Labeled { document, analysis, timings })
}

/// Whether a file of the result tells more of a cell than its label.
fn needs_probabilities(setup: &Setup<'_>) -> bool {
    setup.args.stages || setup.args.probabilities || setup.formats.iter().any(|format| format.needs_cells)
}

fn unapplied_edits(analysis: &Analysis, context: &Context) -> Vec<String> {
    let file = context.edits.display();
    let outcomes = analysis.edit_outcomes.iter().enumerate();
    let unapplied = outcomes.filter_map(|(index, outcome)| Some((index + 1, outcome.as_ref().err()?)));
    unapplied.map(|(n, reason)| format!("edit {n} of {file} does not apply: {reason}")).collect()
}

/// Why no name of the earlier result was kept.
fn disagreement(frames: &Frames) -> String {
    let tried = match &frames.alignment {
        None => "give --align to find the turn and the shift between them",
        Some(found) if found.is_certain() => "nor do they once the earlier one is turned and shifted",
        Some(_) => "and no turn and shift lays them on one another with certainty",
    };
    format!(
        "the frames of the map and of the earlier result do not agree: {:.0} % of the area is that of the same places; no number and \
         no name was kept; {tried}",
        100.0 * frames.matched_share
    )
}

/// The files of a result, the document last. A format that cannot hold the map is skipped, as the document says.
pub(super) fn files(
    map: &LoadedMap,
    document: &mut TopologyDocument,
    analysis: &Analysis,
    setup: &Setup<'_>,
    context: &Context,
) -> Result<OutputSet> {
    // With the walls and openings that edits drew.
    let grid = analysis.drawn.as_ref().unwrap_or(&map.grid);
    let (graph, frame) = (&analysis.space.graph, &grid.frame);
    let mut files = OutputSet::new(Existing::ReplaceResult);
    files.keep_inputs(&[map.files.as_slice(), &context.inputs].concat(), setup.args.force);
    if setup.args.stages {
        files.add("labels.1-classified.png", label_png(graph, &analysis.classified));
        files.add("labels.2-smoothed.png", label_png(graph, &analysis.smoothed.most_likely()));
    }
    if setup.args.probabilities {
        files.add("probabilities.npy", probability_npy(graph, &analysis.smoothed));
    }
    let label_set = &setup.model.model.label_set;
    let (overview, (labels, regions)) = rayon::join(
        || overview_png(grid, &analysis.labeling, label_set, &analysis.topology, &map.name),
        || {
            rayon::join(
                || label_png(graph, &analysis.labeling),
                || region_png(graph, &analysis.regions, &analysis.place_ids),
            )
        },
    );
    files.add("labels.png", labels);
    files.add("labels.yaml", raster_yaml("labels.png", frame));
    files.add("regions.png", regions?);
    files.add("regions.yaml", raster_yaml("regions.png", frame));
    files.add("overview.png", overview);
    let has_picture = setup.formats.iter().any(|format| format.needs_cells);
    let picture = has_picture.then(|| (&grid.cells, most_likely_probability(graph, &analysis.smoothed)));
    document.program.options.extend(setup.formats.iter().map(|format| export_option(format.name)));
    add_exports(&mut files, document, &setup.formats, setup, picture)?;
    seal(&mut files, document, Vec::new())?;
    Ok(files)
}

/// Adds the files of `formats`, or why a format is skipped.
pub(super) fn add_exports(
    files: &mut OutputSet,
    document: &mut TopologyDocument,
    formats: &[&'static Format],
    setup: &Setup<'_>,
    picture: Option<(&Grid<Occupancy>, Grid<f32>)>,
) -> Result<()> {
    let mut skipped = Vec::new();
    let mut export = Export::new(document, &setup.masks)?;
    export.written = document::fixed_time().unwrap_or_default();
    export.georeference = setup.args.georeference.map(|place| place.0);
    if let Some((occupancy, probability)) = picture {
        export.occupancy = Some(occupancy);
        export.probability = Some(probability);
    }
    for format in formats {
        match format.write(&export, &format.usual_name(&document.map.name)) {
            Ok(exported) => exported.into_iter().for_each(|(name, bytes)| files.add(name, bytes)),
            Err(error) => {
                skipped.push(SkippedFormat { format: format.name.to_owned(), reason: error.to_string() });
            }
        }
    }
    document.skipped.extend(skipped);
    Ok(())
}

/// How the document names that a format was asked for.
pub(crate) fn export_option(format: &str) -> String {
    format!("{EXPORT}{format}")
}

/// How the option of a format begins.
pub(super) const EXPORT: &str = "--export ";

/// Adds the document, which lists the files that stay and all that were added before.
pub(crate) fn seal(
    files: &mut OutputSet,
    document: &mut TopologyDocument,
    kept: Vec<FileRecord>,
) -> Result<()> {
    files.keep_files(kept.iter().map(|file| file.name.clone()).collect());
    document.files = kept;
    document.files.extend(files.files().map(|(name, bytes)| FileRecord::of(name, bytes)));
    document.seal()?;
    files.add(DOCUMENT, document.to_json()?);
    Ok(())
}

fn most_likely_probability(graph: &CellGraph, field: &LabelField) -> Grid<f32> {
    let mut grid = Grid::filled(graph.width(), graph.height(), 0.0);
    for (node, cell) in graph.cells_in_rows(0..graph.height()).enumerate() {
        grid[cell] = field.row(node).iter().copied().fold(0.0, f32::max);
    }
    grid
}

/// Whether the result has all that was asked for.
pub(super) fn outcome(document: &TopologyDocument) -> Outcome {
    let is_whole = document.errors.is_empty() && document.skipped.is_empty();
    if is_whole { Outcome::Done } else { Outcome::CheckFailed }
}

/// What people must know of a result.
pub(super) fn remarks(document: &TopologyDocument) -> Vec<String> {
    let findings = document.findings.iter().map(|finding| {
        let is_error = document.errors.contains(finding);
        if is_error { format!("error: {finding}") } else { finding.clone() }
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
