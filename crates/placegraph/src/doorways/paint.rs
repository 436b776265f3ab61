//! The cells of a gate.

use super::gate::{Narrow, center_of};
use crate::grid::{Cell, CellGraph, Connectivity};

/// The cells of the map in the square of `reach` cells around the center of a gate, in order.
pub(super) fn cells_within(graph: &CellGraph, gate: &Narrow, reach: f64) -> impl Iterator<Item = Cell> {
    let range = |middle: f64, side: u32| {
        ((middle - reach).max(0.0) as u32)..((middle + reach).max(0.0) as u32 + 1).min(side)
    };
    let columns = range(gate.center.x, graph.width());
    range(gate.center.y, graph.height()).flat_map(move |y| columns.clone().map(move |x| Cell::new(x, y)))
}

/// Free cells between the jambs, at most `half_depth` cells along the passage from the center, in order.
pub(super) fn nodes_in(graph: &CellGraph, gate: &Narrow, half_depth: f64) -> Vec<usize> {
    cells_within(graph, gate, (gate.width / 2.0).hypot(half_depth) + 1.0)
        .filter(|&cell| {
            let (across, along) = gate.local(center_of(cell));
            // The jambs are centers of walls: free cells between them end one cell before.
            across.abs() < gate.width / 2.0 - 0.5 && along.abs() <= half_depth
        })
        .filter_map(|cell| graph.node_at(cell))
        .collect()
}

/// The doorway of `gate`: the free cells of its rectangle with `margin` cells added on both sides and one at
/// both jambs, which are ragged, as far as they are connected to the line between the jambs.
pub(super) fn strip(graph: &CellGraph, gate: &Narrow, margin: f64) -> Vec<usize> {
    let all = nodes_in(graph, &gate.with_jambs(), gate.depth / 2.0 + margin);
    let mut reached = nodes_in(graph, gate, 0.75);
    let mut is_reached: Vec<bool> = all.iter().map(|node| reached.binary_search(node).is_ok()).collect();
    while let Some(node) = reached.pop() {
        for next in graph.neighbors(node, Connectivity::Four) {
            if let Ok(position) = all.binary_search(&next)
                && !is_reached[position]
            {
                is_reached[position] = true;
                reached.push(next);
            }
        }
    }
    all.into_iter().zip(is_reached).filter(|(_, reached)| *reached).map(|(node, _)| node).collect()
}
