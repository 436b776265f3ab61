//! Relaxation beside its plain twin and beside the memory's speed, in one run:
//! `cargo bench -p placegraph --bench relaxation`. Read the ratios, not the times: a plain iteration reads and writes every
//! probability once.
#![allow(clippy::unwrap_used, reason = "helpers of benches")]

#[path = "probe/memory.rs"]
mod memory;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use placegraph::grid::{Cell, CellGraph, Grid, Occupancy};
use placegraph::labels::LabelField;
use placegraph::relax::{Compatibility, RelaxConfig, relax};
use placegraph_testkit::relax as plain;

const ITERATIONS: u32 = 50;

/// Rooms of 4.5 × 3.5 m with doors, at 5 cm a cell, and any distributions over `n_labels` classes.
fn office(width: u32, height: u32, n_labels: usize) -> (CellGraph, LabelField) {
    let is_wall = |Cell { x, y }: Cell| {
        let (column, row) = (x % 90, y % 70);
        column == 0 && !(20..38).contains(&row) || row == 0 && !(40..58).contains(&column)
    };
    let cells = Grid::filled(width, height, ()).cells();
    let occupancy = cells.map(|cell| if is_wall(cell) { Occupancy::Occupied } else { Occupancy::Free });
    let graph = CellGraph::new(&Grid::from_rows(width, height, occupancy.collect()));
    let row = |node: usize| {
        let weights = (0..n_labels).map(move |k| 1.0 + (node * (k + 3) * 7919 % 101) as f32);
        let sum: f32 = weights.clone().sum();
        weights.map(move |weight| weight / sum)
    };
    let field = LabelField::from_rows(n_labels, (0..graph.n_nodes()).flat_map(row).collect());
    (graph, field)
}

/// Every class goes best with itself.
fn compatibility(n_labels: usize) -> Compatibility {
    let row = |k| (0..=n_labels).map(|other| if k == other { 0.5 } else { -0.1 }).collect();
    Compatibility::from_rows((0..=n_labels).map(row).collect()).unwrap()
}

fn relaxation(criterion: &mut Criterion) {
    let config = RelaxConfig::default();
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    for n_labels in [3, 4] {
        let (graph, field) = office(1200, 900, n_labels);
        let r = compatibility(n_labels);
        let mut group = criterion.benchmark_group(format!("relaxation, {n_labels} labels"));
        group.sample_size(10);
        group.throughput(Throughput::Elements(graph.n_nodes() as u64 * u64::from(ITERATIONS)));
        group.bench_function("all threads", |bencher| bencher.iter(|| relax(&graph, &field, &r, &config)));
        group.bench_function("one thread", |bencher| {
            bencher.iter(|| one_thread.install(|| relax(&graph, &field, &r, &config)));
        });
        let (graph, field) = office(300, 200, n_labels);
        group.throughput(Throughput::Elements(graph.n_nodes() as u64 * u64::from(ITERATIONS)));
        group.bench_function("plain twin", |bencher| {
            bencher.iter(|| plain::relax_in_f32(&graph, &field, &r, ITERATIONS));
        });
        group.finish();
    }
}

criterion_group!(benches, memory::limits, relaxation);
criterion_main!(benches);
