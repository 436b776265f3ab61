//! Maps that are still growing: one map of a building after the other, places whose numbers and names stay, and
//! work that is not done twice.
//!
//! What the classifier says of a cell depends on its scan alone. A session keeps it, and what stops beams in the map: in the
//! next map only cells that see a change are measured again. All later stages run anew, so every result is that of
//! [`analyze`](crate::pipeline::analyze) with the last result as its `previous`, bit for bit. With
//! [`hold`](crate::pipeline::Config::hold), labels do not flicker, in either.

use std::collections::BTreeMap;

use crate::geom::Point2;
use crate::grid::{Cell, FreeSpace, OccupancyGrid};
use crate::labels::{LabelField, Labeling};
use crate::model::{Method, Model};
use crate::pipeline::{Analysis, Classified, Config, analyze_with, classify, recognize_classified};
use crate::progress::{Progress, Stage};
use crate::scan::{ScanConfig, Stops, may_differ};
use crate::topology::{PlaceId, TopologicalMap};

/// Labels one map of a building after the other.
///
/// # Examples
/// ```
/// use placegraph::grid::OccupancyGrid;
/// use placegraph::model::Model;
/// use placegraph::pipeline::Config;
/// use placegraph::progress::Silent;
/// use placegraph::session::Session;
///
/// let mut session = Session::new(Model::builtin());
/// let half = "##########\n#........?\n#........?\n##########";
/// let first = session.update(&OccupancyGrid::from_ascii(0.5, half), &Config::default(), &Silent);
/// let whole = "###############\n#.............#\n#.............#\n###############";
/// let second = session.update(&OccupancyGrid::from_ascii(0.5, whole), &Config::default(), &Silent);
/// assert_eq!(first.analysis.topology.places[0].id, second.analysis.topology.places[0].id);
/// ```
#[derive(Debug)]
pub struct Session {
    model: Model,
    /// What is known of the scans of the last map, and of that which edits drew of it.
    memories: Vec<Memory>,
    last: Option<Last>,
}

/// A result and how it differs from the last one.
#[derive(Clone, Debug)]
pub struct Update {
    /// The result.
    pub analysis: Analysis,
    /// Free cells whose scan was known, and which were not measured again.
    pub n_reused: usize,
    /// Cells that are free in the last map too.
    pub n_common: usize,
    /// Those among them that have another label.
    pub n_relabeled: usize,
    /// Free cells whose scan was known, but which have another label.
    pub n_flickering: usize,
    /// Places of the last result that are still there: one of now shares more than half of the union of their cells, among those that are
    /// free in both maps.
    pub n_there: usize,
    /// Those among them that have their number.
    pub n_kept: usize,
}

/// What the classifier said of the cells of a map.
#[derive(Clone, Debug)]
struct Memory {
    space: FreeSpace,
    stops: Stops,
    field: LabelField,
}

/// The last result.
#[derive(Clone, Debug)]
struct Last {
    space: FreeSpace,
    labeling: Labeling,
    /// The place of every node.
    places: Vec<Option<PlaceId>>,
    topology: TopologicalMap,
}

impl Session {
    /// A session without any map yet.
    pub fn new(model: Model) -> Self {
        Self { model, memories: Vec::new(), last: None }
    }

    /// The model that maps are labeled with.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The places of the last map.
    pub fn topology(&self) -> Option<&TopologicalMap> {
        self.last.as_ref().map(|last| &last.topology)
    }

    /// Forgets the last result: the next one has new numbers. Scans stay known.
    pub fn forget_places(&mut self) {
        self.last = None;
    }

    /// Labels the next map. Where `config.previous` has no earlier result, the last one stands in for it.
    ///
    /// Cost: beams towards what changed, scans and features of the cells that see it, and all that follows on them. Memory in addition to
    /// that of [`analyze`](crate::pipeline::analyze): a bit a cell, and 4 bytes a free cell for each class.
    pub fn update(&mut self, map: &OccupancyGrid, config: &Config, progress: &dyn Progress) -> Update {
        let mut config = config.clone();
        config.previous = config.previous.or_else(|| self.topology().cloned());
        let Self { model, memories, last } = self;
        let mut before = std::mem::take(memories).into_iter();
        let (mut n_reused, mut is_known) = (0, Vec::new());
        let analysis = analyze_with(map, model, &config, progress, &mut |map| {
            let space = FreeSpace::of(map);
            progress.begin(Stage::Classify);
            let (classified, memory, known) =
                classify_again(map, &space, model, before.next().as_ref(), progress);
            memories.extend(memory);
            n_reused += known.iter().filter(|is_known| **is_known).count();
            is_known = known;
            recognize_classified(space, classified, model, &config, progress)
        });
        let now = Last {
            space: analysis.space.clone(),
            labeling: analysis.labeling.clone(),
            places: analysis
                .regions
                .region_of
                .iter()
                .map(|region| analysis.place_ids[region.index()])
                .collect(),
            topology: analysis.topology.clone(),
        };
        let (n_common, n_relabeled) = last.as_ref().map_or((0, 0), |last| relabeled(last, &now, |_| true));
        // A network knows no scan again.
        let is_known = |node: usize| is_known.get(node).copied().unwrap_or(false);
        let n_flickering = last.as_ref().map_or(0, |last| relabeled(last, &now, is_known).1);
        let (n_there, n_kept) = last.as_ref().map_or((0, 0), |last| kept(last, &now));
        *last = Some(now);
        Update { analysis, n_reused, n_common, n_relabeled, n_flickering, n_there, n_kept }
    }
}

/// What the classifier says of the cells of a map, what to remember of it, and which cells were known.
fn classify_again(
    map: &OccupancyGrid,
    space: &FreeSpace,
    model: &Model,
    memory: Option<&Memory>,
    progress: &dyn Progress,
) -> (Classified, Option<Memory>, Vec<bool>) {
    // A network's potentials are not kept: they are many times as large.
    let Method::Boosted(boosted) = &model.method else {
        return (classify(map, space, model, progress), None, Vec::new());
    };
    let cells = space.graph.cells();
    let stops = Stops::of(map, &model.scan);
    let n_labels = model.label_set.len();
    let mut values = vec![0.0; cells.len() * n_labels];
    let mut unknown = Vec::new();
    let known = memory.map(|memory| Known::new(memory, map, space, &stops, &model.scan));
    for (node, &cell) in cells.iter().enumerate() {
        match known.as_ref().and_then(|known| known.row(node, cell)) {
            Some(row) => values[node * n_labels..(node + 1) * n_labels].copy_from_slice(row),
            None => unknown.push(node),
        }
    }
    let unknown_cells: Vec<Cell> = unknown.iter().map(|&node| cells[node]).collect();
    let mut found = vec![0.0; unknown.len() * n_labels];
    boosted.list.classify_cells(map, &unknown_cells, &model.scan, progress, &mut found);
    for (&node, row) in unknown.iter().zip(found.chunks_exact(n_labels)) {
        values[node * n_labels..(node + 1) * n_labels].copy_from_slice(row);
    }
    let mut is_known = vec![true; cells.len()];
    for &node in &unknown {
        is_known[node] = false;
    }
    let field = LabelField::from_rows(n_labels, values);
    let memory = Memory { space: space.clone(), stops, field: field.clone() };
    (Classified::of_scans(field), Some(memory), is_known)
}

/// A memory, seen from another map of the same building.
struct Known<'a> {
    memory: &'a Memory,
    shift: Shift,
    /// Whether the scan of every node may be another one.
    may_differ: Vec<bool>,
}

impl<'a> Known<'a> {
    fn new(
        memory: &'a Memory,
        map: &OccupancyGrid,
        space: &FreeSpace,
        stops: &Stops,
        config: &ScanConfig,
    ) -> Self {
        let shift = Shift::between(space, &memory.space);
        let moved = (shift.x, shift.y);
        let may_differ = may_differ(map, stops, &memory.stops, moved, space.graph.cells(), config);
        Self { memory, shift, may_differ }
    }

    /// The distribution of the node of `cell` when it was at the same place, if its scan is the same.
    fn row(&self, node: usize, cell: Cell) -> Option<&'a [f32]> {
        let before = (!self.may_differ[node]).then(|| self.shift.node(cell, &self.memory.space))?;
        before.map(|node| self.memory.field.row(node))
    }
}

/// How many cells a grid is moved against another one: SLAM adds cells on all sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shift {
    x: i64,
    y: i64,
}

impl Shift {
    /// The shift that takes cells of `from` to those of `to` at the same place, to the nearest whole cell.
    fn between(from: &FreeSpace, to: &FreeSpace) -> Self {
        let corner = to.frame.cells_from_map(from.frame.map_from_cells(Point2::new(0.0, 0.0)));
        Self { x: corner.x.round() as i64, y: corner.y.round() as i64 }
    }

    /// The node of `to` at the place of `cell`, if it is free there.
    fn node(self, cell: Cell, to: &FreeSpace) -> Option<usize> {
        let moved = |value: u32, by: i64, end: u32| {
            u32::try_from(i64::from(value) + by).ok().filter(|&moved| moved < end)
        };
        let x = moved(cell.x, self.x, to.graph.width())?;
        let y = moved(cell.y, self.y, to.graph.height())?;
        to.graph.node_at(Cell::new(x, y))
    }
}

/// For every cell that is free in both maps: its node then and now.
fn common<'a>(last: &'a Last, now: &'a Last) -> impl Iterator<Item = (usize, usize)> + 'a {
    let shift = Shift::between(&now.space, &last.space);
    let graph = &now.space.graph;
    let cells = graph.cells_in_rows(0..graph.height()).enumerate();
    cells.filter_map(move |(node, cell)| Some((shift.node(cell, &last.space)?, node)))
}

/// Number of cells that are free in both maps and `wanted`, by their node now, and of those that changed their label.
fn relabeled(last: &Last, now: &Last, wanted: impl Fn(usize) -> bool) -> (usize, usize) {
    common(last, now).filter(|&(_, node)| wanted(node)).fold((0, 0), |(n, n_relabeled), (then, node)| {
        (n + 1, n_relabeled + usize::from(last.labeling[then] != now.labeling[node]))
    })
}

/// Number of places of the last result that are still there, and of those that have their number.
fn kept(last: &Last, now: &Last) -> (usize, usize) {
    let (mut n_then, mut n_now, mut n_both) = (BTreeMap::new(), BTreeMap::new(), BTreeMap::new());
    for (then, node) in common(last, now) {
        if let Some((then, now)) = last.places[then].zip(now.places[node]) {
            *n_then.entry(then).or_insert(0) += 1;
            *n_now.entry(now).or_insert(0) += 1;
            *n_both.entry((then, now)).or_insert(0) += 1;
        }
    }
    let is_there =
        |((then, now), n): &(&(PlaceId, PlaceId), &usize)| 2 * **n > n_then[then] + n_now[now] - **n;
    let there: Vec<_> = n_both.iter().filter(is_there).collect();
    (there.len(), there.iter().filter(|((then, now), _)| then == now).count())
}
