//! The stages after the classifier, and the whole of [`pipeline::analyze`], at three sizes:
//! `cargo bench -p placegraph --bench stages`. Plain twins run beside, named after their stage.
//!
//! The whole map also runs on `maps/office`, on fr79 in the folder of `PLACEGRAPH_DATA`, and with
//! `PLACEGRAPH_LARGE=1` on 10 M cells.

#![allow(missing_docs, reason = "criterion makes public functions")]
#![allow(clippy::unwrap_used, reason = "a benchmark panics where a test would")]

use std::path::Path;

use criterion::{BenchmarkId, Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use imageproc::definitions::Image;
use imageproc::region_labelling::connected_components;
use placegraph::doorways::{self, DoorwayConfig};
use placegraph::export;
use placegraph::grid::{Cell, CellGraph, FreeSpace, OccupancyGrid};
use placegraph::import::{ReadOptions, load_map};
use placegraph::labels::{Label, LabelField, Labeling};
use placegraph::model::Model;
use placegraph::pipeline;
use placegraph::progress::Silent;
use placegraph::regions::{DiagonalSteps, connected, properties};
use placegraph::spaces::{self, SpaceConfig};
use placegraph::topology;
use placegraph_testkit::regions::flood_fill;

mod maps;
mod twins;

use maps::{dump, is_door, office};

/// Widths of the maps: 20 000, 300 000 and a million cells.
const WIDTHS: [u32; 3] = [160, 640, 1160];

fn model() -> Model {
    Model::builtin()
}

/// Doors, corridors and rooms where they are, and some cells labeled wrong.
fn labels(graph: &CellGraph) -> Labeling {
    let label = |&cell: &Cell| match (cell.x / 90 + cell.y / 70) % 3 {
        _ if is_door(cell) => Label(2),
        _ if (cell.x * 31 + cell.y * 17) % 211 == 0 => Label(0),
        0 => Label(0),
        _ => Label(1),
    };
    graph.cells().iter().map(label).collect()
}

/// A distribution in which every label is the most probable one.
fn field(labeling: &Labeling) -> LabelField {
    let row =
        |label: &Label| (0..3).map(|k| if k == label.index() { 0.8 } else { 0.1 }).collect::<Vec<f32>>();
    LabelField::from_rows(3, labeling.iter().flat_map(row).collect())
}

fn stages(criterion: &mut Criterion) {
    let set = model().label_set;
    for width in WIDTHS {
        let grid = office(width);
        let space = FreeSpace::of(&grid);
        let graph = &space.graph;
        let n = graph.n_nodes();
        let labeling = labels(graph);
        let field = field(&labeling);
        let regions = connected(graph, &labeling, DiagonalSteps::default());
        let topology = topology::build(&space, &field, &regions, &set);
        let image = Image::from_fn(grid.cells.width(), grid.cells.height(), |x, y| {
            image::Luma([graph.node_at(Cell::new(x, y)).map_or(0, |node| labeling[node].0 + 1)])
        });
        dump(image.width(), image.height(), image.as_raw());
        let as_graph = twins::cells_as_graph(graph);
        let mut group = criterion.benchmark_group("stages");
        group.sample_size(10).sampling_mode(SamplingMode::Flat).throughput(Throughput::Elements(n as u64));
        let mut bench = |name: &str, run: &dyn Fn()| {
            group.bench_function(BenchmarkId::new(name, n), |bencher| bencher.iter(run));
        };
        bench("graph", &|| drop(CellGraph::new(&grid.cells)));
        bench("graph, hash map", &|| drop(twins::numbered(&grid.cells)));
        bench("regions", &|| drop(connected(graph, &labeling, DiagonalSteps::default())));
        bench("regions, flood fill", &|| drop(flood_fill(graph, &labeling, DiagonalSteps::default())));
        bench("regions, imageproc", &|| {
            drop(connected_components(
                &image,
                imageproc::region_labelling::Connectivity::Eight,
                image::Luma([0]),
            ));
        });
        bench("region statistics", &|| drop(properties(&space, &regions)));
        bench("region statistics, cell by cell", &|| drop(twins::statistics(graph, &regions)));
        bench("doorways", &|| {
            let config = DoorwayConfig::default();
            drop(doorways::mark(&space, [&field; 2], &labeling, &set, &config, None));
        });
        bench("doorways, saddles alone by flooding (imageproc, petgraph)", &|| {
            std::hint::black_box(twins::flooded(&image));
        });
        let label = |config| drop(spaces::label(&space, &field, &labeling, &set, &config, None));
        bench("spaces", &|| label(SpaceConfig::default()));
        bench("spaces, in tiles", &|| label(SpaceConfig { max_cut: 0, ..SpaceConfig::default() }));
        bench("topology and outlines", &|| {
            drop(topology::build(&space, &field, &regions, &set));
        });
        bench("topology and outlines, petgraph's Dijkstra alone", &|| {
            std::hint::black_box(twins::shortest_ways(&as_graph));
        });
        bench("outlines", &|| drop(topology::outlines(&space, &regions)));
        bench("outlines, imageproc", &|| {
            std::hint::black_box(twins::contours(&image, 3));
        });
        bench("labels.png", &|| drop(export::label_png(graph, &labeling)));
        bench("labels.png, zlib's usual effort", &|| drop(twins::deflated_png(&image)));
        bench("overview.png", &|| drop(export::overview_png(&grid, &labeling, &set, &topology, "office")));
        // As many pixels a cell as the overview has.
        let px_per_cell = ((2000 + width / 2) / width).clamp(1, 8);
        let view = export::View {
            frame: grid.frame,
            left_cells: 0.0,
            top_cells: f64::from(grid.cells.height()),
            px_per_cell: f64::from(px_per_cell),
            offset_px: [0.0; 2],
            text_px: 12.0,
        };
        let overlay = export::overlay_svg(&topology, &set, &view);
        bench("overview.png, all of it as SVG", &|| {
            drop(twins::drawn_as_svg(&image, &set, &overlay, px_per_cell));
        });
        group.finish();
    }
}

fn whole_maps(criterion: &mut Criterion) {
    let model = model();
    let mut maps: Vec<(String, OccupancyGrid)> =
        WIDTHS[..2].iter().map(|&width| ("tiled".into(), office(width))).collect();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    maps.push(("maps-office".into(), load(&root.join("maps/office/map.yaml"))));
    if let Some(folder) = std::env::var_os("PLACEGRAPH_DATA") {
        maps.push(("fr79".into(), load(&Path::new(&folder).join("eval/fr79_slam/map.yaml"))));
    }
    if std::env::var_os("PLACEGRAPH_LARGE").is_some() {
        maps.push(("tiled".into(), office(3700)));
    }
    let mut group = criterion.benchmark_group("analyze");
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    for (name, grid) in maps {
        let n = CellGraph::new(&grid.cells).n_nodes();
        group.throughput(Throughput::Elements(n as u64));
        group.bench_function(BenchmarkId::new(name, n), |bencher| {
            bencher.iter(|| pipeline::analyze(&grid, &model, &pipeline::Config::default(), &Silent));
        });
    }
    group.finish();
}

fn load(path: &Path) -> OccupancyGrid {
    load_map(path, &ReadOptions::default()).unwrap().grid
}

criterion_group!(benches, stages, whole_maps);
criterion_main!(benches);
