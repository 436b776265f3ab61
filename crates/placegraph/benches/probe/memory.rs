//! How fast this machine streams memory: the bound of every stage that does little with much.

use std::hint::black_box;

use criterion::{Criterion, Throughput};
use rayon::prelude::*;

/// Larger than any cache, in `f32`: 256 MiB.
const N_VALUES: usize = 1 << 26;
/// Values that a thread takes at a time.
const CHUNK: usize = 1 << 20;

/// Passes that read and write every value: bytes a second, reads and writes both counted.
pub(crate) fn limits(criterion: &mut Criterion) {
    let mut values = vec![1.0f32; N_VALUES];
    let mut group = criterion.benchmark_group("memory");
    group.sample_size(10).throughput(Throughput::Bytes((2 * N_VALUES * size_of::<f32>()) as u64));
    group.bench_function("one thread", |bencher| {
        bencher.iter(|| {
            values.chunks_mut(CHUNK).for_each(update);
            black_box(&values);
        });
    });
    group.bench_function("all threads", |bencher| {
        bencher.iter(|| {
            values.par_chunks_mut(CHUNK).for_each(update);
            black_box(&values);
        });
    });
    group.finish();
}

/// Reads and writes every value once.
fn update(values: &mut [f32]) {
    for value in values {
        *value = *value * 0.5 + 0.5;
    }
}
