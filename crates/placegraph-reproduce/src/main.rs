//! Repeats the experiments of Sect. 4.8 on the chapter's maps, and puts the results next to its figures.
//!
//! The chapter's setting is 100 rounds, temperature 1, 50 iterations and the corrections; the order of the decision list
//! is chosen on held-out training cells. The best setting chooses rounds and temperature likewise, and marks narrow
//! passages as doorways. No test cell has a part in any choice.

mod buildings;
mod data;
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

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, Result, bail};
use clap::Parser;
use placegraph::export::overview_png;
use placegraph::labels::LabelSet;
use placegraph::progress::Silent;

use self::buildings::{Building, CHAPTER, Source};
use self::experiment::Run;
use self::network::NetworkRun;
use self::plots::{Line, curves_svg};
use self::results::{Curve, Drawings, Point, Published, Results, compare, painted};
use self::settings::Settings;
use self::trial::{Made, Trial};

/// Folder of the pictures, next to the page.
const PICTURES: &str = "results";
/// What people write about a run. The page points to it where it is there; it is never written.
const REMARKS: &str = "results-remarks.md";

/// Runs the chapter's experiments on its maps and sets the figures side by side.
#[derive(Debug, Parser)]
#[command(version, about)]
struct Arguments {
    /// Folder with the maps: `fr79_slam`, `fr52_slam` and `sdr_b_slam`, each with `map.yaml`, its image and `labels.png`. Without it, where they come from
    data: Option<PathBuf>,
    /// Folder for `results.md`, `results.json` and the pictures in `results/`; the page links to your own
    /// `results-remarks.md`, if that is there
    #[arg(short, long, value_name = "DIR", default_value = "reproduction")]
    out: PathBuf,
}

/// Files by name.
type Files = Vec<(String, Vec<u8>)>;

/// Makes all experiments and writes page, numbers and pictures.
fn main() -> Result<()> {
    let args = Arguments::parse();
    let Some(data) = args.data else {
        say(&data::guide(Path::new("")));
        return Ok(());
    };
    if let Some(absent) = data::FILES.iter().find(|file| !data.join(file.path).is_file()) {
        say(&data::guide(&data));
        bail!("expected the chapter's maps in {}, {} is missing", data.display(), absent.path);
    }
    let buildings = load(&data, &CHAPTER)?;
    let (results, pictures) = reproduce(&buildings, &Settings::default())?;
    write(&results, pictures, &args.out)?;
    say(&format!("the experiments are in {}", args.out.join("results.md").display()));
    Ok(())
}

fn load(data: &Path, [b79, b52, sdr]: &[Source; 3]) -> Result<[Building; 3]> {
    Ok([Building::load(data, b79)?, Building::load(data, b52)?, Building::load(data, sdr)?])
}

/// Writes the pictures, then the page that shows them.
fn write(results: &Results, pictures: Files, folder: &Path) -> Result<()> {
    let remarks = folder.join(REMARKS).is_file().then_some(REMARKS);
    let page = page::page(results, remarks).into_bytes();
    let numbers = format!("{}\n", serde_json::to_string_pretty(results)?).into_bytes();
    write_files(&folder.join(PICTURES), pictures)?;
    write_files(folder, vec![("results.md".to_owned(), page), ("results.json".to_owned(), numbers)])
}

fn write_files(folder: &Path, files: Files) -> Result<()> {
    let could_not = |path: &Path| format!("could not write {}", path.display());
    fs::create_dir_all(folder).with_context(|| could_not(folder))?;
    for (name, bytes) in files {
        let path = folder.join(name);
        fs::write(&path, bytes).with_context(|| could_not(&path))?;
    }
    Ok(())
}

#[expect(clippy::print_stderr, reason = "a program that takes minutes says where it is")]
fn say(message: &str) {
    eprintln!("{message}");
}

/// All experiments, and the pictures of their maps and curves.
fn reproduce(buildings: &[Building; 3], settings: &Settings) -> Result<(Results, Files)> {
    let mut pictures = Files::new();
    let [b79, ..] = buildings;
    let mut made = Vec::new();
    let trials = trial::trials(buildings, settings);
    let mut steps = Steps { n_in_all: trials.len() + 3, n_begun: 0 };
    for trial in &trials {
        let one = steps.step(trial.title, || trial.make(&Silent))?;
        add_pictures(&mut pictures, trial, &one)?;
        let points =
            stages::iterations(&one.chapter, &trial.test.map.grid, &one.truth, &settings.iterations_curve)?;
        made.push((one, Curve { title: trial.test.title, points }));
    }
    let Made { chapter, best, .. } = &made[0].0;
    let trained = [&chapter.trained, &best.trained];
    let orders = steps.step("Table 4.1", || orders::orders(b79, trained, settings, &Silent))?;
    let features = orders::most_informative(&chapter.trained);
    let networks = steps.step("networks", || networks(b79, settings))?;
    for (number, run) in networks.iter().enumerate() {
        add_network_pictures(&mut pictures, number, run)?;
    }
    let pairs = steps.step("pairs of buildings", || trial::pairs(buildings, settings, &Silent))?;
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
    pictures.push(("rounds.svg".to_owned(), rounds_svg(&results)?.into_bytes()));
    pictures.push(("iterations.svg".to_owned(), iterations_svg(&results)?.into_bytes()));
    Ok((results, pictures))
}

/// The experiments in turn: each is named with the time that it took.
struct Steps {
    n_in_all: usize,
    n_begun: usize,
}

impl Steps {
    fn step<T>(&mut self, what: &str, work: impl FnOnce() -> Result<T>) -> Result<T> {
        self.n_begun += 1;
        let begun = Instant::now();
        let done = work();
        let seconds = begun.elapsed().as_secs_f64();
        say(&format!("{}/{} {what}: {seconds:.1} s", self.n_begun, self.n_in_all));
        done
    }
}

/// The networks of Sect. 4.8.3: the chapter's on its cells, then the best setting on every cell.
fn networks(building: &Building, settings: &Settings) -> Result<Vec<NetworkRun>> {
    let chapter = Settings::chapter_network();
    let printed = Settings::printed_network();
    let stride = settings.network_stride;
    Ok(vec![
        network::network(building, "distances alone", stride, &chapter, &Silent),
        network::network(building, "distances alone, features weighed as printed", stride, &printed, &Silent),
        network::on_a_list(building, "distances and a decision list", &settings.best_network(), &Silent)?,
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
fn add_pictures(pictures: &mut Files, trial: &Trial<'_>, made: &Made) -> Result<()> {
    let (map, first) = (&trial.test.map.grid, trial.first);
    let mut add = |name: &str, png: Vec<u8>| pictures.push((format!("{}-{name}.png", made.result.id), png));
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

fn add_network_pictures(pictures: &mut Files, number: usize, run: &NetworkRun) -> Result<()> {
    let (map, split) = (&run.map.grid, run.split);
    let truth = buildings::from_column(split, &run.map.labels);
    pictures.push((format!("network-{}.png", number + 1), pictures::labels_png(map, &run.found, split)?));
    let errors = pictures::errors_png(map, &run.found, &truth, split)?;
    pictures.push((format!("network-{}-errors.png", number + 1), errors));
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
