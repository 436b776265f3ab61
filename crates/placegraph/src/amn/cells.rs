//! The training cells of a network, with their distances to the exemplars (Eq. 4.11), computed once for all parts of
//! the maps that are held out. Cost: cells × exemplars × features.

use std::borrow::Cow;

use super::config::IamnConfig;
use super::iamn::{Standardization, distance_of_missing};
use super::nearest::Exemplars;
use crate::features::FeatureTable;
use crate::grid::{Cell, CellGraph, FreeSpace, Grid, Occupancy};
use crate::labels::{Label, Labeling};

/// Training data of a network: the nodes of some maps, map after map.
#[derive(Clone, Copy, Debug)]
pub struct LabeledCells<'a> {
    /// The training cells of each map; cells that have no label or are held out have no node.
    pub maps: &'a [FreeSpace],
    /// The features of their nodes.
    pub table: &'a FeatureTable,
    /// The true labels of their nodes.
    pub labels: &'a [Label],
    /// Number of labels K.
    pub n_labels: usize,
    /// Scores of another classifier, equally many for every node, that become node features unchanged; may be empty.
    /// They must come from a classifier that has not seen the surroundings of the node; otherwise the network trusts
    /// them too much.
    pub scores: &'a [f32],
}

/// A part of a map with the features of its nodes.
pub(super) struct MapPart<'a> {
    pub(super) graph: Cow<'a, CellGraph>,
    pub(super) features: Vec<f32>,
    pub(super) labels: Labeling,
}

/// The cells of all maps with their distances to the exemplars of every block.
pub(super) struct TrainingCells<'a> {
    maps: &'a [FreeSpace],
    labels: &'a [Label],
    scores: &'a [f32],
    pub(super) n_labels: usize,
    n_blocks: usize,
    n_features: usize,
    /// Block of every cell.
    blocks: Vec<usize>,
    pub(super) exemplar_rows: Vec<f32>,
    pub(super) exemplar_labels: Labeling,
    /// Per cell, class and block the smallest squared distances.
    nearest: Vec<f32>,
    most_neighbors: usize,
}

impl<'a> TrainingCells<'a> {
    pub(super) fn new(
        cells: &LabeledCells<'a>,
        standardization: &Standardization,
        config: &IamnConfig,
    ) -> Self {
        let &LabeledCells { maps, table, labels, n_labels, scores } = cells;
        let rows = standardization.rows(table);
        let n_features = standardization.features.len();
        let n_nodes: usize = maps.iter().map(|map| map.graph.n_nodes()).sum();
        assert!(n_nodes == labels.len() && n_nodes == table.n_rows(), "a row and a label per node");
        assert!(scores.len().is_multiple_of(n_nodes.max(1)), "as many scores for every node");
        let blocks: Vec<usize> = maps.iter().flat_map(|map| blocks_of(&map.graph, config.n_blocks)).collect();
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
    pub(super) fn parts(
        &self,
        n_neighbors: usize,
        of: impl Fn(usize) -> bool,
        to: impl Fn(usize) -> bool,
    ) -> Vec<MapPart<'a>> {
        let mut first = 0;
        let mut parts = Vec::new();
        for map in self.maps {
            let all = first..first + map.graph.n_nodes();
            first = all.end;
            let rows: Vec<usize> = all.clone().filter(|&i| of(self.blocks[i])).collect();
            let graph = if rows.len() == all.len() {
                Cow::Borrowed(&map.graph)
            } else {
                Cow::Owned(subgraph(&map.graph, rows.iter().map(|&i| i - all.start)))
            };
            let features = rows.iter().flat_map(|&i| self.node_features(i, n_neighbors, &to)).collect();
            parts.push(MapPart { graph, features, labels: rows.iter().map(|&i| self.labels[i]).collect() });
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
        let n_scores = self.scores.len() / self.labels.len();
        distances.extend(&self.scores[i * n_scores..(i + 1) * n_scores]);
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

fn places(maps: &[FreeSpace], exclusion_m: f64) -> Vec<Place> {
    let of_map = |(map, m): (usize, &FreeSpace)| {
        // Without a radius the cell itself is still left out.
        let unit = m.resolution_m() / exclusion_m.max(m.resolution_m());
        let place = move |cell: &Cell| Place { map, x: cell.x as f64 * unit, y: cell.y as f64 * unit };
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::FeatureId;
    use crate::grid::OccupancyGrid;

    fn graph(row: &str) -> CellGraph {
        CellGraph::new(&OccupancyGrid::from_ascii(0.5, row).cells)
    }

    #[test]
    fn blocks_are_runs_of_columns_with_equally_many_cells() {
        assert_eq!(blocks_of(&graph("..#....."), 2), [0, 0, 0, 0, 1, 1, 1]);
    }

    #[test]
    fn exemplars_are_spread_over_the_map() {
        let mut labels = vec![Label(0); 10];
        labels[5] = Label(1);
        assert_eq!(thin(&labels, 2, 3), [0, 3, 7, 5]);
        assert_eq!(thin(&labels, 2, 20).len(), 10);
    }

    #[test]
    fn near_exemplars_do_not_count_for_a_training_cell() {
        let table = FeatureTable::from_columns(vec![FeatureId(0)], 6, (0..6u8).map(f32::from).collect());
        let labels = [0, 0, 0, 0, 0, 1].map(Label);
        let maps = [FreeSpace::of(&OccupancyGrid::from_ascii(0.5, "......"))];
        let scores: Vec<f32> = (0..6u8).map(|i| f32::from(i) / 8.0).collect();
        let cells =
            LabeledCells { maps: &maps, table: &table, labels: &labels, n_labels: 2, scores: &scores };
        let standardization =
            Standardization { features: vec![FeatureId(0)], mean: vec![0.0], deviation: vec![1.0] };
        for (exclusion_m, nearest) in [(0.0, 1.0), (1.0, 2.0), (1.5, 3.0)] {
            let config =
                IamnConfig { exclusion_m, n_neighbors: vec![1], n_blocks: 2, ..IamnConfig::default() };
            let cells = TrainingCells::new(&cells, &standardization, &config);
            assert_eq!(cells.node_features(1, 1, &|_| true), [nearest, 4.0, 0.125]);
            // No other cell has the class of the last.
            assert_eq!(cells.node_features(5, 1, &|_| true)[1..], [2f32.sqrt(), 0.625]);
        }
    }
}
