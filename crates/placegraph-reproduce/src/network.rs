//! The instance-based network of Sect. 4.8.3 on one building: the left part is learned from, the right one labeled.
//!
//! The chapter's network: nodes are cells at a stride, scans are cast in the map itself. The best setting: every cell is a
//! node and sees a decision list, as `placegraph train --method iamn` makes it.

use anyhow::Result;
use placegraph::amn::{self, IamnConfig, IamnReport, LabeledCells};
use placegraph::eval::CellScores;
use placegraph::features::{self, extract};
use placegraph::grid::{Cell, CellGraph, FreeSpace, Grid, MapFrame, Occupancy, OccupancyGrid};
use placegraph::labels::{Label, LabelSet};
use placegraph::pipeline;
use placegraph::progress::{Progress, Stage};
use placegraph::scan::ScanConfig;
use placegraph::training::{LabeledMap, NetworkConfig, TrainedNetwork, train_network};

use super::buildings::{Building, from_column};
use super::results::{Network, compare, painted, score};

/// First column, and first row from the top, of the cells that are nodes: with these, a stride of 4 leaves the chapter's
/// 8088 nodes of building 79.
const FIRST_COLUMN: u32 = 2;

/// A network's figures, and what it labeled.
#[derive(Debug)]
pub(super) struct NetworkRun {
    pub(super) result: Network,
    /// The map of the nodes, with the drawn labels.
    pub(super) map: LabeledMap,
    /// First column of the test part.
    pub(super) split: u32,
    pub(super) found: Grid<Option<Label>>,
}

/// Every `stride`-th cell of a map.
struct Sampled {
    map: LabeledMap,
    /// First column of the test part.
    split: u32,
    stride: u32,
    /// Column and row of the first cell.
    first: Cell,
}

impl Sampled {
    fn new(building: &Building, stride: u32) -> Self {
        let full = &building.map;
        let (width, height) = (full.grid.cells.width(), full.grid.cells.height());
        let first = Cell::new(FIRST_COLUMN % stride, (height - 1) % stride);
        let cells: Vec<Cell> = (first.y..height)
            .step_by(stride as usize)
            .flat_map(|y| (first.x..width).step_by(stride as usize).map(move |x| Cell::new(x, y)))
            .collect();
        let (width, height) = ((width - first.x).div_ceil(stride), (height - first.y).div_ceil(stride));
        let occupancy = cells.iter().map(|&cell| full.grid.cells[cell]).collect();
        let labels = cells.iter().map(|&cell| full.labels[cell]).collect();
        let frame = coarse_frame(&full.grid.frame, stride);
        let map = LabeledMap {
            name: full.name.clone(),
            grid: OccupancyGrid { frame, cells: Grid::from_rows(width, height, occupancy) },
            labels: Grid::from_rows(width, height, labels),
            window: None,
            building: None,
        };
        Self { map, split: (building.split - first.x).div_ceil(stride), stride, first }
    }

    /// The graph over the free cells that `keep` says, and the cells of the full map they are.
    fn graph(&self, keep: impl Fn(Cell) -> bool) -> (CellGraph, Vec<Cell>) {
        let mut cells = self.map.grid.cells.clone();
        for cell in self.map.grid.cells.cells().filter(|&cell| !keep(cell)) {
            cells[cell] = Occupancy::Unknown;
        }
        let graph = CellGraph::new(&cells);
        let full =
            |cell: &Cell| Cell::new(self.first.x + cell.x * self.stride, self.first.y + cell.y * self.stride);
        let full = graph.cells().iter().map(full).collect();
        (graph, full)
    }
}

/// Cells `stride` times as large; where exactly does not matter to graph and picture.
fn coarse_frame(frame: &MapFrame, stride: u32) -> MapFrame {
    MapFrame::new(frame.resolution_m() * f64::from(stride), frame.map_from_grid()).unwrap_or(*frame)
}

/// Trains and applies the network on every `stride`-th cell of `building`.
pub(super) fn network(
    building: &Building,
    title: &'static str,
    stride: u32,
    config: &IamnConfig,
    progress: &dyn Progress,
) -> NetworkRun {
    let sampled = Sampled::new(building, stride);
    let (labels, split) = (&sampled.map.labels, sampled.split);
    let (graph, cells) = sampled.graph(|cell| cell.x < split && labels[cell].is_some());
    let truth: Vec<Label> = graph.cells().iter().filter_map(|&cell| labels[cell]).collect();
    let scan = ScanConfig::default();
    progress.begin(Stage::Features);
    let table = extract(&building.map.grid, &cells, &features::freiburg203(), &scan, progress);
    let maps = [FreeSpace { frame: sampled.map.grid.frame, graph }];
    let n_labels = LabelSet::default().len();
    let labeled = LabeledCells { maps: &maps, table: &table, labels: &truth, n_labels, scores: &[] };
    let (model, report) = amn::train(&labeled, config, progress);
    drop(table);

    progress.begin(Stage::Smooth);
    let (graph, cells) = sampled.graph(|cell| cell.x >= split);
    let table = extract(&building.map.grid, &cells, &model.standardization.features, &scan, progress);
    let labeled = amn::label(&graph, &model.transform(&table), &model);
    let truth = from_column(split, labels);
    let found = painted(labels, graph.cells(), &labeled.labeling);
    let alone = painted(labels, graph.cells(), &labeled.alone.most_likely());
    let judged = [compare(&alone, &truth), compare(&found, &truth)];
    let result = result(&sampled.map, title, &report, judged, None);
    NetworkRun { result, map: sampled.map, split, found }
}

/// Trains and applies the network on a decision list on every cell of `building`; doorways are marked after it.
pub(super) fn on_a_list(
    building: &Building,
    title: &'static str,
    config: &NetworkConfig,
    progress: &dyn Progress,
) -> Result<NetworkRun> {
    let maps = [building.left()];
    let TrainedNetwork { model, report } = train_network(&maps, &LabelSet::default(), config, progress)?;
    let analysis = pipeline::analyze(&building.map.grid, &model, &pipeline::Config::default(), progress);
    let truth = building.truth_from(building.split);
    let judged = |labeling: &[Label]| score(analysis.space.graph.cells(), labeling, &truth);
    let found = analysis.smoothed.most_likely();
    let stages = [judged(&analysis.classified), judged(&found)];
    let corrected = judged(&analysis.labeling);
    let result = result(&building.map, title, &report.network, stages, Some(corrected));
    let found = painted(&truth, analysis.space.graph.cells(), &found);
    Ok(NetworkRun { result, map: building.map.clone(), split: building.split, found })
}

/// The row of a network on `map`, judged by its node scores alone and as a network.
fn result(
    map: &LabeledMap,
    title: &'static str,
    report: &IamnReport,
    [alone, found]: [CellScores; 2],
    corrected: Option<CellScores>,
) -> Network {
    let chosen = &report.validation[report.best];
    Network {
        title,
        cell_m: map.grid.frame.resolution_m(),
        n_nodes: map.grid.count(Occupancy::Free),
        n_features: report.selection.chosen.len(),
        n_neighbors: chosen.n_neighbors,
        cost: chosen.cost,
        alone,
        found,
        corrected,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_node_is_in_the_top_row_and_the_third_column() {
        // Rows from the top: 0, 4; columns 2, 6. Height 6, so y = 5 and 1.
        let grid = OccupancyGrid::from_ascii(0.05, "..#....\n.......\n.......\n.......\n......#\n.......");
        let labels = grid.cells.map(|_| Some(Label(1)));
        let map = LabeledMap { name: "drawn".into(), grid, labels, window: None, building: None };
        let building = Building { title: "drawn", map, split: 3, second_drawing: None };
        let sampled = Sampled::new(&building, 4);
        let cells = &sampled.map.grid.cells;
        assert_eq!((cells.width(), cells.height(), sampled.split), (2, 2, 1));
        assert_eq!(cells[Cell::new(0, 1)], Occupancy::Occupied);
        assert_eq!(cells[Cell::new(1, 0)], Occupancy::Occupied);
        let (_, full) = sampled.graph(|_| true);
        assert_eq!(full, [Cell::new(2, 1), Cell::new(6, 5)]);
    }
}
