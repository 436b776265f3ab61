//! `placegraph map`: labels, regions and the topological map of one or many maps.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use placegraph::export::{
    MapInfo, TopologyDocument, label_png, overview_png, probability_npy, raster_yaml, region_png,
};
use placegraph::import::{LoadedMap, check};
use placegraph::pipeline::{self, Analysis, Correction, Doorways};

use super::Outcome;
use crate::args::MapArgs;
use crate::model::NamedModel;
use crate::output::{OutputSet, complain};
use crate::progress::Watch;
use crate::read;

/// Labels every map; with several, one that fails does not stop the rest.
pub(crate) fn run(args: &MapArgs, verbose: bool) -> Result<Outcome> {
    let model = NamedModel::load(args.model.as_deref())?;
    model.check_method(args.method)?;
    let folders = output_folders(&args.maps, &args.out)?;
    if let ([map], [folder]) = (args.maps.as_slice(), folders.as_slice()) {
        label(map, folder, &model, args, verbose)?;
        return Ok(Outcome::Done);
    }
    let mut n_failed = 0;
    for (map, folder) in args.maps.iter().zip(&folders) {
        if let Err(error) = label(map, folder, &model, args, verbose) {
            n_failed += 1;
            complain(&format!("error: {}: {error:#}", map.display()));
        }
    }
    ensure!(n_failed < args.maps.len(), "none of the {n_failed} maps could be labeled");
    Ok(if n_failed == 0 { Outcome::Done } else { Outcome::CheckFailed })
}

/// One folder a map: `out` for a single map, else a folder in it by file stem, with the parent folder's name
/// where stems repeat.
fn output_folders(maps: &[PathBuf], out: &Path) -> Result<Vec<PathBuf>> {
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

/// Reads, labels and writes one map.
fn label(path: &Path, folder: &Path, model: &NamedModel, args: &MapArgs, verbose: bool) -> Result<()> {
    let map = read::map(path, &args.read)?;
    let findings = check(&map).findings;
    for finding in &findings {
        complain(&format!("{}: {finding}", path.display()));
    }
    let watch = Watch::start(&map.name);
    let config = pipeline::Config {
        doorways: if args.no_doorways { Doorways::Skip } else { Doorways::Mark },
        correction: if args.no_correction { Correction::Skip } else { Correction::Apply },
    };
    let analysis = pipeline::analyze(&map.grid, &model.model, &config, &watch);
    let timings = watch.finish();
    let mut document = TopologyDocument::new(
        MapInfo::of(&map.grid, &map.name, &map.hash),
        Some(model.info()),
        &model.model.label_set,
        &analysis.topology,
    );
    document.findings = findings.iter().map(ToString::to_string).collect();
    document.timings_ms =
        timings.iter().map(|(stage, time)| (stage.name().to_owned(), time.as_secs_f64() * 1e3)).collect();
    let written = files(&map, &analysis, &document, model, args)?.commit(folder)?;
    if verbose {
        for (stage, time) in &timings {
            complain(&format!("{:<10} {:>8.1} ms", stage.name(), time.as_secs_f64() * 1e3));
        }
    }
    summarize(path, &analysis, &written, folder);
    Ok(())
}

fn files(
    map: &LoadedMap,
    analysis: &Analysis,
    document: &TopologyDocument,
    model: &NamedModel,
    args: &MapArgs,
) -> Result<OutputSet> {
    let (graph, frame) = (&analysis.graph, &map.grid.frame);
    let mut files = OutputSet::default();
    if args.stages {
        files.add("labels.1-classified.png", label_png(graph, &analysis.classified.most_likely()));
        files.add("labels.2-smoothed.png", label_png(graph, &analysis.smoothed.most_likely()));
    }
    if args.probabilities {
        files.add("probabilities.npy", probability_npy(graph, &analysis.smoothed));
    }
    files.add("labels.png", label_png(graph, &analysis.labeling));
    files.add("labels.yaml", raster_yaml("labels.png", frame));
    files.add("regions.png", region_png(graph, &analysis.regions)?);
    files.add("regions.yaml", raster_yaml("regions.png", frame));
    files.add("topology.json", document.to_json()?);
    let label_set = &model.model.label_set;
    files.add(
        "overview.png",
        overview_png(&map.grid, &analysis.labeling, label_set, &analysis.topology, &map.name),
    );
    Ok(files)
}

/// One line a map, on standard error: results are in the files.
fn summarize(path: &Path, analysis: &Analysis, written: &[PathBuf], folder: &Path) {
    let mut count: BTreeMap<&str, usize> = BTreeMap::new();
    for place in &analysis.topology.places {
        *count.entry(place.class.as_str()).or_default() += 1;
    }
    let places: Vec<String> = count.iter().map(|(class, n)| format!("{n} {class}")).collect();
    complain(&format!(
        "{}: {}; {} connections; {} files in {}",
        path.display(),
        if places.is_empty() { "no place".to_owned() } else { places.join(", ") },
        analysis.topology.connections.len(),
        written.len(),
        folder.display()
    ));
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
