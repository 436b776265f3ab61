//! Labels one map: a map and what was asked for in, result files out.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result, ensure};
use placegraph::export::{
    MapInfo, TopologyDocument, label_png, overview_png, probability_npy, raster_yaml, region_png,
};
use placegraph::grid::{CellGraph, Grid, Occupancy};
use placegraph::import::{LoadedMap, check, has_memory};
use placegraph::labels::LabelField;
use placegraph::model::sha256_hex;
use placegraph::pipeline::{self, Analysis, Correction, Doorways};
use placegraph::progress::Stage;
use placegraph::topology::edits::EditFile;

use crate::args::{Format, MapArgs, RulesArg};
use crate::document;
use crate::exports::{self, Subject};
use crate::masks::Masks;
use crate::model::NamedModel;
use crate::output::OutputSet;
use crate::progress::Watch;
use crate::read;

/// The name of the file that says what a result was made of. It is put in place last: where it is, the others
/// are.
pub(crate) const DOCUMENT: &str = "topology.json";

/// What holds for all maps of a run.
#[derive(Debug)]
pub(crate) struct Setup<'a> {
    args: &'a MapArgs,
    model: NamedModel,
    config: pipeline::Config,
    masks: Masks,
    formats: Vec<Format>,
    /// What results depend on beside map and model.
    options: Vec<String>,
    /// Name of the frame that the earlier result is in.
    previous_frame_id: Option<String>,
}

/// A labeled map whose files are not yet written.
#[derive(Debug)]
pub(crate) struct Labeled {
    /// Everything but the pictures.
    pub(crate) document: TopologyDocument,
    /// All results; of the smoothed field, only what the files need.
    pub(crate) analysis: Analysis,
    /// How long each stage took.
    pub(crate) timings: Vec<(Stage, Duration)>,
    /// Formats that cannot hold this map, and why.
    pub(crate) left_out: Vec<String>,
}

impl<'a> Setup<'a> {
    /// Reads every file that the arguments name, but no map.
    pub(crate) fn new(args: &'a MapArgs) -> Result<Self> {
        ensure!(
            args.maps.len() == 1 || (args.previous.is_none() && args.edits.is_none()),
            "expected one map with --previous or --edits, found {}",
            args.maps.len()
        );
        let model = NamedModel::load(args.model.as_deref())?;
        model.check_method(args.method)?;
        let previous = args.previous.as_deref().map(document::read).transpose()?;
        let edits = args.edits.as_deref().map(read_edits).transpose()?.unwrap_or_default();
        let masks = Masks::load(args.masks.as_deref())?;
        masks.check(&model.model.label_set)?;
        let mut formats = args.export.clone();
        formats.sort_unstable();
        formats.dedup();
        let config = pipeline::Config {
            doorways: if args.no_doorways { Doorways::Skip } else { Doorways::Mark },
            correction: if args.no_correction { Correction::Skip } else { Correction::Apply },
            edits: edits.edits,
            previous: previous.as_ref().map(TopologyDocument::topology),
        };
        let previous_frame_id = previous.map(|document| document.map.frame_id);
        Ok(Self { args, model, config, masks, options: options(args, &formats)?, formats, previous_frame_id })
    }

    /// The names of the classes, in the order of their labels.
    pub(crate) fn classes(&self) -> Vec<&str> {
        self.model.model.label_set.classes().iter().map(|class| class.name.as_str()).collect()
    }

    /// Labels `map`.
    pub(crate) fn label(&self, map: &LoadedMap, watch: &Watch) -> Result<Labeled> {
        let n_free = map.grid.count(Occupancy::Free) as u64;
        let n_labels = self.model.model.label_set.len();
        let n_bytes = pipeline::memory_bytes(map.grid.cells.values().len() as u64, n_free, n_labels);
        ensure!(
            has_memory(n_bytes),
            "expected {n_bytes} bytes of memory to label {n_free} free cells, found less"
        );
        let info = MapInfo::of(&map.grid, &map.name, &map.hash);
        if let Some(found) = self.previous_frame_id.as_ref().filter(|found| **found != info.frame_id) {
            anyhow::bail!("expected an earlier result in the frame {:?}, found {found:?}", info.frame_id);
        }
        let findings = check(map).findings;
        let mut analysis = pipeline::analyze(&map.grid, &self.model.model, &self.config, watch);
        if !self.needs_probabilities() {
            // Beside pictures, the largest block of all.
            analysis.smoothed = LabelField::from_rows(n_labels, Vec::new());
        }
        let timings = watch.finish();
        let label_set = &self.model.model.label_set;
        let mut document =
            TopologyDocument::new(info, Some(self.model.info()), label_set, &analysis.topology);
        document.program.options.clone_from(&self.options);
        document.findings = findings.iter().map(ToString::to_string).collect();
        document.findings.extend(self.unapplied_edits(&analysis));
        if exports::fixed_time().is_none() {
            let in_ms =
                |(stage, time): &(Stage, Duration)| (stage.name().to_owned(), time.as_secs_f64() * 1e3);
            document.timings_ms = timings.iter().map(in_ms).collect();
        }
        Ok(Labeled { document, analysis, timings, left_out: Vec::new() })
    }

    /// Whether a file of the result tells more of a cell than its label.
    fn needs_probabilities(&self) -> bool {
        self.args.stages || self.args.probabilities || self.formats.contains(&Format::Report)
    }

    fn unapplied_edits(&self, analysis: &Analysis) -> Vec<String> {
        let file = self.args.edits.as_deref().unwrap_or(Path::new("")).display();
        let outcomes = analysis.edit_outcomes.iter().enumerate();
        let unapplied = outcomes.filter_map(|(index, outcome)| Some((index + 1, outcome.as_ref().err()?)));
        unapplied.map(|(n, reason)| format!("edit {n} of {file} does not apply: {reason}")).collect()
    }

    /// The result in `folder` if it is complete and made from `map` just as it would be made now.
    pub(crate) fn kept(&self, map: &LoadedMap, folder: &Path) -> Option<TopologyDocument> {
        let found = document::read(&folder.join(DOCUMENT)).ok()?;
        let is_same = found.program.version == env!("CARGO_PKG_VERSION")
            && found.program.options == self.options
            && found.map.hash == map.hash
            && found.map.name == map.name
            && found.model.as_ref() == Some(&self.model.info());
        let reasons = self.left_out_of(&found);
        let is_left_out =
            |format: &Format| reasons.iter().any(|reason| reason.starts_with(&left_out(*format)));
        let names = self.file_names(&map.name, |format| !is_left_out(format)).ok()?;
        (is_same && names.iter().all(|name| folder.join(name).is_file())).then_some(found)
    }

    /// The formats that a result has not, and why, as its document says.
    pub(crate) fn left_out_of(&self, document: &TopologyDocument) -> Vec<String> {
        let is_reason =
            |finding: &&String| self.formats.iter().any(|&format| finding.starts_with(&left_out(format)));
        document.findings.iter().filter(is_reason).cloned().collect()
    }

    /// The names of a result's files, with those of the formats that are `wanted`.
    fn file_names(&self, map_name: &str, wanted: impl Fn(&Format) -> bool) -> Result<Vec<String>> {
        let mut names: Vec<String> =
            ["labels.png", "labels.yaml", "regions.png", "regions.yaml", "overview.png"]
                .map(str::to_owned)
                .into();
        if self.args.stages {
            names.extend(["labels.1-classified.png", "labels.2-smoothed.png"].map(str::to_owned));
        }
        if self.args.probabilities {
            names.push("probabilities.npy".to_owned());
        }
        for &format in self.formats.iter().filter(|format| wanted(format)) {
            names.extend(exports::file_names(format, &exports::usual_name(format, map_name))?);
        }
        Ok(names)
    }

    /// The files of a result. A format that cannot hold the map is left out, and `labeled` tells it.
    pub(crate) fn files(&self, map: &LoadedMap, labeled: &mut Labeled) -> Result<OutputSet> {
        let Labeled { document, analysis, .. } = &*labeled;
        let (graph, frame) = (&analysis.graph, &map.grid.frame);
        let mut files = OutputSet::default();
        if self.args.stages {
            files.add("labels.1-classified.png", label_png(graph, &analysis.classified));
            files.add("labels.2-smoothed.png", label_png(graph, &analysis.smoothed.most_likely()));
        }
        if self.args.probabilities {
            files.add("probabilities.npy", probability_npy(graph, &analysis.smoothed));
        }
        let label_set = &self.model.model.label_set;
        let (overview, (labels, regions)) = rayon::join(
            || overview_png(&map.grid, &analysis.labeling, label_set, &analysis.topology, &map.name),
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
        let mut subject = Subject::new(document, &self.masks)?;
        if self.formats.contains(&Format::Report) {
            subject.occupancy = Some(&map.grid.cells);
            subject.probability = Some(most_likely_probability(graph, &analysis.smoothed));
        }
        let mut reasons = Vec::new();
        for &format in &self.formats {
            let main = exports::usual_name(format, &map.name);
            match subject.files(format, &main) {
                Ok(exported) => exported.into_iter().for_each(|(name, bytes)| files.add(name, bytes)),
                Err(error) => {
                    exports::file_names(format, &main)?.into_iter().for_each(|name| files.leave_out(name));
                    reasons.push(format!("{}{error:#}", left_out(format)));
                }
            }
        }
        labeled.document.findings.extend_from_slice(&reasons);
        labeled.left_out = reasons;
        files.add(DOCUMENT, labeled.document.to_json()?);
        Ok(files)
    }
}

/// How a finding begins that says why a format is left out.
fn left_out(format: Format) -> String {
    format!("{format} is left out: ")
}

fn read_edits(path: &Path) -> Result<EditFile> {
    let text = read::text(path, "edit file")?;
    EditFile::from_toml(&text).with_context(|| format!("in {}", path.display()))
}

/// What was typed that results depend on, always in the same words; files by their content.
fn options(args: &MapArgs, formats: &[Format]) -> Result<Vec<String>> {
    let switches = [
        (args.stages, "--stages"),
        (args.probabilities, "--probabilities"),
        (args.no_doorways, "--no-doorways"),
        (args.no_correction, "--no-correction"),
        (args.read.rules == RulesArg::Ros1, "--rules ros1"),
        (args.read.trust_thresholds, "--trust-thresholds"),
    ];
    let mut options: Vec<String> =
        switches.into_iter().filter(|(is_on, _)| *is_on).map(|(_, name)| name.to_owned()).collect();
    options.extend(args.read.resolution.map(|resolution| format!("--resolution {resolution}")));
    options.extend(formats.iter().map(|format| format!("--export {format}")));
    let files = [("--masks", &args.masks), ("--previous", &args.previous), ("--edits", &args.edits)];
    for (name, path) in files {
        if let Some(path) = path {
            let bytes = std::fs::read(path).with_context(|| format!("could not read {}", path.display()))?;
            options.push(format!("{name} sha256:{}", sha256_hex(&bytes)));
        }
    }
    Ok(options)
}

fn most_likely_probability(graph: &CellGraph, field: &LabelField) -> Grid<f32> {
    let mut grid = Grid::filled(graph.width(), graph.height(), 0.0);
    for (node, cell) in graph.cells_in_rows(0..graph.height()).enumerate() {
        grid[cell] = field.row(node).iter().copied().fold(0.0, f32::max);
    }
    grid
}

/// The number of places of each class that has any, and of connections, in words.
pub(crate) fn summary(document: &TopologyDocument) -> String {
    let mut count: BTreeMap<&str, usize> = BTreeMap::new();
    for place in &document.places {
        *count.entry(place.class.as_str()).or_default() += 1;
    }
    let places: Vec<String> = count.iter().map(|(class, n)| format!("{n} {class}")).collect();
    let places = if places.is_empty() { "no place".to_owned() } else { places.join(", ") };
    format!("{places}; {} connections", document.connections.len())
}

/// One folder a map: `out` for a single map, else a folder in it by file stem, with the parent folder's name
/// where stems repeat.
pub(crate) fn output_folders(maps: &[PathBuf], out: &Path) -> Result<Vec<PathBuf>> {
    if maps.len() == 1 {
        return Ok(vec![out.to_owned()]);
    }
    let stem = |path: &Path| path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let parent =
        |path: &Path| path.parent().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
    let mut seen: BTreeMap<String, usize> = BTreeMap::new();
    for map in maps {
        *seen.entry(stem(map).context("expected the path of a map file")?).or_default() += 1;
    }
    let mut folders: BTreeMap<String, &Path> = BTreeMap::new();
    maps.iter()
        .map(|map| {
            let own = stem(map).unwrap_or_default();
            let name = if seen[&own] == 1 { own } else { parent(map).unwrap_or(own) };
            if let Some(earlier) = folders.insert(name.clone(), map) {
                anyhow::bail!(
                    "{} and {} would both be written to {}: label them in two runs",
                    earlier.display(),
                    map.display(),
                    out.join(&name).display()
                );
            }
            Ok(out.join(name))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folders(maps: &[&str]) -> Result<Vec<PathBuf>> {
        output_folders(&maps.iter().map(PathBuf::from).collect::<Vec<_>>(), Path::new("out"))
    }

    #[test]
    fn one_map_takes_the_folder_itself_and_several_get_one_each() {
        assert_eq!(folders(&["a/map.yaml"]).unwrap(), [Path::new("out")]);
        assert_eq!(folders(&["a.yaml", "b.yaml"]).unwrap(), [Path::new("out/a"), Path::new("out/b")]);
    }

    #[test]
    fn parents_tell_apart_what_stems_do_not() {
        assert_eq!(folders(&["a/map.yaml", "b/map.yaml"]).unwrap(), [Path::new("out/a"), Path::new("out/b")]);
        assert!(folders(&["x/a/map.yaml", "y/a/map.yaml"]).is_err());
    }
}
