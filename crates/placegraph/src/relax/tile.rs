//! Several iterations over a part of the map that stays in cache.
//!
//! Iteration t of row y needs rows y − 1, y and y + 1 after iteration t − 1, so rows are taken from below one by one, and each
//! new one is followed by iteration 1 of the row below it, iteration 2 of the row below that, and so on: three rows are kept of
//! every iteration. At the borders of a tile the first and last columns and rows lack neighbors, one more with every iteration;
//! they are computed by the neighboring tiles.

#![expect(clippy::inline_always, reason = "only what is inlined is compiled for several instruction sets")]

use std::ops::Range;

use super::compatibility::Compatibility;
use super::planes::{LANES, Planes};
use crate::labels::Label;

/// Most iterations at once: the columns that lack neighbors then lie in the block next to the tile.
pub(super) const MAX_STEPS: u32 = LANES as u32;
/// Blocks of a tile: with three rows for each of ten iterations and four labels it takes half a megabyte of cache.
pub(super) const TILE_BLOCKS: usize = 64;
/// Products below this are 0: denormal numbers are slow, and nothing can raise them again.
const TINY: f32 = 1e-30;

/// The coefficients of 1 + q(k) as a linear function of the neighbors' sums B.
#[derive(Debug)]
pub(super) struct Support<const K: usize> {
    base: [f32; K],
    weights: [[f32; K]; K],
}

impl<const K: usize> Support<K> {
    pub(super) fn new(r: &Compatibility) -> Self {
        let label = |k: usize| Label(k as u8);
        let wall = |k: usize| r.r(label(k), r.wall());
        let weight = |k: usize, other: usize| ((r.r(label(k), label(other)) - wall(k)) / 8.0) as f32;
        Self {
            base: std::array::from_fn(|k| (1.0 + wall(k)) as f32),
            weights: std::array::from_fn(|k| std::array::from_fn(|other| weight(k, other))),
        }
    }
}

/// What is computed of the map.
#[derive(Debug)]
pub(super) struct Tile {
    /// The rows that are wanted.
    pub(super) rows: Range<u32>,
    /// The blocks that are wanted.
    pub(super) blocks: Range<usize>,
    /// Number of rows of the map.
    pub(super) height: u32,
    /// Number of iterations, at most [`MAX_STEPS`].
    pub(super) steps: u32,
}

/// K planes of a row of a tile: plane k begins at k · `stride`, one block and one column left of the tile.
#[derive(Clone, Copy)]
struct Row<'a> {
    values: &'a [f32],
    stride: usize,
}

impl Tile {
    /// Length of one plane's part of a row: the tile, a block at either end, and a column for these to look at.
    pub(super) fn stride(&self) -> usize {
        (self.blocks.len() + 2) * LANES + 2
    }

    /// The rows after iteration `step` that the wanted ones depend on.
    fn rows_after(&self, step: u32) -> Range<u32> {
        let left = self.steps - step;
        self.rows.start.saturating_sub(left)..(self.rows.end + left).min(self.height)
    }

    /// Calls `visit` with every wanted row and its planes after the last iteration; returns the largest change of a
    /// probability in that one. `planes` has the rows before the first iteration.
    #[inline(always)]
    pub(super) fn relax<const K: usize>(
        &self,
        planes: &Planes,
        support: &Support<K>,
        mut visit: impl FnMut(u32, &[f32]),
    ) -> f32 {
        let (stride, steps) = (self.stride(), self.steps as usize);
        let row_len = K * stride;
        let outside = vec![0.0; row_len];
        let mut columns = vec![0.0; row_len];
        // Three rows after each iteration.
        let mut after = vec![0.0; 3 * steps * row_len];
        let mut change = [0.0; LANES];
        let all = self.rows_after(0);
        for newest in all.start..all.end + self.steps {
            for step in 1..=steps {
                let Some(y) = newest.checked_sub(step as u32) else { break };
                if !self.rows_after(step as u32).contains(&y) {
                    continue;
                }
                let (before, out) = after.split_at_mut(3 * (step - 1) * row_len);
                let row_before = |y: Option<u32>| match y.filter(|&y| y < self.height) {
                    None => Row { values: &outside, stride },
                    Some(y) if step == 1 => {
                        Row { values: planes.row(y, self.blocks.start), stride: planes.stride }
                    }
                    Some(y) => {
                        let start = (3 * (step - 2) + y as usize % 3) * row_len;
                        Row { values: &before[start..start + row_len], stride }
                    }
                };
                let rows = [y.checked_sub(1), Some(y), Some(y + 1)].map(row_before);
                let out = &mut out[y as usize % 3 * row_len..][..row_len];
                let is_last = step == steps;
                self.step_row(planes, y, rows, support, &mut columns, out, is_last, &mut change);
                if is_last {
                    visit(y, out);
                }
            }
        }
        change.into_iter().fold(0.0, f32::max)
    }

    /// One iteration of row `y`, given it and the rows below and above it.
    #[expect(clippy::too_many_arguments, reason = "buffers that are made once")]
    #[inline(always)]
    fn step_row<const K: usize>(
        &self,
        planes: &Planes,
        y: u32,
        rows: [Row<'_>; 3],
        support: &Support<K>,
        columns: &mut [f32],
        out: &mut [f32],
        is_last: bool,
        change: &mut [f32; LANES],
    ) {
        let stride = self.stride();
        let n_blocks = self.blocks.len() + 2;
        let is_used = |block: usize| planes.is_used(y, self.blocks.start + block);
        let mut first = 0;
        while first < n_blocks {
            let end = (first..n_blocks).find(|&block| is_used(block) != is_used(first)).unwrap_or(n_blocks);
            if is_used(first) {
                sum_columns::<K>(columns, rows, stride, first * LANES..end * LANES + 2);
                for block in first..end {
                    let mut changed = [0.0; LANES];
                    update_block(rows[1], columns, stride, block * LANES + 1, support, out, &mut changed);
                    if is_last && (1..=self.blocks.len()).contains(&block) {
                        for (largest, changed) in change.iter_mut().zip(changed) {
                            *largest = largest.max(changed);
                        }
                    }
                }
            } else {
                for k in 0..K {
                    out[k * stride + 1..][first * LANES..end * LANES].fill(0.0);
                }
            }
            first = end;
        }
    }
}

/// Sums of three cells, one above the other, in the columns `span`: half of the separable 3 × 3 sum.
#[inline(always)]
fn sum_columns<const K: usize>(columns: &mut [f32], rows: [Row<'_>; 3], stride: usize, span: Range<usize>) {
    for k in 0..K {
        let [below, middle, above] = rows.map(|row| &row.values[k * row.stride..][span.clone()]);
        let sums = &mut columns[k * stride..][span.clone()];
        for (((sum, a), b), c) in sums.iter_mut().zip(below).zip(middle).zip(above) {
            *sum = (a + b) + c;
        }
    }
}

/// Eqs. (4.7) and (4.6) for sixteen neighboring cells, and how much each of them changed.
#[expect(clippy::needless_range_loop, reason = "indices k, k' and i read like the equations")]
#[inline(always)]
fn update_block<const K: usize>(
    row: Row<'_>,
    columns: &[f32],
    stride: usize,
    at: usize,
    support: &Support<K>,
    out: &mut [f32],
    change: &mut [f32; LANES],
) {
    let mut p = [[0.0f32; LANES]; K];
    let mut neighbors = [[0.0f32; LANES]; K];
    for k in 0..K {
        p[k].copy_from_slice(&row.values[k * row.stride + at..][..LANES]);
        let window = &columns[k * stride + at - 1..][..LANES + 2];
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
        let out = &mut out[k * stride + at..][..LANES];
        for i in 0..LANES {
            // Eq. (4.6)
            out[i] = if sum[i] > 0.0 { product[k][i] / sum[i] } else { p[k][i] };
            change[i] = change[i].max((out[i] - p[k][i]).abs());
        }
    }
}
