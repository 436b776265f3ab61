//! The chapter as one function: a map and a model in, labels, regions and the topological map out.

use crate::doorways::{self, DoorwayConfig};
use crate::grid::{CellGraph, OccupancyGrid};
use crate::labels::{LabelField, Labeling};
use crate::model::{Labeled, Model};
use crate::progress::{Progress, Stage};
use crate::regions::{DiagonalSteps, RegionMap, connected, correct};
use crate::topology::{self, TopologicalMap};

/// What of the pipeline is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Config {
    /// Whether narrow passages between larger spaces are marked as doorways.
    pub doorways: Doorways,
    /// Whether small regions, and doorways that join nothing, are relabeled (Sect. 4.7).
    pub correction: Correction,
}

/// Whether narrow passages become doorways, whatever their cells were labeled ([`doorways::mark`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Doorways {
    /// They do.
    #[default]
    Mark,
    /// Doorways are what the classifier says, as in the chapter.
    Skip,
}

/// Whether the two corrections of Sect. 4.7 are made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Correction {
    /// They are.
    #[default]
    Apply,
    /// Regions stay as they are.
    Skip,
}

impl Default for Config {
    fn default() -> Self {
        Self { doorways: Doorways::Mark, correction: Correction::Apply }
    }
}

/// Every result of the pipeline. Fields and labels are over the nodes of `graph`.
#[derive(Clone, Debug)]
pub struct Analysis {
    /// The map's free cells.
    pub graph: CellGraph,
    /// Distribution of every node by its own scan (Sect. 4.3 or 4.6.1).
    pub classified: LabelField,
    /// The same after the neighbors were heard (Sect. 4.5 or 4.6).
    pub smoothed: LabelField,
    /// The regions, corrected if asked for (Sect. 4.7).
    pub regions: RegionMap,
    /// The label of every node: that of its region.
    pub labeling: Labeling,
    /// The topological map of the regions.
    pub topology: TopologicalMap,
}

/// Labels `map` with `model` and builds its topological map.
///
/// Same map and model, same bits, on any number of threads. Cost: linear in the free cells.
pub fn analyze(map: &OccupancyGrid, model: &Model, config: &Config, progress: &dyn Progress) -> Analysis {
    let graph = CellGraph::new(&map.cells);
    let Labeled { classified, smoothed, mut labeling } = model.label(map, &graph, progress);

    progress.begin(Stage::Correct);
    let resolution_m = map.frame.resolution_m();
    if config.doorways == Doorways::Mark {
        let settings = DoorwayConfig::default();
        labeling = doorways::mark(&graph, resolution_m, &smoothed, &labeling, &model.label_set, &settings);
    }
    let found = connected(&graph, &labeling, DiagonalSteps::default());
    let regions = match config.correction {
        Correction::Skip => found,
        Correction::Apply => {
            correct(&graph, resolution_m, &found, &model.label_set, &model.thresholds).regions
        }
    };
    let labeling = regions.labeling();

    progress.begin(Stage::Topology);
    let topology = topology::build(&graph, &map.frame, &smoothed, &regions, &model.label_set);
    Analysis { graph, classified, smoothed, regions, labeling, topology }
}
