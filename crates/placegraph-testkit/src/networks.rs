//! Labeling problems on grids, the same in every language, and their solution by enumeration.

use placegraph::cuts::Potentials;
use placegraph::grid::{CellGraph, Connectivity, Grid, Occupancy};
use placegraph::labels::{Label, Labeling};

/// Random bits that depend on `index` alone (the finalizer of SplitMix64).
pub fn hash(index: u64) -> u64 {
    let mut z = index.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A uniform number in 0 .. 1 that depends on `index` alone.
pub fn uniform(index: u64) -> f64 {
    (hash(index) >> 11) as f64 / (1u64 << 53) as f64
}

/// The graph of a map that is free everywhere.
pub fn open_floor(width: u32, height: u32) -> CellGraph {
    CellGraph::new(&Grid::filled(width, height, Occupancy::Free))
}

/// Noise smoothed over 5 × 5 cells as node potentials, whole numbers from 0 to 1000, on an open floor; all
/// labels earn the same `reward` per edge. `benches/peers/alpha_expansion.py` makes the same problem.
pub fn smooth_problem(
    width: u32,
    height: u32,
    n_labels: usize,
    reward: f64,
    connectivity: Connectivity,
) -> (CellGraph, Potentials) {
    let (w, h) = (width as usize, height as usize);
    let mut node = vec![0.0; w * h * n_labels];
    for k in 0..n_labels {
        let noise: Vec<u64> = (0..w * h).map(|i| hash((k * w * h + i) as u64) >> 40).collect();
        for y in 0..h {
            for x in 0..w {
                let rows = y.saturating_sub(2)..(y + 3).min(h);
                let sum: u64 = rows
                    .map(|v| noise[v * w + x.saturating_sub(2)..v * w + (x + 3).min(w)].iter().sum::<u64>())
                    .sum();
                node[(y * w + x) * n_labels + k] = ((sum * 40) >> 24) as f64;
            }
        }
    }
    let potentials = Potentials { node, edge: vec![reward; n_labels], connectivity };
    (open_floor(width, height), potentials)
}

/// All labelings of `n_nodes` nodes, the first node's label changing fastest.
pub fn labelings(n_nodes: usize, n_labels: usize) -> impl Iterator<Item = Labeling> {
    (0..n_labels.pow(n_nodes as u32)).map(move |mut index| {
        let mut digit = |_| {
            let label = Label((index % n_labels) as u8);
            index /= n_labels;
            label
        };
        (0..n_nodes).map(&mut digit).collect()
    })
}

/// The labeling of highest score among all; the first of [`labelings`] where several are equal.
pub fn best_by_enumeration(graph: &CellGraph, potentials: &Potentials) -> Labeling {
    let mut best = (f64::NEG_INFINITY, Vec::new());
    for labeling in labelings(graph.n_nodes(), potentials.n_labels()) {
        let score = potentials.score(graph, &labeling);
        if score > best.0 {
            best = (score, labeling);
        }
    }
    best.1
}

/// A small problem with uniform node potentials and a random reward below `reward` for every label.
pub fn random_problem(
    (width, height): (u32, u32),
    n_labels: usize,
    reward: f64,
    connectivity: Connectivity,
    seed: u64,
) -> (CellGraph, Potentials) {
    let graph = open_floor(width, height);
    let random = |index: usize| uniform(seed << 20 | index as u64);
    let n = graph.n_nodes() * n_labels;
    let node = (0..n).map(random).collect();
    let edge = (0..n_labels).map(|k| reward * random(n + k)).collect();
    (graph, Potentials { node, edge, connectivity })
}
