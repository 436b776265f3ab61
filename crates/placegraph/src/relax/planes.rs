//! Probabilities on the map's area as planes of `f32`, one a class: the layout in which one relaxation step is a
//! few additions and multiplications of neighboring numbers.

use rayon::prelude::*;

use crate::grid::CellGraph;
use crate::labels::LabelField;

/// Columns that a step computes together.
pub(super) const LANES: usize = 16;
/// Cells left and right of a row that are always 0.
pub(super) const MARGIN: usize = 1;

/// K planes over the bounding box of the free cells; 0 in every cell that is not free.
///
/// Row-major; a row holds its K planes one after the other, each with a margin at both ends.
#[derive(Debug)]
pub(super) struct Planes {
    /// Length of one plane's part of a row.
    pub(super) stride: usize,
    pub(super) values: Vec<f32>,
    /// Per row, the runs of [`LANES`]-wide blocks that hold a free cell: first and last + 1.
    pub(super) runs: Vec<Vec<(u32, u32)>>,
    n_labels: usize,
    corner: (u32, u32),
}

impl Planes {
    /// The planes of `field` over the nodes of `graph`, which has at least one.
    pub(super) fn new(graph: &CellGraph, field: &LabelField) -> Self {
        let n_labels = field.n_labels();
        let xs = || graph.cells().iter().map(|cell| cell.x);
        let (left, right) = (xs().min().unwrap_or(0), xs().max().unwrap_or(0));
        let ys = |cell: Option<&crate::grid::Cell>| cell.map_or(0, |cell| cell.y);
        let (bottom, top) = (ys(graph.cells().first()), ys(graph.cells().last()));
        let n_rows = (top - bottom + 1) as usize;
        let stride = ((right - left + 1) as usize).next_multiple_of(LANES) + 2 * MARGIN;
        let mut planes = Self {
            stride,
            values: vec![0.0; n_rows * n_labels * stride],
            runs: vec![Vec::new(); n_rows],
            n_labels,
            corner: (left, bottom),
        };
        planes.fill(graph, field);
        planes
    }

    /// Length of a row of all planes.
    pub(super) fn row_len(&self) -> usize {
        self.n_labels * self.stride
    }

    fn fill(&mut self, graph: &CellGraph, field: &LabelField) {
        let (left, bottom) = self.corner;
        let (stride, row_len) = (self.stride, self.row_len());
        let rows = self.values.par_chunks_mut(row_len).zip(&mut self.runs).enumerate();
        rows.for_each(|(row, (values, runs))| {
            let y = bottom + row as u32;
            let first = graph.cells().partition_point(|cell| cell.y < y);
            let last = graph.cells().partition_point(|cell| cell.y <= y);
            for node in first..last {
                let x = graph.cells()[node].x - left;
                for (k, &p) in field.row(node).iter().enumerate() {
                    values[k * stride + MARGIN + x as usize] = p;
                }
                extend_runs(runs, x / LANES as u32);
            }
        });
    }

    /// The planes as a field over the nodes of the same graph.
    pub(super) fn field(&self, graph: &CellGraph) -> LabelField {
        const NODES: usize = 4096;
        let n_labels = self.n_labels;
        let mut values = vec![0.0; graph.n_nodes() * n_labels];
        let blocks = values.par_chunks_mut(NODES * n_labels).zip(graph.cells().par_chunks(NODES));
        blocks.for_each(|(values, cells)| {
            for (row, cell) in values.chunks_exact_mut(n_labels).zip(cells) {
                let (x, y) = ((cell.x - self.corner.0) as usize, (cell.y - self.corner.1) as usize);
                for (k, p) in row.iter_mut().enumerate() {
                    *p = self.values[(y * n_labels + k) * self.stride + MARGIN + x];
                }
            }
        });
        LabelField::from_rows(n_labels, values)
    }
}

/// Adds `block`, which is not before the last one, to the runs of a row.
fn extend_runs(runs: &mut Vec<(u32, u32)>, block: u32) {
    match runs.last_mut() {
        Some((_, end)) if block <= *end => *end = (*end).max(block + 1),
        _ => runs.push((block, block + 1)),
    }
}
