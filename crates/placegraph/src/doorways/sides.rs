//! What lies on the two sides of a gate.

use super::gate::{Gate, center_of};
use super::paint;
use crate::grid::{Cell, CellGraph, NO_NODE};

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

impl Walks {
    /// How far a side is looked at, in steps.
    fn near_reach(&self) -> u32 {
        self.far.max(self.labels.1).ceil() as u32
    }

    /// The middle of the longest way around is at most so many steps from both sides.
    fn half_bypass(&self) -> u32 {
        (self.bypass / 2.0).ceil() as u32
    }
}

/// One side of a gate.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Side {
    /// Largest squared clearance within the near walk.
    pub(super) near_clearance: u32,
    /// Largest squared clearance within the far walk.
    pub(super) far_clearance: u32,
    /// Cells within the far walk.
    pub(super) n_cells: usize,
    /// Nodes at the walk where labels are read.
    pub(super) label_nodes: Vec<usize>,
}

/// The two sides of a gate, as far as they were flooded.
pub(super) struct Sides<'a> {
    clearance: &'a [u32],
    walks: &'a Walks,
    window: Window,
    floods: [Flood; 2],
}

/// A flood of one side, from the gate.
struct Flood {
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

impl<'a> Sides<'a> {
    /// Cost: linear in the cells within reach.
    pub(super) fn of(graph: &CellGraph, clearance: &'a [u32], gate: &Gate, walks: &'a Walks) -> Self {
        let reach = walks.near_reach().max(walks.half_bypass());
        let window = Window::around(graph, gate, reach);
        let floods = [1.0, -1.0].map(|direction| Flood::from(graph, gate, direction, &window));
        Self { clearance, walks, window, floods }
    }

    /// What a walk of the far or the labels' length finds, on both sides.
    pub(super) fn near(&mut self) -> [Side; 2] {
        let reach = self.walks.near_reach();
        self.floods.each_mut().map(|flood| {
            flood.advance(&self.window, reach);
            let mut side = Side::default();
            for &at in &flood.reached {
                let (node, walked) = (self.window.nodes[at as usize] as usize, flood.steps[at as usize]);
                side.visit(node, self.clearance[node], walked as f64, self.walks);
            }
            side
        })
    }

    /// Length of the shortest walk from one side to the other that does not pass the gate, at most [`Walks::bypass`].
    pub(super) fn bypass(&mut self) -> f64 {
        let reach = self.walks.half_bypass();
        for flood in &mut self.floods {
            flood.advance(&self.window, reach);
        }
        let [one, other] = &self.floods;
        let meetings = (one.reached.iter())
            .map(|&at| (one.steps[at as usize], other.steps[at as usize]))
            .filter(|&(_, other)| other < CLOSED);
        let shortest = meetings.map(|(one, other)| one + other).min();
        shortest.map_or(self.walks.bypass, |steps| self.walks.bypass.min(steps as f64))
    }
}

impl Flood {
    /// The start of a flood: the cells just beside the line.
    fn from(graph: &CellGraph, gate: &Gate, direction: f64, window: &Window) -> Self {
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
    fn advance(&mut self, window: &Window, reach: u32) {
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

impl Side {
    fn visit(&mut self, node: usize, clearance: u32, walked: f64, walks: &Walks) {
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

/// The cells of the map that a flood can reach, and a cell more on every side: a square, cut off where the map ends.
struct Window {
    low: (i64, i64),
    width: usize,
    /// Nodes, row by row; [`NO_NODE`] where a cell is not free, and along the border.
    nodes: Vec<u32>,
}

impl Window {
    fn around(graph: &CellGraph, gate: &Gate, reach: u32) -> Self {
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
