//! `placegraph train`: labeled maps to a model file.

mod page;
mod words;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use placegraph::features;
use placegraph::grid::{Cell, OccupancyGrid};
use placegraph::import::{self, LabelCoding, LabelTarget, NamedFiles, ReadOptions, TrainingFile, has_memory};
use placegraph::labels::{Label, LabelSet};
use placegraph::learning::learn;
use placegraph::training::{
    Choice, HoldOut, LabeledMap, NetworkConfig, TrainConfig, Window, train, train_network,
};

use placegraph_generate::{Mapping, Options, Style, generate};
use rayon::prelude::*;

use super::Outcome;
use crate::args::{CropArg, FeaturesArg, HoldOutArg, MethodArg, TrainArgs};
use crate::classes::{self, Classes};
use crate::model::NamedModel;
use crate::output::{complain, print, print_json, write_file};
use crate::progress::Watch;
use crate::read;

/// Cells of a class to go on from a model with.
const BASE_CELLS_PER_CLASS: usize = 20_000;

/// Trains and writes a model, and prints a report.
pub(crate) fn run(args: &TrainArgs, verbose: bool) -> Result<Outcome> {
    let (entries, Classes { label_set, coding }) = what_to_train_on(args)?;
    let options = read::options(&args.read);
    let mut maps = Vec::new();
    let mut inputs: Vec<PathBuf> = args.manifest.iter().cloned().collect();
    for entry in &entries {
        let (map, files) = read_entry(entry, &coding, &options)?;
        maps.push(map);
        inputs.extend(files);
    }
    let config = match args.method {
        MethodArg::Boosted => config(args)?,
        MethodArg::Iamn => {
            ensure!(
                args.base.is_none() && args.report.is_none(),
                "--base and --report are for the method boosted, not for iamn"
            );
            network_config(args).base
        }
    };
    if args.base.as_ref().is_some_and(|base| base.as_os_str() == "default") {
        maps.extend(rehearsal());
    }
    let n_examples = n_examples(&maps, &label_set, &config);
    check_memory(n_examples, &config)?;
    complain(&announcement(n_examples, label_set.len(), &config));
    let watch = Watch::with_lines("training");
    let (model, report) = match args.method {
        MethodArg::Boosted => {
            // The chapter has no stage for doorways.
            let learn = if args.chapter { train } else { learn };
            let trained = learn(&maps, &label_set, &config, &watch)?;
            let report = words::boosted(&trained, &maps, &label_set);
            if let Some(path) = &args.report {
                let page = page::html(&trained.report, &maps, &label_set);
                write_file(path, page.as_bytes(), &inputs)?;
            }
            (trained.model, report)
        }
        MethodArg::Iamn => {
            let trained = train_network(&maps, &label_set, &network_config(args), &watch)?;
            let report = words::network(&trained, &maps, &label_set);
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

/// Generated buildings like those that the default model learned from, by the same seeds: a model that goes on learning from a few maps
/// alone forgets the rest (`docs/training.md` has the figures).
fn rehearsal() -> Vec<LabeledMap> {
    const N: u64 = 8;
    let sources = [(11, Mapping::Slam), (12, Mapping::Clean), (13, Mapping::Furnished)];
    let numbered: Vec<(u64, Mapping, u64)> =
        sources.iter().flat_map(|&(seed, mapping)| (0..N).map(move |index| (seed, mapping, index))).collect();
    let made = |(seed, mapping, index): (u64, Mapping, u64)| {
        let building = generate(Style::Mixed, seed, index, &Options { mapping, resolution_m: None });
        // 255 is ambiguous.
        let labels = building.labels.map(|&value| value.checked_sub(1).filter(|&k| k < 3).map(Label));
        let name = format!("generated_{seed}_{index:03}");
        LabeledMap { name, grid: building.map, labels, window: None, building: None }
    };
    numbered.into_par_iter().map(made).collect()
}

/// Memory that training takes at most for each example and feature: the table, and the columns sorted, twice while what is
/// held out is judged.
const BYTES_PER_VALUE: u64 = 16;
/// What it takes in addition.
const BASE_BYTES: u64 = 64 << 20;

/// Seconds of one core that features take for each value, and boosting for each value and round, four classes at once. Measured
/// (`docs/training.md`); other machines differ by a factor of two or three.
const FEATURE_S: f64 = 1.5e-6;
const ROUND_S: f64 = 1.3e-9;

/// Examples that training learns from at most.
fn n_examples(maps: &[LabeledMap], label_set: &LabelSet, config: &TrainConfig) -> u64 {
    let mut n_cells = vec![0u64; label_set.len()];
    for (_, label) in maps.iter().flat_map(LabeledMap::labeled_cells) {
        n_cells[label.index()] += 1;
    }
    let most = config.max_cells_per_class.map_or(u64::MAX, |most| most.max(1) as u64);
    let n_taken: u64 = n_cells.into_iter().map(|n| n / n.div_ceil(most).max(1) + 1).sum();
    n_taken * config.scales.len() as u64
}

/// Asks for the memory before it is needed: an allocation that fails would end the program without a word.
fn check_memory(n_examples: u64, config: &TrainConfig) -> Result<()> {
    let n_values = n_examples * config.features.len() as u64;
    let n_bytes = BASE_BYTES.saturating_add(BYTES_PER_VALUE.saturating_mul(n_values));
    ensure!(
        has_memory(n_bytes),
        "not enough memory: training on {n_examples} examples needs {n_bytes} bytes; fewer cells of each class need less"
    );
    Ok(())
}

/// What will be done, and about how long it takes.
fn announcement(n_examples: u64, n_classes: usize, config: &TrainConfig) -> String {
    let n_values = (n_examples * config.features.len() as u64) as f64;
    let most_rounds = config.rounds.candidates().iter().copied().max().unwrap_or(0) as f64;
    // Every fold leaves its part out; the last run has all examples. A report trains on a quarter and a half too.
    let runs = config.n_folds as f64 * (if config.learning_curve { 1.75 } else { 1.0 });
    let rounds = most_rounds * runs * n_classes.div_ceil(4) as f64;
    let seconds = n_values * (FEATURE_S + ROUND_S * rounds) / rayon::current_num_threads() as f64;
    let time = match seconds {
        ..90.0 => format!("{:.0} s", seconds.max(1.0)),
        _ => format!("{:.0} min", seconds / 60.0),
    };
    format!(
        "training on {n_examples} examples with {} features; about {time} on {} threads",
        config.features.len(),
        rayon::current_num_threads()
    )
}

fn what_to_train_on(args: &TrainArgs) -> Result<(Vec<Entry>, Classes)> {
    if let Some(path) = &args.manifest {
        return manifest(path);
    }
    let (Some(map), Some(labels)) = (&args.map, &args.labels) else {
        bail!("expected a training file, or --map with --labels");
    };
    let crop = args.crop.map(|CropArg { x0, y0, x1, y1 }| [x0, y0, x1, y1]);
    let entry = Entry { map: map.clone(), labels: labels.clone(), crop, building: None };
    Ok((vec![entry], Classes::of(args.classes.as_deref(), labels)?))
}

/// Reads a training file; the paths it names are relative to where it lies. Its author says what to train on, as the
/// arguments would: it may name any file.
fn manifest(path: &Path) -> Result<(Vec<Entry>, Classes)> {
    let in_file = || format!("in {}", path.display());
    let file = TrainingFile::from_toml(&read::text(path, "training file")?).with_context(in_file)?;
    let entries = file.maps.iter().map(|entry| -> Result<Entry> {
        let named = |name| {
            import::named_file(path, name, NamedFiles::Anywhere)
                .with_context(in_file)
                .with_context(|| name.to_owned())
        };
        let (map, labels) = (named(&entry.map)?, named(&entry.labels)?);
        Ok(Entry { map, labels, crop: entry.crop, building: entry.building.clone() })
    });
    let TrainingFile { classes: label_set, coding, .. } = &file;
    let classes = Classes { label_set: label_set.clone(), coding: coding.clone() };
    Ok((entries.collect::<Result<_>>()?, classes))
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
    /// The building that it shows.
    pub(super) building: Option<String>,
}

/// Reads a map and its labels; also returns the files that they were read from.
fn read_entry(
    entry: &Entry,
    coding: &LabelCoding,
    options: &ReadOptions,
) -> Result<(LabeledMap, Vec<PathBuf>)> {
    let map = read::load(&entry.map, options)?;
    let target = LabelTarget::of(&map.name, &map.grid, coding);
    let labels = classes::labels(&entry.labels, options.max_cells, &target)?;
    let window =
        entry.crop.map(|crop| window(crop, &map.grid)).transpose().with_context(|| map.name.clone())?;
    let files = map.files.into_iter().chain([entry.labels.clone()]).collect();
    let map = LabeledMap {
        name: map.name,
        grid: map.grid,
        labels: labels.map(|cell| cell.class()),
        window,
        building: entry.building.clone(),
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

fn config(args: &TrainArgs) -> Result<TrainConfig> {
    let config = match &args.base {
        Some(base) => {
            let path = (base.as_os_str() != "default").then_some(base.as_path());
            let config = TrainConfig::from_base(NamedModel::load(path)?.model);
            // Some of the cells are those of the rehearsal.
            TrainConfig { max_cells_per_class: Some(BASE_CELLS_PER_CLASS), scales: vec![1.0], ..config }
        }
        None if args.chapter => TrainConfig::chapter(),
        None => TrainConfig::default(),
    };
    Ok(with_arguments(config, args))
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
    if let Some(HoldOutArg::Blocks) = args.hold_out {
        config.hold_out = HoldOut::Blocks;
    }
    config.learning_curve = args.report.is_some();
    config.scan.max_speck_m = args.max_speck.unwrap_or(config.scan.max_speck_m);
    config.max_cells_per_class = args.max_cells_per_class.or(config.max_cells_per_class);
    config
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
