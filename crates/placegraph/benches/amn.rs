//! α-expansion on the problems of `peers/alpha_expansion.py`, and how its time grows with their size:
//! `cargo bench -p placegraph --bench amn`. The scores that it prints are to be compared with those of the peers.

#![allow(missing_docs, reason = "criterion makes public functions")]
#![allow(clippy::print_stdout, reason = "the scores are a result")]

use criterion::{BenchmarkId, Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use placegraph::cuts::expand;
use placegraph::grid::Connectivity;
use placegraph_testkit::networks::smooth_problem;

/// The strong coupling of the peers' two.
const REWARD: f64 = 40.0;

fn expansion(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("alpha-expansion");
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    for side in [100, 361, 1000] {
        for connectivity in [Connectivity::Four, Connectivity::Eight] {
            let (graph, potentials) = smooth_problem(side, side, 3, REWARD, connectivity);
            let name = format!("{connectivity:?}, reward {REWARD}");
            let score = potentials.score(&graph, &expand(&graph, &potentials, &potentials.best_alone()));
            println!("{side}x{side} {name}: score {score:.0}");
            group.throughput(Throughput::Elements(graph.n_nodes() as u64));
            group.bench_function(BenchmarkId::new(name, graph.n_nodes()), |bencher| {
                bencher.iter(|| expand(&graph, &potentials, &potentials.best_alone()));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, expansion);
criterion_main!(benches);
