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
