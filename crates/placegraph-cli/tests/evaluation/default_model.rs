//! The model inside the program on real buildings, of which it has seen none: cells, doorways, rooms, and how steady
//! the labels are when the map is turned or drawn at another resolution.
//!
//! Reads the folder named by `PLACEGRAPH_DATA`; without it the tests are skipped. Some maps are judged, or all labeled
//! ones with `PLACEGRAPH_MAPS=all`; the tables of `docs/default-model.md` are what this prints then.

use std::path::{Path, PathBuf};

use placegraph::eval::{CellScores, Confusion, RoomScores, room_scores};
use placegraph::geom::{Point2, Pose2, Vec2};
use placegraph::grid::{Cell, Grid, MapFrame, Occupancy, OccupancyGrid};
use placegraph::import::{self, LabelCell, LabelCoding};
use placegraph::labels::Label;
use placegraph::model::Model;
use placegraph::pipeline::{Analysis, Config, analyze};
use placegraph::progress::Silent;

/// Maps with drawn doorways: those of the chapter's buildings, and those whose authors drew them.
const LABELED: [&str; 11] = [
    "fr52_slam",
    "fr79_slam",
    "sdr_b_slam",
    "Freiburg52_scan",
    "Freiburg52_scan_furnitures",
    "lab_d_scan",
    "lab_d_scan_furnitures",
    "lab_intel",
    "lab_intel_furnitures",
    "office_e",
    "office_e_furnitures",
];

/// Buildings with drawn rooms, bare; each has a furnished twin.
const WITH_ROOMS: [&str; 12] = [
    "Freiburg52_scan",
    "Freiburg79_scan",
    "lab_a_scan",
    "lab_b_scan",
    "lab_d_scan",
    "lab_intel",
    "office_a",
    "office_b",
    "office_c",
    "office_e",
    "office_f",
    "office_i",
];

/// The folder of maps, and whether all are to be judged.
fn data() -> Option<(PathBuf, bool)> {
    let Some(folder) = std::env::var_os("PLACEGRAPH_DATA") else {
        println!("skipped: PLACEGRAPH_DATA does not name the folder of maps");
        return None;
    };
    let all = std::env::var_os("PLACEGRAPH_MAPS").is_some_and(|maps| maps == "all");
    Some((Path::new(&folder).join("eval"), all))
}

fn model() -> Model {
    Model::builtin()
}

fn load(folder: &Path) -> OccupancyGrid {
    import::load_map(&folder.join("map.yaml"), &import::ReadOptions::default()).unwrap().grid
}

fn labeled(map: &OccupancyGrid) -> Analysis {
    analyze(map, &model(), &Config::default(), &Silent)
}

fn cell_scores(folder: &Path) -> CellScores {
    let (map, set) = (load(folder), model().label_set);
    let analysis = labeled(&map);
    let size = (map.cells.width(), map.cells.height());
    let image = std::fs::read(folder.join("labels.png")).unwrap();
    let truth = import::read_labels(&image, size, &LabelCoding::of(&set)).unwrap().map(|cell| match cell {
        LabelCell::Class(label) => Some(*label),
        LabelCell::None | LabelCell::Ignore => None,
    });
    let mut found: Grid<Option<Label>> = Grid::filled(size.0, size.1, None);
    for (&cell, &label) in analysis.space.graph.cells().iter().zip(&analysis.labeling) {
        found[cell] = Some(label);
    }
    Confusion::count(&found, &truth, &set).scores(&set)
}

fn rooms(folder: &Path) -> RoomScores {
    let map = load(folder);
    let analysis = labeled(&map);
    let image = std::fs::read(folder.join("rooms.png")).unwrap();
    let rooms = import::read_rooms(&image, (map.cells.width(), map.cells.height())).unwrap();
    room_scores(&analysis.space.graph, &analysis.regions, &model().label_set, &rooms.map(|&id| id.into()))
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    values.iter().sum::<f64>() / values.len() as f64
}

#[test]
fn cells_and_doorways() {
    let Some((folder, all)) = data() else { return };
    let names = if all { &LABELED[..] } else { &["fr52_slam", "lab_d_scan", "lab_d_scan_furnitures"] };
    println!("| map | cells right | macro-F1 | doorway precision | doorway recall |");
    println!("|---|---|---|---|---|");
    let row = |name: &str, [accuracy, f1, precision, recall]: [f64; 4]| {
        println!("| {name} | {:.2} % | {f1:.3} | {precision:.2} | {recall:.2} |", 100.0 * accuracy);
    };
    let measured = names.iter().map(|name| {
        let scores = cell_scores(&folder.join(name));
        let doorway = scores.classes.iter().find(|class| class.name == "doorway").unwrap();
        let found = [scores.accuracy, scores.macro_f1, doorway.precision, doorway.recall].map(Option::unwrap);
        row(name, found);
        found
    });
    let measured: Vec<[f64; 4]> = measured.collect();
    let means = [0, 1, 2, 3].map(|k| mean(measured.iter().map(|scores| scores[k])));
    row("mean", means);
    let floors = [0.95, 0.80, 0.60, 0.70];
    assert!(means.iter().zip(floors).all(|(found, floor)| *found >= floor), "{means:?}");
    // Furniture costs at most 2 points: 1.7 on lab_d_scan, nothing on the Intel lab.
    let accuracy_of = |name: &str| names.iter().position(|other| *other == name).map(|at| measured[at][0]);
    for (name, [furnished, ..]) in names.iter().zip(&measured) {
        let bare = name.strip_suffix("_furnitures").and_then(accuracy_of);
        assert!(bare.is_none_or(|bare| bare - furnished <= 0.02), "{name}: {bare:?} bare, {furnished}");
    }
}

#[test]
fn rooms_bare_and_furnished() {
    let Some((folder, all)) = data() else { return };
    let names = if all { &WITH_ROOMS[..] } else { &["Freiburg52_scan", "lab_d_scan"] };
    for suffix in ["", "_furnitures"] {
        println!("| map | rooms | recall | precision | mean best IoU | split | merging |");
        println!("|---|---|---|---|---|---|---|");
        let measured = names.iter().map(|name| {
            let name = format!("{name}{suffix}");
            let scores = rooms(&folder.join(&name));
            let shares = [scores.recall, scores.precision, scores.mean_iou].map(Option::unwrap);
            let [recall, precision, iou] = shares.map(|share| 100.0 * share);
            let RoomScores { n_rooms, n_split_rooms, n_merging_instances, .. } = scores;
            println!(
                "| {name} | {n_rooms} | {recall:.1} | {precision:.1} | {iou:.1} | {n_split_rooms} | {n_merging_instances} |"
            );
            shares
        });
        let measured: Vec<[f64; 3]> = measured.collect();
        let means = [0, 1, 2].map(|k| mean(measured.iter().map(|scores| scores[k])));
        let [recall, precision, iou] = means.map(|share| 100.0 * share);
        println!("| mean | | {recall:.1} | {precision:.1} | {iou:.1} | | |\n");
        assert!(means[0] >= 0.90 && means[1] >= 0.90 && means[2] >= 0.75, "{suffix}: {means:?}");
    }
}

/// `map` turned by `angle_rad` about its middle and drawn anew with cells `factor` times as large. A cell is occupied if
/// any of the cells that it covers is.
struct Redrawn {
    grid: OccupancyGrid,
    angle_rad: f64,
    factor: f64,
    middles: [Point2; 2],
}

impl Redrawn {
    fn new(map: &OccupancyGrid, angle_degrees: f64, factor: f64) -> Self {
        let angle_rad = angle_degrees.to_radians();
        let (width, height) = (map.cells.width() as f64, map.cells.height() as f64);
        let (sin, cos) = (angle_rad.sin().abs(), angle_rad.cos().abs());
        let new_width = ((width * cos + height * sin) / factor).ceil() as u32;
        let new_height = ((width * sin + height * cos) / factor).ceil() as u32;
        let frame = MapFrame::new(map.frame.resolution_m() * factor, Pose2::default()).unwrap();
        let cells = Grid::filled(new_width, new_height, Occupancy::Unknown);
        let middle = |width: u32, height: u32| Point2::new(width as f64 / 2.0, height as f64 / 2.0);
        let middles = [middle(map.cells.width(), map.cells.height()), middle(new_width, new_height)];
        let mut redrawn = Self { grid: OccupancyGrid { frame, cells }, angle_rad, factor, middles };
        let n_samples = factor.ceil() as u32;
        for cell in redrawn.grid.cells.cells().collect::<Vec<_>>() {
            let sample = |v: u32, k: u32| v as f64 + (k as f64 + 0.5) / n_samples as f64;
            let samples = (0..n_samples * n_samples)
                .map(|k| Point2::new(sample(cell.x, k % n_samples), sample(cell.y, k / n_samples)))
                .filter_map(|point| cell_at(&map.cells, redrawn.original(point)))
                .map(|cell| map.cells[cell]);
            let found: Vec<Occupancy> = samples.collect();
            let first = [Occupancy::Occupied, Occupancy::Free].into_iter().find(|kind| found.contains(kind));
            redrawn.grid.cells[cell] = first.unwrap_or(Occupancy::Unknown);
        }
        redrawn
    }

    fn original(&self, point: Point2) -> Point2 {
        let from_middle = (point - self.middles[1]) * self.factor;
        self.middles[0] + from_middle.rotated(-self.angle_rad)
    }

    fn redrawn(&self, cell: Cell) -> Point2 {
        let from_middle = cell.center() - self.middles[0];
        let turned: Vec2 = from_middle.rotated(self.angle_rad);
        self.middles[1] + turned * (1.0 / self.factor)
    }

    /// The share of the cells free in both maps that have the same label.
    fn agreement(&self, original: &Analysis) -> f64 {
        let found = labeled(&self.grid);
        let (mut same, mut both) = (0.0, 0.0);
        for (&cell, label) in original.space.graph.cells().iter().zip(&original.labeling) {
            let there = cell_at(&self.grid.cells, self.redrawn(cell));
            if let Some(node) = there.and_then(|cell| found.space.graph.node_at(cell)) {
                both += 1.0;
                same += f64::from(u8::from(found.labeling[node] == *label));
            }
        }
        same / both
    }
}

fn cell_at<T>(grid: &Grid<T>, point: Point2) -> Option<Cell> {
    let inside = |v: f64, side: u32| (0.0..side as f64).contains(&v);
    (inside(point.x, grid.width()) && inside(point.y, grid.height()))
        .then(|| Cell::new(point.x as u32, point.y as u32))
}

#[test]
fn turned_and_redrawn_maps_get_the_same_labels() {
    let Some((folder, all)) = data() else { return };
    let names = if all { &LABELED[..] } else { &["fr52_slam"] };
    let changes = [(90.0, 1.0), (17.0, 1.0), (0.0, 0.5), (0.0, 2.0)];
    println!("| map | turned by 90° | by 17° | cells half as large | twice as large |");
    println!("|---|---|---|---|---|");
    let row = |name: &str, shares: [f64; 4]| {
        let [quarter, askew, finer, coarser] = shares.map(|share| 100.0 * share);
        println!("| {name} | {quarter:.2} % | {askew:.2} % | {finer:.2} % | {coarser:.2} % |");
    };
    let measured = names.iter().map(|name| {
        let map = load(&folder.join(name));
        let original = labeled(&map);
        let shares =
            changes.map(|(degrees, factor)| Redrawn::new(&map, degrees, factor).agreement(&original));
        row(name, shares);
        shares
    });
    let measured: Vec<[f64; 4]> = measured.collect();
    row("mean", [0, 1, 2, 3].map(|k| mean(measured.iter().map(|shares| shares[k]))));
    for (name, shares) in names.iter().zip(&measured) {
        assert!(shares.iter().all(|share| *share >= 0.96), "{name}: {shares:?}");
    }
}
