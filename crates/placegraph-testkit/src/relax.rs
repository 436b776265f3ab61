//! Relaxation labeling by the book: K + 1 labels in every cell of the grid, `f64`.

use placegraph::grid::{CellGraph, Connectivity};
use placegraph::labels::{Label, LabelField};
use placegraph::relax::Compatibility;

/// The distributions of the graph's nodes over K classes after `iterations` steps of Eqs. (4.6) and (4.7).
pub fn relax(graph: &CellGraph, initial: &LabelField, r: &Compatibility, iterations: u32) -> Vec<Vec<f64>> {
    let n = r.n_labels();
    let mut p: Vec<Vec<f64>> = (0..graph.n_nodes())
        .map(|node| initial.row(node).iter().map(|&p| f64::from(p)).chain([0.0]).collect())
        .collect();
    let wall: Vec<f64> = (0..=n).map(|k| if k == n { 1.0 } else { 0.0 }).collect();
    for _ in 0..iterations {
        let updated = (0..graph.n_nodes()).map(|i| {
            let mut q = vec![0.0; n + 1];
            for &step in Connectivity::Eight.steps() {
                let p_j = graph.node_at_step(i, step).map_or(&wall, |j| &p[j]);
                for (k, q) in q.iter_mut().enumerate() {
                    for (k_other, p) in p_j.iter().enumerate() {
                        *q += r.r(Label(k as u8), Label(k_other as u8)) * p / 8.0;
                    }
                }
            }
            let product: Vec<f64> = p[i].iter().zip(&q).map(|(p, q)| p * (1.0 + q)).collect();
            let sum: f64 = product.iter().sum();
            if sum > 0.0 { product.iter().map(|v| v / sum).collect() } else { p[i].clone() }
        });
        p = updated.collect();
    }
    p.into_iter().map(|row| row[..n].to_vec()).collect()
}

/// The same in `f32`, one cell after the other, each sum in the order in which the library makes it: its twin to the
/// last bit.
pub fn relax_in_f32(
    graph: &CellGraph,
    initial: &LabelField,
    r: &Compatibility,
    iterations: u32,
) -> LabelField {
    let n = r.n_labels();
    let label = |k: usize| Label(k as u8);
    let wall = |k: usize| r.r(label(k), r.wall());
    let weight = |k: usize, other: usize| ((r.r(label(k), label(other)) - wall(k)) / 8.0) as f32;
    let mut p = initial.values().to_vec();
    for _ in 0..iterations {
        let mut next = p.clone();
        for i in 0..graph.n_nodes() {
            let at = |k: usize, x, y| graph.node_at_step(i, (x, y)).map_or(0.0, |j| p[j * n + k]);
            let column = |k: usize, x| (at(k, x, -1) + at(k, x, 0)) + at(k, x, 1);
            let own = &p[i * n..(i + 1) * n];
            let neighbors: Vec<f32> =
                (0..n).map(|k| ((column(k, -1) + column(k, 0)) + column(k, 1)) - own[k]).collect();
            let product: Vec<f32> = (0..n)
                .map(|k| {
                    let support = |sum: f32, other: usize| sum + weight(k, other) * neighbors[other];
                    let value = own[k] * (0..n).fold((1.0 + wall(k)) as f32, support);
                    if value > 1e-30 { value } else { 0.0 }
                })
                .collect();
            let sum: f32 = product.iter().fold(0.0, |sum, value| sum + value);
            if sum > 0.0 {
                for k in 0..n {
                    next[i * n + k] = product[k] / sum;
                }
            }
        }
        p = next;
    }
    LabelField::from_rows(n, p)
}
