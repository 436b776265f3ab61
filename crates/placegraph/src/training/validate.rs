//! Order, rounds and temperature of the decision list, chosen on held-out blocks of the training maps.
//!
//! Boosting is nested, so one run of the most rounds serves all smaller numbers. For each number of rounds the best
//! order is found at temperature 1, then the temperature with the least mean of −ln p(true class). The pair of rounds
//! and temperature with the least such mean wins, ties to fewer rounds and lower temperature; the order is then the
//! most accurate one for that pair.

use super::{Dataset, TrainConfig};
use crate::boost::{
    CompiledClassifiers, DecisionList, OrderScore, Scores, StrongClassifier, adaboost, search_order,
    table_scores,
};
use crate::labels::Label;
use crate::progress::{Progress, Silent, Stage};

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
}

/// What validation found, and the classifiers that it trained.
pub(super) struct CrossValidated {
    pub(super) validation: Validation,
    /// For every fold the classifiers of the chosen number of rounds that did not see it; none if the rest of the
    /// examples lacked a class.
    pub(super) classifiers: Vec<Vec<StrongClassifier>>,
}

/// Held-out examples of all folds, and their scores after each number of rounds.
struct HeldOut {
    n_folds: usize,
    labels: Vec<Label>,
    scores: Vec<Scores>,
    /// Of every fold, with the most rounds.
    classifiers: Vec<Vec<StrongClassifier>>,
}

/// The order with the largest accuracy; ties go to the first.
pub(super) fn best_order(orders: &[OrderScore]) -> &OrderScore {
    orders.iter().fold(&orders[0], |best, order| if order.accuracy > best.accuracy { order } else { best })
}

/// Cross-validates; `None` if no fold leaves examples of all classes to learn from.
pub(super) fn validate(
    data: &Dataset,
    config: &TrainConfig,
    progress: &dyn Progress,
) -> Option<CrossValidated> {
    progress.begin(Stage::Validate);
    let rounds = config.rounds.candidates();
    let held_out = held_out(data, rounds, config.n_folds, progress)?;
    let mut curve: Vec<RoundsScore> = Vec::new();
    let mut best = 0;
    for (candidate, (&n_rounds, scores)) in rounds.iter().zip(&held_out.scores).enumerate() {
        let orders = search_order(scores, &held_out.labels, &data.cells_per_example, 1.0);
        let OrderScore { order, accuracy, .. } = best_order(&orders);
        let (temperature, log_loss) = best_temperature(order, scores, &held_out.labels, data, config);
        curve.push(RoundsScore { n_rounds, accuracy: *accuracy, temperature, log_loss });
        if log_loss < curve[best].log_loss {
            best = candidate;
        }
    }
    let RoundsScore { n_rounds, temperature, .. } = curve[best];
    let scores = &held_out.scores[best];
    let orders = search_order(scores, &held_out.labels, &data.cells_per_example, temperature);
    let log_loss = log_loss(&best_order(&orders).order, temperature, scores, &held_out.labels, data);
    let truncated = |of_fold: &Vec<StrongClassifier>| of_fold.iter().map(|c| c.truncated(n_rounds)).collect();
    let classifiers = held_out.classifiers.iter().map(truncated).collect();
    let n_folds = held_out.n_folds;
    let validation = Validation { n_folds, n_rounds, temperature, log_loss, orders, curve };
    Some(CrossValidated { validation, classifiers })
}

fn best_temperature(
    order: &[Label],
    scores: &Scores,
    labels: &[Label],
    data: &Dataset,
    config: &TrainConfig,
) -> (f64, f64) {
    let loss = |&t: &f64| (t, log_loss(order, t, scores, labels, data));
    let losses = config.temperature.candidates().iter().map(loss);
    losses.fold((1.0, f64::INFINITY), |best, loss| if loss.1 < best.1 { loss } else { best })
}

/// Trains on all folds but one and scores that one, for each in turn.
fn held_out(data: &Dataset, rounds: &[usize], n_folds: usize, progress: &dyn Progress) -> Option<HeldOut> {
    let n_labels = data.cells_per_example.len();
    let most = rounds.iter().copied().max().unwrap_or(0);
    let mut found = HeldOut { n_folds: 0, labels: Vec::new(), scores: Vec::new(), classifiers: Vec::new() };
    let mut values = vec![Vec::new(); rounds.len()];
    for fold in 0..n_folds {
        let (out, kept): (Vec<u32>, Vec<u32>) = (0..data.examples.len() as u32)
            .partition(|&row| usize::from(data.examples[row as usize].fold) == fold);
        progress.advance(fold, n_folds);
        found.classifiers.push(Vec::new());
        if out.is_empty() || kept.is_empty() {
            continue;
        }
        let label = |&row: &u32| data.examples[row as usize].label;
        let kept_labels: Vec<Label> = kept.iter().map(label).collect();
        let Ok(classifiers) = adaboost(&data.table, &kept, &kept_labels, n_labels, most, &Silent) else {
            continue;
        };
        for (&n_rounds, values) in rounds.iter().zip(&mut values) {
            let truncated: Vec<StrongClassifier> =
                classifiers.iter().map(|classifier| classifier.truncated(n_rounds)).collect();
            let scores = table_scores(&data.table, &out, &CompiledClassifiers::new(&truncated));
            values.extend_from_slice(scores.values());
        }
        found.classifiers[fold] = classifiers;
        found.labels.extend(out.iter().map(label));
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
        sum -= n * list.probabilities(scores.row(example))[label.index()].ln();
        n_cells += n;
    }
    sum / n_cells
}
