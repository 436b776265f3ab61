//! Regions of a map of 16 million cells, with their measures and contacts, and its topological map:
//! `cargo bench -p placegraph --bench regions`.
#![allow(clippy::unwrap_used, reason = "helpers of benches")]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use placegraph::grid::{Cell, CellGraph, DiagonalSteps, FreeSpace, Grid, MapFrame, Occupancy};
use placegraph::labels::{Label, LabelField, LabelSet};
use placegraph::regions::{connected, contacts, properties};
use placegraph::topology::{build, outlines};

mod maps;

/// Rooms of 4.5 × 3.5 m along corridors, with doorways and ragged walls, at 5 cm a cell; the label of every cell, if it is free.
fn label(Cell { x, y }: Cell) -> Option<Label> {
    let (column, row) = (x % 90, y % 180);
    let rough = 2 + u32::from((x * 7 + y * 13) % 11 < 3);
    match row {
        0..40 => Some(Label(0)),
        40..43 | 177..180 => (30..50).contains(&column).then_some(Label(2)),
        _ => (column >= rough).then_some(Label(1)),
    }
}

fn regions(criterion: &mut Criterion) {
    let cells = || Grid::filled(4000, 4000, ()).cells();
    let occupancy = cells().map(|cell| label(cell).map_or(Occupancy::Occupied, |_| Occupancy::Free));
    let map = Grid::from_rows(4000, 4000, occupancy.collect());
    let frame = MapFrame::new(0.05, placegraph::geom::Pose2::default()).unwrap();
    let space = FreeSpace { frame, graph: CellGraph::new(&map) };
    let graph = &space.graph;
    let labeling: Vec<Label> = cells().filter_map(label).collect();
    let field = LabelField::from_rows(3, [0.5, 0.25, 0.25].repeat(graph.n_nodes()));
    let bytes: Vec<u8> = cells().map(|cell| label(cell).map_or(0, |label| label.0 + 1)).collect();
    maps::dump(4000, 4000, &bytes);
    let found = connected(graph, &labeling, DiagonalSteps::default());

    let mut group = criterion.benchmark_group("16 M cells");
    group.sample_size(10).throughput(Throughput::Elements(16_000_000));
    group.bench_function("graph", |bencher| bencher.iter(|| CellGraph::new(&map)));
    group.bench_function("connected", |bencher| {
        bencher.iter(|| connected(graph, &labeling, DiagonalSteps::default()));
    });
    group.bench_function("properties", |bencher| bencher.iter(|| properties(&space, &found)));
    group.bench_function("contacts", |bencher| bencher.iter(|| contacts(graph, &found)));
    group.bench_function("outlines", |bencher| bencher.iter(|| outlines(&space, &found)));
    group.bench_function("topological map, routes and all", |bencher| {
        bencher.iter(|| build(&space, &field, &found, &LabelSet::default()));
    });
    group.finish();
}

criterion_group!(benches, regions);
criterion_main!(benches);
