//! The relaxation iteration (Sect. 4.5, Eqs. 4.6 and 4.7): every cell's probabilities are moved toward what its eight
//! neighbors support, all cells at once.
//!
//! Cost O(K² n) an iteration; memory 4 K bytes per cell of the free cells' bounding box, beside input and output.
//!
//! Influence weights are o = 1/8 for each of the eight neighbors, also where some of them are walls or outside the
//! map. Cells that are not free are wall with probability 1 and stay so: the update is multiplicative. They need no
//! plane of their own either, because a neighbor is wall exactly where the K class probabilities are 0. With
//! B(k') = Σ_j p_j(k') over the eight neighbors, Σ_j p_j(wall) = 8 − Σ B(k'), so Eq. (4.7) reads
//!
//! ```text
//! q(k) = r(k, wall) + ⅛ Σ_k' (r(k, k') − r(k, wall)) B(k')
//! ```
//!
//! **Deviation**: `f32`, under a test that bounds the difference from the formula in `f64` (`tests/relax_oracle.rs`);
//! probabilities below 10⁻³⁰ become 0. A cell for which the neighbors rule out every label keeps its probabilities,
//! which Eq. (4.6) leaves open.

#![expect(clippy::inline_always, reason = "only what is inlined is compiled for several instruction sets")]

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::compatibility::Compatibility;
use super::planes::{LANES, MARGIN, Planes};
use crate::grid::CellGraph;
use crate::labels::{Label, LabelField};
use crate::scan::Instructions;

/// Rows that one thread steps through at a time. Part of no result: a step reads only the state before it.
const BAND: usize = 32;
/// Products below this are 0: denormal numbers are slow, and nothing can raise them again.
const TINY: f32 = 1e-30;

/// How long to iterate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RelaxConfig {
    /// Number of iterations. Default 50, as in the chapter.
    pub iterations: u32,
    /// Stop earlier, when no node's most probable label has changed in so many iterations. Default: never.
    pub patience: Option<u32>,
}

impl Default for RelaxConfig {
    fn default() -> Self {
        Self { iterations: 50, patience: None }
    }
}

/// The result of the relaxation.
#[derive(Clone, Debug, PartialEq)]
pub struct Relaxed {
    /// The probabilities after the last iteration.
    pub field: LabelField,
    /// Number of iterations made.
    pub iterations: u32,
    /// Largest change of a probability in the last iteration.
    pub last_change: f32,
}

/// Relaxes `initial` over the 8-neighborhoods of `graph`.
///
/// # Panics
/// If the field is not over the graph's nodes or the compatibilities not over the field's labels.
pub fn relax(
    graph: &CellGraph,
    initial: &LabelField,
    compatibility: &Compatibility,
    config: &RelaxConfig,
) -> Relaxed {
    assert_eq!(initial.n_nodes(), graph.n_nodes(), "a distribution per node");
    assert_eq!(initial.n_labels(), compatibility.n_labels(), "compatibilities of the same labels");
    match initial.n_labels() {
        2 => relax_planes::<2>(graph, initial, compatibility, config),
        3 => relax_planes::<3>(graph, initial, compatibility, config),
        4 => relax_planes::<4>(graph, initial, compatibility, config),
        5 => relax_planes::<5>(graph, initial, compatibility, config),
        6 => relax_planes::<6>(graph, initial, compatibility, config),
        7 => relax_planes::<7>(graph, initial, compatibility, config),
        8 => relax_planes::<8>(graph, initial, compatibility, config),
        other => unreachable!("a label set has 2 to 8 classes, not {other}"),
    }
}

fn relax_planes<const K: usize>(
    graph: &CellGraph,
    initial: &LabelField,
    compatibility: &Compatibility,
    config: &RelaxConfig,
) -> Relaxed {
    if graph.n_nodes() == 0 {
        return Relaxed { field: initial.clone(), iterations: 0, last_change: 0.0 };
    }
    let support = Support::<K>::new(compatibility);
    let mut planes = Planes::new(graph, initial);
    let mut stability = config.patience.map(|patience| Stability::new(patience, initial));
    let mut last_change = 0.0;
    let mut iterations = 0;
    while iterations < config.iterations {
        last_change = step(&mut planes, &support);
        iterations += 1;
        if stability.as_mut().is_some_and(|stability| stability.reached(&planes.field(graph))) {
            break;
        }
    }
    Relaxed { field: planes.field(graph), iterations, last_change }
}

/// Watches for labels that no longer change.
struct Stability {
    patience: u32,
    labels: Vec<Label>,
    unchanged: u32,
}

impl Stability {
    fn new(patience: u32, field: &LabelField) -> Self {
        Self { patience, labels: field.most_likely(), unchanged: 0 }
    }

    fn reached(&mut self, field: &LabelField) -> bool {
        let labels = field.most_likely();
        self.unchanged = if labels == self.labels { self.unchanged + 1 } else { 0 };
        self.labels = labels;
        self.unchanged >= self.patience
    }
}

/// The coefficients of 1 + q(k) as a linear function of the neighbors' sums B.
struct Support<const K: usize> {
    base: [f32; K],
    weights: [[f32; K]; K],
}

impl<const K: usize> Support<K> {
    fn new(r: &Compatibility) -> Self {
        let label = |k: usize| Label(k as u8);
        let wall = |k: usize| r.r(label(k), r.wall());
        let weight = |k: usize, other: usize| ((r.r(label(k), label(other)) - wall(k)) / 8.0) as f32;
        Self {
            base: std::array::from_fn(|k| (1.0 + wall(k)) as f32),
            weights: std::array::from_fn(|k| std::array::from_fn(|other| weight(k, other))),
        }
    }
}

/// One iteration over all cells; the largest change of a probability.
///
/// In place: a band of rows keeps copies of the rows that it has overwritten, and of its neighbor bands' edges.
fn step<const K: usize>(planes: &mut Planes, support: &Support<K>) -> f32 {
    let (stride, row_len) = (planes.stride, planes.row_len());
    let band_len = BAND * row_len;
    let outside = vec![0.0; row_len];
    let edges: Vec<(Vec<f32>, Vec<f32>)> = planes
        .values
        .par_chunks(band_len)
        .map(|band| (band[..row_len].to_vec(), band[band.len() - row_len..].to_vec()))
        .collect();
    let bands = planes.values.par_chunks_mut(band_len).zip(planes.runs.par_chunks(BAND)).enumerate();
    bands
        .map(|(number, (band, runs))| {
            let below = number.checked_sub(1).map_or(&outside, |n| &edges[n].1);
            let above = edges.get(number + 1).map_or(&outside, |edge| &edge.0);
            Instructions::default().run(
                #[inline(always)]
                || step_band(band, runs, below, above, stride, support),
            )
        })
        .reduce(|| 0.0, f32::max)
}

/// One iteration over the rows of a band, given the rows below and above it as they were before.
#[inline(always)]
fn step_band<const K: usize>(
    band: &mut [f32],
    runs: &[Vec<(u32, u32)>],
    below: &[f32],
    above: &[f32],
    stride: usize,
    support: &Support<K>,
) -> f32 {
    let row_len = K * stride;
    let mut below = below.to_vec();
    let mut old = vec![0.0; row_len];
    let mut columns = vec![0.0; row_len];
    let mut change = [0.0; LANES];
    for (row, runs) in runs.iter().enumerate() {
        let (done, rest) = band.split_at_mut((row + 1) * row_len);
        let current = &mut done[row * row_len..];
        let above = if rest.is_empty() { above } else { &rest[..row_len] };
        old.copy_from_slice(current);
        for &(first, end) in runs {
            let span = first as usize * LANES..end as usize * LANES + 2 * MARGIN;
            sum_columns::<K>(&mut columns, [&below, &old, above], stride, span);
            for block in first as usize..end as usize {
                update_block(current, &columns, stride, block * LANES + MARGIN, support, &mut change);
            }
        }
        std::mem::swap(&mut below, &mut old);
    }
    change.into_iter().fold(0.0, f32::max)
}

/// Sums of three cells, one above the other: half of the separable 3 × 3 sum.
#[inline(always)]
fn sum_columns<const K: usize>(
    columns: &mut [f32],
    rows: [&[f32]; 3],
    stride: usize,
    span: std::ops::Range<usize>,
) {
    for k in 0..K {
        let span = k * stride + span.start..k * stride + span.end;
        let [below, middle, above] = rows.map(|row| &row[span.clone()]);
        for (((sum, a), b), c) in columns[span].iter_mut().zip(below).zip(middle).zip(above) {
            *sum = (a + b) + c;
        }
    }
}

/// Eqs. (4.7) and (4.6) for sixteen neighboring cells.
#[expect(clippy::needless_range_loop, reason = "indices k, k' and i read like the equations")]
#[inline(always)]
fn update_block<const K: usize>(
    current: &mut [f32],
    columns: &[f32],
    stride: usize,
    at: usize,
    support: &Support<K>,
    change: &mut [f32; LANES],
) {
    let mut p = [[0.0f32; LANES]; K];
    let mut neighbors = [[0.0f32; LANES]; K];
    for k in 0..K {
        let start = k * stride + at;
        p[k].copy_from_slice(&current[start..start + LANES]);
        let window = &columns[start - 1..=start + LANES];
        for i in 0..LANES {
            neighbors[k][i] = ((window[i] + window[i + 1]) + window[i + 2]) - p[k][i];
        }
    }
    let mut product = [[0.0f32; LANES]; K];
    let mut sum = [0.0f32; LANES];
    for k in 0..K {
        let mut one_plus_q = [support.base[k]; LANES];
        for other in 0..K {
            // Eq. (4.7)
            for i in 0..LANES {
                one_plus_q[i] += support.weights[k][other] * neighbors[other][i];
            }
        }
        for i in 0..LANES {
            let value = p[k][i] * one_plus_q[i];
            product[k][i] = if value > TINY { value } else { 0.0 };
            sum[i] += product[k][i];
        }
    }
    for k in 0..K {
        let start = k * stride + at;
        for (i, new) in current[start..start + LANES].iter_mut().enumerate() {
            // Eq. (4.6)
            *new = if sum[i] > 0.0 { product[k][i] / sum[i] } else { p[k][i] };
            change[i] = change[i].max((*new - p[k][i]).abs());
        }
    }
}
