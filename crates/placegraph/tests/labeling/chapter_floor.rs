//! The chapter's three experiments (Sect. 4.8) on hand-labeled maps of its buildings: trained on the left halves, and
//! not below the share of cells that Table 4.1 and Sect. 4.8 report for the classifier alone. After all stages it is
//! not below the chapter's share either, but on SDR site B.
//!
//! Reads the folder named by `PLACEGRAPH_DATA`; without it the tests are skipped. No setting was chosen by these
//! results: everything is a default, except that large classes are thinned to keep the test short.

use placegraph::grid::FreeSpace;
use placegraph::labels::LabelSet;
use placegraph::pipeline::{Config, analyze, classify, smooth};
use placegraph::progress::Silent;
use placegraph::training::{LabeledMap, TrainConfig, Trained, train};

use crate::labeled_halves::{evaluate, labeled_map};

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

/// Trains on all `maps` and returns the accuracy of the classifier, and of the whole pipeline, on the columns of `test`
/// from `split` on.
fn experiment(maps: &[LabeledMap], test: &LabeledMap, split: u32, config: &TrainConfig) -> (f64, f64) {
    let trained = train(maps, &LabelSet::default(), config, &Silent).unwrap();
    report(&trained);
    let space = FreeSpace::of(&test.grid);
    let classified = classify(&test.grid, &space, &trained.model, &Silent);
    let labeled = smooth(&space, classified, &trained.model);
    let classified = labeled.classified.most_likely();
    let accuracy = evaluate(test, space.graph.cells(), &classified, split, "classified").0;
    evaluate(test, space.graph.cells(), &labeled.labeling, split, "relaxed");
    let analysis = analyze(&test.grid, &trained.model, &Config::default(), &Silent);
    let corrected = evaluate(test, space.graph.cells(), &analysis.labeling, split, "corrected").0;
    (accuracy, corrected)
}

fn short() -> TrainConfig {
    TrainConfig { max_cells_per_class: Some(6000), ..TrainConfig::default() }
}

#[test]
fn building_79_left_to_right() {
    let Some(map) = labeled_map("fr79_slam", Some(350)) else { return };
    // From all cells: of fewer, the last bits of a feature move the figure by a few tenths of a point.
    let (classified, corrected) = experiment(std::slice::from_ref(&map), &map, 350, &TrainConfig::default());
    assert!(classified >= 0.973 && corrected >= 0.9895, "{classified}, {corrected}");
}

#[test]
fn building_52_left_to_right() {
    let Some(map) = labeled_map("fr52_slam", Some(270)) else { return };
    let (classified, corrected) = experiment(std::slice::from_ref(&map), &map, 270, &short());
    assert!(classified >= 0.970 && corrected >= 0.9866, "{classified}, {corrected}");
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
    let (classified, corrected) = experiment(&maps, &test, 0, &config);
    // Below the chapter's 96.94 %, which the rules for doorways reached: learned gates call the mouths of cubicles doorways
    // (`docs/default-model.md`).
    assert!(classified >= 0.924 && corrected >= 0.966, "{classified}, {corrected}");
}
