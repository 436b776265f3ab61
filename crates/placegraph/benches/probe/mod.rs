//! How fast this machine streams memory: the bound of every stage that does little with much.

use std::hint::black_box;
use std::time::Instant;

use rayon::prelude::*;

/// Larger than any cache, in `f32`: 256 MiB.
const N_VALUES: usize = 1 << 26;
/// Values that a thread takes at a time.
const CHUNK: usize = 1 << 20;
/// The best of so many passes counts: others may use the machine.
const N_PASSES: usize = 5;

/// Bytes a second from and to memory, reads and writes both counted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bandwidth {
    /// One thread alone.
    pub(crate) one_core: f64,
    /// All threads of the pool together.
    pub(crate) all_cores: f64,
}

impl Bandwidth {
    /// Measures both, and prints them. Takes about a second.
    pub(crate) fn measure() -> Self {
        let mut values = vec![1.0f32; N_VALUES];
        let one_core = best_of_passes(|| values.chunks_mut(CHUNK).for_each(update));
        let all_cores = best_of_passes(|| values.par_chunks_mut(CHUNK).for_each(update));
        black_box(&values);
        println!("memory: {:.1} GB/s one core, {:.1} GB/s all", one_core * 1e-9, all_cores * 1e-9);
        Self { one_core, all_cores }
    }
}

/// Reads and writes every value once.
fn update(values: &mut [f32]) {
    for value in values {
        *value = *value * 0.5 + 0.5;
    }
}

fn best_of_passes(mut pass: impl FnMut()) -> f64 {
    let seconds = (0..N_PASSES).map(|_| {
        let start = Instant::now();
        pass();
        start.elapsed().as_secs_f64()
    });
    let best = seconds.fold(f64::INFINITY, f64::min);
    (2 * N_VALUES * size_of::<f32>()) as f64 / best
}
