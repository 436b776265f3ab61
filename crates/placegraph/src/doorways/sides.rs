//! Whether a gate parts the space around it.

use super::gate::{Gate, center_of};
use crate::grid::{CellGraph, Connectivity};

/// Whether the free cells on the two sides of `gate` do not meet within `reach` cells of it other than
/// through it, and both sides are `min_widening` times wider somewhere.
pub(super) fn parts_the_space(
    graph: &CellGraph,
    clearance: &[i64],
    gate: &Gate,
    reach: f64,
    min_widening: f64,
) -> bool {
    let mut side_of = std::collections::BTreeMap::new();
    let least = (gate.width / 2.0 * min_widening).powi(2);
    [1.0, -1.0].into_iter().all(|side| {
        let mut open: Vec<usize> = beside(graph, gate, side);
        let mut widest = 0;
        for &node in &open {
            if side_of.insert(node, side > 0.0).is_some_and(|other| other != (side > 0.0)) {
                return false;
            }
        }
        while let Some(node) = open.pop() {
            widest = widest.max(clearance[node]);
            for next in graph.neighbors(node, Connectivity::Four) {
                let center = center_of(graph.cells()[next]);
                if is_on_line(gate, center) || center.distance(gate.center) > reach {
                    continue;
                }
                match side_of.get(&next) {
                    Some(&known) if known != (side > 0.0) => return false,
                    Some(_) => {}
                    None => {
                        side_of.insert(next, side > 0.0);
                        open.push(next);
                    }
                }
            }
        }
        widest as f64 >= least
    })
}

/// Whether a cell lies on the line between the jambs, so thick that no step of four crosses it.
fn is_on_line(gate: &Gate, center: crate::geom::Point2) -> bool {
    let (across, along) = gate.local(center);
    along.abs() <= 0.75 && across.abs() <= gate.width / 2.0 + 0.5
}

/// Free cells just beside the line.
fn beside(graph: &CellGraph, gate: &Gate, side: f64) -> Vec<usize> {
    super::paint::nodes_in(graph, gate, 1.75)
        .into_iter()
        .filter(|&node| {
            let (_, along) = gate.local(center_of(graph.cells()[node]));
            along * side > 0.75
        })
        .collect()
}
