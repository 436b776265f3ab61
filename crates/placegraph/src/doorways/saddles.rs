//! Clearance and its saddles: level stretches with higher ground on two sides.

use std::cmp::Ordering;

use crate::grid::{CellGraph, Connectivity, NO_NODE, squared_clearances};

/// Squared distance of every node to the nearest center of a cell that is not free, in cells.
pub(super) fn squared_clearance(graph: &CellGraph) -> Vec<i64> {
    let mut clearance = Vec::with_capacity(graph.n_nodes());
    squared_clearances(graph, |_, _| true, |_, run| clearance.extend_from_slice(run));
    clearance
}

/// Nodes of equal clearance that are connected, and whether they are a saddle.
///
/// Where the map is flooded from the widest places down, spaces meet, or close a loop, at saddles only: there the nodes
/// around that have more clearance form two or more groups. Taken as a whole, a level stretch is a saddle or none
/// whichever way the map is turned.
pub(super) fn saddles(graph: &CellGraph, clearance: &[i64], is_wanted: impl Fn(i64) -> bool) -> Vec<usize> {
    let mut is_seen = vec![false; graph.n_nodes()];
    let mut found = Vec::new();
    for (start, cell) in graph.cells_in_rows(0..graph.height()).enumerate() {
        if is_seen[start] || !is_wanted(clearance[start]) {
            continue;
        }
        is_seen[start] = true;
        let (mut level, mut higher) = (vec![(start, cell)], Vec::new());
        let mut next = 0;
        while let Some(&(node, cell)) = level.get(next) {
            next += 1;
            for neighbor in graph.around(cell).into_iter().flatten().filter(|&neighbor| neighbor != NO_NODE) {
                let neighbor = neighbor as usize;
                match clearance[neighbor].cmp(&clearance[node]) {
                    Ordering::Greater => higher.push(neighbor),
                    Ordering::Equal if !is_seen[neighbor] => {
                        is_seen[neighbor] = true;
                        level.push((neighbor, graph.cell(neighbor)));
                    }
                    _ => {}
                }
            }
        }
        if n_groups(graph, higher) >= 2 {
            found.extend(level.into_iter().map(|(node, _)| node));
        }
    }
    found.sort_unstable();
    found
}

/// Number of 8-connected groups of `nodes`.
fn n_groups(graph: &CellGraph, mut nodes: Vec<usize>) -> usize {
    nodes.sort_unstable();
    nodes.dedup();
    let mut is_seen = vec![false; nodes.len()];
    let mut n = 0;
    for start in 0..nodes.len() {
        if std::mem::replace(&mut is_seen[start], true) {
            continue;
        }
        n += 1;
        let mut open = vec![nodes[start]];
        while let Some(node) = open.pop() {
            for neighbor in graph.neighbors(node, Connectivity::Eight) {
                if let Ok(position) = nodes.binary_search(&neighbor)
                    && !std::mem::replace(&mut is_seen[position], true)
                {
                    open.push(neighbor);
                }
            }
        }
    }
    n
}
