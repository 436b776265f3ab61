//! Table 4.1, all orders of the decision list with the new and the old features, and the number of rounds.
//!
//! Boosting is nested, so one run of the most rounds serves every smaller number.

use anyhow::Result;
use placegraph::boost::{
    CompiledClassifiers, DecisionList, Scores, StrongClassifier, adaboost, table_scores,
};
use placegraph::features::{self, FeatureId, FeatureTable, extract};
use placegraph::grid::{Cell, Grid};
use placegraph::labels::{Label, LabelSet};
use placegraph::progress::{Progress, Stage};
use placegraph::training::{Dataset, TrainConfig, Trained};

use super::buildings::Building;
use super::experiment::boosted;
use super::results::{ClassVotes, OrderRow, Point, names, score};
use super::settings::Settings;

/// Features listed for every class.
const BEST_FEATURES: usize = 8;

/// Table 4.1: the first two labels of the order, and the per cent with the new and the old features.
const TABLE_4_1: [([Label; 3], [f64; 2]); 6] = [
    ([Label(0), Label(1), Label(2)], [97.27, 93.16]),
    ([Label(1), Label(0), Label(2)], [97.26, 93.31]),
    ([Label(1), Label(2), Label(0)], [96.94, 93.94]),
    ([Label(0), Label(2), Label(1)], [87.73, 80.10]),
    ([Label(2), Label(0), Label(1)], [87.21, 80.10]),
    ([Label(2), Label(1), Label(0)], [86.60, 80.49]),
];

/// Table 4.1 and the curve over rounds.
#[derive(Debug)]
pub(super) struct Orders {
    pub(super) table: Vec<OrderRow>,
    pub(super) rounds: Vec<Point>,
}

/// The test cells with all features, and their true labels.
struct Test {
    cells: Vec<Cell>,
    features: FeatureTable,
    truth: Grid<Option<Label>>,
}

/// Trains on the left part of `building` and labels the right one; `chapter` and `best` are the two settings on the same
/// cells. The curve over rounds takes the order of the chapter's.
pub(super) fn orders(
    building: &Building,
    [chapter, best]: [&Trained; 2],
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<Orders> {
    let order = &boosted(&chapter.model)?.list.order;
    let best = &boosted(&best.model)?.list;
    let most = settings.rounds_curve.iter().copied().max().unwrap_or(0).max(settings.rounds);
    let new = boost(building, features::all(), most, settings, progress)?;
    let old = boost(building, features::old152(), settings.rounds, settings, progress)?;
    let test = Test::new(building, settings, progress);

    let judged = |order: &[Label], scores: &Scores, temperature: f64| {
        score(&test.cells, &label(order, scores, temperature), &test.truth)
    };
    let rounds = settings.rounds_curve.iter().map(|&n_rounds| {
        let scores = test.scores(&truncated(&new, n_rounds));
        Point { at: n_rounds, scores: judged(order, &scores, 1.0) }
    });
    let rounds = rounds.collect();
    let (new, old) = (test.scores(&truncated(&new, settings.rounds)), test.scores(&old));
    let of_best = test.scores(&best.classifiers);
    let table = TABLE_4_1.iter().map(|(order, published)| OrderRow {
        order: names(order),
        published: *published,
        held_out_accuracy: held_out_accuracy(chapter, order),
        new: judged(order, &new, 1.0),
        old: judged(order, &old, 1.0),
        best: judged(order, &of_best, best.temperature),
    });
    Ok(Orders { table: table.collect(), rounds })
}

impl Test {
    fn new(building: &Building, settings: &Settings, progress: &dyn Progress) -> Self {
        let map = &building.map.grid;
        let is_tested = |cell: &Cell| cell.x >= building.split && map.is_free(*cell);
        let cells: Vec<Cell> = map.cells.cells().filter(is_tested).collect();
        progress.begin(Stage::Features);
        let features = extract(map, &cells, &features::all(), &settings.chapter().scan, progress);
        Self { cells, features, truth: building.truth_from(building.split) }
    }

    fn scores(&self, classifiers: &[StrongClassifier]) -> Scores {
        let rows: Vec<u32> = (0..self.cells.len() as u32).collect();
        table_scores(&self.features, &rows, &CompiledClassifiers::new(classifiers))
    }
}

/// The classifiers of all classes after `n_rounds` rounds on all cells of the left part.
pub(super) fn boost(
    building: &Building,
    features: Vec<FeatureId>,
    n_rounds: usize,
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<Vec<StrongClassifier>> {
    let label_set = LabelSet::default();
    let config = TrainConfig { features, ..settings.chapter() };
    let data = Dataset::build(&[building.left()], &label_set, &config, progress)?;
    let labels = data.labels();
    progress.begin(Stage::Boost);
    let rows: Vec<u32> = (0..labels.len() as u32).collect();
    Ok(adaboost(&data.table, &rows, &labels, label_set.len(), n_rounds, progress)?)
}

fn truncated(classifiers: &[StrongClassifier], n_rounds: usize) -> Vec<StrongClassifier> {
    classifiers.iter().map(|classifier| classifier.truncated(n_rounds)).collect()
}

/// The labels that the list in `order` gives.
fn label(order: &[Label], scores: &Scores, temperature: f64) -> Vec<Label> {
    let list = DecisionList { order: order.to_vec(), classifiers: Vec::new(), temperature };
    list.classify(scores).most_likely()
}

fn held_out_accuracy(trained: &Trained, order: &[Label]) -> Option<f64> {
    let orders = &trained.report.validation.as_ref()?.orders;
    orders.iter().find(|score| score.order == order).map(|score| score.accuracy)
}

/// The most informative features, class by class.
pub(super) fn most_informative(trained: &Trained) -> Vec<ClassVotes> {
    let label_set = LabelSet::default();
    let of_class = |label: Label| {
        let mut votes: Vec<_> =
            trained.report.votes.iter().map(|vote| (vote.feature, vote.alpha[label.index()])).collect();
        votes.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        let described = votes.into_iter().take(BEST_FEATURES).map(|(id, alpha)| {
            let feature = id.feature();
            (feature.name.clone(), feature.description, alpha)
        });
        ClassVotes { class: label_set.class(label).name.clone(), features: described.collect() }
    };
    label_set.labels().map(of_class).collect()
}
