//! Clearance and its saddles: nodes where higher ground lies on two sides.

use crate::grid::{Cell, CellGraph, NO_NODE, squared_clearances};

/// Squared distance of every node to the nearest center of a cell that is not free, in cells.
pub(super) fn squared_clearance(graph: &CellGraph) -> Vec<i64> {
    let mut clearance = Vec::with_capacity(graph.n_nodes());
    squared_clearances(graph, |_, _| true, |_, run| clearance.extend_from_slice(run));
    clearance
}

/// The 8 cells around a cell, counter-clockwise from the right.
const RING: [(i32, i32); 8] = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];

/// Whether the neighbors of `node`, in `cell`, with more clearance (ties: the lower node) form two or more 8-connected
/// groups. Where the map is flooded from the widest places down, spaces meet, or close a loop, at such nodes
/// only. The count is the crossing number [Hilditch 1969].
pub(super) fn is_saddle(graph: &CellGraph, clearance: &[i64], node: usize, cell: Cell) -> bool {
    let key = |node: usize| (clearance[node], std::cmp::Reverse(node));
    let around = graph.around(cell);
    let higher = RING.map(|(x, y)| {
        let next = around[(y + 1) as usize][(x + 1) as usize];
        next != NO_NODE && key(next as usize) > key(node)
    });
    let starts = |k: &usize| !higher[*k] && (higher[*k + 1] || higher[(*k + 2) % 8]);
    [0, 2, 4, 6].iter().filter(|k| starts(k)).count() >= 2
}
