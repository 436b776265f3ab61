//! Labeled maps to an instance-based network, alone or on top of a decision list.
//!
//! Cost: features of all labeled cells; boosting as for the list, on a thinned share of them; then that of
//! [`crate::amn::train`].
//!
//! **Deviations**: by default the nodes also see the log-confidences of a decision list. Those of a training cell come
//! from a list that did not see its fold; a list is nearly always right on the cells it was trained on, and the network
//! would trust it alone. Wrong cells of rare classes cost more ([`Loss::Root`]): under equal costs the network gives up
//! doorways, whose every cell has an edge to another class. [`NetworkConfig::chapter`] is the chapter's network, without a list.

use super::train::{SAME_RESOLUTION, record, train_list};
use super::validate::{CrossValidated, validate};
use super::{Dataset, LabeledMap, TrainConfig, TrainError, Validation};
use crate::amn::learn::{LearnConfig, Loss};
use crate::amn::{self, IamnConfig, IamnReport, LabeledCells, Validated};
use crate::boost::{CompiledClassifiers, DecisionList, table_scores};
use crate::features;
use crate::features::select::SelectConfig;
use crate::grid::{CellGraph, FreeSpace, Grid, Occupancy};
use crate::labels::LabelSet;
use crate::model::{
    ChoiceRecord, Method, Model, NetworkModel, NetworkRecord, TrainingRecord, TrainingSettings,
    log_confidences,
};
use crate::progress::Progress;

/// How an instance-based network is trained.
#[derive(Clone, Debug, PartialEq)]
pub struct NetworkConfig {
    /// Features, scans and thresholds, and the training of the decision list, if there is one. The limit of cells per
    /// class holds for the list; the network trains on all cells. Scales must be 1 alone, because a network knows
    /// places, not single scans.
    pub base: TrainConfig,
    /// Inputs of nodes in addition to distances.
    pub scores: NodeScores,
    /// How the network is trained.
    pub network: IamnConfig,
}

/// Inputs of nodes in addition to distances to exemplars.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NodeScores {
    /// Log-confidences of a decision list's classifiers.
    #[default]
    List,
    /// Nothing, as in the chapter.
    None,
}

/// Cells per class that the list below a network learns from.
const LIST_CELLS_PER_CLASS: usize = 6000;

impl Default for NetworkConfig {
    fn default() -> Self {
        let base = TrainConfig {
            scales: vec![1.0],
            max_cells_per_class: Some(LIST_CELLS_PER_CLASS),
            ..TrainConfig::default()
        };
        let learn = LearnConfig { loss: Loss::Root, ..LearnConfig::default() };
        Self { base, scores: NodeScores::List, network: IamnConfig { learn, ..IamnConfig::default() } }
    }
}

impl NetworkConfig {
    /// The chapter's own setting: 30 of the 203 features; distances alone, to all exemplars but the cell itself; every
    /// wrong cell costs the same. What the chapter does not say is chosen on held-out blocks: M and C in every training,
    /// the weight w₂ of correlations once, on the left parts of the chapter's buildings.
    pub fn chapter() -> Self {
        let network = IamnConfig {
            select: SelectConfig { correlation_weight: 0.5, ..SelectConfig::default() },
            n_neighbors: vec![1, 3, 10],
            costs: vec![100.0, 1000.0],
            exclusion_m: 0.0,
            ..IamnConfig::default()
        };
        Self {
            base: TrainConfig {
                features: features::freiburg203(),
                scales: vec![1.0],
                max_cells_per_class: None,
                ..TrainConfig::default()
            },
            scores: NodeScores::None,
            network,
        }
    }
}

/// A trained model and its report.
#[derive(Clone, Debug)]
pub struct TrainedNetwork {
    /// The model.
    pub model: Model,
    /// The training report.
    pub report: NetworkReport,
}

/// How training went.
#[derive(Clone, Debug, PartialEq)]
pub struct NetworkReport {
    /// Number of training cells of each class.
    pub n_cells: Vec<usize>,
    /// Of the decision list, if there is one.
    pub list: Option<ListReport>,
    /// Of the network.
    pub network: IamnReport,
}

/// How the decision list's training went.
#[derive(Clone, Debug, PartialEq)]
pub struct ListReport {
    /// Results on held-out examples; `None` if no part could be held out.
    pub validation: Option<Validation>,
    /// Share of its training cells that it labels wrongly.
    pub training_error: f64,
}

/// A decision list for the nodes, and its log-confidences of the training cells.
struct ListScores {
    list: DecisionList,
    report: ListReport,
    scores: Vec<f32>,
}

/// Trains a network on `maps`.
///
/// # Errors
/// If a setting is out of range, labels do not fit their map or the label set, a class has no cell, or maps differ in
/// resolution.
pub fn train_network(
    maps: &[LabeledMap],
    label_set: &LabelSet,
    config: &NetworkConfig,
    progress: &dyn Progress,
) -> Result<TrainedNetwork, TrainError> {
    config.base.validate()?;
    if config.base.scales != [1.0] {
        return Err(TrainError::Setting { field: "scales", expected: "1 alone for a network" });
    }
    let resolution_m = one_resolution(maps)?;
    let all = TrainConfig { max_cells_per_class: None, ..config.base.clone() };
    let data = Dataset::build(maps, label_set, &all, progress)?;
    let below = match config.scores {
        NodeScores::List => Some(list_scores(&data, label_set, &config.base, progress)?),
        NodeScores::None => None,
    };
    let spaces: Vec<FreeSpace> =
        maps.iter().map(|map| FreeSpace { frame: map.grid.frame, graph: labeled_graph(map) }).collect();
    let labels = data.labels();
    let cells = LabeledCells {
        maps: &spaces,
        table: &data.table,
        labels: &labels,
        n_labels: label_set.len(),
        scores: below.as_ref().map_or(&[], |below| &below.scores),
    };
    let (network, network_report) = amn::train(&cells, &config.network, progress);
    let n_cells = label_set.labels().map(|label| labels.iter().filter(|&&other| other == label).count());
    let (list, list_report) = below.map(|below| (below.list, below.report)).unzip();
    let report = NetworkReport { n_cells: n_cells.collect(), list: list_report, network: network_report };
    let model = Model {
        label_set: label_set.clone(),
        scan: config.base.scan,
        method: Method::Iamn(NetworkModel { list, network }),
        doorways: Vec::new(),
        thresholds: config.base.thresholds,
        record: training_record(maps, label_set, config, resolution_m, &report),
    };
    Ok(TrainedNetwork { model, report })
}

/// The resolution of all maps: rewards of edges hold for cells of one size.
fn one_resolution(maps: &[LabeledMap]) -> Result<f64, TrainError> {
    let of = |map: &LabeledMap| map.grid.frame.resolution_m();
    let first = maps.first().map(of).ok_or(TrainError::NoLabels)?;
    match maps.iter().find(|map| (of(map) / first - 1.0).abs() > SAME_RESOLUTION) {
        Some(map) => Err(TrainError::Resolution { map: map.name.clone() }),
        None => Ok(first),
    }
}

/// The labeled cells of `map` as a graph; its nodes are in the order of the data set's rows.
fn labeled_graph(map: &LabeledMap) -> CellGraph {
    let mut labeled = Grid::filled(map.grid.cells.width(), map.grid.cells.height(), Occupancy::Unknown);
    map.labeled_cells().for_each(|(cell, _)| labeled[cell] = Occupancy::Free);
    CellGraph::new(&labeled)
}

fn list_scores(
    data: &Dataset,
    label_set: &LabelSet,
    config: &TrainConfig,
    progress: &dyn Progress,
) -> Result<ListScores, TrainError> {
    let thinned = config.max_cells_per_class.map(|most| data.thinned(most));
    let examples = thinned.as_ref().unwrap_or(data);
    let validated = validate(examples, config, progress);
    let validation = validated.as_ref().map(|validated| &validated.validation);
    let (list, training_error) = train_list(examples, validation, label_set, config, progress)?;
    let scores = cross_fitted(data, &list, validated.as_ref());
    let report = ListReport { validation: validated.map(|validated| validated.validation), training_error };
    Ok(ListScores { list, report, scores })
}

/// Log-confidences of all examples, each by the classifiers that did not see its fold; if there are none, by the list itself.
fn cross_fitted(data: &Dataset, list: &DecisionList, validated: Option<&CrossValidated>) -> Vec<f32> {
    let per_example = 2 * list.order.len();
    let n_folds = validated.map_or(0, |validated| validated.classifiers.len());
    let mut scores = vec![0.0; data.examples.len() * per_example];
    for fold in 0..n_folds.max(1) {
        let of_fold = validated.map_or(&[][..], |validated| &validated.classifiers[fold]);
        let classifiers = if of_fold.is_empty() { &list.classifiers } else { of_fold };
        let rows: Vec<u32> = (0..data.examples.len() as u32)
            .filter(|&row| n_folds == 0 || usize::from(data.examples[row as usize].fold) == fold)
            .collect();
        let of_rows = table_scores(&data.table, &rows, &CompiledClassifiers::new(classifiers));
        let of_rows = log_confidences(&of_rows, list.temperature);
        for (&row, of_row) in rows.iter().zip(of_rows.chunks_exact(per_example)) {
            scores[row as usize * per_example..][..per_example].copy_from_slice(of_row);
        }
    }
    scores
}

fn training_record(
    maps: &[LabeledMap],
    label_set: &LabelSet,
    config: &NetworkConfig,
    resolution_m: f64,
    report: &NetworkReport,
) -> TrainingRecord {
    let validation = report.list.as_ref().and_then(|list| list.validation.as_ref());
    let IamnConfig { select, exclusion_m, n_blocks, max_exemplars_per_class, learn, .. } = &config.network;
    TrainingRecord {
        program_version: env!("CARGO_PKG_VERSION").to_owned(),
        maps: maps.iter().map(|map| map.record(label_set)).collect(),
        resolution_m,
        training_error: 1.0 - report.network.training_confusion.accuracy().unwrap_or(0.0),
        validation: validation.map(|validation| record(validation, label_set)),
        network: Some(network_record(&report.network)),
        settings: TrainingSettings(serde_json::json!({
            "list": report.list.is_some().then(|| config.base.settings()),
            "n_features": select.n_features,
            "correlation_weight": select.correlation_weight,
            "exclusion_m": exclusion_m,
            "n_blocks": n_blocks,
            "max_exemplars_per_class": max_exemplars_per_class,
            "loss": match learn.loss {
                Loss::Hamming => "hamming",
                Loss::Balanced => "balanced",
                Loss::Root => "root",
            },
            "tolerance": learn.tolerance,
        })),
    }
}

fn network_record(report: &IamnReport) -> NetworkRecord {
    let choice = |tried: &Validated| ChoiceRecord {
        n_neighbors: tried.n_neighbors,
        cost: tried.cost,
        accuracy: tried.confusion.accuracy().unwrap_or(0.0),
        macro_f1: tried.macro_f1,
    };
    let Validated { n_neighbors, cost, .. } = report.validation[report.best];
    NetworkRecord { n_neighbors, cost, choices: report.validation.iter().map(choice).collect() }
}
