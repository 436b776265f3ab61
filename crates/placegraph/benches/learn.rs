//! Time of the learning half: boosting, scores of many cells, order search.
//!
//! `cargo bench -p placegraph --bench learn`
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use placegraph::boost::{CompiledClassifiers, Scores, adaboost, search_order, table_scores};
use placegraph::features::{FeatureId, FeatureTable};
use placegraph::labels::Label;
use placegraph::progress::Silent;
use placegraph_testkit::boost::{largest_edge_by_sorting, sorted_columns};

/// Cells of the left half of a building at 5 cm.
const N_EXAMPLES: usize = 65_000;
const N_FEATURES: usize = 203;

/// Numbers from 0 to 1 from a small congruential generator.
fn noise(n: usize, seed: u32) -> Vec<f32> {
    let mut state = seed;
    let next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / 16_777_216.0
    };
    std::iter::repeat_with(next).take(n).collect()
}

/// Noisy copies of three hidden quantities, and classes that depend on them.
fn examples() -> (FeatureTable, Vec<Label>) {
    let hidden: Vec<Vec<f32>> = (0..3).map(|k| noise(N_EXAMPLES, k)).collect();
    let column = |c: usize| {
        let own = noise(N_EXAMPLES, 100 + c as u32);
        own.into_iter().zip(&hidden[c % 3]).map(|(noise, value)| value + noise).collect::<Vec<_>>()
    };
    let values = (0..N_FEATURES).flat_map(column).collect();
    let columns = (0..N_FEATURES as u16).map(FeatureId).collect();
    let label = |i: usize| Label(u8::from(hidden[0][i] > 0.6) + u8::from(hidden[1][i] * hidden[2][i] > 0.4));
    (FeatureTable::from_columns(columns, N_EXAMPLES, values), (0..N_EXAMPLES).map(label).collect())
}

/// Writes the examples for `peers/boosting.py` to the folder named by `PLACEGRAPH_DUMP`.
fn dump(table: &FeatureTable, labels: &[Label]) {
    let Ok(folder) = std::env::var("PLACEGRAPH_DUMP") else { return };
    let columns = (0..table.columns().len()).flat_map(|column| table.column(column));
    let values: Vec<u8> = columns.flat_map(|value| value.to_le_bytes()).collect();
    std::fs::write(format!("{folder}/boost.values"), values).unwrap();
    let labels: Vec<u8> = labels.iter().map(|label| label.0).collect();
    std::fs::write(format!("{folder}/boost.labels"), labels).unwrap();
}

fn boosting(c: &mut Criterion) {
    let (table, labels) = examples();
    dump(&table, &labels);
    let rows: Vec<u32> = (0..N_EXAMPLES as u32).collect();
    let mut group = c.benchmark_group("boost");
    group.sample_size(10);
    for n_rounds in [1, 101] {
        group.bench_function(format!("rounds: {n_rounds}, 65k x 203, 3 classes"), |b| {
            b.iter(|| adaboost(&table, &rows, &labels, 3, black_box(n_rounds), &Silent).unwrap());
        });
    }
    let sorted = sorted_columns(&table);
    let (positive, weights): (Vec<bool>, Vec<f64>) =
        labels.iter().map(|&label| (label == Label(0), 1.0 / N_EXAMPLES as f64)).unzip();
    group.bench_function("plain search of one round, 65k x 203, 1 class", |b| {
        b.iter(|| largest_edge_by_sorting(&table, &sorted, &positive, &weights));
    });
    let classifiers = adaboost(&table, &rows, &labels, 3, 300, &Silent).unwrap();
    let classifiers = CompiledClassifiers::new(&classifiers);
    group.bench_function("scores of 65k cells, 3 x 300 stumps", |b| {
        b.iter(|| table_scores(&table, &rows, &classifiers));
    });
    let scores = Scores::from_rows(8, noise(8 * 10_000, 9).into_iter().map(|v| v * 8.0 - 4.0).collect());
    let eight: Vec<Label> = (0..10_000).map(|i| Label((i % 8) as u8)).collect();
    group.bench_function("40320 orders, 10k cells", |b| {
        b.iter(|| search_order(&scores, &eight, &[1; 8], 1.0));
    });
    group.finish();
}

criterion_group!(benches, boosting);
criterion_main!(benches);
