//! Probabilities of some rows of the map as planes of `f32`, one per class: a layout in which one relaxation step is
//! a few additions and multiplications of neighboring numbers.

use std::ops::Range;

use crate::grid::CellGraph;

/// Columns that a step computes together: a block.
pub(super) const LANES: usize = 16;
/// Columns left and right of a row that are always 0: a block, and one column that its first and last cells look at.
const MARGIN: usize = LANES + 1;

/// K planes over some rows; 0 in every cell that is not free. A row holds its K planes one after the other.
#[derive(Debug)]
pub(super) struct Planes {
    /// The rows.
    pub(super) rows: Range<u32>,
    /// Length of one plane's part of a row.
    pub(super) stride: usize,
    /// Number of blocks in a row.
    pub(super) n_blocks: usize,
    n_labels: usize,
    values: Vec<f32>,
    /// Whether a block holds a free cell, row by row.
    is_used: Vec<bool>,
}

impl Planes {
    /// Room for `rows` of the map of `graph`.
    pub(super) fn new(graph: &CellGraph, rows: Range<u32>, n_labels: usize) -> Self {
        let n_blocks = (graph.width() as usize).div_ceil(LANES);
        let stride = n_blocks * LANES + 2 * MARGIN;
        Self {
            stride,
            n_blocks,
            n_labels,
            values: vec![0.0; rows.len() * n_labels * stride],
            is_used: vec![false; rows.len() * n_blocks],
            rows,
        }
    }

    /// Puts the distributions of the nodes in `rows` into place.
    pub(super) fn fill(&mut self, graph: &CellGraph, rows: Range<u32>, field: &[f32]) {
        let mut distributions = field.chunks_exact(self.n_labels);
        for y in rows {
            let row = (y - self.rows.start) as usize;
            let values = &mut self.values[row * self.n_labels * self.stride..];
            let is_used = &mut self.is_used[row * self.n_blocks..][..self.n_blocks];
            for (x, distribution) in graph.columns(y, 0..graph.width()).zip(&mut distributions) {
                for (k, &p) in distribution.iter().enumerate() {
                    values[k * self.stride + MARGIN + x as usize] = p;
                }
                is_used[x as usize / LANES] = true;
            }
        }
    }

    /// Row `y` from one block and one column left of `block` on.
    pub(super) fn row(&self, y: u32, block: usize) -> &[f32] {
        let row = (y - self.rows.start) as usize;
        &self.values[row * self.n_labels * self.stride + block * LANES..]
    }

    /// Whether block number `block` of row `y`, counted from one left of the map, holds a free cell.
    pub(super) fn is_used(&self, y: u32, block: usize) -> bool {
        let row = (y - self.rows.start) as usize;
        (1..=self.n_blocks).contains(&block) && self.is_used[row * self.n_blocks + block - 1]
    }
}
