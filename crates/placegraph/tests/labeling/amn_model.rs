//! Instance-based networks on made-up features: what is learned on one map holds on another.

use placegraph::amn::{self, IamnConfig, IamnModel, LabeledCells, side_by_side};
use placegraph::features::{self, FeatureTable};
use placegraph::geom::Pose2;
use placegraph::grid::{CellGraph, FreeSpace, MapFrame};
use placegraph::labels::{Label, Labeling};
use placegraph::progress::Silent;
use placegraph_testkit::networks::{hash, open_floor, uniform};

const SIDE: u32 = 48;
const RESOLUTION_M: f64 = 0.25;

struct Map {
    graph: CellGraph,
    table: FeatureTable,
    labels: Labeling,
}

/// Patches of 8 x 8 cells, each of a class; two noisy features tell the classes apart, a third does not.
fn map(seed: u64) -> Map {
    let graph = open_floor(SIDE, SIDE);
    let patch = |x: u32, y: u32| (hash(seed << 8 | u64::from(y / 8 * 8 + x / 8)) % 3) as u8;
    let labels: Labeling = graph.cells().iter().map(|cell| Label(patch(cell.x, cell.y))).collect();
    let noise = |i: usize| (uniform(seed << 32 | i as u64) - 0.5) as f32;
    let n = labels.len();
    let value = |column: usize, label: Label| match column {
        0 => f32::from(label.0),
        1 => f32::from(u8::from(label.0 == 1)),
        _ => 0.0,
    };
    let values = (0..3)
        .flat_map(|c| labels.iter().enumerate().map(move |(i, &l)| value(c, l) + 1.8 * noise(c * n + i)))
        .collect();
    let columns = features::all()[..3].to_vec();
    Map { graph, table: FeatureTable::from_columns(columns, n, values), labels }
}

fn train(map: &Map, scores: &[f32]) -> IamnModel {
    let maps = [FreeSpace {
        frame: MapFrame::new(RESOLUTION_M, Pose2::default()).unwrap(),
        graph: map.graph.clone(),
    }];
    let cells = LabeledCells { maps: &maps, table: &map.table, labels: &map.labels, n_labels: 3, scores };
    amn::train(&cells, &IamnConfig { costs: vec![10.0], ..IamnConfig::default() }, &Silent).0
}

fn wrong(found: &[Label], map: &Map) -> usize {
    found.iter().zip(&map.labels).filter(|(a, b)| a != b).count()
}

#[test]
fn what_is_learned_on_one_map_holds_on_another() {
    let model = train(&map(1), &[]);
    let other = map(2);
    let found = amn::label(&other.graph, &model.transform(&other.table), &model);
    assert_eq!(found.field.most_likely(), found.labeling);
    let (alone, together) = (wrong(&found.alone.most_likely(), &other), wrong(&found.labeling, &other));
    assert!(
        alone > 200 && together < 60,
        "{alone} of {} wrong alone, {together} together",
        other.labels.len()
    );
}

#[test]
fn scores_of_another_classifier_are_heard() {
    // The other classifier knows the label, but for noise of its own.
    let scores = |map: &Map, seed: u64| -> Vec<f32> {
        let of = |(i, label): (usize, &Label)| {
            [0, 1, 2].map(|k| {
                let noise = 2.0 * uniform(seed << 40 | (3 * i + k) as u64) as f32;
                noise + if label.index() == k { 1.5 } else { 0.0 }
            })
        };
        map.labels.iter().enumerate().flat_map(of).collect()
    };
    let (first, second) = (map(1), map(2));
    let model = train(&first, &scores(&first, 1));
    assert_eq!(model.n_scores(), 3);
    let heard = side_by_side(model.transform(&second.table), 3, &scores(&second, 2));
    let deaf = train(&first, &[]);
    let with = amn::label(&second.graph, &heard, &model);
    let without = amn::label(&second.graph, &deaf.transform(&second.table), &deaf);
    let (with, without) =
        (wrong(&with.alone.most_likely(), &second), wrong(&without.alone.most_likely(), &second));
    assert!(2 * with < without, "{with} wrong with scores, {without} without");
}

#[test]
fn one_thread_and_four_make_the_same_model_and_labels() {
    let (first, second) = (map(1), map(2));
    let of = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let model = train(&first, &[]);
            let found = amn::label(&second.graph, &model.transform(&second.table), &model);
            (serde_json::to_string(&model).unwrap(), found.labeling)
        })
    };
    let (model, labeling) = of(1);
    assert_eq!(of(4), (model.clone(), labeling.clone()));
    // The file's model labels the same.
    let read: IamnModel = serde_json::from_str(&model).unwrap();
    assert_eq!(amn::label(&second.graph, &read.transform(&second.table), &read).labeling, labeling);
}
