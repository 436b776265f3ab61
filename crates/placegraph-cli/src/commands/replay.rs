//! `placegraph replay`: a map that grows, one state after the other, with what changed at each step.

use std::collections::BTreeSet;
use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};
use placegraph::export::{MapInfo, TopologyDocument, label_png, overview_png};
use placegraph::geom::Point2;
use placegraph::grid::OccupancyGrid;
use placegraph::import::recording::{self, Recording};
use placegraph::import::{MapError, ReadOptions};
use placegraph::model::sha256_hex;
use placegraph::pipeline::{self, Analysis, Config};
use placegraph::progress::Silent;
use placegraph::result::{Files, seal};
use placegraph::session::{Session, Update};
use placegraph::topology::identity::Change;
use placegraph::topology::{PlaceId, TopologicalMap};

use super::{Outcome, map};
use crate::args::ReplayArgs;
use crate::model::NamedModel;
use crate::output::{Existing, OutputSet, csv_row, print};
use crate::read;

/// Name of the table.
const TABLE: &str = "replay.csv";

/// The columns of the table.
const COLUMNS: [&str; 20] = [
    "step",
    "map",
    "free_cells",
    "reused",
    "relabeled",
    "flicker",
    "places",
    "there",
    "there_kept",
    "kept",
    "appeared",
    "vanished",
    "split",
    "merged",
    "doorways",
    "doorways_lost",
    "doorways_found",
    "doorways_back",
    "seconds",
    "fresh_seconds",
];

/// Labels all maps, writes the files, and prints a line for each map.
pub(crate) fn run(args: &ReplayArgs) -> Result<Outcome> {
    let model = NamedModel::load(args.model.as_deref())?;
    let edits = args.edits.as_deref().map(map::read_edits).transpose()?;
    let edits = edits.map(|(edits, _)| edits).unwrap_or_default();
    let config = Config { edits, hold: !args.no_hold, ..Config::default() };
    let mut replay = Replay {
        session: Session::new(model.model.clone()),
        model,
        config,
        check: args.check,
        files: Files::new(),
        table: csv_row(COLUMNS.iter().map(|&name| name.to_owned())),
        n_steps: 0,
        n_differ: 0,
        seen: BTreeSet::new(),
        lost: Vec::new(),
        last: None,
        labels: Vec::new(),
    };
    let result = for_each_map(args, &mut |name, grid, hash| replay.step(name, grid, &hash));
    result.with_context(|| args.source.display().to_string())?;
    replay.finish(args)
}

/// Calls `each` with the name, the map and the hash of every state.
fn for_each_map(
    args: &ReplayArgs,
    each: &mut dyn FnMut(&str, &OccupancyGrid, String) -> Result<()>,
) -> Result<()> {
    if map::is_folder_of_maps(&args.source) {
        let maps = map::maps_in(&args.source, &args.out)?;
        ensure!(!maps.is_empty(), "expected maps, found none");
        for path in maps {
            let map = read::map(&path, &args.read)?;
            let name = path.strip_prefix(&args.source).unwrap_or(&path).display().to_string();
            each(&name, &map.grid, map.hash)?;
        }
        return Ok(());
    }
    let mut options = read::options(&args.read);
    options.topic = Some(topic(&args.source, &options).map_err(read::told)?);
    recording::grids(Recording::open(&args.source)?, &options, &mut |recorded| {
        let (grid, _) = recording::map_of(&recorded, &options)?;
        let seconds = Duration::from_nanos(recorded.log_time_ns).as_secs_f64();
        each(&format!("{seconds:.3}"), &grid, sha256_hex(&recorded.cdr))
    })?;
    Ok(())
}

/// The topic whose maps are meant.
fn topic(source: &Path, options: &ReadOptions) -> Result<String, MapError> {
    let mut found = BTreeSet::new();
    let all = recording::grids(Recording::open(source)?, options, &mut |grid| {
        found.insert(grid.topic);
        Ok::<(), MapError>(())
    })?;
    let all = || all.iter().cloned().collect();
    match (found.pop_first(), found.is_empty(), &options.topic) {
        (Some(topic), true, _) => Ok(topic),
        (Some(_), false, _) => Err(MapError::SeveralTopics { found: all() }),
        (None, _, Some(topic)) => Err(MapError::NoSuchTopic { topic: topic.clone(), found: all() }),
        (None, _, None) => Err(MapError::NoRecordedGrid),
    }
}

/// What is known while maps go by.
struct Replay {
    session: Session,
    model: NamedModel,
    config: Config,
    /// Whether every map is labeled anew as well.
    check: bool,
    files: Files,
    table: String,
    n_steps: usize,
    /// Steps whose result was not that of a map labeled anew.
    n_differ: usize,
    /// Numbers of all doorways that were there once.
    seen: BTreeSet<PlaceId>,
    /// Where doorways were that are not there any more.
    lost: Vec<Point2>,
    last: Option<(TopologicalMap, MapInfo)>,
    /// The label image of the last step.
    labels: Vec<u8>,
}

/// Doorways nearer than this are the same one.
const SAME_DOORWAY_M: f64 = 0.5;

/// The middles of all doorways.
fn middles(map: &TopologicalMap) -> Vec<Point2> {
    let doorways = map.places.iter().filter_map(|place| place.doorway.as_ref());
    doorways.map(|doorway| doorway.jambs[0].midpoint(doorway.jambs[1])).collect()
}

impl Replay {
    fn step(&mut self, name: &str, grid: &OccupancyGrid, hash: &str) -> Result<()> {
        self.n_steps += 1;
        let previous = self.session.topology().cloned();
        let started = Instant::now();
        let update = self.session.update(grid, &self.config, &Silent);
        let seconds = started.elapsed().as_secs_f64();
        let mut fresh_seconds = String::new();
        if self.check {
            let started = Instant::now();
            let config = Config { previous: previous.clone(), ..self.config.clone() };
            let fresh = pipeline::analyze(grid, &self.model.model, &config, &Silent);
            fresh_seconds = format!("{:.3}", started.elapsed().as_secs_f64());
            self.n_differ += usize::from(!is_same(&fresh, &update.analysis));
        }
        let Update { analysis, n_reused, n_common, n_relabeled, n_flickering, n_there, n_kept: n_there_kept } =
            &update;
        let topology = &analysis.topology;
        let n_free = analysis.space.graph.n_nodes();
        let share = |part: usize, whole: usize| format!("{:.4}", part as f64 / whole.max(1) as f64);
        let before: BTreeSet<PlaceId> =
            previous.iter().flat_map(|map| &map.places).map(|place| place.id).collect();
        let n_kept = topology.places.iter().filter(|place| before.contains(&place.id)).count();
        let n_of = |is: fn(&Change) -> bool| analysis.changes.iter().filter(|change| is(change)).count();
        let doorways: BTreeSet<PlaceId> =
            topology.places.iter().filter(|place| place.doorway.is_some()).map(|place| place.id).collect();
        let n_back = doorways.iter().filter(|id| self.seen.contains(id) && !before.contains(id)).count();
        self.seen.extend(&doorways);
        let middles = middles(topology);
        let is_near = |a: &Point2, b: &[Point2]| b.iter().any(|b| a.distance(*b) < SAME_DOORWAY_M);
        let n_open = self.lost.len();
        self.lost.retain(|lost| !is_near(lost, &middles));
        let n_found = n_open - self.lost.len();
        let before_middles = previous.as_ref().map(self::middles).unwrap_or_default();
        let lost = before_middles.into_iter().filter(|middle| !is_near(middle, &middles));
        let n_lost = lost.clone().count();
        self.lost.extend(lost);
        let row = [
            self.n_steps.to_string(),
            name.to_owned(),
            n_free.to_string(),
            share(*n_reused, n_free),
            share(*n_relabeled, *n_common),
            share(*n_flickering, *n_reused),
            topology.places.len().to_string(),
            n_there.to_string(),
            n_there_kept.to_string(),
            n_kept.to_string(),
            n_of(|change| matches!(change, Change::Appeared { .. })).to_string(),
            n_of(|change| matches!(change, Change::Vanished { .. })).to_string(),
            n_of(|change| matches!(change, Change::Split { .. })).to_string(),
            n_of(|change| matches!(change, Change::Merged { .. })).to_string(),
            doorways.len().to_string(),
            n_lost.to_string(),
            n_found.to_string(),
            n_back.to_string(),
            format!("{seconds:.3}"),
            fresh_seconds,
        ];
        let row = csv_row(row.into_iter());
        if self.n_steps == 1 {
            print(&self.table)?;
        }
        print(&row)?;
        self.table += &row;
        let drawn = analysis.drawn.as_ref().unwrap_or(grid);
        let classes = &self.model.model.label_set;
        let picture = overview_png(drawn, &analysis.labeling, classes, topology, name);
        self.files.push((format!("step-{:04}.png", self.n_steps), picture));
        self.labels = label_png(&analysis.space.graph, &analysis.labeling);
        self.last = Some((topology.clone(), MapInfo::of(grid, name, hash)));
        Ok(())
    }

    /// Writes all files.
    fn finish(mut self, args: &ReplayArgs) -> Result<Outcome> {
        let (topology, info) = self.last.context("expected at least one map")?;
        self.files.push(("labels.png".to_owned(), self.labels));
        self.files.push((TABLE.to_owned(), self.table.into_bytes()));
        let classes = &self.model.model.label_set;
        let mut document = TopologyDocument::new(info, Some(self.model.info()), classes, &topology);
        seal(&mut document, &mut self.files, Vec::new())?;
        let mut set = OutputSet::new(Existing::ReplaceResult);
        for (name, bytes) in self.files {
            set.add(name, bytes);
        }
        set.commit(&args.out)?;
        Ok(if self.n_differ == 0 { Outcome::Done } else { Outcome::CheckFailed })
    }
}

/// Whether two results of a map are the same, to the bit.
fn is_same(a: &Analysis, b: &Analysis) -> bool {
    a.classified == b.classified
        && a.smoothed == b.smoothed
        && a.labeling == b.labeling
        && a.topology == b.topology
        && a.changes == b.changes
}
