//! What lies on the two sides of a gate.

use std::collections::VecDeque;

use super::gate::{Gate, center_of};
use crate::grid::{Cell, CellGraph};

/// How far from a gate its sides are looked at, in cells along the walk. A walk takes steps to 4- and 8-neighbors
/// in turn, so that its length is within 6 % of the Euclidean one in every direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Walks {
    /// Just behind the door.
    pub(super) near: f64,
    /// In the space behind it.
    pub(super) far: f64,
    /// Where the labels of that space are read.
    pub(super) labels: (f64, f64),
    /// The longest way around the gate that is looked for, from side to side.
    pub(super) bypass: f64,
}

/// One side of a gate.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Side {
    /// Largest squared clearance within the near walk.
    pub(super) near_clearance: i64,
    /// Largest squared clearance within the far walk.
    pub(super) far_clearance: i64,
    /// Cells within the far walk.
    pub(super) n_cells: usize,
    /// Nodes at the walk where labels are read.
    pub(super) label_nodes: Vec<usize>,
}

/// Both sides of a gate, and the way around it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Surroundings {
    pub(super) sides: [Side; 2],
    /// Length of the shortest walk from one side to the other that does not pass the gate, at most
    /// [`Walks::bypass`].
    pub(super) bypass: f64,
}

/// Floods both sides of `gate`. Cost: linear in the cells within reach.
pub(super) fn surroundings(graph: &CellGraph, clearance: &[i64], gate: &Gate, walks: &Walks) -> Surroundings {
    let reach = walks.far.max(walks.labels.1).max(walks.bypass / 2.0).ceil() as u32;
    let window = Window::around(graph, gate, reach);
    let mut sides = [Side::default(), Side::default()];
    let mut bypass = walks.bypass;
    // Steps to the first side, to tell where the two meet.
    let mut first: Vec<Option<u32>> = Vec::new();
    for (side, direction) in sides.iter_mut().zip([1.0, -1.0]) {
        let mut steps: Vec<Option<u32>> = vec![None; window.n_cells()];
        let mut open: VecDeque<usize> = beside(graph, gate, direction).into();
        for &node in &open {
            steps[window.index(graph.cell(node))] = Some(0);
        }
        while let Some(node) = open.pop_front() {
            let own = graph.cell(node);
            let here = window.index(own);
            let walked = steps[here].unwrap_or(0);
            side.visit(node, clearance[node], walked as f64, walks);
            if let Some(Some(other)) = first.get(here) {
                bypass = bypass.min((walked + other) as f64);
            }
            if walked >= reach {
                continue;
            }
            for &step in &RING[..if walked.is_multiple_of(2) { 8 } else { 4 }] {
                let Some(next) = reachable(graph, own, step) else { continue };
                let cell = Cell::new(own.x.wrapping_add_signed(step.0), own.y.wrapping_add_signed(step.1));
                let known = &mut steps[window.index(cell)];
                if known.is_none() && !is_on_line(gate, cell) {
                    *known = Some(walked + 1);
                    open.push_back(next);
                }
            }
        }
        first = steps;
    }
    Surroundings { sides, bypass }
}

/// Steps to the 4-neighbors, then to the diagonal ones.
const RING: [(i32, i32); 8] = [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)];

/// The node one step away from `cell`; a diagonal step does not pass between two cells that are not free.
fn reachable(graph: &CellGraph, cell: Cell, (dx, dy): (i32, i32)) -> Option<usize> {
    let is_free = |step| graph.node_beside(cell, step).is_some();
    let may_pass = dx == 0 || dy == 0 || is_free((dx, 0)) || is_free((0, dy));
    graph.node_beside(cell, (dx, dy)).filter(|_| may_pass)
}

impl Side {
    fn visit(&mut self, node: usize, clearance: i64, walked: f64, walks: &Walks) {
        if walked <= walks.near {
            self.near_clearance = self.near_clearance.max(clearance);
        }
        if walked <= walks.far {
            self.far_clearance = self.far_clearance.max(clearance);
            self.n_cells += 1;
        }
        if walked > walks.labels.0 && walked < walks.labels.1 {
            self.label_nodes.push(node);
        }
    }
}

/// The cells of the map that a flood can reach: a square, cut off where the map ends.
struct Window {
    low: Cell,
    width: usize,
    height: usize,
}

impl Window {
    fn around(graph: &CellGraph, gate: &Gate, reach: u32) -> Self {
        let radius = reach as f64 + gate.width / 2.0 + 3.0;
        let low = |middle: f64| (middle - radius).max(0.0) as u32;
        let side = |low: u32, side: u32| (2 * radius as usize + 3).min((side - low.min(side)) as usize);
        let (x, y) = (low(gate.center.x), low(gate.center.y));
        Self { low: Cell::new(x, y), width: side(x, graph.width()), height: side(y, graph.height()) }
    }

    fn n_cells(&self) -> usize {
        self.width * self.height
    }

    fn index(&self, cell: Cell) -> usize {
        (cell.y - self.low.y) as usize * self.width + (cell.x - self.low.x) as usize
    }
}

/// Whether a cell lies on the line between the jambs, so thick that no step of four crosses it.
fn is_on_line(gate: &Gate, cell: Cell) -> bool {
    let (across, along) = gate.local(center_of(cell));
    along.abs() <= 0.75 && across.abs() <= gate.width / 2.0 + 0.5
}

/// Free cells just beside the line.
fn beside(graph: &CellGraph, gate: &Gate, direction: f64) -> Vec<usize> {
    let is_beside = |&node: &usize| gate.local(center_of(graph.cell(node))).1 * direction > 0.75;
    super::paint::nodes_in(graph, gate, 1.75).into_iter().filter(is_beside).collect()
}
