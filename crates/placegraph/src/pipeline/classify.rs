//! Sect. 4.2 to 4.4, or 4.6.1: what every free cell's own scan says of it.

use std::ops::Range;

use crate::boost::DecisionList;
use crate::cuts::Potentials;
use crate::grid::{Cell, CellGraph, FreeSpace, OccupancyGrid};
use crate::labels::LabelField;
use crate::model::{BoostedModel, Method, Model};
use crate::progress::{Progress, Stage};
use crate::scan::ScanConfig;

/// Cells that are classified at a time: what is stored of each meanwhile takes 8 bytes.
const MIN_STRIP: usize = 1 << 19;
/// Most strips of a map: each takes a pass over the map.
const MAX_STRIPS: usize = 16;

/// What every node's own scan says of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Classified {
    /// Distribution of every node by its own scan (Sect. 4.3 or 4.6.1).
    pub field: LabelField,
    /// The potentials of Eq. (4.9), if the model is a network.
    pub(super) potentials: Option<Potentials>,
}

impl Classified {
    /// What a decision list says.
    pub(crate) fn of_scans(field: LabelField) -> Self {
        Self { field, potentials: None }
    }
}

/// Classifies the free cells of `map`, each by its own scan: scans, features and the decision list (Sect. 4.2 to 4.4), or the
/// node potentials of a network (Sect. 4.6.1).
///
/// # Examples
/// ```
/// use placegraph::grid::{FreeSpace, OccupancyGrid};
/// use placegraph::model::Model;
/// use placegraph::pipeline::{classify, smooth};
/// use placegraph::progress::Silent;
///
/// # let drawing = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/building.txt"));
/// # let drawing = drawing.replace(['c', 'r', 'd'], ".");
/// let (map, model) = (OccupancyGrid::from_ascii(0.25, &drawing), Model::builtin());
/// let space = FreeSpace::of(&map);
/// let found = smooth(&space, classify(&map, &space, &model, &Silent), &model);
/// // What single scans say is ragged; the neighbors make it even.
/// let n_changed = found.classified.most_likely().iter().zip(&found.labeling).filter(|(a, b)| a != b).count();
/// assert!(n_changed > 0);
/// ```
///
/// Memory of the boosted method, in addition to the result: half a byte a cell, or 4 MB.
pub fn classify(
    map: &OccupancyGrid,
    space: &FreeSpace,
    model: &Model,
    progress: &dyn Progress,
) -> Classified {
    let graph = &space.graph;
    match &model.method {
        Method::Boosted(BoostedModel { list, .. }) => {
            let n_nodes = MIN_STRIP.max(graph.n_nodes().div_ceil(MAX_STRIPS));
            let field = classify_in_strips(map, graph, list, &model.scan, n_nodes, progress);
            Classified::of_scans(field)
        }
        Method::Iamn(network) => {
            let features = network.node_features(map, graph.cells(), &model.scan, progress);
            let potentials = network.network.potentials(&features);
            Classified { field: network.network.alone(&potentials), potentials: Some(potentials) }
        }
    }
}

/// The distribution that `list` gives every node, in strips of about `n_nodes` nodes.
fn classify_in_strips(
    map: &OccupancyGrid,
    graph: &CellGraph,
    list: &DecisionList,
    scan: &ScanConfig,
    n_nodes: usize,
    progress: &dyn Progress,
) -> LabelField {
    let n_labels = list.order.len();
    let mut values = vec![0.0; graph.n_nodes() * n_labels];
    for rows in strips(graph, n_nodes) {
        let nodes = graph.nodes_in_rows(rows.clone());
        let part = PartOfStage { whole: progress, done: nodes.start, total: graph.n_nodes() };
        let mut cells: Vec<Cell> = Vec::with_capacity(nodes.len());
        cells.extend(graph.cells_in_rows(rows));
        let field = &mut values[nodes.start * n_labels..nodes.end * n_labels];
        list.classify_cells(map, &cells, scan, &part, field);
    }
    LabelField::from_rows(n_labels, values)
}

/// The rows of the map in strips of at least `n_nodes` nodes, but for the last. Scans are cast for 8 rows at a time.
fn strips(graph: &CellGraph, n_nodes: usize) -> Vec<Range<u32>> {
    let mut strips: Vec<Range<u32>> = Vec::new();
    for y in (0..graph.height()).step_by(8) {
        let end = graph.height().min(y + 8);
        match strips.last_mut() {
            Some(strip) if graph.nodes_in_rows(strip.clone()).len() < n_nodes => strip.end = end,
            _ => strips.push(y..end),
        }
    }
    strips
}

/// The progress of a part of a stage.
struct PartOfStage<'a> {
    whole: &'a dyn Progress,
    done: usize,
    total: usize,
}

impl Progress for PartOfStage<'_> {
    fn begin(&self, stage: Stage) {
        self.whole.begin(stage);
    }

    fn advance(&self, done: usize, _: usize) {
        self.whole.advance(self.done + done, self.total);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boost::{DecisionStump, Polarity, StrongClassifier, WeightedStump};
    use crate::features::FeatureId;
    use crate::grid::{Grid, Occupancy};
    use crate::labels::Label;
    use crate::progress::Silent;

    #[test]
    fn strips_of_any_size_give_the_same_distributions() {
        let mut cells = Grid::filled(150, 90, Occupancy::Free);
        for cell in cells.cells().filter(|cell| cell.x % 50 == 20 && cell.y % 40 > 9) {
            cells[cell] = Occupancy::Occupied;
        }
        let map = OccupancyGrid { cells, ..OccupancyGrid::from_ascii(0.05, ".") };
        let graph = CellGraph::new(&map.cells);
        let classifier = |name: &str, threshold| {
            let feature = FeatureId::from_name(name).unwrap();
            let stump = DecisionStump { feature, threshold, polarity: Polarity::Below };
            StrongClassifier { stumps: vec![WeightedStump { stump, alpha: 0.5 }] }
        };
        let list = DecisionList {
            order: vec![Label(1), Label(0)],
            classifiers: vec![classifier("A1", 1.0), classifier("B1", 9.0)],
            temperature: 1.0,
        };
        let field =
            |n_nodes| classify_in_strips(&map, &graph, &list, &ScanConfig::default(), n_nodes, &Silent);
        let whole = field(usize::MAX);
        assert!(strips(&graph, 1).len() == 12 && strips(&graph, usize::MAX).len() == 1);
        assert!(field(1) == whole && field(3000) == whole);
        assert!(whole.most_likely().contains(&Label(0)) && whole.most_likely().contains(&Label(1)));
    }
}
