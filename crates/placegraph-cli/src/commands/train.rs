//! `placegraph train`: labeled maps to a model file.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use placegraph::features;
use placegraph::grid::{Cell, OccupancyGrid};
use placegraph::import::{self, LabelCell, LabelCoding, NamedFiles, ReadOptions, TrainingFile, has_memory};
use placegraph::labels::LabelSet;
use placegraph::training::{
    Choice, LabeledMap, ListReport, NetworkConfig, NetworkReport, TrainConfig, Trained, TrainedNetwork,
    TrainingReport, Validation, Window, train, train_network,
};

use super::Outcome;
use crate::args::{CropArg, FeaturesArg, MethodArg, TrainArgs};
use crate::output::{complain, print, print_json, write_file};
use crate::progress::Watch;
use crate::read;

/// Features that the report names.
const BEST_FEATURES: usize = 12;

/// Trains and writes a model, and tells how it went.
pub(crate) fn run(args: &TrainArgs, verbose: bool) -> Result<Outcome> {
    let (entries, label_set, coding) = what_to_train_on(args)?;
    let options = read::options(&args.read);
    let mut maps = Vec::new();
    let mut inputs: Vec<PathBuf> = args.manifest.iter().cloned().collect();
    for entry in &entries {
        let (map, files) = read_entry(entry, &coding, &options)?;
        maps.push(map);
        inputs.extend(files);
    }
    check_memory(
        &maps,
        &label_set,
        &if args.method == MethodArg::Iamn { network_config(args).base } else { config(args) },
    )?;
    let watch = Watch::start("training");
    let (model, report) = match args.method {
        MethodArg::Boosted => {
            let trained = train(&maps, &label_set, &config(args), &watch)?;
            let report = report(&trained, &label_set);
            (trained.model, report)
        }
        MethodArg::Iamn => {
            let trained = train_network(&maps, &label_set, &network_config(args), &watch)?;
            let report = network_report(&trained, &label_set);
            (trained.model, report)
        }
    };
    let timings = watch.finish();
    write_file(&args.output, &model.to_json(), &inputs)?;
    if verbose {
        for (stage, time) in timings {
            complain(&format!("{:<10} {:>8.1} ms", stage.name(), time.as_secs_f64() * 1e3));
        }
    }
    if args.json {
        print_json(&model.record)?;
    } else {
        print(&report)?;
    }
    Ok(Outcome::Done)
}

/// Memory that training takes at most for each example and feature: the table, and the columns sorted, twice while what is
/// held out is judged.
const BYTES_PER_VALUE: u64 = 16;
/// What it takes in addition.
const BASE_BYTES: u64 = 64 << 20;

/// Asks for the memory before it is needed: an allocation that fails would end the program without a word.
fn check_memory(maps: &[LabeledMap], label_set: &LabelSet, config: &TrainConfig) -> Result<()> {
    let mut n_cells = vec![0u64; label_set.len()];
    for (_, label) in maps.iter().flat_map(LabeledMap::labeled_cells) {
        n_cells[label.index()] += 1;
    }
    let most = config.max_cells_per_class.map_or(u64::MAX, |most| most.max(1) as u64);
    let n_taken: u64 = n_cells.into_iter().map(|n| n / n.div_ceil(most).max(1) + 1).sum();
    let n_values = n_taken * config.scales.len() as u64 * config.features.len() as u64;
    let n_bytes = BASE_BYTES.saturating_add(BYTES_PER_VALUE.saturating_mul(n_values));
    ensure!(
        has_memory(n_bytes),
        "not enough memory: training on {n_taken} cells needs {n_bytes} bytes; fewer cells of each class need less"
    );
    Ok(())
}

fn what_to_train_on(args: &TrainArgs) -> Result<(Vec<Entry>, LabelSet, LabelCoding)> {
    if let Some(path) = &args.manifest {
        return manifest(path);
    }
    let (Some(map), Some(labels)) = (&args.map, &args.labels) else {
        bail!("expected a training file, or --map with --labels");
    };
    let crop = args.crop.map(|CropArg { x0, y0, x1, y1 }| [x0, y0, x1, y1]);
    let entry = Entry { map: map.clone(), labels: labels.clone(), crop };
    let label_set = LabelSet::default();
    let coding = LabelCoding::of(&label_set);
    Ok((vec![entry], label_set, coding))
}

/// Reads a training file; the paths it names are relative to where it lies. Its author says what to train on, as the
/// arguments would: it may name any file.
fn manifest(path: &Path) -> Result<(Vec<Entry>, LabelSet, LabelCoding)> {
    let in_file = || format!("in {}", path.display());
    let file = TrainingFile::from_toml(&read::text(path, "training file")?).with_context(in_file)?;
    let entries = file.maps.iter().map(|entry| -> Result<Entry> {
        let named = |name| {
            import::named_file(path, name, NamedFiles::Anywhere)
                .with_context(in_file)
                .with_context(|| name.to_owned())
        };
        Ok(Entry { map: named(&entry.map)?, labels: named(&entry.labels)?, crop: entry.crop })
    });
    Ok((entries.collect::<Result<_>>()?, file.classes, file.coding))
}

/// A map to train on.
#[derive(Debug)]
pub(super) struct Entry {
    /// The map.
    pub(super) map: PathBuf,
    /// Its labels.
    pub(super) labels: PathBuf,
    /// The pixels to train on: x0, y0, x1, y1.
    pub(super) crop: Option<[u32; 4]>,
}

/// Reads a map and its labels; also returns the files that they were read from.
fn read_entry(
    entry: &Entry,
    coding: &LabelCoding,
    options: &ReadOptions,
) -> Result<(LabeledMap, Vec<PathBuf>)> {
    let map = read::load(&entry.map, options)?;
    let size = (map.grid.cells.width(), map.grid.cells.height());
    let in_labels = || format!("in the labels {}", entry.labels.display());
    let bytes = read::image(&entry.labels, options.max_cells)?;
    let labels = import::read_labels(&bytes, size, coding).with_context(in_labels)?;
    let window =
        entry.crop.map(|crop| window(crop, &map.grid)).transpose().with_context(|| map.name.clone())?;
    let files = map.files.into_iter().chain([entry.labels.clone()]).collect();
    let map = LabeledMap {
        name: map.name,
        grid: map.grid,
        labels: labels.map(|cell| match cell {
            LabelCell::Class(label) => Some(*label),
            LabelCell::None | LabelCell::Ignore => None,
        }),
        window,
    };
    Ok((map, files))
}

/// Pixels, y down, to cells, y up.
fn window([x0, y0, x1, y1]: [u32; 4], map: &OccupancyGrid) -> Result<Window> {
    let (width, height) = (map.cells.width(), map.cells.height());
    if x0 >= x1 || y0 >= y1 || x1 > width || y1 > height {
        bail!("expected a crop x0,y0,x1,y1 inside {width} x {height} pixels, found {x0},{y0},{x1},{y1}");
    }
    Ok(Window { min: Cell::new(x0, height - y1), end: Cell::new(x1, height - y0) })
}

fn config(args: &TrainArgs) -> TrainConfig {
    let config = if args.chapter { TrainConfig::chapter() } else { TrainConfig::default() };
    with_arguments(config, args)
}

fn network_config(args: &TrainArgs) -> NetworkConfig {
    let config = if args.chapter { NetworkConfig::chapter() } else { NetworkConfig::default() };
    NetworkConfig { base: with_arguments(config.base, args), ..config }
}

fn with_arguments(mut config: TrainConfig, args: &TrainArgs) -> TrainConfig {
    if let Some(set) = args.features {
        config.features = match set {
            FeaturesArg::All => features::all(),
            FeaturesArg::Freiburg203 => features::freiburg203(),
            FeaturesArg::Chapter183 => features::chapter183(),
            FeaturesArg::Old152 => features::old152(),
            FeaturesArg::Lean120 => features::lean120(),
        };
    }
    if let Some(rounds) = args.rounds {
        config.rounds = Choice::Set(rounds);
    }
    if let Some(temperature) = args.temperature {
        config.temperature = Choice::Set(temperature);
    }
    if let Some(scales) = &args.scales {
        config.scales.clone_from(scales);
    }
    config.scan.max_speck_m = args.max_speck.unwrap_or(config.scan.max_speck_m);
    config.max_cells_per_class = args.max_cells_per_class.or(config.max_cells_per_class);
    config
}

fn report(trained: &Trained, label_set: &LabelSet) -> String {
    let TrainingReport { n_examples, validation, training_error, votes } = &trained.report;
    let mut text = String::new();
    let classes = || label_set.classes().iter().map(|class| class.name.as_str());
    let examples: Vec<String> = classes().zip(n_examples).map(|(name, n)| format!("{n} {name}")).collect();
    // Writing to a string cannot fail.
    let _ = writeln!(text, "examples: {}", examples.join(", "));
    let _ = writeln!(text, "wrong on the training cells: {:.2} %", training_error * 100.0);
    if let Some(validation) = validation {
        text += &orders(validation, label_set);
    }
    let _ = writeln!(text, "features that say most (sum of alpha per class):");
    for vote in votes.iter().take(BEST_FEATURES) {
        let alphas: Vec<String> =
            classes().zip(&vote.alpha).map(|(name, alpha)| format!("{name} {alpha:.2}")).collect();
        let _ = writeln!(text, "  {:<8} {}", vote.feature.feature().name, alphas.join("  "));
    }
    text
}

fn orders(validation: &Validation, label_set: &LabelSet) -> String {
    let mut text = String::new();
    let _ = writeln!(
        text,
        "held out in {} parts: {} rounds, temperature {}, mean -ln p {:.4}",
        validation.n_folds, validation.n_rounds, validation.temperature, validation.log_loss
    );
    let _ = writeln!(text, "orders of the decision list, on held-out cells:");
    for order in &validation.orders {
        let names: Vec<&str> =
            order.order.iter().map(|&label| label_set.class(label).name.as_str()).collect();
        let _ = writeln!(
            text,
            "  {:6.2} %  macro-F1 {:.3}  {}",
            order.accuracy * 100.0,
            order.macro_f1,
            names.join("-")
        );
    }
    text
}

fn network_report(trained: &TrainedNetwork, label_set: &LabelSet) -> String {
    let NetworkReport { n_cells, list, network } = &trained.report;
    let mut text = String::new();
    let cells: Vec<String> =
        label_set.classes().iter().zip(n_cells).map(|(class, n)| format!("{n} {}", class.name)).collect();
    let _ = writeln!(text, "cells: {}", cells.join(", "));
    if let Some(ListReport { validation: Some(validation), .. }) = list {
        text += &orders(validation, label_set);
    }
    let _ = writeln!(text, "network, on held-out blocks:");
    let tried = trained.model.record.network.clone().unwrap_or_default();
    for choice in &tried.choices {
        let _ = writeln!(
            text,
            "  {:6.2} %  macro-F1 {:.3}  M {}, C {}",
            choice.accuracy * 100.0,
            choice.macro_f1,
            choice.n_neighbors,
            choice.cost
        );
    }
    let _ = writeln!(text, "taken: M {}, C {}", tried.n_neighbors, tried.cost);
    let _ =
        writeln!(text, "wrong on the training cells: {:.2} %", trained.model.record.training_error * 100.0);
    let features: Vec<&str> =
        network.selection.chosen.iter().map(|chosen| chosen.feature.feature().name.as_str()).collect();
    let _ = writeln!(text, "features that distances are computed from: {}", features.join(" "));
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crop_counts_rows_from_the_top() {
        let map = OccupancyGrid::from_ascii(1.0, "..\n..\n..");
        let window = window([0, 0, 2, 1], &map).unwrap();
        assert!(window.contains(Cell::new(0, 2)) && !window.contains(Cell::new(0, 1)));
        assert!(super::window([0, 0, 3, 1], &map).is_err());
    }
}
