//! The results of the experiments: everything in the page and in `results.json`.

use placegraph::eval::{CellScores, ClassScores, Confusion};
use placegraph::grid::{Cell, Grid};
use placegraph::labels::{Label, LabelSet};
use serde::Serialize;

use super::settings::Settings;

/// Everything.
#[derive(Debug, Serialize)]
pub(super) struct Results {
    pub(super) version: &'static str,
    pub(super) settings: Settings,
    pub(super) experiments: Vec<Experiment>,
    /// The chapter's network first, the best one last.
    pub(super) networks: Vec<Network>,
    pub(super) orders: Vec<OrderRow>,
    pub(super) rounds: Vec<Point>,
    pub(super) iterations: Vec<Curve>,
    pub(super) features: Vec<ClassVotes>,
    pub(super) pairs: Vec<Pair>,
    pub(super) drawings: Vec<Drawings>,
}

/// A figure of the chapter: the share of cells that are right, in per cent.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Published {
    /// The decision list alone.
    pub(super) list: f64,
    /// After relaxation and corrections.
    pub(super) corrected: f64,
}

/// One experiment of Sect. 4.8.1 or 4.8.2.
#[derive(Debug, Serialize)]
pub(super) struct Experiment {
    pub(super) section: &'static str,
    /// Begins the names of its pictures.
    pub(super) id: &'static str,
    pub(super) title: &'static str,
    pub(super) published: Published,
    pub(super) chapter: Setting,
    pub(super) best: Setting,
    pub(super) corrections: Vec<Correction>,
    pub(super) errors: Errors,
}

/// A trained model's choices and what it reached, stage by stage.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Setting {
    pub(super) n_training_cells: usize,
    pub(super) rounds: usize,
    pub(super) temperature: f64,
    pub(super) order: Vec<String>,
    pub(super) list: CellScores,
    pub(super) relaxed: CellScores,
    /// With corrections; in the best setting doorways are marked before them.
    pub(super) corrected: CellScores,
    pub(super) n_places: usize,
}

/// What one of the corrections of Sect. 4.7 does to the relaxed labels.
#[derive(Debug, Serialize)]
pub(super) struct Correction {
    pub(super) name: &'static str,
    pub(super) n_relabeled_regions: usize,
    pub(super) n_regions: usize,
    pub(super) scores: CellScores,
}

/// Where wrong cells lie.
#[derive(Debug, Serialize)]
pub(super) struct Errors {
    pub(super) n_wrong: u64,
    /// Wrong cells that are drawn or were labeled as doorway.
    pub(super) n_doorway: u64,
    /// Wrong cells of which the found label is drawn in a neighboring cell.
    pub(super) n_near: u64,
    /// Wrong cells where the second drawing agrees with the found label, if there is one.
    pub(super) n_disputed: Option<u64>,
    /// The largest connected patches of one kind of error.
    pub(super) patches: Vec<Patch>,
}

/// Connected wrong cells of one true and one found class.
#[derive(Debug, Serialize)]
pub(super) struct Patch {
    pub(super) n_cells: u32,
    /// Mean cell center, in meters of the map frame.
    pub(super) center_m: [f64; 2],
    pub(super) truth: String,
    pub(super) found: String,
}

/// A network of Sect. 4.8.3.
#[derive(Debug, Serialize)]
pub(super) struct Network {
    pub(super) title: &'static str,
    pub(super) cell_m: f64,
    pub(super) n_nodes: usize,
    pub(super) n_features: usize,
    pub(super) n_neighbors: usize,
    pub(super) cost: f64,
    /// The scores of the nodes without edges.
    pub(super) alone: CellScores,
    pub(super) found: CellScores,
    /// With doorways marked and corrections, where every cell of the map is a node.
    pub(super) corrected: Option<CellScores>,
}

/// An order of the decision list in Table 4.1.
#[derive(Debug, Serialize)]
pub(super) struct OrderRow {
    pub(super) order: Vec<String>,
    /// Per cent, with the new and the old features.
    pub(super) published: [f64; 2],
    pub(super) held_out_accuracy: Option<f64>,
    pub(super) new: CellScores,
    pub(super) old: CellScores,
    /// With the new features in the best setting.
    pub(super) best: CellScores,
}

/// A point of a curve.
#[derive(Debug, Serialize)]
pub(super) struct Point {
    /// Rounds or iterations.
    pub(super) at: usize,
    pub(super) scores: CellScores,
}

/// The curve of one building.
#[derive(Debug, Serialize)]
pub(super) struct Curve {
    pub(super) title: &'static str,
    pub(super) points: Vec<Point>,
}

/// The most informative features of a class.
#[derive(Debug, Serialize)]
pub(super) struct ClassVotes {
    pub(super) class: String,
    /// Name, description, sum of α.
    pub(super) features: Vec<(String, &'static str, f64)>,
}

/// One building for training and another one for the test.
#[derive(Debug, Serialize)]
pub(super) struct Pair {
    pub(super) train: &'static str,
    pub(super) test: &'static str,
    pub(super) chapter: Setting,
    pub(super) best: Setting,
}

/// A second drawing of a map's labels, judged as if it were found.
#[derive(Debug, Serialize)]
pub(super) struct Drawings {
    pub(super) title: &'static str,
    pub(super) scores: CellScores,
}

/// Labels of `cells` as a grid of the size of `like`.
pub(super) fn painted<T>(like: &Grid<T>, cells: &[Cell], labeling: &[Label]) -> Grid<Option<Label>> {
    let mut grid = Grid::filled(like.width(), like.height(), None);
    for (&cell, &label) in cells.iter().zip(labeling) {
        grid[cell] = Some(label);
    }
    grid
}

/// The measures of the labels of `cells` against `truth`.
pub(super) fn score(cells: &[Cell], labeling: &[Label], truth: &Grid<Option<Label>>) -> CellScores {
    compare(&painted(truth, cells, labeling), truth)
}

/// The measures of `found` against `truth`.
pub(super) fn compare(found: &Grid<Option<Label>>, truth: &Grid<Option<Label>>) -> CellScores {
    let label_set = LabelSet::default();
    Confusion::count(found, truth, &label_set).scores(&label_set)
}

/// The label called doorway; [`LabelSet::default`] has it last.
pub(super) const DOORWAY: Label = Label(2);

/// The rates of doorways.
pub(super) fn doorways(scores: &CellScores) -> &ClassScores {
    &scores.classes[DOORWAY.index()]
}

/// Names of the labels.
pub(super) fn names(order: &[Label]) -> Vec<String> {
    order.iter().map(|&label| LabelSet::default().class(label).name.clone()).collect()
}
