//! Time and score of α-expansion on the problems of `peers/alpha_expansion.py`, and how it grows with their size.
//!
//! A table instead of statistics: processor seconds of the one thread that works, best of three, so that a busy
//! machine disturbs little.
#![allow(clippy::print_stdout, reason = "a table is the result")]

use std::fs;
use std::hint::black_box;
use std::time::Instant;

use placegraph::amn::infer;
use placegraph::grid::Connectivity;
use placegraph_testkit::networks::smooth_problem;

fn main() {
    for side in [100, 180, 361, 600, 1000] {
        for connectivity in [Connectivity::Four, Connectivity::Eight] {
            for reward in [10.0, 40.0] {
                let (graph, potentials) = smooth_problem(side, side, 3, reward, connectivity);
                let mut best = f64::INFINITY;
                let mut score = 0.0;
                for _ in 0..3 {
                    let begin = processor_seconds();
                    let labeling = infer::expand(black_box(&graph), &potentials, &potentials.best_alone());
                    best = best.min(processor_seconds() - begin);
                    score = potentials.score(&graph, &labeling);
                }
                println!(
                    "{side}x{side} {connectivity:?} reward {reward}: score {score:.0}  total {best:.3} s"
                );
            }
        }
    }
}

/// Processor time of this thread where the system tells it, else the clock.
fn processor_seconds() -> f64 {
    thread_local!(static START: Instant = Instant::now());
    let nanoseconds = fs::read_to_string("/proc/thread-self/schedstat")
        .ok()
        .and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(|| START.with(|start| start.elapsed().as_secs_f64()), |ns| ns * 1e-9)
}
