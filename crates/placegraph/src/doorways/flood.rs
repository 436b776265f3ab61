//! Walks from a gate into the spaces on its two sides.

use super::gate::{Narrow, center_of};
use super::paint;
use crate::grid::{Cell, CellGraph, NO_NODE};

/// A flood of one side, from the gate. Steps to 4- and 8-neighbors take turns, so that its length is within 6 % of the Euclidean one
/// in every direction.
pub(super) struct Flood {
    /// Length of the walk to every cell of the window.
    steps: Vec<u32>,
    /// Positions in the window in the order in which they were reached, and which of them is next.
    reached: Vec<u32>,
    next: usize,
}

/// No walk has come here yet.
const UNKNOWN: u32 = u32::MAX;
/// No walk shall come here: the line between the jambs.
const CLOSED: u32 = u32::MAX - 1;

impl Flood {
    /// The nodes that were reached, with the length of the walk to them.
    pub(super) fn visited(&self, window: &Window) -> impl Iterator<Item = (usize, u32)> {
        self.reached.iter().map(|&at| (window.nodes[at as usize] as usize, self.steps[at as usize]))
    }

    /// Length of the shortest walk that both floods make together.
    pub(super) fn meeting([one, other]: &[Self; 2]) -> Option<u32> {
        let meetings = (one.reached.iter())
            .map(|&at| (one.steps[at as usize], other.steps[at as usize]))
            .filter(|&(_, other)| other < CLOSED);
        meetings.map(|(one, other)| one + other).min()
    }

    /// The start of a flood: the cells just beside the line.
    pub(super) fn from(graph: &CellGraph, gate: &Narrow, direction: f64, window: &Window) -> Self {
        let mut flood = Self { steps: vec![UNKNOWN; window.nodes.len()], reached: Vec::new(), next: 0 };
        for node in paint::nodes_in(graph, gate, 1.75) {
            let cell = graph.cell(node);
            let at = window.index(cell);
            if gate.local(center_of(cell)).1 * direction > 0.75 {
                flood.steps[at] = 0;
                flood.reached.push(at as u32);
            }
        }
        for cell in paint::cells_within(graph, gate, (gate.width / 2.0).hypot(0.75) + 1.0) {
            // So thick that no step of four crosses it.
            let (across, along) = gate.local(center_of(cell));
            if along.abs() <= 0.75 && across.abs() <= gate.width / 2.0 + 0.5 {
                flood.steps[window.index(cell)] = CLOSED;
            }
        }
        flood
    }

    /// Goes on until everything is found that is at most `reach` steps away.
    pub(super) fn advance(&mut self, window: &Window, reach: u32) {
        let row = window.width as isize;
        // To the 4-neighbors, then to the diagonal ones, with the two cells that those pass between.
        let straight = [1, row, -1, -row];
        let diagonal = [[1, row], [-1, row], [-1, -row], [1, -row]];
        let is_free = |at: usize| window.nodes[at] != NO_NODE;
        while let Some(&at) = self.reached.get(self.next) {
            let at = at as usize;
            let walked = self.steps[at];
            if walked >= reach {
                return;
            }
            self.next += 1;
            let mut step = |offset: isize| {
                let to = at.wrapping_add_signed(offset);
                if is_free(to) && self.steps[to] == UNKNOWN {
                    self.steps[to] = walked + 1;
                    self.reached.push(to as u32);
                }
            };
            straight.into_iter().for_each(&mut step);
            if walked.is_multiple_of(2) {
                let may_pass = |beside: [isize; 2]| {
                    beside.into_iter().any(|offset| is_free(at.wrapping_add_signed(offset)))
                };
                diagonal.into_iter().filter(|&beside| may_pass(beside)).for_each(|[x, y]| step(x + y));
            }
        }
    }
}

/// The cells of the map that a flood can reach, and a cell more on every side: a square, cut off where the map ends.
pub(super) struct Window {
    low: (i64, i64),
    width: usize,
    /// Nodes, row by row; [`NO_NODE`] where a cell is not free, and along the border.
    nodes: Vec<u32>,
}

impl Window {
    pub(super) fn around(graph: &CellGraph, gate: &Narrow, reach: u32) -> Self {
        let radius = reach as f64 + gate.width / 2.0 + 3.0;
        let range = |middle: f64, side: u32| {
            (middle - radius).max(0.0) as u32..((middle + radius).ceil() as u32).saturating_add(1).min(side)
        };
        let (columns, rows) = (range(gate.center.x, graph.width()), range(gate.center.y, graph.height()));
        let (width, height) = (columns.len() + 2, rows.len() + 2);
        let mut nodes = vec![NO_NODE; width * height];
        for (y, row) in rows.clone().zip(nodes[width..].chunks_exact_mut(width)) {
            let first_node = graph.n_nodes_before(y, columns.start) as u32;
            for (x, node) in graph.columns(y, columns.clone()).zip(first_node..) {
                row[(x - columns.start) as usize + 1] = node;
            }
        }
        Self { low: (i64::from(columns.start) - 1, i64::from(rows.start) - 1), width, nodes }
    }

    fn index(&self, cell: Cell) -> usize {
        let (x, y) = (i64::from(cell.x) - self.low.0, i64::from(cell.y) - self.low.1);
        y as usize * self.width + x as usize
    }
}
