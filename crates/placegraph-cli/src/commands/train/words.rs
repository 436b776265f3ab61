//! What a training report says, for the terminal and the page.

use std::fmt::Write;

use placegraph::boost::OrderScore;
use placegraph::labels::{ConfusionMatrix, Label, LabelSet};
use placegraph::training::{
    CurvePoint, HoldOut, LabeledMap, ListReport, NetworkReport, Trained, TrainedNetwork, TrainingReport,
    Validation,
};

/// Features that the report names.
const BEST_FEATURES: usize = 12;
/// Orders of the decision list that the report names.
const BEST_ORDERS: usize = 3;
/// Share of the cells of a class that are taken for another one, from which the report says so.
const ALIKE: f64 = 0.25;
/// What is gained by twice as many labels, from which more of them are advised.
const WORTHWHILE: f64 = 0.01;

/// What the figures do not count.
pub(super) const CELL_BY_CELL: &str = "These figures count cells that are labeled one by one, from single scans. The stages after that \
    (smoothing, doorways, whole rooms) usually mend a part of the errors: judge their result with `placegraph evaluate`.";

/// How many examples the model learned from.
pub(super) fn examples(report: &TrainingReport, maps: &[LabeledMap], classes: &LabelSet) -> String {
    let names = classes.classes().iter().map(|class| class.name.as_str());
    let counts: Vec<String> = names.zip(&report.n_examples).map(|(name, n)| format!("{n} {name}")).collect();
    let n_maps = maps.len();
    let maps = if n_maps == 1 { "1 map".to_owned() } else { format!("{n_maps} maps") };
    format!(
        "learned from {maps}; examples: {}; wrong on them: {:.2} %",
        counts.join(", "),
        100.0 * report.training_error
    )
}

/// How good the model is on what it has not seen, and what that does not show.
pub(super) fn verdict(validation: &Validation) -> String {
    let accuracies = || validation.maps.iter().map(|map| 100.0 * map.accuracy);
    let (low, high) = (accuracies().fold(100.0, f64::min), accuracies().fold(0.0, f64::max));
    let all = 100.0 * validation.confusion.accuracy().unwrap_or(0.0);
    match validation.held_out {
        HoldOut::Buildings => format!(
            "In buildings that it had not seen, the model labels {all:.1} % of the cells right, from {low:.1} to {high:.1} % by map."
        ),
        HoldOut::Blocks => format!(
            "In parts of the same building that it had not seen, the model labels {all:.1} % of the cells right. That does not show how it does in \
             another building, where it is usually worse: label a part of one, and compare."
        ),
    }
}

/// Pairs of classes, one of which is often taken for the other, the worst first.
pub(super) fn hard_to_tell_apart(confusion: &ConfusionMatrix, classes: &LabelSet) -> Vec<String> {
    let mut pairs: Vec<(f64, Label, Label)> = Vec::new();
    for label in classes.labels() {
        let n = confusion.n_true(label).max(1) as f64;
        let of_pair = |other: Label| confusion.counts[label.index()][other.index()] as f64 / n;
        let others = classes.labels().filter(|&other| other != label);
        pairs
            .extend(others.map(|other| (of_pair(other), label, other)).filter(|&(share, ..)| share >= ALIKE));
    }
    pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
    let name = |label| &classes.class(label).name;
    let words = |&(share, label, other): &(f64, Label, Label)| {
        format!("{:.0} % of {} is taken for {}", 100.0 * share, name(label), name(other))
    };
    pairs.iter().map(words).collect()
}

/// Whether more labels would help, by the last step of the learning curve.
pub(super) fn more_maps(curve: &[CurvePoint]) -> Option<String> {
    let [.., half, all] = curve else { return None };
    let gain = all.accuracy - half.accuracy;
    let advice = if gain >= WORTHWHILE {
        "More labels would probably help further."
    } else {
        "More labels of the same kind would help little; labels of other buildings may."
    };
    Some(format!(
        "With {:.0} % of the labeled places {:.1} % of the held-out cells are right, with all of them {:.1} %. {advice}",
        100.0 * half.share,
        100.0 * half.accuracy,
        100.0 * all.accuracy
    ))
}

/// Accuracy, macro-F1 and names of the best orders of the decision list.
pub(super) fn best_orders(validation: &Validation, classes: &LabelSet) -> Vec<(f64, f64, String)> {
    let mut best: Vec<&OrderScore> = validation.orders.iter().collect();
    // A stable sort: of equal ones the first is taken, as training does.
    best.sort_by(|a, b| b.accuracy.total_cmp(&a.accuracy));
    let names = |order: &[Label]| {
        order.iter().map(|&label| classes.class(label).name.as_str()).collect::<Vec<_>>().join("-")
    };
    best.iter().take(BEST_ORDERS).map(|order| (order.accuracy, order.macro_f1, names(&order.order))).collect()
}

/// The report on a boosted model.
pub(super) fn boosted(trained: &Trained, maps: &[LabeledMap], classes: &LabelSet) -> String {
    let report = &trained.report;
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{}", examples(report, maps, classes));
    match &report.validation {
        Some(validation) => text += &held_out(validation, maps, classes),
        None => text += "no part could be held out: every class must be labeled in two places at least\n",
    }
    if let Some(words) = more_maps(&report.curve) {
        let _ = writeln!(text, "{words}");
    }
    let _ = writeln!(text, "most informative features (sum of alpha per class):");
    for vote in report.votes.iter().take(BEST_FEATURES) {
        let names = classes.classes().iter().map(|class| class.name.as_str());
        let alphas: Vec<String> =
            names.zip(&vote.alpha).map(|(name, alpha)| format!("{name} {alpha:.2}")).collect();
        let _ = writeln!(text, "  {:<8} {}", vote.feature.feature().name, alphas.join("  "));
    }
    text
}

fn held_out(validation: &Validation, maps: &[LabeledMap], classes: &LabelSet) -> String {
    let mut text = format!("{}\n", verdict(validation));
    if validation.held_out == HoldOut::Buildings {
        for map in &validation.maps {
            let _ = writeln!(text, "  {:6.2} %  {}", 100.0 * map.accuracy, maps[map.map as usize].name);
        }
    }
    for line in hard_to_tell_apart(&validation.confusion, classes) {
        let _ = writeln!(text, "  {line}");
    }
    let _ = writeln!(
        text,
        "chosen on held-out cells: {} rounds, temperature {}, mean -ln p {:.4}; probabilities are off by {:.1} points in the mean",
        validation.n_rounds,
        validation.temperature,
        validation.log_loss,
        100.0 * validation.calibration_error()
    );
    let _ = writeln!(text, "orders of the decision list, the best first:");
    for (accuracy, macro_f1, names) in best_orders(validation, classes) {
        let _ = writeln!(text, "  {:6.2} %  macro-F1 {macro_f1:.3}  {names}", 100.0 * accuracy);
    }
    let n_more = validation.orders.len().saturating_sub(BEST_ORDERS);
    if n_more > 0 {
        let _ = writeln!(text, "  and {n_more} more");
    }
    text
}

/// The report on a network.
pub(super) fn network(trained: &TrainedNetwork, maps: &[LabeledMap], classes: &LabelSet) -> String {
    let NetworkReport { n_cells, list, network } = &trained.report;
    let mut text = String::new();
    let cells: Vec<String> =
        classes.classes().iter().zip(n_cells).map(|(class, n)| format!("{n} {}", class.name)).collect();
    let _ = writeln!(text, "cells: {}", cells.join(", "));
    if let Some(ListReport { validation: Some(validation), .. }) = list {
        text += &held_out(validation, maps, classes);
    }
    let _ = writeln!(text, "network, on held-out blocks:");
    let tried = trained.model.record.network.clone().unwrap_or_default();
    for choice in &tried.choices {
        let _ = writeln!(
            text,
            "  {:6.2} %  macro-F1 {:.3}  M {}, C {}",
            choice.accuracy * 100.0,
            choice.macro_f1,
            choice.n_neighbors,
            choice.cost
        );
    }
    let _ = writeln!(text, "chosen: M {}, C {}", tried.n_neighbors, tried.cost);
    let _ = writeln!(text, "training error: {:.2} %", trained.model.record.training_error * 100.0);
    let features: Vec<&str> =
        network.selection.chosen.iter().map(|chosen| chosen.feature.feature().name.as_str()).collect();
    let _ = writeln!(text, "features used for distances: {}", features.join(" "));
    text
}
