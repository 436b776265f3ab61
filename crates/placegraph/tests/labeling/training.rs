//! Training on a drawn building.

use std::sync::Mutex;

use placegraph::amn::IamnConfig;
use placegraph::geom::Pose2;
use placegraph::grid::{Cell, FreeSpace, Grid, MapFrame, OccupancyGrid};
use placegraph::labels::{Label, LabelSet};
use placegraph::model::{Method, Model};
use placegraph::pipeline::{classify, smooth};
use placegraph::progress::{Progress, Silent, Stage};
use placegraph::training::{
    Choice, Dataset, LabeledMap, NetworkConfig, NodeScores, TrainConfig, TrainError, Window, train,
    train_network,
};

/// Rooms above and below a corridor, doorways between: c, r and d, at 25 cm.
const BUILDING: &str = "
    ##########################################
    #rrrrrrrrr#rrrrrrrr#rrrrrrrrrrr#rrrrrrrrr#
    #rrrrrrrrr#rrrrrrrr#rrrrrrrrrrr#rrrrrrrrr#
    #rrrrrrrrr#rrrrrrrr#rrrrrrrrrrr#rrrrrrrrr#
    #rrrrrrrrr#rrrrrrrr#rrrrrrrrrrr#rrrrrrrrr#
    #rrrrrrrrr#rrrrrrrr#rrrrrrrrrrr#rrrrrrrrr#
    #rrrrrrrrr#rrrrrrrr#rrrrrrrrrrr#rrrrrrrrr#
    ####ddd########ddd######ddd########ddd####
    #cccccccccccccccccccccccccccccccccccccccc#
    #cccccccccccccccccccccccccccccccccccccccc#
    #cccccccccccccccccccccccccccccccccccccccc#
    #cccccccccccccccccccccccccccccccccccccccc#
    ####ddd########ddd######ddd########ddd####
    #rrrrrrrrr#rrrrrrrr#rrrrrrrrrrr#rrrrrrrrr#
    #rrrrrrrrr#rrrrrrrr#rrrrrrrrrrr#rrrrrrrrr#
    #rrrrrrrrr#rrrrrrrr#rrrrrrrrrrr#rrrrrrrrr#
    #rrrrrrrrr#rrrrrrrr#rrrrrrrrrrr#rrrrrrrrr#
    #rrrrrrrrr#rrrrrrrr#rrrrrrrrrrr#rrrrrrrrr#
    ##########################################
";

fn building() -> LabeledMap {
    let map = BUILDING.replace(['c', 'r', 'd'], ".");
    let grid = OccupancyGrid::from_ascii(0.25, &map);
    let lines = BUILDING.lines().map(str::trim).filter(|line| !line.is_empty());
    let label = |letter: char| "crd".find(letter).map(|k| Label(k as u8));
    let values = lines.rev().flat_map(|line| line.chars().map(label)).collect();
    let labels = Grid::from_rows(grid.cells.width(), grid.cells.height(), values);
    LabeledMap { name: "drawn".into(), grid, labels, window: None, building: None }
}

/// Few rounds, so that the tests are short.
fn config() -> TrainConfig {
    TrainConfig {
        rounds: Choice::Among(vec![5, 20]),
        block_m: 2.5,
        scales: vec![1.0],
        max_cells_per_class: None,
        ..TrainConfig::default()
    }
}

/// Shares of every stage, as reported.
#[derive(Default)]
struct Shares(Mutex<Vec<(Stage, Vec<f64>)>>);

impl Progress for Shares {
    fn begin(&self, stage: Stage) {
        self.0.lock().unwrap().push((stage, Vec::new()));
    }

    fn advance(&self, done: usize, total: usize) {
        self.0.lock().unwrap().last_mut().unwrap().1.push(done as f64 / total as f64);
    }
}

/// Folds take long: whoever waits sees every round of each, and the bar of a stage never starts over.
#[test]
fn progress_of_a_stage_covers_all_of_its_parts() {
    let shares = Shares::default();
    let config = TrainConfig { scales: vec![1.0, 2.0], ..config() };
    train(&[building()], &LabelSet::default(), &config, &shares).unwrap();
    let stages = shares.0.into_inner().unwrap();
    let names: Vec<Stage> = stages.iter().map(|(stage, _)| *stage).collect();
    assert_eq!(names, [Stage::Features, Stage::Validate, Stage::Boost]);
    for (stage, shares) in stages {
        let n_at_least = if stage == Stage::Features { 2 } else { 20 };
        assert!(shares.len() >= n_at_least, "{stage}: {shares:?}");
        assert!(shares.is_sorted() || stage == Stage::Features, "{stage}: {shares:?}");
        let (first_half, second_half) = shares.split_at(shares.len() / 2);
        let largest = |shares: &[f64]| shares.iter().copied().fold(0.0, f64::max);
        assert!(
            largest(first_half) <= largest(second_half) && largest(second_half) <= 1.0,
            "{stage}: {shares:?}"
        );
    }
}

fn error(maps: &[LabeledMap], config: &TrainConfig) -> TrainError {
    train(maps, &LabelSet::default(), config, &Silent).unwrap_err()
}

#[test]
fn a_building_is_learned_and_the_report_says_how() {
    let map = building();
    let trained = train(std::slice::from_ref(&map), &LabelSet::default(), &config(), &Silent).unwrap();
    let report = &trained.report;
    assert_eq!(report.n_examples, [160, 407, 24]);
    assert!(report.training_error < 0.01, "{}", report.training_error);
    let validation = report.validation.as_ref().unwrap();
    assert_eq!((validation.n_folds, validation.orders.len(), validation.curve.len()), (4, 6, 2));
    assert!(validation.orders.iter().all(|order| order.accuracy > 0.8));
    assert!(
        report.votes.windows(2).all(|pair| pair[0].alpha.iter().sum::<f64>() >= pair[1].alpha.iter().sum())
    );

    let record = &trained.model.record;
    assert_eq!(record.maps[0].cells_per_class, [160, 407, 24]);
    assert_eq!((record.maps[0].name.as_str(), record.maps[0].sha256.len()), ("drawn", 64));
    assert!((record.resolution_m - 0.25).abs() < 1e-15);
    let orders = &record.validation.as_ref().unwrap().orders;
    assert!(orders.windows(2).all(|pair| pair[0].accuracy >= pair[1].accuracy));
    assert_eq!(Model::from_json(&trained.model.to_json()).unwrap(), trained.model);

    let Method::Boosted(boosted) = &trained.model.method else { panic!("a boosted model") };
    let best = validation.orders.iter().max_by(|a, b| {
        // The first of the best: later ones must be better.
        a.accuracy.total_cmp(&b.accuracy).then(b.order.cmp(&a.order))
    });
    assert_eq!(boosted.list.order, best.unwrap().order);
    let space = FreeSpace::of(&map.grid);
    let graph = &space.graph;
    let found = classify(&map.grid, &space, &trained.model, &Silent).field.most_likely();
    let wrong = graph.cells().iter().zip(&found).filter(|(cell, label)| map.labels[**cell] != Some(**label));
    let share = wrong.count() as f64 / graph.n_nodes() as f64;
    assert!((share - report.training_error).abs() < 1e-12);
}

#[test]
fn the_chapters_setting_is_one_switch() {
    let trained = train(&[building()], &LabelSet::default(), &TrainConfig::chapter(), &Silent).unwrap();
    let Method::Boosted(boosted) = &trained.model.method else { panic!("a boosted model") };
    assert!(boosted.list.classifiers.iter().all(|classifier| classifier.stumps.len() <= 100));
    assert!((boosted.list.temperature - 1.0).abs() < 1e-15);
    // Rooms and corridors never touch.
    assert!((boosted.compatibility.r(Label(0), Label(1)) + 1.0).abs() < 1e-15);
    let softened = train(&[building()], &LabelSet::default(), &config(), &Silent).unwrap();
    let Method::Boosted(boosted) = &softened.model.method else { panic!("a boosted model") };
    assert!((boosted.compatibility.r(Label(0), Label(1)) + 0.999).abs() < 1e-15);
}

#[test]
fn any_number_of_threads_trains_the_same_model() {
    let with_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| train(&[building()], &LabelSet::default(), &config(), &Silent).unwrap().model.hash())
    };
    assert_eq!(with_threads(1), with_threads(4));
}

#[test]
fn every_scale_adds_a_row_and_large_classes_can_be_thinned() {
    let rows =
        |config: &TrainConfig| Dataset::build(&[building()], &LabelSet::default(), config, &Silent).unwrap();
    let plain = rows(&config());
    let data = rows(&TrainConfig { scales: vec![1.0, 2.0], ..config() });
    let n = plain.examples.len();
    assert_eq!((n, data.examples.len()), (591, 1182));
    assert_eq!(data.examples[..n], data.examples[n..]);
    assert_eq!(data.table.column(0)[..n], *plain.table.column(0));
    let doubled = plain.table.column(0).iter().zip(&data.table.column(0)[n..]);
    // Column 0 is the mean difference of neighboring ranges, a length.
    assert!(doubled.into_iter().all(|(one, two)| (two - 2.0 * one).abs() <= 1e-4 * two));

    let thin = rows(&TrainConfig { max_cells_per_class: Some(100), ..config() });
    assert_eq!(thin.cells_per_example, [2, 5, 1]);
    let count = |k| thin.examples.iter().filter(|example| example.label == Label(k)).count();
    assert_eq!([count(0), count(1), count(2)], [80, 82, 24]);
}

#[test]
fn a_window_keeps_the_rest_of_the_map_out() {
    let mut map = building();
    map.window = Some(Window { min: Cell::new(0, 0), end: Cell::new(20, 19) });
    let trained = train(&[map.clone()], &LabelSet::default(), &config(), &Silent).unwrap();
    assert_eq!(trained.model.record.maps[0].cells_per_class, [76, 187, 12]);
    // Labels outside the window say nothing.
    for cell in map.labels.cells().filter(|cell| cell.x >= 20).collect::<Vec<_>>() {
        map.labels[cell] = None;
    }
    let without = train(&[map], &LabelSet::default(), &config(), &Silent).unwrap();
    assert_eq!(without.model.method, trained.model.method);
    assert_ne!(without.model.record.maps, trained.model.record.maps);
}

#[test]
fn one_block_alone_is_trained_without_validation() {
    let config = TrainConfig { block_m: 1000.0, temperature: Choice::Set(3.0), ..config() };
    let trained = train(&[building()], &LabelSet::default(), &config, &Silent).unwrap();
    assert_eq!(trained.report.validation, None);
    let Method::Boosted(boosted) = &trained.model.method else { panic!("a boosted model") };
    assert!((boosted.list.temperature - 3.0).abs() < 1e-15);
}

#[test]
fn labels_that_cannot_be_learned_are_refused() {
    let mut unlabeled = building();
    unlabeled.labels.values_mut().fill(None);
    assert_eq!(error(&[unlabeled.clone()], &config()), TrainError::NoLabels);
    assert_eq!(error(&[], &config()), TrainError::NoLabels);
    let mut no_doorway = building();
    no_doorway.labels.values_mut().iter_mut().filter(|l| **l == Some(Label(2))).for_each(|l| *l = None);
    assert_eq!(error(&[no_doorway], &config()), TrainError::ClassAbsent { class: "doorway".into() });
    let scales = TrainConfig { scales: vec![], ..config() };
    assert!(matches!(error(&[building()], &scales), TrainError::Setting { field: "scales", .. }));
}

/// Few rounds, neighbors and costs, and blocks that fit the building.
fn network_config(scores: NodeScores) -> NetworkConfig {
    let network = IamnConfig { n_neighbors: vec![1], costs: vec![10.0, 100.0], ..IamnConfig::default() };
    NetworkConfig { base: config(), scores, network }
}

#[test]
fn networks_with_and_without_a_list_learn_a_building() {
    let map = building();
    for scores in [NodeScores::List, NodeScores::None] {
        let maps = std::slice::from_ref(&map);
        let trained = train_network(maps, &LabelSet::default(), &network_config(scores), &Silent).unwrap();
        let Method::Iamn(network) = &trained.model.method else { panic!("a network") };
        assert_eq!(network.list.is_some(), scores == NodeScores::List);
        assert_eq!(trained.report.n_cells, [160, 407, 24]);
        let record = trained.model.record.network.as_ref().unwrap();
        assert_eq!((record.choices.len(), record.n_neighbors), (2, 1));
        assert!(record.choices.iter().all(|choice| (0.8..=1.0).contains(&choice.accuracy)));
        assert_eq!(Model::from_json(&trained.model.to_json()).unwrap(), trained.model);

        let space = FreeSpace::of(&map.grid);
        let found = smooth(&space, classify(&map.grid, &space, &trained.model, &Silent), &trained.model);
        assert_eq!(found.smoothed.most_likely(), found.labeling);
        let labels = space.graph.cells().iter().map(|&cell| map.labels[cell]);
        let right = labels.zip(&found.labeling).filter(|(label, found)| *label == Some(**found)).count();
        assert!(right as f64 > 0.97 * found.labeling.len() as f64, "{scores:?}: {right}");
    }
}

#[test]
fn a_network_is_the_same_on_any_number_of_threads() {
    let map = building();
    let bytes = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let config = network_config(NodeScores::List);
        let train = || train_network(std::slice::from_ref(&map), &LabelSet::default(), &config, &Silent);
        pool.install(train).unwrap().model.to_json()
    };
    assert_eq!(bytes(1), bytes(4));
}

#[test]
fn a_network_wants_one_scale_and_one_resolution() {
    let refused = |maps: &[LabeledMap], config: &NetworkConfig| {
        train_network(maps, &LabelSet::default(), config, &Silent).unwrap_err()
    };
    let mut config = network_config(NodeScores::None);
    let mut finer = building();
    finer.grid.frame = MapFrame::new(0.1, Pose2::default()).unwrap();
    assert_eq!(refused(&[building(), finer], &config), TrainError::Resolution { map: "drawn".into() });
    config.base.scales = vec![1.0, 1.2];
    assert!(matches!(refused(&[building()], &config), TrainError::Setting { field: "scales", .. }));
    assert_eq!(refused(&[], &network_config(NodeScores::None)), TrainError::NoLabels);
}
