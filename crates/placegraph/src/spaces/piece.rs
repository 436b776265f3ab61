//! A part of the map that is cut on its own, with what is known of the cells around it.

use std::ops::Range;

use crate::cuts::SmallExpansion;
use crate::grid::{Cell, CellGraph, Run};
use crate::labels::{Label, Labeling};

/// A rectangle of the map.
#[derive(Clone, Debug)]
pub(super) struct Rectangle {
    columns: Range<u32>,
    rows: Range<u32>,
}

impl Rectangle {
    /// The smallest one around `runs`, which are in row-major order.
    pub(super) fn around(runs: &[Run]) -> Self {
        let left = runs.iter().map(|run| run.start).min().unwrap_or(0);
        let right = runs.iter().map(|run| run.end).max().unwrap_or(1);
        let row = |run: Option<&Run>| run.map_or(0, |run| run.y);
        Self { columns: left..right, rows: row(runs.first())..row(runs.last()) + 1 }
    }

    /// The map in squares of `side` cells, cut off where the map ends.
    pub(super) fn tiles(graph: &CellGraph, side: u32) -> Vec<Self> {
        let ends = |start: u32, end: u32| start..end.min(start.saturating_add(side));
        let rows = (0..graph.height()).step_by(side as usize).map(|y| ends(y, graph.height()));
        let tiles = rows.flat_map(|rows| {
            let columns = (0..graph.width()).step_by(side as usize).map(|x| ends(x, graph.width()));
            columns.map(move |columns| Self { columns, rows: rows.clone() })
        });
        tiles.collect()
    }

    pub(super) fn n_cells(&self) -> usize {
        self.columns.len() * self.rows.len()
    }

    /// The nodes in it, in order, with their cells.
    pub(super) fn nodes<'g>(&self, graph: &'g CellGraph) -> impl Iterator<Item = (usize, Cell)> + use<'g> {
        let columns = self.columns.clone();
        self.rows.clone().flat_map(move |y| {
            let first = graph.n_nodes_before(y, columns.start);
            (first..).zip(graph.columns(y, columns.clone()).map(move |x| Cell::new(x, y)))
        })
    }

    /// It and the cells around it.
    fn grown(&self, graph: &CellGraph) -> Self {
        let grown = |range: &Range<u32>, end: u32| range.start.saturating_sub(1)..end.min(range.end + 1);
        Self { columns: grown(&self.columns, graph.width()), rows: grown(&self.rows, graph.height()) }
    }

    /// Column and row of a cell in it or beside it, counted from a frame of one cell around it.
    fn framed(&self, cell: Cell) -> (u32, u32) {
        (cell.x + 1 - self.columns.start, cell.y + 1 - self.rows.start)
    }
}

/// Nodes in a rectangle that are to be labeled.
pub(super) struct Piece<'g> {
    graph: &'g CellGraph,
    rectangle: Rectangle,
    /// In order.
    pub(super) nodes: Vec<u32>,
    /// The nodes alone, in the rectangle.
    alone: CellGraph,
}

impl<'g> Piece<'g> {
    /// The nodes of `graph` in `rectangle` for which `is_open` holds.
    pub(super) fn new(graph: &'g CellGraph, rectangle: Rectangle, is_open: impl Fn(usize) -> bool) -> Self {
        let open: Vec<(usize, Cell)> = rectangle.nodes(graph).filter(|&(node, _)| is_open(node)).collect();
        let width = rectangle.columns.len();
        let mut cells = open
            .iter()
            .map(|(_, cell)| rectangle.framed(*cell))
            .map(|(column, row)| (row as usize - 1) * width + column as usize - 1)
            .peekable();
        let alone = CellGraph::from_free(width as u32, rectangle.rows.len() as u32, |index| {
            cells.next_if_eq(&index).is_some()
        });
        let nodes = open.iter().map(|&(node, _)| node as u32).collect();
        Self { graph, rectangle, nodes, alone }
    }

    /// The best labeling of the nodes, among more than two labels, from `start`; nothing around them is known.
    pub(super) fn best(
        &self,
        edge: &[f64],
        start: impl Fn(usize) -> Label,
        row: impl Fn(usize, &mut Vec<f64>),
    ) -> Labeling {
        let start: Labeling = self.nodes.iter().map(|&node| start(node as usize)).collect();
        SmallExpansion::new(&self.alone, edge, &start, |index, out| row(self.nodes[index] as usize, out))
            .best()
    }

    /// The best labelings of the nodes, of two labels, one for each of `given`: what is known of the nodes around. What it
    /// says of the nodes themselves does not count.
    pub(super) fn best_within<const N: usize>(
        &self,
        edge: &[f64],
        row: impl Fn(usize, &mut Vec<f64>),
        given: [&dyn Fn(usize) -> Option<Label>; N],
    ) -> [Labeling; N] {
        let start = vec![Label(0); self.nodes.len()];
        let of_index = |index: usize, out: &mut Vec<f64>| row(self.nodes[index] as usize, out);
        let mut expansion = SmallExpansion::new(&self.alone, edge, &start, of_index);
        given.map(|given| {
            let around = self.rectangle.grown(self.graph).nodes(self.graph);
            expansion.best_within(
                around.filter_map(|(node, cell)| Some((self.rectangle.framed(cell), given(node)?))),
            )
        })
    }
}
