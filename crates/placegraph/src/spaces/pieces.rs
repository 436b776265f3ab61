//! The pieces of free space between doorways and the lines of gates, and what joins them.

use std::collections::BTreeSet;

use crate::grid::{CellGraph, Connectivity};
use crate::labels::Label;

/// The piece of a node that is in none: of a doorway, or of a cut.
const NO_PIECE: u32 = u32::MAX;
/// The same of a node whose piece is not known yet.
const OPEN: u32 = u32::MAX - 1;

/// The free space of a map, divided at its doorways and at cuts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pieces {
    /// The piece of every node.
    piece_of: Vec<u32>,
    /// Number of cells of every piece.
    n_cells: Vec<usize>,
    /// Nodes of cuts that are in no doorway, in order.
    pub(super) cut: Vec<usize>,
}

impl Pieces {
    /// The 4-connected sets of nodes for which `is_open` holds, without those of `cuts`, in the order of their first nodes.
    pub(super) fn of(
        graph: &CellGraph,
        labeling: &[Label],
        is_open: impl Fn(Label) -> bool,
        cuts: &[Vec<usize>],
    ) -> Self {
        let mut cut: Vec<usize> =
            cuts.iter().flatten().copied().filter(|&node| is_open(labeling[node])).collect();
        cut.sort_unstable();
        cut.dedup();
        let mut piece_of: Vec<u32> =
            labeling.iter().map(|&label| if is_open(label) { OPEN } else { NO_PIECE }).collect();
        for &node in &cut {
            piece_of[node] = NO_PIECE;
        }
        let mut n_cells = Vec::new();
        let mut open = Vec::new();
        for start in 0..graph.n_nodes() {
            if piece_of[start] != OPEN {
                continue;
            }
            let piece = n_cells.len() as u32;
            let mut n = 0;
            piece_of[start] = piece;
            open.push(start as u32);
            while let Some(node) = open.pop() {
                n += 1;
                for neighbor in graph.neighbors(node as usize, Connectivity::Four) {
                    if piece_of[neighbor] == OPEN {
                        piece_of[neighbor] = piece;
                        open.push(neighbor as u32);
                    }
                }
            }
            n_cells.push(n);
        }
        Self { piece_of, n_cells, cut }
    }

    /// Number of pieces.
    pub fn len(&self) -> usize {
        self.n_cells.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.n_cells.is_empty()
    }

    /// The piece of a node, if it is in one.
    pub fn piece_of(&self, node: usize) -> Option<usize> {
        Some(self.piece_of[node]).filter(|&piece| piece != NO_PIECE).map(|piece| piece as usize)
    }

    /// The nodes of every piece, in order.
    pub(super) fn nodes(&self) -> Vec<Vec<u32>> {
        let mut nodes: Vec<Vec<u32>> = self.n_cells.iter().map(|&n| Vec::with_capacity(n)).collect();
        for (node, &piece) in self.piece_of.iter().enumerate().filter(|&(_, &piece)| piece != NO_PIECE) {
            nodes[piece as usize].push(node as u32);
        }
        nodes
    }

    /// The pieces with `is_place` that are joined: every set of 8-connected nodes that are in none of these joins those that touch it.
    pub(super) fn joined(&self, graph: &CellGraph, is_place: &[bool]) -> Vec<BTreeSet<u32>> {
        let is_between = |node: usize| self.piece_of(node).is_none_or(|piece| !is_place[piece]);
        let mut is_seen = vec![false; self.piece_of.len()];
        let mut joined = Vec::new();
        let mut open = Vec::new();
        for start in 0..self.piece_of.len() {
            if !is_between(start) || std::mem::replace(&mut is_seen[start], true) {
                continue;
            }
            let mut touched = BTreeSet::new();
            open.push(start as u32);
            while let Some(node) = open.pop() {
                for neighbor in graph.neighbors(node as usize, Connectivity::Eight) {
                    if !is_between(neighbor) {
                        touched.insert(self.piece_of[neighbor]);
                    } else if !std::mem::replace(&mut is_seen[neighbor], true) {
                        open.push(neighbor as u32);
                    }
                }
            }
            joined.push(touched);
        }
        joined
    }
}
