//! What this machine can do at best: arithmetic, and operations on bits, in registers.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, SamplingMode, Throughput};
use placegraph::scan::Instructions;

use super::processor::ProcessorTime;

/// Values side by side.
const WIDTH: usize = 16;
/// Words of 64 bits side by side.
const WORDS: usize = 8;
/// Sums that are worked on in turn, so that none waits for itself.
const SUMS: usize = 7;
const N_ROUNDS: usize = 4096;

/// Multiplications with an addition each, and operations on words of 64 bits, of one core.
pub(crate) fn limits(criterion: &mut Criterion<ProcessorTime>) {
    let mut group = criterion.benchmark_group("limits");
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    group.throughput(Throughput::Elements((N_ROUNDS * SUMS * WIDTH) as u64));
    for instructions in Instructions::ALL {
        group.bench_function(BenchmarkId::new("multiply and add", format!("{instructions:?}")), |bencher| {
            bencher.iter(|| {
                instructions.run(
                    #[inline(always)]
                    || multiply_and_add(black_box(0.999)),
                )
            });
        });
    }
    group.throughput(Throughput::Elements((N_ROUNDS * SUMS * WORDS * 4) as u64));
    // Not the widest: with AVX-512 the compiler keeps these words out of the vector registers.
    for instructions in [Instructions::Avx2, Instructions::Baseline] {
        group.bench_function(BenchmarkId::new("bits", format!("{instructions:?}")), |bencher| {
            bencher.iter(|| {
                instructions.run(
                    #[inline(always)]
                    || shift_and_mask(black_box(3)),
                )
            });
        });
    }
    group.finish();
}

/// Two shifts, an "or" and an "and" a word, as a walk over the map's bits makes them.
#[inline(always)]
fn shift_and_mask(mask: u64) -> u64 {
    let [mut a, mut b, mut c, mut d, mut e, mut f, mut g]: [[u64; WORDS]; SUMS] =
        std::array::from_fn(|sum| [sum as u64; WORDS]);
    for _ in 0..N_ROUNDS {
        (a, b, c, d) = (turned(a, mask), turned(b, mask), turned(c, mask), turned(d, mask));
        (e, f, g) = (turned(e, mask), turned(f, mask), turned(g, mask));
    }
    [a, b, c, d, e, f, g].as_flattened().iter().fold(0, |all, word| all ^ word)
}

/// Four operations a word.
#[inline(always)]
fn turned(words: [u64; WORDS], mask: u64) -> [u64; WORDS] {
    words.map(
        #[inline(always)]
        |word| (word >> 1 | word << 5) & !mask,
    )
}

#[inline(always)]
fn multiply_and_add(factor: f32) -> f32 {
    // By name: of an array the compiler would put the sums side by side instead of the lanes.
    let [mut a, mut b, mut c, mut d, mut e, mut f, mut g]: [[f32; WIDTH]; SUMS] =
        std::array::from_fn(|sum| [sum as f32; WIDTH]);
    for _ in 0..N_ROUNDS {
        (a, b, c, d) = (next(a, factor), next(b, factor), next(c, factor), next(d, factor));
        (e, f, g) = (next(e, factor), next(f, factor), next(g, factor));
    }
    [a, b, c, d, e, f, g].as_flattened().iter().sum()
}

#[inline(always)]
fn next(sum: [f32; WIDTH], factor: f32) -> [f32; WIDTH] {
    sum.map(
        #[inline(always)]
        |value| value * factor + 1.0,
    )
}
