//! Instance-based networks on hand-labeled maps of the chapter's buildings (Sect. 4.8.4): trained on the left halves, judged
//! on the right ones.
//!
//! Reads the folder named by `PLACEGRAPH_DATA`; without it the tests are skipped. No setting was chosen by these
//! results; lists are shorter and exemplars fewer than by default, to keep the test short.

use placegraph::amn::{self, IamnConfig, LabeledCells};
use placegraph::features::extract;
use placegraph::geom::Pose2;
use placegraph::grid::{Cell, CellGraph, FreeSpace, Grid, MapFrame, Occupancy};
use placegraph::labels::{Label, LabelSet};
use placegraph::pipeline::{classify, smooth};
use placegraph::progress::Silent;
use placegraph::scan::ScanConfig;
use placegraph::training::{Choice, LabeledMap, NetworkConfig, TrainConfig, train_network};

use crate::labeled_halves::{evaluate, labeled_map};

/// Every fourth cell along both axes.
const STRIDE: u32 = 4;

/// The graph in which every `STRIDE`-th cell is next to the following one.
fn coarse_graph(cells: &[Cell]) -> CellGraph {
    let coarse = |v: u32| v / STRIDE;
    let width = cells.iter().map(|c| coarse(c.x) + 1).max().unwrap();
    let height = cells.iter().map(|c| coarse(c.y) + 1).max().unwrap();
    let mut map = Grid::filled(width, height, Occupancy::Unknown);
    for c in cells {
        map[Cell::new(coarse(c.x), coarse(c.y))] = Occupancy::Free;
    }
    CellGraph::new(&map)
}

#[test]
fn the_chapters_network_on_building_79_at_20_cm() {
    const SPLIT: u32 = 350;
    let Some(map) = labeled_map("fr79_slam", Some(SPLIT)) else { return };
    // Row 0 from the top and column 2: exactly the number of nodes that the chapter gives.
    let top = map.grid.cells.height() - 1;
    let is_sampled = |cell: &Cell| (top - cell.y).is_multiple_of(STRIDE) && cell.x % STRIDE == 2;
    let free = |cell: &Cell| map.grid.is_free(*cell);
    let sampled: Vec<Cell> = map.grid.cells.cells().filter(is_sampled).filter(free).collect();
    assert_eq!(sampled.len(), 8088);
    let (train, labels): (Vec<Cell>, Vec<Label>) =
        map.labeled_cells().filter(|(cell, _)| is_sampled(cell)).unzip();
    let test: Vec<Cell> = sampled.into_iter().filter(|cell| cell.x >= SPLIT).collect();

    let NetworkConfig { base, network, .. } = NetworkConfig::chapter();
    let scan = ScanConfig::default();
    let table = extract(&map.grid, &train, &base.features, &scan, &Silent);
    let graph = coarse_graph(&train);
    let maps = [FreeSpace { frame: MapFrame::new(0.2, Pose2::default()).unwrap(), graph }];
    let cells = LabeledCells { maps: &maps, table: &table, labels: &labels, n_labels: 3, scores: &[] };
    let (model, report) = amn::train(&cells, &network, &Silent);
    assert_eq!(report.selection.chosen.len(), 30);
    let table = extract(&map.grid, &test, &model.standardization.features, &scan, &Silent);
    let found = amn::label(&coarse_graph(&test), &model.transform(&table), &model);
    let (accuracy, _) = evaluate(&map, &test, &found.labeling, SPLIT, "network alone, 20 cm");
    // What the chapter reports, on labels of its own.
    assert!(accuracy >= 0.976, "{accuracy}");
}

/// A list of 50 rounds, fewer exemplars, two blocks and one C.
fn short() -> NetworkConfig {
    let config = NetworkConfig::default();
    NetworkConfig {
        base: TrainConfig { rounds: Choice::Set(50), max_cells_per_class: Some(2000), ..config.base },
        network: IamnConfig {
            max_exemplars_per_class: 1000,
            n_blocks: 2,
            costs: vec![100.0],
            ..config.network
        },
        ..config
    }
}

fn left_to_right(name: &str, split: u32) -> Option<(f64, f64)> {
    let map = labeled_map(name, Some(split))?;
    let maps: &[LabeledMap] = std::slice::from_ref(&map);
    let model = train_network(maps, &LabelSet::default(), &short(), &Silent).unwrap().model;
    let space = FreeSpace::of(&map.grid);
    let found = smooth(&space, classify(&map.grid, &space, &model, &Silent), &model);
    assert_eq!(found.smoothed.most_likely(), found.labeling);
    Some(evaluate(&map, space.graph.cells(), &found.labeling, split, "network on a list, 5 cm"))
}

#[test]
fn building_79_at_5_cm() {
    let Some((accuracy, doorway_recall)) = left_to_right("fr79_slam", 350) else { return };
    assert!(accuracy >= 0.978 && doorway_recall > 0.3, "{accuracy}, doorways {doorway_recall}");
}

#[test]
fn building_52_at_5_cm() {
    let Some((accuracy, doorway_recall)) = left_to_right("fr52_slam", 270) else { return };
    assert!(accuracy >= 0.978 && doorway_recall > 0.3, "{accuracy}, doorways {doorway_recall}");
}
