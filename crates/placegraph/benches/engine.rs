//! The engine against its plain twins, in one run on the same cells: read the ratios, not the times.

#![allow(missing_docs, reason = "criterion makes public functions")]
#![allow(clippy::unwrap_used, reason = "a benchmark panics where a test would")]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use placegraph::features::{FeatureId, Job, evaluate, freiburg203, of_scan};
use placegraph::geom::Pose2;
use placegraph::grid::{Cell, CellGraph, Grid, MapFrame, Occupancy, OccupancyGrid};
use placegraph::progress::Silent;
use placegraph::scan::{self, Block, BlockRanges, Instructions, N_BEAMS, RayCaster, ScanConfig};
use placegraph_testkit::plain_features::plain_feature;
use placegraph_testkit::rays::traverse;

/// Rooms of 4.5 × 3.5 m with doors and a few obstacles, at 5 cm a cell.
fn office() -> OccupancyGrid {
    let mut cells = Grid::filled(640, 480, Occupancy::Free);
    for cell in cells.clone().cells() {
        let (column, row) = (cell.x % 90, cell.y % 70);
        let wall = column == 0 && !(20..38).contains(&row) || row == 0 && !(40..58).contains(&column);
        let border = cell.x == 0 || cell.y == 0 || cell.x == 639 || cell.y == 479;
        let obstacle = (cell.x * 7919 + cell.y * 104_729) % 997 == 0;
        if wall || border || obstacle {
            cells[cell] = Occupancy::Occupied;
        }
    }
    OccupancyGrid { frame: MapFrame::new(0.05, Pose2::default()).unwrap(), cells }
}

/// Free cells of the second and third band of blocks.
fn some_cells(grid: &OccupancyGrid) -> Vec<Cell> {
    let graph = CellGraph::new(&grid.cells);
    graph.cells().iter().copied().filter(|cell| (8..24).contains(&cell.y)).collect()
}

fn casting(criterion: &mut Criterion) {
    let (grid, config) = (office(), ScanConfig::default());
    let cells = some_cells(&grid);
    let caster = RayCaster::new(&grid, &config);
    let blocks = Block::of_cells(&cells);
    let mut ranges = BlockRanges::new();
    let mut group = criterion.benchmark_group("rays");
    group.throughput(Throughput::Elements((cells.len() * N_BEAMS) as u64));
    for instructions in [Instructions::Widest, Instructions::Baseline] {
        group.bench_function(format!("walk, {instructions:?}"), |bencher| {
            bencher.iter(|| {
                for block in &blocks {
                    caster.cast_block(block, instructions, &mut ranges);
                }
            });
        });
    }
    group.sample_size(10);
    let few: Vec<Cell> = cells.iter().copied().step_by(50).collect();
    group.throughput(Throughput::Elements((few.len() * N_BEAMS) as u64));
    group.bench_function("traversal", |bencher| {
        bencher.iter(|| few.iter().map(|&cell| traverse(&grid, cell, &config)[17]).sum::<f64>());
    });
    group.finish();
}

fn measuring(criterion: &mut Criterion) {
    let (grid, config) = (office(), ScanConfig::default());
    let cells = some_cells(&grid);
    let thirty: Vec<FeatureId> = freiburg203().into_iter().step_by(7).collect();
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let mut group = criterion.benchmark_group("cells");
    group.sample_size(10);
    group.throughput(Throughput::Elements(cells.len() as u64));
    for (name, columns) in [("203 features", freiburg203()), ("29 features", thirty), ("none", Vec::new())] {
        for instructions in [Instructions::Widest, Instructions::Baseline] {
            let job = Job {
                grid: &grid,
                cells: &cells,
                columns: &columns,
                config: &config,
                progress: &Silent,
                instructions,
            };
            group.bench_function(format!("{name}, {instructions:?}"), |bencher| {
                bencher.iter(|| {
                    one_thread.install(|| evaluate(&job, 1, |values, out| out.fill(values.n_cells())))
                });
            });
        }
    }
    let few: Vec<Cell> = cells.iter().copied().step_by(500).collect();
    let scans: Vec<_> = few.iter().map(|&cell| scan::cast(&grid, cell, &config)).collect();
    let columns = freiburg203();
    group.throughput(Throughput::Elements(few.len() as u64));
    group.bench_function("203 plain formulas, without casting", |bencher| {
        bencher.iter(|| {
            let values = scans
                .iter()
                .flat_map(|scan| columns.iter().map(|id| plain_feature(id.feature(), scan.ranges_m())));
            values.sum::<f64>()
        });
    });
    group.bench_function("203 features of single scans", |bencher| {
        bencher.iter(|| scans.iter().map(|scan| of_scan(scan, &columns)[0]).sum::<f32>());
    });
    group.finish();
}

criterion_group!(benches, casting, measuring);
criterion_main!(benches);
