//! The chapter as one function: a map and a model in, labels, regions and the topological map out.
//!
//! [`analyze`] reads like the chapter's table of contents. What is freed early, and why, is decided below it.

mod classify;
mod hold;
mod places;
mod smooth;

use crate::doorways::{self, DoorwayConfig};
use crate::grid::{FreeSpace, OccupancyGrid};
use crate::labels::{Held, Label, LabelField, Labeling};
use crate::model::{Method, Model};
use crate::progress::{Progress, Stage};
use crate::regions::{DiagonalSteps, RegionId, RegionMap, connected, correct, islands, label_islands};
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

/// Which stages run, with which parameters, and what is known about the places of the map already.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// How narrow passages become doorways, whatever labels their cells have ([`doorways::mark`]). With `None`, doorways
    /// come from the classifier alone, as in the chapter.
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
    /// Whether labels of the earlier result are held on to: a doorway that was there, and the class that a cell had, go only with more
    /// evidence than is needed to decide between them anew ([`DoorwayConfig::held_lead`], [`SpaceConfig::held_odds`]). For maps
    /// that grow: labels do not flicker.
    pub hold: bool,
    /// Whether to find the turn and the shift to the frame of the earlier result first ([`align`]).
    ///
    /// [`align`]: crate::topology::align::align
    pub align_previous: bool,
}

/// How well the frame of the earlier result fits that of the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frames {
    /// Area of the places that were matched one to one, divided by the area of the smaller map. Below [`MIN_MATCHED_SHARE`] the
    /// frames disagree: no number or name was kept.
    pub matched_share: f64,
    /// The turn and the shift that were found, if they were asked for. They were applied only if they are certain.
    pub alignment: Option<Alignment>,
}

impl Frames {
    /// Whether the frames disagree, so that no number or name was kept.
    pub fn disagree(&self) -> bool {
        self.matched_share < MIN_MATCHED_SHARE
    }

    /// Why no name of the earlier result was kept, if none was.
    pub fn disagreement(&self) -> Option<String> {
        let tried = match &self.alignment {
            None => "",
            Some(found) if found.is_certain() => ", even after the earlier result was turned and shifted",
            Some(_) => ", and no turn and shift between them is certain",
        };
        let percent = 100.0 * self.matched_share;
        self.disagree().then(|| {
            format!(
                "the frames of the map and of the earlier result do not agree: only {percent:.0} % of the area matches places of \
                 the earlier result{tried}; no numbers or names were kept"
            )
        })
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
            hold: false,
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
    /// The map with the walls and openings of the edits, from which `space` was made; `None` without such edits.
    pub drawn: Option<OccupancyGrid>,
    /// What became of every edit.
    pub edit_outcomes: Vec<Outcome>,
    /// What changed since the earlier result; empty without one.
    pub changes: Vec<Change>,
    /// How the frames fit; `None` without an earlier result.
    pub frames: Option<Frames>,
}

/// A map's regions before edits by hand, and what they were made from. Fields and labels are over the nodes of `space.graph`.
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
    /// The regions that are no places: [`islands()`](crate::regions::islands()), if the regions are corrected.
    pub islands: Vec<RegionId>,
}

/// Labels `map` with `model` and builds its topological map.
///
/// Walls and openings among the edits are drawn into the map first. Numbers and names are those of the map without them.
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

/// [`analyze`] with regions that the caller provides, for example from the last call: `recognize` must return what
/// [`recognize`] returns for its map. Only the edits and the stages after them run.
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

/// The regions of `map`: all stages before edits by hand.
pub fn recognize(map: &OccupancyGrid, model: &Model, config: &Config, progress: &dyn Progress) -> Recognized {
    let space = FreeSpace::of(map); // the graph G = (V, E): Sect. 4.5

    progress.begin(Stage::Classify); // scans, features, decision list: Sect. 4.2 to 4.4; for a network: 4.6.1
    let classified = classify(map, &space, model, progress);
    recognize_classified(space, classified, model, config, progress)
}

/// The regions of a map whose cells are classified.
pub(crate) fn recognize_classified(
    space: FreeSpace,
    classified: Classified,
    model: &Model,
    config: &Config,
    progress: &dyn Progress,
) -> Recognized {
    let label_set = &model.label_set;
    progress.begin(Stage::Smooth); // relaxation: Sect. 4.5; or the network: Sect. 4.6
    let Smoothed { classified, mut smoothed, mut labeling } = smooth(&space, classified, model);
    let by_scan = classified.most_likely();

    let held = hold::labels(&space, label_set, config);
    let mut cuts = Vec::new();
    if let Some(config) = &config.doorways {
        progress.begin(Stage::Doorways); // not in the chapter
        let scans = if let Method::Boosted(_) = &model.method { &classified } else { &smoothed };
        let config = config.heeding(&model.doorways);
        let marked =
            doorways::mark(&space, [scans, &smoothed], &labeling, label_set, &config, held.as_deref());
        (labeling, cuts) = (marked.labeling, marked.cuts);
    }

    if let Some(config) = &config.spaces {
        progress.begin(Stage::Spaces); // not in the chapter
        let pieces = spaces::pieces_between(&space, &labeling, &cuts, label_set);
        let scans = if let Method::Boosted(_) = &model.method { &classified } else { &smoothed };
        // What is known of pieces is known of the evidence of the built-in model.
        let given = if model.labels_as_builtin() {
            spaces::passages(&space, &pieces, [scans, &smoothed], label_set, config)
        } else {
            vec![None; pieces.len()]
        };
        (labeling, smoothed) =
            label_spaces(&space, classified, smoothed, &labeling, model, config, held.as_deref());
        labeling = spaces::label_whole(&space, labeling, &pieces, &given, label_set, config);
    } else {
        drop(classified);
    }

    progress.begin(Stage::Regions); // connected cells of one label: Sect. 4.7
    let mut regions = connected(&space.graph, &labeling, DiagonalSteps::default());
    drop(labeling);

    let mut islands = Vec::new();
    if config.correction {
        progress.begin(Stage::Correct); // the two heuristics by size: Sect. 4.7
        (regions, islands) = correct_regions(&space, regions, model, config.spaces.as_ref());
    }
    Recognized { space, classified: by_scan, smoothed, regions, islands }
}

/// Edits by hand, then places and how they connect: Sect. 4.7.
fn complete(recognized: Recognized, model: &Model, config: &Config, progress: &dyn Progress) -> Analysis {
    let Recognized { space, classified, smoothed, regions, islands } = recognized;
    let Places { regions, topology, place_ids, edit_outcomes, changes, frames } =
        places(&space, &smoothed, regions, &islands, model, config, progress);
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

/// The most memory that [`analyze`] and the files of its result take in addition to the map and 64 MB, in bytes: it grows with the
/// cells of the map, of which `n_free` are free, with its [`parts`], and with the places that they become
/// (`docs/reliability.md`). Most maps take half of it: the bound is that of a map which is one space.
pub fn memory_bytes(n_cells: u64, n_free: u64, n_labels: usize, n_parts: u64, n_places: u64) -> u64 {
    n_cells * 48 + n_free * 9 * n_labels as u64 + n_parts * BYTES_PER_PART + n_places * BYTES_PER_PLACE
}

/// Bytes that a part of the free cells takes as a region.
const BYTES_PER_PART: u64 = 500;

/// Bytes that a place takes with its outline, its name, and its part of the files in all formats: mostly the letters of its name in
/// the picture.
const BYTES_PER_PLACE: u64 = 20_000;

/// The number of connected parts of a map's free cells, each of which becomes at least one region, and the number of those that are
/// not [islands](crate::regions::islands()) and become at least one place. Takes a part of [`memory_bytes`] and a pass.
pub fn parts(map: &OccupancyGrid, min_island_m2: f64) -> (u64, u64) {
    let space = FreeSpace::of(map);
    let labels = vec![Label(0); space.graph.n_nodes()];
    let parts = connected(&space.graph, &labels, DiagonalSteps::default());
    let n_parts = parts.regions.len();
    (n_parts as u64, (n_parts - islands(&space, &parts, min_island_m2).len()) as u64)
}

/// Up to this number of nodes, both the classified and the smoothed field are kept while spaces are cut. Both fields and a cut
/// together are the peak of memory. For larger maps the field is smoothed again, which is cheap.
const MAX_KEPT: usize = 1 << 20;

/// The labels of the spaces between doorways, and the smoothed field.
fn label_spaces(
    space: &FreeSpace,
    mut classified: LabelField,
    smoothed: LabelField,
    labeling: &[Label],
    model: &Model,
    config: &SpaceConfig,
    held: Held<'_>,
) -> (Labeling, LabelField) {
    let label = |evidence| spaces::label(space, evidence, labeling, &model.label_set, config, held);
    match &model.method {
        Method::Boosted(boosted) if space.graph.n_nodes() > MAX_KEPT => {
            drop(smoothed);
            let labeling = label(&classified);
            relax_in_place(&space.graph, &mut classified, &boosted.compatibility, &boosted.relaxation);
            (labeling, classified)
        }
        Method::Boosted(_) => (label(&classified), smoothed),
        // A network learns the scores of nodes together with those of edges; on their own they mean little.
        Method::Iamn(_) => (label(&smoothed), smoothed),
    }
}

/// `found` without regions that are too small for their class and, with `spaces`, without alcoves; and its islands, which take the
/// label of what is around them.
fn correct_regions(
    space: &FreeSpace,
    found: RegionMap,
    model: &Model,
    spaces: Option<&SpaceConfig>,
) -> (RegionMap, Vec<RegionId>) {
    let (label_set, thresholds) = (&model.label_set, &model.thresholds);
    let mut corrected = correct(space, &found, label_set, thresholds).regions;
    drop(found);
    let joined = spaces.and_then(|config| spaces::join_alcoves(space, &corrected, label_set, config));
    if let Some(joined) = joined {
        corrected = correct(space, &joined, label_set, thresholds).regions;
    }
    let islands = islands(space, &corrected, thresholds.min_island_m2);
    (label_islands(&space.graph, corrected, &islands), islands)
}

#[cfg(test)]
#[cfg(feature = "default-model")]
mod tests;
