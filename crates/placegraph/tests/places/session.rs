//! Maps that grow: what is reused changes no bit, and numbers stay.

use std::num::NonZeroUsize;

use placegraph::geom::Point2;
use placegraph::grid::{Grid, Occupancy, OccupancyGrid};
use placegraph::model::Model;
use placegraph::pipeline::{Analysis, Config, analyze};
use placegraph::progress::Silent;
use placegraph::session::{Session, Update};
use placegraph::topology::edits::EditFile;
use placegraph_generate::{Style, generate_growing};

/// The states of a home's map while a robot makes it.
fn growing(seed: u64) -> Vec<OccupancyGrid> {
    let every = NonZeroUsize::new(6).unwrap();
    let (building, maps) = generate_growing(Style::Home, seed, 0, Some(0.1), every);
    assert!(maps.len() > 3, "{} maps", maps.len());
    let n_free = |map: &OccupancyGrid| map.count(Occupancy::Free);
    assert!(n_free(&maps[0]) < n_free(&building.map), "the first map is not yet the last one");
    maps
}

fn assert_same(a: &Analysis, b: &Analysis, step: usize) {
    assert!(a.classified == b.classified && a.smoothed == b.smoothed, "step {step}: cells");
    assert!(a.labeling == b.labeling && a.regions == b.regions, "step {step}: regions");
    assert_eq!(a.topology, b.topology, "step {step}");
    assert_eq!((&a.changes, &a.place_ids), (&b.changes, &b.place_ids), "step {step}");
}

/// Labels all maps in one session, and each anew with the last result as the previous one; the updates.
fn compare(maps: &[OccupancyGrid], config: &Config) -> Vec<Update> {
    let mut session = Session::new(Model::builtin());
    let mut previous = None;
    let updates = maps.iter().enumerate().map(|(step, map)| {
        let update = session.update(map, config, &Silent);
        let fresh =
            analyze(map, session.model(), &Config { previous: previous.take(), ..config.clone() }, &Silent);
        assert_same(&update.analysis, &fresh, step);
        assert_eq!(session.topology(), Some(&fresh.topology));
        previous = Some(fresh.topology);
        update
    });
    updates.collect()
}

#[test]
fn a_growing_map_is_labeled_as_if_anew() {
    for seed in [1, 2] {
        let maps = growing(seed);
        let corners: Vec<(u32, f64)> =
            maps.iter().map(|map| (map.cells.width(), map.frame.map_from_grid().x)).collect();
        assert!(corners.windows(2).any(|pair| pair[0] != pair[1]), "the grid grows too: {corners:?}");
        let updates = compare(&maps, &Config::default());
        assert_eq!(updates[0].n_reused, 0);
        let reused: usize = updates[1..].iter().map(|update| update.n_reused).sum();
        let free: usize = updates[1..].iter().map(|update| update.analysis.space.graph.n_nodes()).sum();
        assert!(reused * 5 > free, "{reused} of {free}");
    }
}

#[test]
fn labels_that_are_held_on_to_flicker_less_and_are_those_of_a_fresh_run() {
    let hold = Config { hold: true, ..Config::default() };
    let share = |updates: &[Update]| {
        let sum = |of: fn(&Update) -> usize| updates[1..].iter().map(of).sum::<usize>() as f64;
        sum(|update| update.n_relabeled) / sum(|update| update.n_common)
    };
    let (mut held, mut anew) = (0.0, 0.0);
    for seed in [1, 2] {
        let maps = growing(seed);
        let updates = compare(&maps, &hold);
        held += share(&updates);
        anew += share(&compare(&maps, &Config::default()));
        // Without an earlier result nothing is held on to.
        let first = analyze(&maps[0], &Model::builtin(), &Config::default(), &Silent);
        assert_same(&updates[0].analysis, &first, 0);
        // Of a map that stays nothing changes, however often it is labeled.
        let last = maps.last().unwrap();
        let again = compare(&[last.clone(), last.clone(), last.clone()], &hold);
        assert_eq!(again[2].n_relabeled, 0);
    }
    assert!(held <= anew && anew > 0.0, "{held} of the cells, {anew} without");
}

#[test]
fn places_that_are_still_there_are_counted_with_those_that_keep_their_number() {
    let maps = growing(2);
    let updates = compare(&maps, &Config::default());
    assert_eq!((updates[0].n_there, updates[0].n_kept), (0, 0));
    assert!(updates.iter().all(|update| update.n_flickering <= update.n_relabeled.min(update.n_reused)));
    for pair in updates.windows(2) {
        let [before, now] = pair else { unreachable!() };
        assert!(now.n_kept <= now.n_there && now.n_there <= before.analysis.topology.places.len());
    }
    assert!(updates[1..].iter().map(|update| update.n_there).sum::<usize>() > maps.len());
}

#[test]
fn a_map_that_stays_costs_no_features() {
    let map = growing(3).pop().unwrap();
    let updates = compare(&[map.clone(), map], &Config::default());
    let n_free = updates[1].analysis.space.graph.n_nodes();
    let Update { n_reused, n_common, n_relabeled, .. } = updates[1];
    assert_eq!((n_reused, n_common, n_relabeled), (n_free, n_free, 0));
    assert_eq!(updates[0].analysis.topology, updates[1].analysis.topology);
}

/// Cells on all sides of a map, as SLAM adds them.
fn padded(map: &OccupancyGrid, left: u32, below: u32) -> OccupancyGrid {
    let (width, height) = (map.cells.width() + left + 3, map.cells.height() + below + 2);
    let mut cells = Grid::filled(width, height, Occupancy::Unknown);
    for cell in map.cells.cells() {
        cells[placegraph::grid::Cell::new(cell.x + left, cell.y + below)] = map.cells[cell];
    }
    let corner = map.frame.map_from_cells(Point2::new(-f64::from(left), -f64::from(below)));
    let origin = placegraph::geom::Pose2 { x: corner.x, y: corner.y, ..map.frame.map_from_grid() };
    let frame = placegraph::grid::MapFrame::new(map.frame.resolution_m(), origin).unwrap();
    OccupancyGrid { frame, cells }
}

#[test]
fn cells_are_known_again_wherever_the_grid_begins() {
    let map = growing(4).pop().unwrap();
    let updates = compare(&[map.clone(), padded(&map, 17, 5), map.clone()], &Config::default());
    for update in &updates[1..] {
        let n_free = update.analysis.space.graph.n_nodes();
        assert_eq!((update.n_reused, update.n_common), (n_free, n_free));
    }
}

#[test]
fn edits_stay_and_drawn_walls_have_a_memory_of_their_own() {
    let maps = growing(5);
    let maps = &maps[maps.len() - 3..];
    let first = Session::new(Model::builtin()).update(&maps[0], &Config::default(), &Silent);
    let places = &first.analysis.topology.places;
    let place = places.iter().find(|place| place.doorway.is_none()).unwrap();
    let [a, b] = places.iter().find_map(|place| place.doorway.as_ref()).unwrap().jambs;
    let text = format!(
        "[[edit]]\naction = \"rename\"\nat = [{}, {}]\nname = \"den\"\n\
         [[edit]]\naction = \"close\"\nline = [[{}, {}], [{}, {}]]\n",
        place.anchor.x, place.anchor.y, a.x, a.y, b.x, b.y
    );
    let edits = EditFile::from_toml(&text).unwrap().edits;
    let updates = compare(maps, &Config { edits, ..Config::default() });
    for update in &updates {
        assert!(update.analysis.drawn.is_some(), "the wall is drawn into each map");
        assert!(update.analysis.topology.places.iter().any(|place| place.name == "den"));
    }
    assert!(updates[2].n_reused > 0);
}

#[test]
fn another_model_of_the_world_is_a_new_session() {
    let maps = growing(1);
    let mut session = Session::new(Model::builtin());
    session.update(&maps[0], &Config::default(), &Silent);
    session.forget_places();
    assert!(session.topology().is_none());
    let update = session.update(&maps[0], &Config::default(), &Silent);
    assert!(update.analysis.changes.is_empty() && update.analysis.frames.is_none());
    assert_eq!(update.n_reused, update.analysis.space.graph.n_nodes(), "scans stay known");
    assert_eq!(update.n_common, 0);
}
