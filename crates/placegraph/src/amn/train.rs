//! Labeled maps → instance-based network: selection of features, exemplars, the choice of M and C on held-out blocks,
//! and the weights (Sect. 4.6).
//!
//! Cost: cells × exemplars × features for the distances, once, whatever is validated; then some tens of inferences per
//! block, M and C, two fifths of them in parallel at best.
//!
//! **Deviations** from the chapter: a training cell's own exemplar and all within [`IamnConfig::exclusion_m`] do not
//! count as its neighbors. The cell itself would always be at distance 0, and cells beside it nearly so; the weights
//! would trust distances that no new map has. M and C, about which the chapter says nothing, are those with the best
//! macro-averaged F1 on blocks of columns left out in turn.

use rayon::prelude::*;

use super::confidence;
use super::iamn::{IamnModel, Standardization, distance_of_missing};
use super::infer;
use super::learn::{Example, LearnConfig, Learned, Learner};
use super::model::Weights;
use super::nearest::Exemplars;
use crate::features::FeatureTable;
use crate::features::select::{self, SelectConfig, Selection};
use crate::grid::{CellGraph, Grid, Occupancy};
use crate::labels::{Label, Labeling};
use crate::progress::{Progress, Stage};

/// The labeled cells of one map.
#[derive(Clone, Copy, Debug)]
pub struct TrainingMap<'a> {
    /// The cells to learn from; cells without a label, or held out, are no nodes.
    pub graph: &'a CellGraph,
    /// Side of a cell of the graph, in meters.
    pub resolution_m: f64,
}

/// How an instance-based network is trained.
#[derive(Clone, Debug, PartialEq)]
pub struct IamnConfig {
    /// Which features are selected.
    pub select: SelectConfig,
    /// Values of M to try. Default 1 alone.
    pub n_neighbors: Vec<usize>,
    /// Values of C to try, ascending, for losses per cell. Default 10, 100, 1000.
    pub costs: Vec<f64>,
    /// Exemplars closer than this to a training cell, along both axes of its map, do not count for it. Default 1 m.
    pub exclusion_m: f64,
    /// Parts of every map that validation holds out in turn. Default 4.
    pub n_blocks: usize,
    /// Of a class with more cells, evenly many in map order become exemplars. Default 8000.
    pub max_exemplars_per_class: usize,
    /// How weights are learned.
    pub learn: LearnConfig,
}

impl Default for IamnConfig {
    fn default() -> Self {
        Self {
            select: SelectConfig::default(),
            n_neighbors: vec![1],
            costs: vec![10.0, 100.0, 1000.0],
            exclusion_m: 1.0,
            n_blocks: 4,
            max_exemplars_per_class: 8000,
            learn: LearnConfig::default(),
        }
    }
}

/// How training went.
#[derive(Clone, Debug, PartialEq)]
pub struct IamnReport {
    /// The features, with their scores.
    pub selection: Selection,
    /// What every M and C reached on held-out blocks.
    pub validation: Vec<Validated>,
    /// Which of them was taken.
    pub best: usize,
    /// The weights' objective and how learning ended.
    pub learned: Learned,
    /// Training cells by true (row) and found (column) label, K × K; near exemplars did not count for them.
    pub training_confusion: Vec<u64>,
}

/// What one choice of M and C reached on held-out blocks.
#[derive(Clone, Debug, PartialEq)]
pub struct Validated {
    /// M.
    pub n_neighbors: usize,
    /// C.
    pub cost: f64,
    /// Cells by true (row) and found (column) label, K × K.
    pub confusion: Vec<u64>,
    /// Mean F1 over the classes.
    pub macro_f1: f64,
}

/// What is learned from: the nodes of some maps, map after map.
#[derive(Clone, Copy, Debug)]
pub struct LabeledCells<'a> {
    /// The maps.
    pub maps: &'a [TrainingMap<'a>],
    /// The features of their nodes.
    pub table: &'a FeatureTable,
    /// The true labels of their nodes.
    pub labels: &'a [Label],
    /// Number of labels K.
    pub n_labels: usize,
    /// Scores of another classifier, K per node, that become node features as they are; or none. They must come from a
    /// classifier that has not seen the node's surroundings, else the network trusts them too much.
    pub scores: &'a [f32],
}

/// Learns from `cells`.
///
/// # Panics
/// If rows, labels, scores and nodes differ in number, no map is given, or a list of the configuration is empty.
pub fn train(
    cells: &LabeledCells<'_>,
    config: &IamnConfig,
    progress: &dyn Progress,
) -> (IamnModel, IamnReport) {
    progress.begin(Stage::Select);
    let &LabeledCells { table, labels, n_labels, .. } = cells;
    let selection = select::select(table, labels, &config.select);
    let features: Vec<_> = selection.chosen.iter().map(|chosen| chosen.feature).collect();
    let standardization = Standardization::of(table, &features);
    let cells = TrainingCells::new(cells, &standardization, config);

    progress.begin(Stage::Learn);
    let (validation, held_out) = validate(&cells, config, progress);
    let best = (0..validation.len())
        .fold(0, |best, i| if validation[i].macro_f1 > validation[best].macro_f1 { i } else { best });
    let Validated { n_neighbors, cost, .. } = validation[best];
    let temperature = confidence::fit_temperature(&held_out[best].scores, &held_out[best].labels, n_labels);

    let whole: Vec<Part<'_>> = cells.parts(n_neighbors, |_| true, |_| true);
    let learned = Learner::new(&examples(&whole), n_labels, &config.learn).fit(cost);
    let on_training = label_parts(&whole, &learned.weights, config);
    let training_confusion = confusion(&on_training.labels, &on_training.found, n_labels);
    let model = IamnModel {
        n_neighbors,
        exemplars: cells.exemplar_rows,
        exemplar_labels: cells.exemplar_labels,
        weights: learned.weights.clone(),
        connectivity: config.learn.connectivity,
        temperature,
        standardization,
    };
    (model, IamnReport { selection, validation, best, learned, training_confusion })
}

/// What validation found for one M and C, over all held-out blocks.
#[derive(Clone, Debug, Default)]
struct HeldOut {
    scores: Vec<f64>,
    labels: Labeling,
    found: Labeling,
}

/// Every M and C, on every block in turn.
fn validate(
    cells: &TrainingCells<'_>,
    config: &IamnConfig,
    progress: &dyn Progress,
) -> (Vec<Validated>, Vec<HeldOut>) {
    let runs: Vec<(usize, usize)> =
        config.n_neighbors.iter().flat_map(|&m| (0..config.n_blocks).map(move |block| (m, block))).collect();
    let done = std::sync::atomic::AtomicUsize::new(0);
    let of_runs: Vec<Vec<HeldOut>> = runs
        .par_iter()
        .map(|&(n_neighbors, block)| {
            let found = hold_out(cells, n_neighbors, block, config);
            progress.advance(done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1, runs.len());
            found
        })
        .collect();
    let (mut validation, mut all) = (Vec::new(), Vec::new());
    for (of_blocks, &n_neighbors) in of_runs.chunks(config.n_blocks).zip(&config.n_neighbors) {
        for (c, &cost) in config.costs.iter().enumerate() {
            let mut together = HeldOut::default();
            for of_costs in of_blocks {
                together.scores.extend(&of_costs[c].scores);
                together.labels.extend(&of_costs[c].labels);
                together.found.extend(&of_costs[c].found);
            }
            let confusion = confusion(&together.labels, &together.found, cells.n_labels);
            let macro_f1 = macro_f1(&confusion, cells.n_labels);
            validation.push(Validated { n_neighbors, cost, confusion, macro_f1 });
            all.push(together);
        }
    }
    (validation, all)
}

/// Learns without `block` and labels it, for every cost; the costs share their planes.
fn hold_out(
    cells: &TrainingCells<'_>,
    n_neighbors: usize,
    block: usize,
    config: &IamnConfig,
) -> Vec<HeldOut> {
    let rest = cells.parts(n_neighbors, |b| b != block, |b| b != block);
    let tests = cells.parts(n_neighbors, |b| b == block, |b| b != block);
    let mut learner = Learner::new(&examples(&rest), cells.n_labels, &config.learn);
    let of_cost = |&cost: &f64| label_parts(&tests, &learner.fit(cost).weights, config);
    config.costs.iter().map(of_cost).collect()
}

/// Labels all `parts`.
fn label_parts(parts: &[Part<'_>], weights: &Weights, config: &IamnConfig) -> HeldOut {
    let mut held_out = HeldOut::default();
    for Part { graph, features, labels, .. } in parts {
        let potentials = weights.potentials(features, config.learn.connectivity);
        let found = infer::expand(graph, &potentials, &potentials.best_alone());
        held_out.scores.extend(confidence::conditional_scores(graph, &potentials, &found));
        held_out.labels.extend(labels);
        held_out.found.extend(found);
    }
    held_out
}

fn confusion(labels: &[Label], found: &[Label], n_labels: usize) -> Vec<u64> {
    let mut counts = vec![0; n_labels * n_labels];
    for (label, found) in labels.iter().zip(found) {
        counts[label.index() * n_labels + found.index()] += 1;
    }
    counts
}

/// Mean over the classes of 2 TP / (2 TP + FP + FN); classes that do not occur are left out.
fn macro_f1(confusion: &[u64], n_labels: usize) -> f64 {
    let f1 = |k: usize| {
        let right = confusion[k * n_labels + k];
        let of_class: u64 = confusion[k * n_labels..(k + 1) * n_labels].iter().sum();
        let found: u64 = confusion.iter().skip(k).step_by(n_labels).sum();
        (of_class + found > 0).then(|| 2.0 * right as f64 / (of_class + found) as f64)
    };
    let present: Vec<f64> = (0..n_labels).filter_map(f1).collect();
    present.iter().sum::<f64>() / present.len().max(1) as f64
}

/// A part of a training map with the features of its nodes.
struct Part<'a> {
    graph: std::borrow::Cow<'a, CellGraph>,
    features: Vec<f32>,
    labels: Labeling,
}

fn examples<'a>(parts: &'a [Part<'_>]) -> Vec<Example<'a>> {
    parts
        .iter()
        .map(|part| Example { graph: &part.graph, features: &part.features, labels: &part.labels })
        .collect()
}

/// The cells of all maps with their distances to the exemplars of every block.
struct TrainingCells<'a> {
    maps: &'a [TrainingMap<'a>],
    labels: &'a [Label],
    scores: &'a [f32],
    n_labels: usize,
    n_blocks: usize,
    n_features: usize,
    /// Block of every cell.
    blocks: Vec<usize>,
    exemplar_rows: Vec<f32>,
    exemplar_labels: Labeling,
    /// Per cell, class and block the smallest squared distances.
    nearest: Vec<f32>,
    most_neighbors: usize,
}

impl<'a> TrainingCells<'a> {
    fn new(cells: &LabeledCells<'a>, standardization: &Standardization, config: &IamnConfig) -> Self {
        let &LabeledCells { maps, table, labels, n_labels, scores } = cells;
        let rows = standardization.rows(table);
        let n_features = standardization.features.len();
        let n_nodes: usize = maps.iter().map(|map| map.graph.n_nodes()).sum();
        assert!(n_nodes == labels.len() && n_nodes == table.n_rows(), "a row and a label per node");
        assert!(scores.is_empty() || scores.len() == n_labels * n_nodes, "K scores per node, or none");
        let blocks: Vec<usize> = maps.iter().flat_map(|map| blocks_of(map.graph, config.n_blocks)).collect();
        let exemplars = thin(labels, n_labels, config.max_exemplars_per_class);
        let exemplar_rows: Vec<f32> =
            exemplars.iter().flat_map(|&i| &rows[i * n_features..(i + 1) * n_features]).copied().collect();
        let groups: Vec<usize> =
            exemplars.iter().map(|&i| labels[i].index() * config.n_blocks + blocks[i]).collect();
        let most_neighbors = config.n_neighbors.iter().copied().max().unwrap_or(1);
        let search = Exemplars::new(n_features, &exemplar_rows, n_labels * config.n_blocks, &groups);
        let places = places(maps, config.exclusion_m);
        let is_far = |cell: usize, exemplar: u32| places[cell].is_far(places[exemplars[exemplar as usize]]);
        Self {
            nearest: search.nearest(&rows, most_neighbors, is_far),
            exemplar_labels: exemplars.iter().map(|&i| labels[i]).collect(),
            maps,
            labels,
            scores,
            n_labels,
            n_blocks: config.n_blocks,
            n_features,
            blocks,
            exemplar_rows,
            most_neighbors,
        }
    }

    /// The cells of the blocks `of`, with distances to the exemplars of the blocks `to`.
    fn parts(
        &self,
        n_neighbors: usize,
        of: impl Fn(usize) -> bool,
        to: impl Fn(usize) -> bool,
    ) -> Vec<Part<'a>> {
        let mut first = 0;
        let mut parts = Vec::new();
        for map in self.maps {
            let all = first..first + map.graph.n_nodes();
            first = all.end;
            let rows: Vec<usize> = all.clone().filter(|&i| of(self.blocks[i])).collect();
            let graph = if rows.len() == all.len() {
                std::borrow::Cow::Borrowed(map.graph)
            } else {
                std::borrow::Cow::Owned(subgraph(map.graph, rows.iter().map(|&i| i - all.start)))
            };
            let features = rows.iter().flat_map(|&i| self.node_features(i, n_neighbors, &to)).collect();
            parts.push(Part { graph, features, labels: rows.iter().map(|&i| self.labels[i]).collect() });
        }
        parts
    }

    /// τ of cell `i`, Eq. (4.11), from the exemplars of the blocks `to`; then its scores.
    fn node_features(&self, i: usize, n_neighbors: usize, to: &impl Fn(usize) -> bool) -> Vec<f32> {
        let per_class = self.n_blocks * self.most_neighbors;
        let row = &self.nearest[i * self.n_labels * per_class..(i + 1) * self.n_labels * per_class];
        let missing = distance_of_missing(self.n_features);
        let mut distances = Vec::with_capacity(self.n_labels * n_neighbors);
        for of_class in row.chunks_exact(per_class) {
            let blocks = of_class.chunks_exact(self.most_neighbors).enumerate();
            let mut all: Vec<f32> =
                blocks.filter(|&(b, _)| to(b)).flat_map(|(_, nearest)| nearest).copied().collect();
            all.sort_by(f32::total_cmp);
            let smallest = all.iter().take(n_neighbors);
            distances.extend(smallest.map(|d| if d.is_finite() { d.sqrt() } else { missing }));
        }
        if !self.scores.is_empty() {
            distances.extend(&self.scores[i * self.n_labels..(i + 1) * self.n_labels]);
        }
        distances
    }
}

/// Where a cell is: its map, and its position in units of the exclusion radius.
#[derive(Clone, Copy)]
struct Place {
    map: usize,
    x: f64,
    y: f64,
}

impl Place {
    fn is_far(self, other: Self) -> bool {
        self.map != other.map || (self.x - other.x).abs() >= 1.0 || (self.y - other.y).abs() >= 1.0
    }
}

fn places(maps: &[TrainingMap<'_>], exclusion_m: f64) -> Vec<Place> {
    let of_map = |(map, m): (usize, &TrainingMap<'_>)| {
        // Without a radius the cell itself is still left out.
        let unit = m.resolution_m / exclusion_m.max(m.resolution_m);
        let place =
            move |cell: &crate::grid::Cell| Place { map, x: cell.x as f64 * unit, y: cell.y as f64 * unit };
        m.graph.cells().iter().map(place).collect::<Vec<_>>()
    };
    maps.iter().enumerate().flat_map(of_map).collect()
}

/// Cuts a map into `n_blocks` runs of columns with about equally many nodes; the block of every node.
fn blocks_of(graph: &CellGraph, n_blocks: usize) -> Vec<usize> {
    let mut below = vec![0; graph.width() as usize + 1];
    for cell in graph.cells() {
        below[cell.x as usize + 1] += 1;
    }
    for x in 1..below.len() {
        below[x] += below[x - 1];
    }
    graph.cells().iter().map(|cell| below[cell.x as usize] * n_blocks / graph.n_nodes()).collect()
}

/// Of every class at most `most` cells, evenly many in map order; class after class.
fn thin(labels: &[Label], n_labels: usize, most: usize) -> Vec<usize> {
    let mut kept = Vec::new();
    for class in 0..n_labels {
        let of_class: Vec<usize> = (0..labels.len()).filter(|&i| labels[i].index() == class).collect();
        let step = of_class.len().div_ceil(most).max(1);
        kept.extend(of_class.into_iter().step_by(step));
    }
    kept
}

/// The graph over some nodes of `graph`, in the same order.
fn subgraph(graph: &CellGraph, nodes: impl Iterator<Item = usize>) -> CellGraph {
    let mut map = Grid::filled(graph.width(), graph.height(), Occupancy::Unknown);
    for node in nodes {
        map[graph.cells()[node]] = Occupancy::Free;
    }
    CellGraph::new(&map)
}
