//! The chapter as one function: a map and a model in, labels, regions and the topological map out.

use std::collections::BTreeSet;

use crate::doorways::{self, DoorwayConfig};
use crate::grid::{CellGraph, GridShape, OccupancyGrid};
use crate::labels::{LabelField, Labeling};
use crate::model::{Labeled, Method, Model};
use crate::progress::{Progress, Stage};
use crate::regions::{DiagonalSteps, RegionId, RegionMap, connected, correct, islands, label_islands};
use crate::relax::relax_in_place;
use crate::spaces::{self, SpaceConfig};
use crate::topology::edits::{self, Edit, Edited, NotApplied};
use crate::topology::identity::{CarriedOver, Change, carry_over};
use crate::topology::{self, PlaceId, TopologicalMap};

/// What of the pipeline is run, and what is known of the map's places before.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Config {
    /// Whether narrow passages between larger spaces are marked as doorways, and the spaces between them
    /// labeled as a whole.
    pub doorways: Doorways,
    /// Whether small regions, and doorways that join nothing, are relabeled (Sect. 4.7).
    pub correction: Correction,
    /// Corrections by hand, applied after the automatic ones in this order.
    pub edits: Vec<Edit>,
    /// An earlier result: places that are still there keep its numbers and names.
    pub previous: Option<TopologicalMap>,
}

/// Whether narrow passages become doorways, whatever their cells were labeled ([`doorways::mark`]), and the
/// spaces that they part are labeled as a whole ([`spaces::settle`]).
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

/// Every result of the pipeline. Fields and labels are over the nodes of `graph`.
#[derive(Clone, Debug)]
pub struct Analysis {
    /// The map's free cells.
    pub graph: CellGraph,
    /// The most probable label of every node by its own scan (Sect. 4.3 or 4.6.1); [`Model::label`] gives the distributions.
    pub classified: Labeling,
    /// Distribution of every node after the neighbors were heard (Sect. 4.5 or 4.6).
    pub smoothed: LabelField,
    /// The regions, corrected if asked for (Sect. 4.7) and edited.
    pub regions: RegionMap,
    /// The label of every node: that of its region.
    pub labeling: Labeling,
    /// The topological map of the regions.
    pub topology: TopologicalMap,
    /// Number of every region's place; `None` for an [island](crate::regions::islands()), which is none.
    pub place_ids: Vec<Option<PlaceId>>,
    /// What became of every edit.
    pub edit_outcomes: Vec<Result<(), NotApplied>>,
    /// What changed since the earlier result; empty without one.
    pub changes: Vec<Change>,
}

/// Nodes up to which the smoothed field is kept beside the other while spaces are cut. Both and a cut take more memory than
/// all else; of larger maps the field is smoothed again, which is cheap.
const MAX_KEPT: usize = 1 << 20;

/// Memory that [`analyze`] and the files of its result take at most beside the map and 64 MB, in bytes: a multiple of the
/// map's cells, of which `n_free` are free (`docs/reliability.md`). Most maps take half of it: the bound is that of a map which
/// is one space.
pub fn memory_bytes(n_cells: u64, n_free: u64, n_labels: usize) -> u64 {
    n_cells * 48 + n_free * 9 * n_labels as u64
}

/// Labels `map` with `model` and builds its topological map.
///
/// Same map and model, same bits, on any number of threads. Cost: linear in the free cells.
pub fn analyze(map: &OccupancyGrid, model: &Model, config: &Config, progress: &dyn Progress) -> Analysis {
    let graph = CellGraph::new(&map.cells);
    let labeled = model.label(map, &graph, progress);

    progress.begin(Stage::Correct);
    let by_scan = labeled.classified.most_likely();
    let resolution_m = map.frame.resolution_m();
    let (labeling, smoothed) = between_doorways(&graph, resolution_m, model, labeled, config.doorways);
    let corrected = regions_of(&graph, resolution_m, labeling, model, config.correction);
    let Edited { regions, names, outcomes } =
        edits::apply(&map.frame, &graph, &model.label_set, corrected, &config.edits);
    let labeling = regions.labeling();

    progress.begin(Stage::Topology);
    let mut built = topology::build(&graph, &map.frame, &smoothed, &regions, &model.label_set);
    if config.correction == Correction::Apply {
        let islands = islands(&graph, resolution_m, &regions, model.thresholds.min_island_m2);
        let ids: BTreeSet<PlaceId> = islands.into_iter().map(topology::place_id).collect();
        built.places.retain(|place| !ids.contains(&place.id));
    }
    let names = names.into_iter().map(|(region, name)| (topology::place_id(region), name)).collect();
    let CarriedOver { map: topology, renumbered, changes } = match &config.previous {
        Some(previous) => carry_over(&built, GridShape::of(map), previous, &names),
        None => CarriedOver::first(&built, &names),
    };
    let number = |region| renumbered.get(&topology::place_id(RegionId(region as u32))).copied();
    let place_ids = (0..regions.regions.len()).map(number).collect();
    Analysis {
        graph,
        classified: by_scan,
        smoothed,
        regions,
        labeling,
        topology,
        place_ids,
        edit_outcomes: outcomes,
        changes,
    }
}

/// The labels in and between doorways, or those of `labeled` where doorways are skipped, and the smoothed field.
fn between_doorways(
    graph: &CellGraph,
    resolution_m: f64,
    model: &Model,
    labeled: Labeled,
    doorways: Doorways,
) -> (Labeling, LabelField) {
    let Labeled { mut classified, smoothed, labeling } = labeled;
    if doorways == Doorways::Skip {
        return (labeling, smoothed);
    }
    let label_set = &model.label_set;
    let labeling =
        doorways::mark(graph, resolution_m, &smoothed, &labeling, label_set, &DoorwayConfig::default());
    let config = SpaceConfig::default();
    let settle = |evidence| spaces::settle(graph, resolution_m, evidence, &labeling, label_set, &config);
    match &model.method {
        Method::Boosted(boosted) if graph.n_nodes() > MAX_KEPT => {
            drop(smoothed);
            let settled = settle(&classified);
            relax_in_place(graph, &mut classified, &boosted.compatibility, &boosted.relaxation);
            (settled, classified)
        }
        Method::Boosted(_) => (settle(&classified), smoothed),
        // A network learns its node scores together with its edges; alone they say little.
        Method::Iamn(_) => (settle(&smoothed), smoothed),
    }
}

/// The regions of `labeling`, corrected if asked for (Sect. 4.7).
fn regions_of(
    graph: &CellGraph,
    resolution_m: f64,
    labeling: Labeling,
    model: &Model,
    correction: Correction,
) -> RegionMap {
    let found = connected(graph, &labeling, DiagonalSteps::default());
    drop(labeling);
    if correction == Correction::Skip {
        return found;
    }
    let thresholds = &model.thresholds;
    let corrected = correct(graph, resolution_m, &found, &model.label_set, thresholds).regions;
    drop(found);
    let islands = islands(graph, resolution_m, &corrected, thresholds.min_island_m2);
    label_islands(graph, corrected, &islands)
}
