//! Scans and features beside their plain twins and beside the processor's speed, in one run on the same cells, in processor
//! time: `cargo bench -p placegraph --bench engine`. Read the ratios, not the times.

#![allow(missing_docs, reason = "criterion makes public functions")]
#![allow(clippy::unwrap_used, reason = "a benchmark panics where a test would")]

use criterion::{BenchmarkId, Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use placegraph::features::{FeatureId, Job, all, evaluate, freiburg203, of_scan};
use placegraph::grid::{Cell, CellGraph, OccupancyGrid};
use placegraph::model::{Method, Model};
use placegraph::progress::Silent;
use placegraph::scan::{self, Block, BlockRanges, Instructions, N_BEAMS, RayCaster, ScanConfig};
use placegraph_testkit::plain_features::plain_feature;
use placegraph_testkit::rays::traverse;

#[path = "probe/limits.rs"]
mod limits;
mod maps;
#[path = "probe/processor.rs"]
mod processor;

use maps::office;
use processor::ProcessorTime;

/// Widths of the maps, for three sizes; the second one for everything that is measured once.
const WIDTHS: [u32; 3] = [160, 320, 640];

fn casting(criterion: &mut Criterion<ProcessorTime>) {
    let config = ScanConfig::default();
    let mut group = criterion.benchmark_group("rays");
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    for (number, width) in WIDTHS.into_iter().enumerate() {
        let grid = office(width);
        let graph = CellGraph::new(&grid.cells);
        let caster = RayCaster::new(&grid, &config);
        let blocks = Block::of_cells(graph.cells());
        let mut ranges = BlockRanges::new();
        group.throughput(Throughput::Elements((graph.n_nodes() * N_BEAMS) as u64));
        for instructions in Instructions::ALL.into_iter().take(if number == 1 { 3 } else { 1 }) {
            let id = BenchmarkId::new(format!("{instructions:?}"), graph.n_nodes());
            group.bench_function(id, |bencher| {
                bencher.iter(|| {
                    for block in &blocks {
                        caster.cast_block(block, instructions, &mut ranges);
                    }
                });
            });
        }
        if number == 1 {
            // The same again, counted in operations on words: what the processor's limit is compared with.
            group.throughput(Throughput::Elements(word_operations(&grid, &caster, &blocks)));
            for instructions in Instructions::ALL {
                let id = BenchmarkId::new(format!("operations, {instructions:?}"), graph.n_nodes());
                group.bench_function(id, |bencher| {
                    bencher.iter(|| {
                        for block in &blocks {
                            caster.cast_block(block, instructions, &mut ranges);
                        }
                    });
                });
            }
        }
        let few = some(&graph, 100);
        group.throughput(Throughput::Elements((few.len() * N_BEAMS) as u64));
        group.bench_function(BenchmarkId::new("traversal", graph.n_nodes()), |bencher| {
            bencher.iter(|| few.iter().map(|&cell| traverse(&grid, cell, &config)[17]).sum::<f64>());
        });
    }
    group.finish();
}

/// Operations on words of 64 bits without which no block can be cast: for every row and step of the longest beam two shifts
/// and a further one, "or", "and not", and 15/8 flips of counters; then 27 for each of the 64 words that eight bit planes become
/// bytes in. Loads, and the look-up of every range, come on top.
fn word_operations(grid: &OccupancyGrid, caster: &RayCaster, blocks: &[Block]) -> u64 {
    let mut ranges = BlockRanges::new();
    let mut n = 0.0;
    for block in blocks {
        caster.cast_block(block, Instructions::default(), &mut ranges);
        for beam in 0..N_BEAMS {
            let longest = (0..ranges.n_cells()).map(|cell| ranges.range_m(cell, beam)).fold(0.0, f32::max);
            let (sin, cos) = (beam as f64).to_radians().sin_cos();
            let n_steps = f64::from(longest) * (sin.abs() + cos.abs()) / grid.frame.resolution_m();
            n += n_steps * 8.0 * (5.0 + 15.0 / 8.0) + 27.0 * 64.0;
        }
    }
    n as u64
}

/// About so many cells, spread over the map.
fn some(graph: &CellGraph, n: usize) -> Vec<Cell> {
    graph.cells().iter().copied().step_by(graph.n_nodes().div_ceil(n)).collect()
}

fn measuring(criterion: &mut Criterion<ProcessorTime>) {
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    for (name, columns) in
        [("203 features", freiburg203()), ("all features", all()), ("default model", default_columns())]
    {
        let mut group = criterion.benchmark_group(name);
        group.sample_size(10).sampling_mode(SamplingMode::Flat);
        for (number, width) in WIDTHS.into_iter().enumerate() {
            if number != 1 && name != "203 features" {
                continue;
            }
            let grid = office(width);
            let graph = CellGraph::new(&grid.cells);
            group.throughput(Throughput::Elements(graph.n_nodes() as u64));
            for instructions in Instructions::ALL.into_iter().take(if number == 1 { 3 } else { 1 }) {
                let id = BenchmarkId::new(format!("{instructions:?}"), graph.n_nodes());
                group.bench_function(id, |bencher| {
                    bencher.iter(|| {
                        one_thread.install(|| measure(&grid, graph.cells(), &columns, instructions))
                    });
                });
            }
            if number == 1 {
                let few = some(&graph, 20);
                let scans: Vec<_> =
                    few.iter().map(|&cell| scan::cast(&grid, cell, &ScanConfig::default())).collect();
                group.throughput(Throughput::Elements(few.len() as u64));
                group.bench_function(BenchmarkId::new("plain formulas", graph.n_nodes()), |bencher| {
                    bencher.iter(|| {
                        let values = scans.iter().flat_map(|scan| {
                            columns.iter().map(|id| plain_feature(id.feature(), scan.ranges_m()))
                        });
                        values.sum::<f64>()
                    });
                });
                group.bench_function(BenchmarkId::new("of single scans", graph.n_nodes()), |bencher| {
                    bencher.iter(|| scans.iter().map(|scan| of_scan(scan, &columns)[0]).sum::<f32>());
                });
            }
        }
        group.finish();
    }
}

/// Scans and features of `cells`.
fn measure(
    grid: &OccupancyGrid,
    cells: &[Cell],
    columns: &[FeatureId],
    instructions: Instructions,
) -> Vec<usize> {
    let (config, progress) = (&ScanConfig::default(), &Silent);
    let job = Job { grid, cells, columns, config, progress, instructions };
    let mut numbers = vec![0; cells.len()];
    evaluate(&job, &mut numbers, |values, out| out.fill(values.n_cells()));
    numbers
}

/// The features that the program's own model looks at.
fn default_columns() -> Vec<FeatureId> {
    let model = Model::builtin();
    let Method::Boosted(boosted) = &model.method else { return Vec::new() };
    let stumps = boosted.list.classifiers.iter().flat_map(|classifier| &classifier.stumps);
    let mut columns: Vec<_> = stumps.map(|weighted| weighted.stump.feature).collect();
    columns.sort_unstable();
    columns.dedup();
    columns
}

criterion_group! {
    name = benches;
    config = Criterion::default().with_measurement(ProcessorTime);
    targets = limits::limits, casting, measuring
}
criterion_main!(benches);
