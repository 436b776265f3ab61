//! Order, rounds and temperature of the decision list, chosen on held-out blocks of the training maps.
//!
//! Boosting is nested, so one run of the most rounds serves all smaller numbers. For each number of rounds the best
//! order is found at temperature 1, then the temperature with the least mean of −ln p(true class). The pair of rounds
//! and temperature with the least such mean wins, ties to fewer rounds and lower temperature; the order is then the
//! most accurate one for that pair.

use std::collections::BTreeMap;

use super::{Dataset, HoldOut, Seen, TrainConfig};
use crate::boost::{
    CompiledClassifiers, DecisionList, OrderScore, Scores, StrongClassifier, boost_on, search_order,
    table_scores,
};
use crate::labels::{ConfusionMatrix, Label};
use crate::progress::{Part, Progress, Stage};

/// What of the macro-F1 a temperature may cost.
const MAX_F1_LOSS: f64 = 0.02;

/// Bins of the probabilities of held-out cells.
const N_BINS: usize = 10;

/// How well a number of rounds does on held-out examples, with its own best order and temperature.
#[derive(Clone, Debug, PartialEq)]
pub struct RoundsScore {
    /// Number of rounds T.
    pub n_rounds: usize,
    /// Share of cells labeled right at temperature 1, in the best order.
    pub accuracy: f64,
    /// The best of the temperatures.
    pub temperature: f64,
    /// Mean of −ln p(true class) at that temperature.
    pub log_loss: f64,
}

/// What the held-out examples say.
#[derive(Clone, Debug, PartialEq)]
pub struct Validation {
    /// Number of folds that could be held out: the rest of the examples must have all classes.
    pub n_folds: usize,
    /// The chosen number of rounds.
    pub n_rounds: usize,
    /// The chosen temperature.
    pub temperature: f64,
    /// Mean of −ln p(true class) of the best order, for both.
    pub log_loss: f64,
    /// All K! orders, in lexicographic order, for both.
    pub orders: Vec<OrderScore>,
    /// All numbers of rounds that were tried.
    pub curve: Vec<RoundsScore>,
    /// What was held out as a whole.
    pub held_out: HoldOut,
    /// Cells by true and found class, for both and the best order.
    pub confusion: ConfusionMatrix,
    /// The maps that have held-out cells.
    pub maps: Vec<MapScore>,
    /// Whether a class that has the probability p is right in the share p of the cells.
    pub reliability: Vec<ReliabilityBin>,
    /// Every held-out example that was seen at the scale 1, with the class found.
    pub found: Vec<(Seen, Label)>,
}

/// How well the held-out cells of one map are labeled.
#[derive(Clone, Debug, PartialEq)]
pub struct MapScore {
    /// Number of the map, from 0.
    pub map: u32,
    /// Its held-out cells, at all scales.
    pub n_cells: f64,
    /// Share of them that is labeled right.
    pub accuracy: f64,
}

/// Held-out cells whose most probable class has a probability in one tenth of the way from 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReliabilityBin {
    /// Number of cells.
    pub n_cells: f64,
    /// Mean of these probabilities.
    pub probability: f64,
    /// Share of the cells for which the class is right.
    pub accuracy: f64,
}

impl Validation {
    /// Expected calibration error: mean over the cells of |probability − share right| of their tenth.
    pub fn calibration_error(&self) -> f64 {
        let n_cells: f64 = self.reliability.iter().map(|bin| bin.n_cells).sum();
        let error = |bin: &ReliabilityBin| bin.n_cells * (bin.probability - bin.accuracy).abs();
        self.reliability.iter().map(error).sum::<f64>() / n_cells.max(1.0)
    }
}

/// What validation found, and the classifiers that it trained.
pub(super) struct CrossValidated {
    pub(super) validation: Validation,
    /// For every fold the classifiers of the chosen number of rounds that did not see it; none if the rest of the
    /// examples lacked a class.
    pub(super) classifiers: Vec<Vec<StrongClassifier>>,
}

/// Held-out examples of all folds, and their scores after each number of rounds.
pub(super) struct HeldOut {
    pub(super) n_folds: usize,
    rows: Vec<u32>,
    pub(super) labels: Vec<Label>,
    pub(super) scores: Vec<Scores>,
    /// Of every fold, with the most rounds.
    classifiers: Vec<Vec<StrongClassifier>>,
}

/// The order with the largest accuracy; ties go to the first.
pub(super) fn best_order(orders: &[OrderScore]) -> &OrderScore {
    orders.iter().fold(&orders[0], |best, order| if order.accuracy > best.accuracy { order } else { best })
}

/// The orders of the decision list on scores: all of them, or that of the model to start from.
pub(super) fn orders(
    scores: &Scores,
    labels: &[Label],
    data: &Dataset,
    temperature: f64,
    config: &TrainConfig,
) -> Vec<OrderScore> {
    let mut orders = search_order(scores, labels, &data.cells_per_example, temperature);
    if let Some(base) = config.base_list() {
        orders.retain(|score| score.order == base.order);
    }
    orders
}

/// Cross-validates; `None` if no fold leaves examples of all classes to learn from.
pub(super) fn validate(
    data: &Dataset,
    config: &TrainConfig,
    progress: &dyn Progress,
) -> Option<CrossValidated> {
    progress.begin(Stage::Validate);
    let rounds = config.rounds.candidates();
    let held_out = held_out(data, rounds, config, &|_| true, progress)?;
    let mut curve: Vec<RoundsScore> = Vec::new();
    let mut best = 0;
    for (candidate, (&n_rounds, scores)) in rounds.iter().zip(&held_out.scores).enumerate() {
        let orders = orders(scores, &held_out.labels, data, 1.0, config);
        let OrderScore { order, accuracy, .. } = best_order(&orders);
        let (temperature, log_loss) = best_temperature(order, scores, &held_out.labels, data, config);
        curve.push(RoundsScore { n_rounds, accuracy: *accuracy, temperature, log_loss });
        if log_loss < curve[best].log_loss {
            best = candidate;
        }
    }
    let RoundsScore { n_rounds, temperature, .. } = curve[best];
    let scores = &held_out.scores[best];
    let orders = orders(scores, &held_out.labels, data, temperature, config);
    let log_loss = log_loss(&best_order(&orders).order, temperature, scores, &held_out.labels, data);
    let truncated = |of_fold: &Vec<StrongClassifier>| config.truncated(of_fold, n_rounds);
    let classifiers = held_out.classifiers.iter().map(truncated).collect();
    let n_folds = held_out.n_folds;
    let order = best_order(&orders).order.clone();
    let judged = judged(
        &held_out,
        scores,
        &DecisionList { order, classifiers: Vec::new(), temperature },
        data,
        config,
    );
    let validation = Validation {
        n_folds,
        n_rounds,
        temperature,
        log_loss,
        orders,
        curve,
        held_out: data.held_out,
        confusion: judged.confusion,
        maps: judged.maps,
        reliability: judged.reliability,
        found: judged.found,
    };
    Some(CrossValidated { validation, classifiers })
}

/// What the chosen list says of the held-out examples.
struct Judged {
    confusion: ConfusionMatrix,
    maps: Vec<MapScore>,
    reliability: Vec<ReliabilityBin>,
    found: Vec<(Seen, Label)>,
}

fn judged(
    held_out: &HeldOut,
    scores: &Scores,
    list: &DecisionList,
    data: &Dataset,
    config: &TrainConfig,
) -> Judged {
    let mut confusion = ConfusionMatrix::new(data.cells_per_example.len());
    let mut bins = vec![ReliabilityBin::default(); N_BINS];
    let mut maps: BTreeMap<u32, MapScore> = BTreeMap::new();
    let mut found = Vec::new();
    for (example, (&row, &label)) in held_out.rows.iter().zip(&held_out.labels).enumerate() {
        let n = data.cells_per_example[label.index()];
        let probabilities = list.probabilities(scores.row(example));
        let best = most_probable(&probabilities);
        let (is_right, p) = (best == label, probabilities[best.index()]);
        confusion.counts[label.index()][best.index()] += u64::from(n);
        let seen = data.seen[row as usize];
        let (n, right) = (f64::from(n), if is_right { f64::from(n) } else { 0.0 });
        let map = maps.entry(seen.map).or_insert(MapScore { map: seen.map, n_cells: 0.0, accuracy: 0.0 });
        (map.n_cells, map.accuracy) = (map.n_cells + n, map.accuracy + right);
        let bin = &mut bins[((p * N_BINS as f64) as usize).min(N_BINS - 1)];
        bin.n_cells += n;
        bin.probability += n * p;
        bin.accuracy += right;
        if (config.scales[seen.scale as usize] - 1.0).abs() < 1e-9 {
            found.push((seen, best));
        }
    }
    for map in maps.values_mut() {
        map.accuracy /= map.n_cells;
    }
    for bin in bins.iter_mut().filter(|bin| bin.n_cells > 0.0) {
        bin.probability /= bin.n_cells;
        bin.accuracy /= bin.n_cells;
    }
    Judged { confusion, maps: maps.into_values().collect(), reliability: bins, found }
}

/// The class with the largest probability; ties go to the first.
fn most_probable(probabilities: &[f64]) -> Label {
    let best = (0..probabilities.len())
        .fold(0, |best, k| if probabilities[k] > probabilities[best] { k } else { best });
    Label(best as u8)
}

/// The temperature with the least mean of −ln p, and that mean, among those at which no class loses: a list at a high temperature
/// gives most cells to its first class, and a rare class none.
fn best_temperature(
    order: &[Label],
    scores: &Scores,
    labels: &[Label],
    data: &Dataset,
    config: &TrainConfig,
) -> (f64, f64) {
    let judged = |&temperature: &f64| {
        let list = DecisionList { order: order.to_vec(), classifiers: Vec::new(), temperature };
        let mut confusion = ConfusionMatrix::new(data.cells_per_example.len());
        for (example, label) in labels.iter().enumerate() {
            let found = most_probable(&list.probabilities(scores.row(example)));
            confusion.counts[label.index()][found.index()] +=
                u64::from(data.cells_per_example[label.index()]);
        }
        let log_loss = log_loss(order, temperature, scores, labels, data);
        (temperature, log_loss, confusion.macro_f1().unwrap_or(0.0))
    };
    let judged: Vec<(f64, f64, f64)> = config.temperature.candidates().iter().map(judged).collect();
    let best_f1 = judged.iter().map(|&(.., f1)| f1).fold(0.0, f64::max);
    let fair = judged.iter().filter(|&&(.., f1)| f1 >= best_f1 - MAX_F1_LOSS);
    fair.fold((1.0, f64::INFINITY), |best, &(t, loss, _)| if loss < best.1 { (t, loss) } else { best })
}

/// Trains on those examples of all folds but one that `is_seen` accepts, and scores that one, for each in turn.
pub(super) fn held_out(
    data: &Dataset,
    rounds: &[usize],
    config: &TrainConfig,
    is_seen: &dyn Fn(u32) -> bool,
    progress: &dyn Progress,
) -> Option<HeldOut> {
    let n_folds = config.n_folds;
    let n_labels = data.cells_per_example.len();
    let most = rounds.iter().copied().max().unwrap_or(0);
    let mut found = HeldOut {
        n_folds: 0,
        rows: Vec::new(),
        labels: Vec::new(),
        scores: Vec::new(),
        classifiers: Vec::new(),
    };
    let mut values = vec![Vec::new(); rounds.len()];
    for fold in 0..n_folds {
        let (out, mut kept): (Vec<u32>, Vec<u32>) = (0..data.examples.len() as u32)
            .partition(|&row| usize::from(data.examples[row as usize].fold) == fold);
        kept.retain(|&row| is_seen(row));
        found.classifiers.push(Vec::new());
        if out.is_empty() || kept.is_empty() {
            continue;
        }
        let label = |&row: &u32| data.examples[row as usize].label;
        let kept_labels: Vec<Label> = kept.iter().map(label).collect();
        let base = config.base_classifiers(n_labels);
        let part = Part { of: progress, number: fold, n_parts: n_folds };
        let Ok(classifiers) = boost_on(&data.table, &kept, &kept_labels, &base, most, &part) else {
            continue;
        };
        for (&n_rounds, values) in rounds.iter().zip(&mut values) {
            let truncated = config.truncated(&classifiers, n_rounds);
            let scores = table_scores(&data.table, &out, &CompiledClassifiers::new(&truncated));
            values.extend_from_slice(scores.values());
        }
        found.classifiers[fold] = classifiers;
        found.labels.extend(out.iter().map(label));
        found.rows.extend(&out);
        found.n_folds += 1;
    }
    found.scores = values.into_iter().map(|values| Scores::from_rows(n_labels, values)).collect();
    (found.n_folds > 0).then_some(found)
}

/// Mean of −ln p(true class) over cells.
fn log_loss(order: &[Label], temperature: f64, scores: &Scores, labels: &[Label], data: &Dataset) -> f64 {
    let list = DecisionList { order: order.to_vec(), classifiers: Vec::new(), temperature };
    let (mut sum, mut n_cells) = (0.0, 0.0);
    for (example, label) in labels.iter().enumerate() {
        let n = f64::from(data.cells_per_example[label.index()]);
        sum -= n * libm::log(list.probabilities(scores.row(example))[label.index()]);
        n_cells += n;
    }
    sum / n_cells
}
