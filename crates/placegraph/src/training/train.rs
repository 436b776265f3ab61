//! Labeled maps to a model: the only code that calls every trainer of the boosted method.
//!
//! Cost: features of the labeled cells at every scale, `n_folds + 1` runs of boosting, all orders of the list.
//!
//! **Deviations**: order, rounds and temperature come from held-out blocks of the training maps. The chapter takes the
//! order that does best on the test map, and says nothing of rounds; its confidences have temperature 1
//! ([`TrainConfig::chapter`]).

use super::config::{CHAPTER_ROUNDS, CHAPTER_TEMPERATURE};
use super::curve::learning_curve;
use super::validate::{best_order, orders, validate};
use super::{CurvePoint, Dataset, LabeledMap, TrainConfig, TrainError, Validation};
use crate::boost::{CompiledClassifiers, DecisionList, OrderScore, StrongClassifier, boost_on, table_scores};
use crate::features::FeatureId;
use crate::labels::{Label, LabelSet};
use crate::model::{
    BoostedModel, Method, Model, OrderRecord, TrainingRecord, TrainingSettings, ValidationRecord,
};
use crate::progress::{Progress, Stage};
use crate::relax::{Compatibility, PairCounts, with_walls};

/// Resolutions that differ by no more than this share are one: savers of maps round them.
pub(super) const SAME_RESOLUTION: f64 = 0.1;
/// Orders that the model's record lists.
const RECORDED_ORDERS: usize = 24;

/// A trained model and its report.
#[derive(Clone, Debug)]
pub struct Trained {
    /// The model.
    pub model: Model,
    /// The training report.
    pub report: TrainingReport,
}

/// How training went.
#[derive(Clone, Debug, PartialEq)]
pub struct TrainingReport {
    /// Number of examples of each class.
    pub n_examples: Vec<usize>,
    /// Results on held-out examples; `None` if no part could be held out.
    pub validation: Option<Validation>,
    /// Share of the training cells that the list labels wrongly.
    pub training_error: f64,
    /// The features in use, by falling total vote.
    pub votes: Vec<FeatureVote>,
    /// The accuracy of models that saw less; empty if it was not asked for.
    pub curve: Vec<CurvePoint>,
}

/// The weight of a feature.
#[derive(Clone, Debug, PartialEq)]
pub struct FeatureVote {
    /// The feature.
    pub feature: FeatureId,
    /// Sum of α over its stumps, for each class.
    pub alpha: Vec<f64>,
}

/// Trains the boosted method on `maps`.
///
/// # Errors
/// If a setting is out of range, labels do not fit their map or the label set, or a class has no cell.
pub fn train(
    maps: &[LabeledMap],
    label_set: &LabelSet,
    config: &TrainConfig,
    progress: &dyn Progress,
) -> Result<Trained, TrainError> {
    config.check_base(label_set)?;
    config.validate()?;
    let data = Dataset::build(maps, label_set, config, progress)?;
    let validation = validate(&data, config, progress).map(|validated| validated.validation);
    let (list, training_error) = train_list(&data, validation.as_ref(), label_set, config, progress)?;
    let curve = match &validation {
        Some(validation) if config.learning_curve => {
            let blocks = data.blocks(maps, config.block_m);
            learning_curve(&data, &blocks, validation, config, progress)
        }
        _ => Vec::new(),
    };
    let (compatibility, resolution_m) = match config.base.as_ref().map(|base| (&base.method, base)) {
        Some((Method::Boosted(boosted), base)) => (boosted.compatibility.clone(), base.record.resolution_m),
        _ => compatibility(maps, label_set, config),
    };
    let known = config.base.iter().flat_map(|base| base.record.maps.iter().cloned());
    let record = TrainingRecord {
        program_version: env!("CARGO_PKG_VERSION").to_owned(),
        maps: known.chain(maps.iter().map(|map| map.record(label_set))).collect(),
        resolution_m,
        training_error,
        validation: validation.as_ref().map(|validation| record(validation, label_set)),
        network: None,
        settings: TrainingSettings(config.settings()),
    };
    let n_examples = |label: Label| data.examples.iter().filter(|example| example.label == label).count();
    let report = TrainingReport {
        n_examples: label_set.labels().map(n_examples).collect(),
        validation,
        training_error,
        votes: votes(&list.classifiers),
        curve,
    };
    let boosted = BoostedModel { list, relaxation: config.relaxation, compatibility };
    let model = Model {
        label_set: label_set.clone(),
        scan: config.scan,
        method: Method::Boosted(boosted),
        doorways: config.base.as_ref().map_or_else(Vec::new, |base| base.doorways.clone()),
        thresholds: config.thresholds,
        record,
    };
    Ok(Trained { model, report })
}

/// The decision list from all examples, and its error on them.
pub(super) fn train_list(
    data: &Dataset,
    validation: Option<&Validation>,
    label_set: &LabelSet,
    config: &TrainConfig,
    progress: &dyn Progress,
) -> Result<(DecisionList, f64), TrainError> {
    // Where nothing could be held out, the chapter's numbers stand in for a choice, or the model to start from as it is.
    let chapter_rounds = if config.base.is_some() { 0 } else { CHAPTER_ROUNDS };
    let (n_rounds, temperature) = validation.map_or_else(
        || (config.rounds.set_or(chapter_rounds), config.temperature.set_or(CHAPTER_TEMPERATURE)),
        |validation| (validation.n_rounds, validation.temperature),
    );
    progress.begin(Stage::Boost);
    let labels = data.labels();
    let rows: Vec<u32> = (0..labels.len() as u32).collect();
    let base = config.base_classifiers(label_set.len());
    let classifiers = boost_on(&data.table, &rows, &labels, &base, n_rounds, progress)?;
    let scores = table_scores(&data.table, &rows, &CompiledClassifiers::new(&classifiers));
    let on_training = orders(&scores, &labels, data, temperature, config);
    let order = best_order(validation.map_or(&on_training, |validation| &validation.orders)).order.clone();
    let accuracy = on_training.iter().find(|score| score.order == order).map_or(0.0, |score| score.accuracy);
    Ok((DecisionList { order, classifiers, temperature }, 1.0 - accuracy))
}

/// The compatibilities of all maps with the first map's resolution, and that resolution.
fn compatibility(maps: &[LabeledMap], label_set: &LabelSet, config: &TrainConfig) -> (Compatibility, f64) {
    let resolution_m = maps.first().map_or(0.0, |map| map.grid.frame.resolution_m());
    let same =
        |map: &&LabeledMap| (map.grid.frame.resolution_m() / resolution_m - 1.0).abs() <= SAME_RESOLUTION;
    let mut counts = PairCounts::new(label_set.len());
    for map in maps.iter().filter(same) {
        let labels = with_walls(&map.grid.cells, &map.labels, label_set.len());
        counts.add(&map.inside_window(labels));
    }
    (counts.compatibility(config.least_compatible), resolution_m)
}

/// Sums of α by feature, largest total first; ties go to the lower feature.
fn votes(classifiers: &[StrongClassifier]) -> Vec<FeatureVote> {
    let mut votes: Vec<FeatureVote> = CompiledClassifiers::new(classifiers)
        .columns()
        .iter()
        .map(|&feature| FeatureVote { feature, alpha: vec![0.0; classifiers.len()] })
        .collect();
    for (class, classifier) in classifiers.iter().enumerate() {
        for w in &classifier.stumps {
            let at = votes.partition_point(|vote| vote.feature < w.stump.feature);
            votes[at].alpha[class] += w.alpha;
        }
    }
    let total = |vote: &FeatureVote| vote.alpha.iter().sum::<f64>();
    votes.sort_by(|a, b| total(b).total_cmp(&total(a)).then(a.feature.cmp(&b.feature)));
    votes
}

pub(super) fn record(validation: &Validation, label_set: &LabelSet) -> ValidationRecord {
    let mut orders: Vec<&OrderScore> = validation.orders.iter().collect();
    orders.sort_by(|a, b| b.accuracy.total_cmp(&a.accuracy));
    orders.truncate(RECORDED_ORDERS);
    let name = |label: &Label| label_set.class(*label).name.clone();
    let order = |score: &OrderScore| OrderRecord {
        order: score.order.iter().map(name).collect(),
        accuracy: score.accuracy,
        macro_f1: score.macro_f1,
    };
    ValidationRecord {
        n_folds: validation.n_folds,
        n_rounds: validation.n_rounds,
        temperature: validation.temperature,
        log_loss: validation.log_loss,
        orders: orders.into_iter().map(order).collect(),
    }
}
