//! Results on real maps, as robots' stacks take them: route graphs that keep Nav2's rules and free space, and ways
//! wherever the true rooms have an opening.
//!
//! Reads the folder named by `PLACEGRAPH_DATA`: a few small maps, or with `PLACEGRAPH_ALL_MAPS=1` every one. Results of an
//! earlier `placegraph map --export nav2` are taken from the folder named by `PLACEGRAPH_RESULTS`.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use crate::running::{json, placegraph, stderr};
use placegraph::export::TopologyDocument;
use placegraph::geom::Point2;
use placegraph::grid::{Cell, Grid, MapFrame};
use placegraph::topology::query::find_route;
use placegraph::topology::{Connection, PlaceId, PlaceRaster, TopologicalMap};
use placegraph_testkit::segments::cells_on_segment;
use serde_json::Value;
use tempfile::TempDir;

/// Small maps: a home, an office, an office with furniture.
const FEW: [&str; 3] = ["rrce_03", "office_a", "Freiburg52_scan_furnitures"];

/// Least share of the openings of true rooms that have a way through.
const LEAST_JOINED: f64 = 0.85;

#[test]
fn route_graphs_are_free_and_join_what_the_truth_joins() {
    let Some(data) = std::env::var_os("PLACEGRAPH_DATA") else {
        println!("skipped: PLACEGRAPH_DATA is not set");
        return;
    };
    let folders = evaluation_maps(&PathBuf::from(data).join("eval"));
    let temporary = TempDir::new().unwrap();
    let earlier = std::env::var_os("PLACEGRAPH_RESULTS").map(PathBuf::from);
    let out = earlier.unwrap_or_else(|| {
        label(&folders, temporary.path());
        temporary.path().to_owned()
    });
    let (mut n_joined, mut n_pairs, mut n_graphs) = (0, 0, 0);
    for folder in &folders {
        let name = folder.file_name().unwrap().to_string_lossy();
        let result = out.join(&*name);
        let document = TopologyDocument::from_json(&fs::read(result.join("topology.json")).unwrap()).unwrap();
        // A map whose places have no way between them has no route graph, and the document says so.
        if !result.join("route_graph.geojson").exists() {
            let is_told = document.skipped.iter().any(|skipped| skipped.format == "nav2");
            assert!(is_told, "{name}: {:?}", document.findings);
            println!("{name}: no route graph");
            continue;
        }
        n_graphs += 1;
        let n_edges = assert_route_graph(&name, &result, &folder.join("map.png"), &document);
        let meta = folder.join("meta.json");
        if meta.exists() && json(&meta)["graph_reliable"] == true {
            let pairs = Openings::read(folder, &document);
            let (joined, same, all) = pairs.joined(&document.topology());
            println!(
                "{name}: {n_edges} edges; {joined} of {all} openings have a way ({same} inside of one place)"
            );
            n_joined += joined;
            n_pairs += all;
        } else {
            println!("{name}: {n_edges} edges");
        }
    }
    let share = n_joined as f64 / n_pairs as f64;
    println!("{n_graphs} route graphs; {n_joined} of {n_pairs} openings ({:.1} %) have a way", 100.0 * share);
    assert!(n_graphs * 10 >= folders.len() * 9, "{n_graphs} of {} maps have a route graph", folders.len());
    assert!(share >= LEAST_JOINED, "{share}");
}

/// Labels the maps.
fn label(folders: &[PathBuf], out: &Path) {
    let maps: Vec<PathBuf> = folders.iter().map(|folder| folder.join("map.yaml")).collect();
    let mut args: Vec<&dyn AsRef<std::ffi::OsStr>> = vec![&"map", &"--export", &"nav2", &"--out", &out];
    args.extend(maps.iter().map(|map| map as &dyn AsRef<std::ffi::OsStr>));
    let output = placegraph(&args);
    // 1: some route graphs were skipped.
    assert!(matches!(output.status.code(), Some(0 | 1)), "{}", stderr(&output));
}

/// The folders of the maps, by name.
fn evaluation_maps(eval: &Path) -> Vec<PathBuf> {
    if std::env::var_os("PLACEGRAPH_ALL_MAPS").is_none() {
        return FEW.iter().map(|name| eval.join(name)).collect();
    }
    let entries = fs::read_dir(eval).unwrap().map(|entry| entry.unwrap().path());
    let mut folders: Vec<PathBuf> = entries.filter(|path| path.join("map.yaml").exists()).collect();
    folders.sort();
    folders
}

/// A gray image with its lowest row first.
fn gray(path: &Path) -> Grid<u8> {
    let image = image::open(path).unwrap().into_luma8();
    let (width, height) = image.dimensions();
    let rows = image.into_raw().chunks_exact(width as usize).rev().flatten().copied().collect();
    Grid::from_rows(width, height, rows)
}

/// What Nav2's loader asks of a route graph, and that every edge, driven straight, touches free cells of the map only. Returns
/// the number of edges.
fn assert_route_graph(name: &str, result: &Path, map: &Path, document: &TopologyDocument) -> usize {
    let map = gray(map);
    let frame: MapFrame = document.map.shape().unwrap().frame;
    let graph = json(&result.join("route_graph.geojson"));
    let mut nodes = BTreeMap::new();
    let mut edges = Vec::new();
    let mut ids = BTreeSet::new();
    for feature in graph["features"].as_array().unwrap() {
        let properties = &feature["properties"];
        let id = |key: &str| properties[key].as_u64().filter(|id| *id < (1 << 31) - 1).unwrap();
        assert!(ids.insert(id("id")), "{name}: id {} twice", id("id"));
        assert_metadata(name, &properties["metadata"]);
        let coordinates = &feature["geometry"]["coordinates"];
        if feature["geometry"]["type"] == "Point" {
            let [x, y] = [0, 1].map(|axis| coordinates[axis].as_f64().unwrap());
            nodes.insert(id("id"), frame.cells_from_map(Point2::new(x, y)));
        } else {
            edges.push((id("startid"), id("endid")));
        }
    }
    let ways: BTreeSet<(u64, u64)> = edges.iter().copied().collect();
    assert!(!nodes.is_empty() && !ways.is_empty(), "{name}");
    for (from, to) in &edges {
        assert!(ways.contains(&(*to, *from)), "{name}: no way back from {to} to {from}");
        for (x, y) in cells_on_segment(nodes[from], nodes[to], 1e-6) {
            let is_free = map[Cell::new(x as u32, y as u32)] == 254;
            assert!(is_free, "{name}: the edge from {from} to {to} touches ({x}, {y})");
        }
    }
    edges.len()
}

/// Scalars and flat arrays of them; numbers are floats.
fn assert_metadata(name: &str, metadata: &Value) {
    let is_scalar = |value: &Value| value.is_string() || value.is_boolean() || value.is_f64();
    for (key, value) in metadata.as_object().unwrap() {
        let fits = value.as_array().map_or_else(|| is_scalar(value), |items| items.iter().all(is_scalar));
        assert!(fits, "{name}: {key} is {value}");
    }
}

/// The true rooms over the places found.
struct Openings {
    /// Pairs of rooms with an opening between them.
    pairs: BTreeSet<(u64, u64)>,
    /// The place that covers most of each room.
    place_of: BTreeMap<u64, PlaceId>,
    /// The room that covers most of each place.
    room_of: BTreeMap<PlaceId, u64>,
}

impl Openings {
    fn read(folder: &Path, document: &TopologyDocument) -> Self {
        let rooms = gray(&folder.join("rooms.png"));
        let raster = PlaceRaster::new(&document.topology(), document.map.shape().unwrap());
        let mut shared: BTreeMap<(u64, PlaceId), u32> = BTreeMap::new();
        for cell in rooms.cells().filter(|&cell| rooms[cell] > 0) {
            if let Some(place) = raster.place_in(cell) {
                *shared.entry((rooms[cell].into(), place)).or_default() += 1;
            }
        }
        let mut by_size: Vec<_> = shared.into_iter().map(|(pair, n_cells)| (n_cells, pair)).collect();
        by_size.sort_unstable();
        // Later entries, which share more, win.
        let place_of = by_size.iter().map(|&(_, (room, place))| (room, place)).collect();
        let room_of = by_size.iter().map(|&(_, (room, place))| (place, room)).collect();
        let graph = json(&folder.join("graph.json"));
        let ends = |edge: &Value| ["a", "b"].map(|end| edge[end].as_u64().unwrap());
        let pairs = graph["edges"].as_array().unwrap().iter().map(ends);
        Self { pairs: pairs.map(|[a, b]| (a.min(b), a.max(b))).collect(), place_of, room_of }
    }

    /// How many pairs of rooms have a way between their places that leads through no third room, how many of these lie in one
    /// place, and how many pairs there are.
    fn joined(&self, map: &TopologicalMap) -> (usize, usize, usize) {
        let (mut n_joined, mut n_same) = (0, 0);
        for (a, b) in &self.pairs {
            let (Some(&from), Some(&to)) = (self.place_of.get(a), self.place_of.get(b)) else { continue };
            let is_near = |place: PlaceId| {
                let is_doorway = map.place(place).is_some_and(|place| place.doorway.is_some());
                // A place that holds several true rooms may be one of the two.
                is_doorway
                    || [from, to].contains(&place)
                    || self.room_of.get(&place).is_none_or(|room| room == a || room == b)
            };
            let is_near = |c: &&Connection| is_near(c.a) && is_near(c.b);
            let connections = map.connections.iter().filter(is_near).cloned().collect();
            let near = TopologicalMap { connections, shortcuts: Vec::new(), ..map.clone() };
            n_joined += usize::from(from == to || find_route(&near, from, to).is_some());
            n_same += usize::from(from == to);
        }
        (n_joined, n_same, self.pairs.len())
    }
}
