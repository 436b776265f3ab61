//! `placegraph reproduce`: the experiments of Sect. 4.8 on the maps that the chapter names, beside its figures.
//!
//! The chapter's setting is 100 rounds, temperature 1, 50 iterations and the corrections; the order of the decision list
//! is chosen on held-out training cells. The best setting chooses rounds and temperature likewise, and marks narrow
//! passages as doorways. No test cell has a part in any choice.

mod buildings;
mod errors;
mod experiment;
mod markdown;
mod network;
mod orders;
mod page;
mod pictures;
mod plots;
mod results;
mod sections;
mod settings;
mod stages;
#[cfg(test)]
mod tests;
mod trial;

use std::path::Path;

use anyhow::{Result, ensure};
use placegraph::export::overview_png;
use placegraph::labels::LabelSet;

use self::buildings::{Building, CHAPTER, Source};
use self::experiment::Run;
use self::network::NetworkRun;
use self::plots::{Line, curves_svg};
use self::results::{Curve, Drawings, Point, Published, Results, compare, painted};
use self::settings::Settings;
use self::trial::{Made, Trial};
use super::Outcome;
use crate::args::ReproduceArgs;
use crate::output::{OutputSet, complain};
use crate::progress::Watch;

/// Folder of the pictures, beside the page.
const PICTURES: &str = "results";
/// What people write about a run. The page points to it where it is there; it is never written.
const REMARKS: &str = "results-remarks.md";

/// Makes all experiments and writes page, numbers and pictures.
pub(crate) fn run(args: &ReproduceArgs, verbose: bool) -> Result<Outcome> {
    ensure!(
        args.data.is_dir(),
        "expected a folder with the chapter's maps, found no folder {}",
        args.data.display()
    );
    let buildings = load(&args.data, &CHAPTER)?;
    let (results, pictures) = reproduce(&buildings, &Settings::default(), verbose)?;
    write(&results, pictures, &args.out)?;
    complain(&format!("the experiments are in {}", args.out.join("results.md").display()));
    Ok(Outcome::Done)
}

fn load(data: &Path, [b79, b52, sdr]: &[Source; 3]) -> Result<[Building; 3]> {
    Ok([Building::load(data, b79)?, Building::load(data, b52)?, Building::load(data, sdr)?])
}

/// Writes the pictures, then the page that shows them.
fn write(results: &Results, pictures: OutputSet, folder: &Path) -> Result<()> {
    pictures.commit(&folder.join(PICTURES))?;
    let mut pages = OutputSet::default();
    let remarks = folder.join(REMARKS).is_file().then_some(REMARKS);
    pages.add("results.md", page::page(results, remarks));
    pages.add("results.json", format!("{}\n", serde_json::to_string_pretty(results)?));
    pages.commit(folder)?;
    Ok(())
}

/// All experiments, and the pictures of their maps and curves.
fn reproduce(buildings: &[Building; 3], settings: &Settings, verbose: bool) -> Result<(Results, OutputSet)> {
    let mut pictures = OutputSet::default();
    let [b79, ..] = buildings;
    let mut made = Vec::new();
    let trials = trial::trials(buildings, settings);
    let mut steps = Steps { n_in_all: trials.len() + 3, n_begun: 0, verbose };
    for trial in &trials {
        let one = steps.step(trial.title, |watch| trial.make(watch))?;
        add_pictures(&mut pictures, trial, &one)?;
        let points =
            stages::iterations(&one.chapter, &trial.test.map.grid, &one.truth, &settings.iterations_curve)?;
        made.push((one, Curve { title: trial.test.title, points }));
    }
    let Made { chapter, best, .. } = &made[0].0;
    let trained = [&chapter.trained, &best.trained];
    let orders = steps.step("Table 4.1", |watch| orders::orders(b79, trained, settings, watch))?;
    let features = orders::most_informative(&chapter.trained);
    let networks = steps.step("networks", |watch| networks(b79, settings, watch))?;
    for (number, run) in networks.iter().enumerate() {
        add_network_pictures(&mut pictures, number, run)?;
    }
    let pairs = steps.step("pairs of buildings", |watch| trial::pairs(buildings, settings, watch))?;
    let (made, iterations): (Vec<Made>, Vec<Curve>) = made.into_iter().unzip();
    let results = Results {
        version: env!("CARGO_PKG_VERSION"),
        settings: settings.clone(),
        experiments: made.into_iter().map(|made| made.result).collect(),
        networks: networks.into_iter().map(|run| run.result).collect(),
        orders: orders.table,
        rounds: orders.rounds,
        iterations,
        features,
        pairs,
        drawings: drawings(buildings),
    };
    pictures.add("rounds.svg", rounds_svg(&results)?);
    pictures.add("iterations.svg", iterations_svg(&results)?);
    Ok((results, pictures))
}

/// The experiments in turn, each under a progress bar that tells how many there are.
struct Steps {
    n_in_all: usize,
    n_begun: usize,
    verbose: bool,
}

impl Steps {
    fn step<T>(&mut self, what: &str, work: impl FnOnce(&Watch) -> Result<T>) -> Result<T> {
        self.n_begun += 1;
        let watch = Watch::start(&format!("{}/{} {what}", self.n_begun, self.n_in_all));
        let done = work(&watch);
        let stages = watch.finish();
        if self.verbose {
            let seconds: f64 = stages.iter().map(|(_, time)| time.as_secs_f64()).sum();
            complain(&format!("{what}: {seconds:.1} s"));
        }
        done
    }
}

/// The networks of Sect. 4.8.3: the chapter's on its cells, then the best setting on every cell.
fn networks(building: &Building, settings: &Settings, watch: &Watch) -> Result<Vec<NetworkRun>> {
    let chapter = Settings::chapter_network();
    let printed = Settings::printed_network();
    let stride = settings.network_stride;
    Ok(vec![
        network::network(building, "distances alone", stride, &chapter, watch),
        network::network(building, "distances alone, features weighed as printed", stride, &printed, watch),
        network::on_a_list(building, "distances and a decision list", &settings.best_network(), watch)?,
    ])
}

/// The second drawings, judged as if they were found.
fn drawings(buildings: &[Building; 3]) -> Vec<Drawings> {
    let judged = buildings.iter().filter_map(|building| {
        let second = building.second_drawing.as_ref()?;
        // Cells that the second drawing leaves open say nothing.
        let mut truth = building.map.labels.clone();
        for (label, other) in truth.values_mut().iter_mut().zip(second.values()) {
            *label = label.filter(|_| other.is_some());
        }
        Some(Drawings { title: building.title, scores: compare(second, &truth) })
    });
    judged.collect()
}

/// What figures 4.7 to 4.10 show: drawn labels, list, relaxed, corrected, the topological map; and the errors.
fn add_pictures(pictures: &mut OutputSet, trial: &Trial<'_>, made: &Made) -> Result<()> {
    let (map, first) = (&trial.test.map.grid, trial.first);
    let mut add = |name: &str, png: Vec<u8>| pictures.add(format!("{}-{name}.png", made.result.id), png);
    let labels = |run: &Run, labeling: &[_]| painted(&map.cells, run.analysis.space.graph.cells(), labeling);
    let png = |run: &Run, labeling: &[_]| pictures::labels_png(map, &labels(run, labeling), first);

    add("drawn", pictures::drawn_png(map, &trial.test.map.labels, first)?);
    let chapter = &made.chapter;
    add("1-list", png(chapter, &chapter.analysis.classified)?);
    add("2-relaxed", png(chapter, &chapter.analysis.smoothed.most_likely())?);
    add("3-corrected", png(chapter, &chapter.analysis.labeling)?);
    add("best", png(&made.best, &made.best.analysis.labeling)?);
    for (name, run) in [("errors", chapter), ("best-errors", &made.best)] {
        let found = labels(run, &run.analysis.labeling);
        add(name, pictures::errors_png(map, &found, &made.truth, first)?);
    }
    for (name, run) in [("topology", chapter), ("best-topology", &made.best)] {
        let analysis = &run.analysis;
        let label_set = LabelSet::default();
        let png = overview_png(map, &analysis.labeling, &label_set, &analysis.topology, trial.title);
        add(name, pictures::halved_png(&png)?);
    }
    Ok(())
}

fn add_network_pictures(pictures: &mut OutputSet, number: usize, run: &NetworkRun) -> Result<()> {
    let (map, split) = (&run.map.grid, run.split);
    let truth = buildings::from_column(split, &run.map.labels);
    pictures.add(format!("network-{}.png", number + 1), pictures::labels_png(map, &run.found, split)?);
    let errors = pictures::errors_png(map, &run.found, &truth, split)?;
    pictures.add(format!("network-{}-errors.png", number + 1), errors);
    Ok(())
}

fn line(name: &str, points: &[Point]) -> Line {
    let point = |point: &Point| Some((point.at as f64, 100.0 * point.scores.accuracy?));
    Line { name: name.to_owned(), points: points.iter().filter_map(point).collect() }
}

/// A figure of the chapter as a level over the range of `points`.
fn level(name: String, value: f64, points: &[Point]) -> Line {
    let ends = [points.first(), points.last()];
    Line { name, points: ends.into_iter().flatten().map(|point| (point.at as f64, value)).collect() }
}

fn rounds_svg(results: &Results) -> Result<String> {
    let Published { list, .. } = results.experiments[0].published;
    let lines = [
        line("building 79, right part", &results.rounds),
        level(format!("the chapter: {list} %"), list, &results.rounds),
    ];
    curves_svg("The decision list after T rounds of boosting", "rounds T", &lines)
}

fn iterations_svg(results: &Results) -> Result<String> {
    let lines: Vec<Line> = results.iterations.iter().map(|curve| line(curve.title, &curve.points)).collect();
    curves_svg("Relaxation labeling", "iterations", &lines)
}
