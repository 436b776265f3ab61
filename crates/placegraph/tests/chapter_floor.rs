//! The chapter's three experiments (Sect. 4.8) on hand-labeled maps of its buildings: trained on the left halves, and
//! not below the share of cells that Table 4.1 and Sect. 4.8 report for the classifier alone.
//!
//! Reads the folder named by `PLACEGRAPH_DATA`; without it the tests are skipped. No setting was chosen by these
//! results: everything is a default, except that large classes are thinned to keep the test short.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests")]

use std::path::PathBuf;

use placegraph::boost::{CompiledClassifiers, cell_scores};
use placegraph::geom::Pose2;
use placegraph::grid::{Cell, CellGraph, Grid, MapFrame, Occupancy, OccupancyGrid};
use placegraph::labels::{Label, LabelSet, Labeling};
use placegraph::model::{Method, Model};
use placegraph::progress::Silent;
use placegraph::relax::relax;
use placegraph::training::{LabeledMap, TrainConfig, Trained, Window, train};

fn data(name: &str) -> Option<PathBuf> {
    let Some(folder) = std::env::var_os("PLACEGRAPH_DATA") else {
        println!("skipped: PLACEGRAPH_DATA does not name the folder of maps");
        return None;
    };
    Some(PathBuf::from(folder).join("eval").join(name))
}

/// An 8-bit image with the bottom row first.
fn gray(path: &PathBuf) -> Grid<u8> {
    let image = image::open(path).unwrap().into_luma8();
    let rows = image.rows().rev().flatten().map(|pixel| pixel.0[0]).collect();
    Grid::from_rows(image.width(), image.height(), rows)
}

/// The map called `name`, to learn from its first `split` columns; all of these maps have cells of 5 cm.
fn labeled_map(name: &str, split: Option<u32>) -> Option<LabeledMap> {
    let folder = data(name)?;
    let cells = gray(&folder.join("map.png")).map(|&value| match value {
        0 => Occupancy::Occupied,
        254 => Occupancy::Free,
        _ => Occupancy::Unknown,
    });
    let labels = gray(&folder.join("labels.png"))
        .map(|&value| if (1..=3).contains(&value) { Some(Label(value - 1)) } else { None });
    let frame = MapFrame::new(0.05, Pose2::default()).unwrap();
    let window = split.map(|x| Window { min: Cell::new(0, 0), end: Cell::new(x, cells.height()) });
    Some(LabeledMap { name: name.to_owned(), grid: OccupancyGrid { frame, cells }, labels, window })
}

/// Labels of all cells of a map, by the classifier alone and after the relaxation.
fn label(model: &Model, map: &LabeledMap) -> (CellGraph, Labeling, Labeling) {
    let Method::Boosted(boosted) = &model.method else { panic!("a boosted model") };
    let graph = CellGraph::new(&map.grid.cells);
    let classifiers = CompiledClassifiers::new(&boosted.list.classifiers);
    let scores = cell_scores(&map.grid, graph.cells(), &classifiers, &model.scan, &Silent);
    let field = boosted.list.classify(&scores);
    let relaxed = relax(&graph, &field, &boosted.compatibility, &boosted.relaxation);
    (graph, field.most_likely(), relaxed.field.most_likely())
}

/// Accuracy over the labeled cells from column `split` on; prints it with the doorways' and the classes' measures.
fn evaluate(map: &LabeledMap, graph: &CellGraph, found: &Labeling, split: u32, stage: &str) -> f64 {
    let mut confusion = [[0.0f64; 3]; 3];
    for (&cell, label) in graph.cells().iter().zip(found).filter(|(cell, _)| cell.x >= split) {
        if let Some(truth) = map.labels[cell] {
            confusion[truth.index()][label.index()] += 1.0;
        }
    }
    let called = |k: usize| confusion.iter().map(|row| row[k]).sum::<f64>();
    let total = |k: usize| confusion[k].iter().sum::<f64>();
    let right: f64 = (0..3).map(|k| confusion[k][k]).sum();
    let accuracy = right / (0..3).map(total).sum::<f64>();
    let (precision, recall) = (confusion[2][2] / called(2), confusion[2][2] / total(2));
    let f1 = (0..3).map(|k| 2.0 * confusion[k][k] / (called(k) + total(k))).sum::<f64>() / 3.0;
    println!(
        "{} {stage}: accuracy {:.2} %, doorway precision {precision:.3} recall {recall:.3}, macro F1 {f1:.3}",
        map.name,
        100.0 * accuracy
    );
    accuracy
}

fn report(trained: &Trained) {
    let Some(validation) = &trained.report.validation else { return };
    println!(
        "{:?} examples, T {}, temperature {}, log loss {:.4}, training error {:.5}, {} bytes",
        trained.report.n_examples,
        validation.n_rounds,
        validation.temperature,
        validation.log_loss,
        trained.report.training_error,
        trained.model.to_json().len()
    );
    for order in &validation.orders {
        println!(
            "{:?} {:.4} {:.4}",
            order.order.iter().map(|l| l.0).collect::<Vec<_>>(),
            order.accuracy,
            order.macro_f1
        );
    }
}

/// Trains on all `maps` and returns the accuracy of the classifier on the columns of `test` from `split` on.
fn experiment(maps: &[LabeledMap], test: &LabeledMap, split: u32, config: &TrainConfig) -> f64 {
    let trained = train(maps, &LabelSet::default(), config, &Silent).unwrap();
    report(&trained);
    let (graph, classified, relaxed) = label(&trained.model, test);
    let accuracy = evaluate(test, &graph, &classified, split, "classified");
    evaluate(test, &graph, &relaxed, split, "relaxed");
    accuracy
}

fn short() -> TrainConfig {
    TrainConfig { max_cells_per_class: Some(6000), ..TrainConfig::default() }
}

#[test]
fn building_79_left_to_right() {
    let Some(map) = labeled_map("fr79_slam", Some(350)) else { return };
    let accuracy = experiment(std::slice::from_ref(&map), &map, 350, &short());
    assert!(accuracy >= 0.973, "{accuracy}");
}

#[test]
fn building_52_left_to_right() {
    let Some(map) = labeled_map("fr52_slam", Some(270)) else { return };
    let accuracy = experiment(std::slice::from_ref(&map), &map, 270, &short());
    assert!(accuracy >= 0.970, "{accuracy}");
}

#[test]
fn sdr_site_b_from_both_left_halves_at_several_scales() {
    let maps = [("fr79_slam", 350), ("fr52_slam", 270)].map(|(name, x)| labeled_map(name, Some(x)));
    let (Some(maps), Some(test)) =
        (maps.into_iter().collect::<Option<Vec<_>>>(), labeled_map("sdr_b_slam", None))
    else {
        return;
    };
    let config =
        TrainConfig { scales: vec![0.7, 0.85, 1.0, 1.2, 1.4], max_cells_per_class: Some(3000), ..short() };
    let accuracy = experiment(&maps, &test, 0, &config);
    assert!(accuracy >= 0.924, "{accuracy}");
}
