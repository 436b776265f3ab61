//! The chapter as one function: a map and a model in, labels, regions and the topological map out.
//!
//! [`analyze`] reads like the chapter's table of contents. What is freed early, and why, is decided below it.

mod classify;
mod places;
mod smooth;

use crate::doorways::{self, DoorwayConfig};
use crate::grid::{FreeSpace, OccupancyGrid};
use crate::labels::{Label, LabelField, Labeling};
use crate::model::{Method, Model};
use crate::progress::{Progress, Stage};
use crate::regions::{DiagonalSteps, RegionMap, connected, correct, islands, label_islands};
use crate::relax::relax_in_place;
use crate::spaces::{self, SpaceConfig};
use crate::topology::align::Alignment;
use crate::topology::edits::{self, Edit, OnMap, Outcome};
use crate::topology::identity::{Change, MIN_MATCHED_SHARE};
use crate::topology::reach::Robot;
use crate::topology::{PlaceId, TopologicalMap};
use places::{Places, places};

pub use classify::{Classified, classify};
pub use smooth::{Smoothed, smooth};

/// Which stages run with which numbers, and what is known of the map's places before.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// How narrow passages become doorways, whatever their cells were labeled ([`doorways::mark`]). With `None`,
    /// doorways are what the classifier says, as in the chapter.
    pub doorways: Option<DoorwayConfig>,
    /// How the spaces between doorways are labeled as a whole ([`spaces::label`]). With `None`, every cell keeps its own
    /// label, as in the chapter.
    pub spaces: Option<SpaceConfig>,
    /// Whether small regions, and doorways that join nothing, are relabeled (Sect. 4.7).
    pub correction: bool,
    /// Corrections by hand, applied after the automatic ones in this order.
    pub edits: Vec<Edit>,
    /// The robot that routes are laid for.
    pub robot: Robot,
    /// An earlier result: places that are still there keep its numbers and names.
    pub previous: Option<TopologicalMap>,
    /// Whether the earlier result is in another frame: the turn and the shift between them are found first ([`align`]).
    ///
    /// [`align`]: crate::topology::align::align
    pub align_previous: bool,
}

/// How the frame of the earlier result and that of the map fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frames {
    /// Area of the places that were matched one to one, by that of the smaller map. Below [`MIN_MATCHED_SHARE`] the frames disagree: no
    /// number and no name was kept.
    pub matched_share: f64,
    /// The turn and the shift that were found, if they were asked for; only if they are certain they were followed.
    pub alignment: Option<Alignment>,
}

impl Frames {
    /// Whether no number and no name was kept.
    pub fn disagree(&self) -> bool {
        self.matched_share < MIN_MATCHED_SHARE
    }
}

impl Default for Config {
    fn default() -> Self {
        Self {
            doorways: Some(DoorwayConfig::default()),
            spaces: Some(SpaceConfig::default()),
            correction: true,
            edits: Vec::new(),
            robot: Robot::default(),
            previous: None,
            align_previous: false,
        }
    }
}

impl Config {
    /// The chapter's stages alone: nothing between the labels of Sect. 4.5 or 4.6 and the regions of Sect. 4.7.
    pub fn chapter() -> Self {
        Self { doorways: None, spaces: None, ..Self::default() }
    }
}

/// Every result of the pipeline. Fields and labels are over the nodes of `space.graph`.
#[derive(Clone, Debug)]
pub struct Analysis {
    /// The map's free cells and where they are.
    pub space: FreeSpace,
    /// The most probable label of every node by its own scan (Sect. 4.3 or 4.6.1); [`classify`] gives the distributions.
    pub classified: Labeling,
    /// Distribution of every node after smoothing over its neighbors (Sect. 4.5 or 4.6).
    pub smoothed: LabelField,
    /// The regions, corrected if asked for (Sect. 4.7) and edited.
    pub regions: RegionMap,
    /// The label of every node: that of its region.
    pub labeling: Labeling,
    /// The topological map of the regions.
    pub topology: TopologicalMap,
    /// Number of every region's place; `None` for an [island](crate::regions::islands()), which is none.
    pub place_ids: Vec<Option<PlaceId>>,
    /// The map with the walls and openings of the edits, which `space` is that of; `None` where there are none.
    pub drawn: Option<OccupancyGrid>,
    /// What became of every edit.
    pub edit_outcomes: Vec<Outcome>,
    /// What changed since the earlier result; empty without one.
    pub changes: Vec<Change>,
    /// How the frames fit; `None` without an earlier result.
    pub frames: Option<Frames>,
}

/// A map's regions before edits by hand, and what they came of. Fields and labels are over the nodes of `space.graph`.
#[derive(Clone, Debug)]
pub struct Recognized {
    /// The map's free cells and where they are.
    pub space: FreeSpace,
    /// The most probable label of every node by its own scan (Sect. 4.3 or 4.6.1).
    pub classified: Labeling,
    /// Distribution of every node after smoothing over its neighbors (Sect. 4.5 or 4.6).
    pub smoothed: LabelField,
    /// The regions, corrected if asked for (Sect. 4.7).
    pub regions: RegionMap,
}

/// Labels `map` with `model` and builds its topological map.
///
/// Walls and openings among the edits are drawn into the map before; numbers and names then are those of the map without them.
///
/// Same map and model, same bits, on any number of threads. Cost: linear in the free cells.
///
/// # Examples
/// Rooms on both sides of a corridor, 25 cm a letter:
/// ```
/// use placegraph::grid::OccupancyGrid;
/// use placegraph::model::Model;
/// use placegraph::pipeline::{Config, analyze};
/// use placegraph::progress::Silent;
///
/// # let drawing = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/building.txt"));
/// # let drawing = drawing.replace(['c', 'r', 'd'], ".");
/// let map = OccupancyGrid::from_ascii(0.25, &drawing);
/// let analysis = analyze(&map, &Model::builtin(), &Config::default(), &Silent);
/// let drawn = analysis.space.graph.to_ascii(|node| ['c', 'r', 'd'][analysis.labeling[node].index()]);
/// assert_eq!(drawn.lines().nth(6), Some("#rrdddddrr#rrrddddd#rrrdddddrrr#rrdddddrr#"));
/// assert_eq!(drawn.lines().nth(8), Some("#ccdddddccccccdddddccccdddddccccccdddddcc#"));
/// ```
///
/// The middle of the building, as it was labeled:
/// ```text
/// #rrrrrrrrr#rrrrrrrr#rrrrrrrrrrr#rrrrrrrrr#
/// #rrdddddrr#rrrddddd#rrrdddddrrr#rrdddddrr#
/// ####ddd########ddd######ddd########ddd####
/// #ccdddddccccccdddddccccdddddccccccdddddcc#
/// #cccccccccccccccccccccccccccccccccccccccc#
/// #cccccccccccccccccccccccccccccccccccccccc#
/// #ccdddddccccccdddddccccdddddccccccdddddcc#
/// ####ddd########ddd######ddd########ddd####
/// ```
pub fn analyze(map: &OccupancyGrid, model: &Model, config: &Config, progress: &dyn Progress) -> Analysis {
    analyze_with(map, model, config, progress, &mut |map| recognize(map, model, config, progress))
}

/// [`analyze`] with regions that are recognized elsewhere, for example kept from the last time: `recognize` must give what
/// [`recognize`] gives for its map. Only edits and what follows are done again.
pub fn analyze_with(
    map: &OccupancyGrid,
    model: &Model,
    config: &Config,
    progress: &dyn Progress,
    recognize: &mut dyn FnMut(&OccupancyGrid) -> Recognized,
) -> Analysis {
    let Some(OnMap { map: drawn, outcomes }) = edits::apply_to_map(map, &config.edits) else {
        return complete(recognize(map), model, config, progress);
    };
    let previous = config.previous.clone().unwrap_or_else(|| {
        let config = Config { edits: Vec::new(), ..config.clone() };
        complete(recognize(map), model, &config, progress).topology
    });
    let align_previous = config.align_previous && config.previous.is_some();
    let config = Config { previous: Some(previous), align_previous, ..config.clone() };
    let mut analysis = complete(recognize(&drawn), model, &config, progress);
    for (position, outcome) in outcomes {
        analysis.edit_outcomes[position] = outcome;
    }
    analysis.drawn = Some(drawn);
    analysis
}

/// The regions of `map`: all that comes before edits by hand.
pub fn recognize(map: &OccupancyGrid, model: &Model, config: &Config, progress: &dyn Progress) -> Recognized {
    let label_set = &model.label_set;
    let space = FreeSpace::of(map); // the graph G = (V, E): Sect. 4.5

    progress.begin(Stage::Classify); // scans, features, decision list: Sect. 4.2 to 4.4; for a network: 4.6.1
    let classified = classify(map, &space, model, progress);

    progress.begin(Stage::Smooth); // relaxation: Sect. 4.5; or the network: Sect. 4.6
    let Smoothed { classified, mut smoothed, mut labeling } = smooth(&space, classified, model);
    let by_scan = classified.most_likely();

    let mut cuts = Vec::new();
    if let Some(config) = &config.doorways {
        progress.begin(Stage::Doorways); // not in the chapter
        let scans = if let Method::Boosted(_) = &model.method { &classified } else { &smoothed };
        let marked = doorways::mark(&space, [scans, &smoothed], &labeling, label_set, config);
        (labeling, cuts) = (marked.labeling, marked.cuts);
    }

    if let Some(config) = &config.spaces {
        progress.begin(Stage::Spaces); // not in the chapter
        (labeling, smoothed) = label_spaces(&space, classified, smoothed, &labeling, model, config);
        labeling = spaces::label_whole(&space, labeling, &cuts, label_set, config);
    } else {
        drop(classified);
    }

    progress.begin(Stage::Regions); // connected cells of one label: Sect. 4.7
    let mut regions = connected(&space.graph, &labeling, DiagonalSteps::default());
    drop(labeling);

    if config.correction {
        progress.begin(Stage::Correct); // the two heuristics by size: Sect. 4.7
        regions = correct_regions(&space, regions, model);
    }
    Recognized { space, classified: by_scan, smoothed, regions }
}

/// Edits by hand, then places and how they connect: Sect. 4.7.
fn complete(recognized: Recognized, model: &Model, config: &Config, progress: &dyn Progress) -> Analysis {
    let Recognized { space, classified, smoothed, regions } = recognized;
    let Places { regions, topology, place_ids, edit_outcomes, changes, frames } =
        places(&space, &smoothed, regions, model, config, progress);
    let labeling = regions.labeling();
    Analysis {
        space,
        classified,
        smoothed,
        regions,
        labeling,
        topology,
        place_ids,
        drawn: None,
        edit_outcomes,
        changes,
        frames,
    }
}

/// Memory that [`analyze`] and the files of its result take at most beside the map and 64 MB, in bytes: a multiple of the
/// map's cells, of which `n_free` are free, and of the places that they become (`docs/reliability.md`). Most maps take half of
/// it: the bound is that of a map which is one space.
///
/// [`n_parts`] is the least number of places.
pub fn memory_bytes(n_cells: u64, n_free: u64, n_labels: usize, n_places: u64) -> u64 {
    n_cells * 48 + n_free * 9 * n_labels as u64 + n_places * BYTES_PER_PLACE
}

/// What a place takes with its outline, its name, and what is drawn and written of it.
const BYTES_PER_PLACE: u64 = 3000;

/// Number of connected parts of a map's free cells: each becomes a region at least. Takes a part of [`memory_bytes`] and a pass.
pub fn n_parts(map: &OccupancyGrid) -> u64 {
    let space = FreeSpace::of(map);
    let labels = vec![Label(0); space.graph.n_nodes()];
    connected(&space.graph, &labels, DiagonalSteps::default()).regions.len() as u64
}

/// Nodes up to which the smoothed field is kept in addition to the other while spaces are cut. Both and a cut take more memory than
/// all else; of larger maps the field is smoothed again, which is cheap.
const MAX_KEPT: usize = 1 << 20;

/// The labels of the spaces between doorways, and the smoothed field.
fn label_spaces(
    space: &FreeSpace,
    mut classified: LabelField,
    smoothed: LabelField,
    labeling: &[Label],
    model: &Model,
    config: &SpaceConfig,
) -> (Labeling, LabelField) {
    let label = |evidence| spaces::label(space, evidence, labeling, &model.label_set, config);
    match &model.method {
        Method::Boosted(boosted) if space.graph.n_nodes() > MAX_KEPT => {
            drop(smoothed);
            let labeling = label(&classified);
            relax_in_place(&space.graph, &mut classified, &boosted.compatibility, &boosted.relaxation);
            (labeling, classified)
        }
        Method::Boosted(_) => (label(&classified), smoothed),
        // A network learns its node scores together with its edges; alone they say little.
        Method::Iamn(_) => (label(&smoothed), smoothed),
    }
}

/// `found` without regions that are too small for their class; islands take the label of what is around them.
fn correct_regions(space: &FreeSpace, found: RegionMap, model: &Model) -> RegionMap {
    let thresholds = &model.thresholds;
    let corrected = correct(space, &found, &model.label_set, thresholds).regions;
    drop(found);
    let islands = islands(space, &corrected, thresholds.min_island_m2);
    label_islands(&space.graph, corrected, &islands)
}

#[cfg(test)]
#[cfg(feature = "default-model")]
mod tests;
