//! What must not change a result: turning, mirroring, padding and refining the map, naming the classes in another
//! order, correcting again, writing and reading, the number of threads. Over generated buildings; figures are in
//! `docs/reliability.md`.

use std::env;

use placegraph::boost::DecisionList;
use placegraph::export::{MapInfo, TopologyDocument, label_png};
use placegraph::features::{self, Job, evaluate};
use placegraph::geom::Pose2;
use placegraph::grid::{Cell, CellGraph, Grid, MapFrame, Occupancy, OccupancyGrid};
use placegraph::import::{LabelCell, LabelCoding, read_labels};
use placegraph::labels::{Label, LabelSet, Labeling};
use placegraph::model::{BoostedModel, Method, Model};
use placegraph::pipeline::{Analysis, Config, analyze, classify};
use placegraph::progress::Silent;
use placegraph::regions::{DiagonalSteps, connected, correct};
use placegraph::relax::Compatibility;
use placegraph::scan::{Instructions, ScanConfig};
use placegraph_generate::{Mapping, Options, Style, generate};

/// The model inside the program.
fn model() -> Model {
    Model::builtin()
}

/// So many buildings, or as many as `PLACEGRAPH_BUILDINGS` says.
fn buildings(n: u64) -> Vec<OccupancyGrid> {
    let n = env::var("PLACEGRAPH_BUILDINGS").ok().map_or(n, |n| n.parse().unwrap());
    let options = Options { mapping: Mapping::Mixed, resolution_m: Some(0.1) };
    let style = |index: u64| if index.is_multiple_of(4) { Style::Office } else { Style::Home };
    (0..n).map(|index| generate(style(index), 77, index, &options).map).collect()
}

fn run(map: &OccupancyGrid, model: &Model) -> Analysis {
    analyze(map, model, &Config::default(), &Silent)
}

/// A grid turned counter-clockwise by a quarter.
fn turned<T: Clone>(grid: &Grid<T>) -> Grid<T> {
    let (width, height) = (grid.height(), grid.width());
    let from = |x: u32, y: u32| grid[Cell::new(y, grid.height() - 1 - x)].clone();
    Grid::from_rows(width, height, (0..height).flat_map(|y| (0..width).map(move |x| from(x, y))).collect())
}

/// A grid mirrored left to right.
fn mirrored<T: Clone>(grid: &Grid<T>) -> Grid<T> {
    let rows = (0..grid.height()).flat_map(|y| grid.row(y).iter().rev().cloned());
    Grid::from_rows(grid.width(), grid.height(), rows.collect())
}

/// Every cell split in four.
fn refined<T: Clone>(grid: &Grid<T>) -> Grid<T> {
    let (width, height) = (grid.width() * 2, grid.height() * 2);
    let from = |x: u32, y: u32| grid[Cell::new(x / 2, y / 2)].clone();
    Grid::from_rows(width, height, (0..height).flat_map(|y| (0..width).map(move |x| from(x, y))).collect())
}

/// `left`, `right`, `below`, `above` more columns and rows of `value`.
fn padded<T: Clone>(grid: &Grid<T>, [left, right, below, above]: [u32; 4], value: &T) -> Grid<T> {
    let (width, height) = (left + grid.width() + right, below + grid.height() + above);
    let mut wider = Grid::filled(width, height, value.clone());
    for cell in grid.cells() {
        wider[Cell::new(cell.x + left, cell.y + below)] = grid[cell].clone();
    }
    wider
}

/// A map with cells as `change` leaves them.
fn changed(map: &OccupancyGrid, change: impl Fn(&Grid<Occupancy>) -> Grid<Occupancy>) -> OccupancyGrid {
    OccupancyGrid { frame: map.frame, cells: change(&map.cells) }
}

/// A value per node as a grid; `None` where no cell is free.
fn on_cells<T: Clone>(graph: &CellGraph, values: &[T]) -> Grid<Option<T>> {
    let mut grid = Grid::filled(graph.width(), graph.height(), None);
    for (&cell, value) in graph.cells().iter().zip(values) {
        grid[cell] = Some(value.clone());
    }
    grid
}

/// The labels after classification, after smoothing, and at the end, as grids.
struct Stages([(&'static str, Grid<Option<Label>>); 3]);

impl Stages {
    fn of(map: &OccupancyGrid, model: &Model) -> Self {
        let found = run(map, model);
        let grid = |labels: &[Label]| on_cells(&found.space.graph, labels);
        Self([
            ("classified", grid(&found.classified)),
            ("smoothed", grid(&found.smoothed.most_likely())),
            ("at the end", grid(&found.labeling)),
        ])
    }
}

/// Counts cells that are labeled alike.
#[derive(Default)]
struct Alike(Vec<(&'static str, u64, u64)>);

impl Alike {
    fn add(
        &mut self,
        expected: &Stages,
        found: &Stages,
        change: impl Fn(&Grid<Option<Label>>) -> Grid<Option<Label>>,
    ) {
        self.0.resize(expected.0.len(), ("", 0, 0));
        for ((count, (name, expected)), (_, found)) in self.0.iter_mut().zip(&expected.0).zip(&found.0) {
            let expected = change(expected);
            assert_eq!((expected.width(), expected.height()), (found.width(), found.height()));
            let pairs =
                expected.values().iter().zip(found.values()).filter(|(a, b)| a.is_some() || b.is_some());
            count.0 = name;
            for (a, b) in pairs {
                count.1 += u64::from(a == b);
                count.2 += 1;
            }
        }
    }

    fn shares(&self, what: &str) -> Vec<f64> {
        let share = |&(name, alike, all): &(&str, u64, u64)| {
            let share = alike as f64 / all as f64;
            println!("{what}, {name}: {:.4} % of {all} cells alike, {} not", 100.0 * share, all - alike);
            share
        };
        self.0.iter().map(share).collect()
    }
}

#[track_caller]
fn assert_shares(alike: &Alike, what: &str, least: [f64; 3]) {
    let shares = alike.shares(what);
    assert!(shares.iter().zip(least).all(|(share, least)| *share >= least), "{what}: {shares:?} < {least:?}");
}

#[test]
fn turned_and_mirrored_maps_have_turned_and_mirrored_labels() {
    let model = model();
    let achiral = without_chiral_features(&model);
    let [mut quarter, mut half, mut mirror, mut mirror_achiral] = [(); 4].map(|()| Alike::default());
    for map in buildings(3) {
        let stages = Stages::of(&map, &model);
        quarter.add(&stages, &Stages::of(&changed(&map, turned), &model), turned);
        half.add(&stages, &Stages::of(&changed(&map, |c| turned(&turned(c))), &model), |c| {
            turned(&turned(c))
        });
        let other = changed(&map, mirrored);
        mirror.add(&stages, &Stages::of(&other, &model), mirrored);
        mirror_achiral.add(&Stages::of(&map, &achiral), &Stages::of(&other, &achiral), mirrored);
    }
    // Features are of 32 bits and sum the beams in another order, which can turn a stump over, and a mirror changes the sign of
    // B10(7), at which the default model looks; the rest is exact.
    assert_shares(&quarter, "turned by 90 degrees", [0.9999, 0.9999, 1.0]);
    assert_shares(&half, "turned by 180 degrees", [0.9999, 0.9999, 1.0]);
    assert_shares(&mirror, "mirrored", [0.99, 0.99, 1.0]);
    assert_shares(&mirror_achiral, "mirrored, no chiral feature", [0.9999, 0.9999, 1.0]);
}

/// The model without the stumps that look at a feature that a mirror changes.
fn without_chiral_features(model: &Model) -> Model {
    let mut model = model.clone();
    let Method::Boosted(boosted) = &mut model.method else { panic!("the default model is boosted") };
    for classifier in &mut boosted.list.classifiers {
        let n = classifier.stumps.len();
        classifier.stumps.retain(|weighted| weighted.stump.feature.feature().mirror_invariant);
        assert!(
            classifier.stumps.len() > n / 2,
            "most stumps look at features that a mirror does not change"
        );
    }
    model
}

/// Class, cells and number of connections of every place, sorted.
fn shape_of_graph(found: &Analysis) -> Vec<(String, u32, usize)> {
    let degree = |id| found.topology.connections.iter().filter(|c| c.a == id || c.b == id).count();
    let mut places: Vec<_> = (found.topology.places.iter())
        .map(|place| (place.class.clone(), place.n_cells, degree(place.id)))
        .collect();
    places.sort_unstable();
    places
}

#[test]
fn a_turned_map_has_the_same_graph() {
    let model = model();
    for map in buildings(2) {
        let here = shape_of_graph(&run(&map, &model));
        assert_eq!(here, shape_of_graph(&run(&changed(&map, turned), &model)));
        assert_eq!(here, shape_of_graph(&run(&changed(&map, mirrored), &model)));
    }
}

#[test]
fn cells_split_in_four_keep_their_labels() {
    let model = model();
    let mut alike = Alike::default();
    for map in buildings(2) {
        let frame = MapFrame::new(map.frame.resolution_m() / 2.0, map.frame.map_from_grid()).unwrap();
        let fine = OccupancyGrid { frame, cells: refined(&map.cells) };
        alike.add(&Stages::of(&map, &model), &Stages::of(&fine, &model), refined);
    }
    // Scans start from the middle of a cell: those of its quarters see other corners.
    assert_shares(&alike, "split in four", [0.90, 0.93, 0.97]);
}

/// All that a run finds, as bits.
fn bits(found: &Analysis) -> (Labeling, Vec<u32>, Labeling, Vec<u32>) {
    let smoothed = found.smoothed.values().iter().map(|p| p.to_bits()).collect();
    let regions = found.regions.region_of.iter().map(|region| region.0).collect();
    (found.classified.clone(), smoothed, found.labeling.clone(), regions)
}

#[test]
fn unknown_cells_around_a_map_change_no_bit() {
    let model = model();
    for (index, map) in buildings(3).iter().enumerate() {
        let by = [[1, 0, 3, 0], [63, 7, 5, 64], [13, 130, 70, 1]][index % 3];
        let wider = changed(map, |cells| padded(cells, by, &Occupancy::Unknown));
        assert!(bits(&run(map, &model)) == bits(&run(&wider, &model)), "building {index}, padded by {by:?}");
    }
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let model = model();
    for map in buildings(2) {
        let [one, four] = [1, 4].map(|n_threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
            pool.install(|| run(&map, &model))
        });
        assert!(bits(&one) == bits(&four));
        assert_eq!(one.topology, four.topology);
    }
}

#[test]
fn every_dispatch_path_gives_the_same_bits() {
    let (columns, config) = (features::all(), ScanConfig::default());
    for map in buildings(1) {
        let graph = CellGraph::new(&map.cells);
        let values = Instructions::ALL.map(|instructions| {
            let (grid, cells, progress) = (&map, graph.cells(), &Silent);
            let job = Job { grid, cells, columns: &columns, config: &config, progress, instructions };
            let mut bits = vec![0; graph.n_nodes() * columns.len()];
            evaluate(&job, &mut bits, |values, out: &mut [u32]| {
                for column in 0..columns.len() {
                    for (cell, value) in values.column(column).iter().enumerate() {
                        out[cell * columns.len() + column] = value.to_bits();
                    }
                }
            });
            bits
        });
        assert!(values.iter().all(|bits| *bits == values[0]));
    }
}

#[test]
fn fields_are_distributions_and_regions_partition_the_free_cells() {
    let model = model();
    for map in buildings(2) {
        let found = run(&map, &model);
        let classified = classify(&map, &found.space, &model, &Silent).field;
        for field in [&classified, &found.smoothed] {
            for node in 0..field.n_nodes() {
                let row = field.row(node);
                let sum: f32 = row.iter().sum();
                assert!(
                    row.iter().all(|p| (0.0..=1.0 + 1e-6).contains(p)) && (sum - 1.0).abs() < 1e-5,
                    "{row:?}"
                );
            }
        }
        let mut n_cells = vec![0; found.regions.regions.len()];
        for (node, region) in found.regions.region_of.iter().enumerate() {
            n_cells[region.index()] += 1;
            assert_eq!(found.labeling[node], found.regions.regions[region.index()].label);
        }
        let named: Vec<u32> = found.regions.regions.iter().map(|region| region.n_cells).collect();
        assert_eq!(n_cells, named);
        assert_eq!(n_cells.iter().sum::<u32>() as usize, map.count(Occupancy::Free));
        let places: u32 = found.topology.places.iter().map(|place| place.n_cells).sum();
        let regions = found.regions.regions.iter().zip(&found.place_ids);
        let islands: u32 = regions.filter(|(_, id)| id.is_none()).map(|(region, _)| region.n_cells).sum();
        assert_eq!((places + islands) as usize, map.count(Occupancy::Free));
    }
}

#[test]
fn correcting_twice_is_correcting_once() {
    let model = model();
    for map in buildings(3) {
        let raw = Config { correction: false, ..Config::chapter() };
        let found = analyze(&map, &model, &raw, &Silent);
        let once = correct(&found.space, &found.regions, &model.label_set, &model.thresholds);
        let twice = correct(&found.space, &once.regions, &model.label_set, &model.thresholds);
        assert_eq!(once.regions, twice.regions);
        assert_eq!((twice.places.n_regions, twice.doorways.n_regions), (0, 0));
        // The same from the labels alone.
        let again = connected(&found.space.graph, &once.regions.labeling(), DiagonalSteps::default());
        let again = correct(&found.space, &again, &model.label_set, &model.thresholds);
        assert_eq!(again.regions.labeling(), once.regions.labeling());
    }
}

#[test]
fn what_is_written_is_read_and_written_again_with_the_same_bytes() {
    let model = model();
    for (index, map) in buildings(3).into_iter().enumerate() {
        let pose = Pose2::new(-17.3, 4.1 + index as f64, 0.3 * index as f64);
        let map = OccupancyGrid { frame: MapFrame::new(0.1, pose).unwrap(), ..map };
        let found = run(&map, &model);
        let info = MapInfo::of(&map, "generated", "00");
        let text = TopologyDocument::new(info, None, &model.label_set, &found.topology).to_json().unwrap();
        let read = TopologyDocument::from_json(text.as_bytes()).unwrap();
        assert_eq!(read.to_json().unwrap(), text);

        let png = label_png(&found.space.graph, &found.labeling);
        let size = (map.cells.width(), map.cells.height());
        let cells = read_labels(&png, size, &LabelCoding::of(&model.label_set)).unwrap();
        let labels: Labeling = (found.space.graph.cells().iter())
            .map(|&cell| match cells[cell] {
                LabelCell::Class(label) => label,
                other => panic!("a label in every free cell, found {other:?}"),
            })
            .collect();
        assert_eq!(labels, found.labeling);
        assert_eq!(label_png(&found.space.graph, &labels), png);
    }
}

/// The model with the k-th class in place `to[k]`.
fn renumbered(model: &Model, to: &[usize]) -> Model {
    let Method::Boosted(boosted) = &model.method else { panic!("the default model is boosted") };
    let n = to.len();
    let from = |place: usize| to.iter().position(|&other| other == place).unwrap();
    let classes = (0..n).map(|place| model.label_set.classes()[from(place)].clone()).collect();
    let old = |place: usize| if place == n { n } else { from(place) };
    let r = |k: usize, j: usize| boosted.compatibility.r(Label(old(k) as u8), Label(old(j) as u8));
    let rows = (0..=n).map(|k| (0..=n).map(|j| r(k, j)).collect()).collect();
    let list = DecisionList {
        order: boosted.list.order.iter().map(|label| Label(to[label.index()] as u8)).collect(),
        classifiers: (0..n).map(|place| boosted.list.classifiers[from(place)].clone()).collect(),
        temperature: boosted.list.temperature,
    };
    let compatibility = Compatibility::from_rows(rows).unwrap();
    let method = Method::Boosted(BoostedModel { list, compatibility, relaxation: boosted.relaxation });
    Model { label_set: LabelSet::new(classes).unwrap(), method, ..model.clone() }
}

#[test]
fn classes_in_another_order_label_the_same() {
    let model = model();
    let mut alike = Alike::default();
    for map in buildings(2) {
        let stages = Stages::of(&map, &model);
        for to in [[1, 2, 0], [0, 2, 1], [2, 1, 0]] {
            let found = Stages::of(&map, &renumbered(&model, &to));
            let rename = |label: &Option<Label>| label.map(|label| Label(to[label.index()] as u8));
            alike.add(&stages, &found, |labels| labels.map(rename));
        }
    }
    // The smoothing sums over the classes in their order.
    assert_shares(&alike, "classes in another order", [1.0, 0.9999, 1.0]);
}
