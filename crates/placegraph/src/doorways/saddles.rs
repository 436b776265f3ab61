//! Clearance and its saddles: level stretches with higher ground on two sides.

use std::cmp::Ordering;
use std::ops::Range;

use rayon::prelude::*;

use crate::grid::{Cell, CellGraph, Connectivity, NO_NODE, squared_clearances};

/// Squared distance of every node to the nearest center of a cell that is not free, in cells: less than 2^30, as a map of fewer
/// than 2^32 cells is less than 2^16 wide or high.
pub(super) fn squared_clearance(graph: &CellGraph) -> Vec<u32> {
    let mut clearance = Vec::with_capacity(graph.n_nodes());
    squared_clearances(
        graph,
        |_, _| true,
        |_, run| clearance.extend(run.iter().map(|&squared| squared as u32)),
    );
    clearance
}

/// Nodes of equal clearance that are connected, and whether they are a saddle.
///
/// Where the map is flooded from the widest places down, spaces meet, or close a loop, at saddles only: there the nodes
/// around that have more clearance form two or more groups. Taken as a whole, a level stretch is a saddle or none
/// whichever way the map is turned.
pub(super) fn saddles(
    graph: &CellGraph,
    clearance: &[u32],
    is_wanted: impl Fn(u32) -> bool + Sync,
) -> Vec<usize> {
    // A level stretch belongs to the strip of rows that has its first node.
    let n_strips = (rayon::current_num_threads() as u32).min(graph.height());
    let row = |strip: u32| (u64::from(strip) * u64::from(graph.height()) / u64::from(n_strips)) as u32;
    let of_strip = |strip| saddles_from(graph, clearance, &is_wanted, row(strip)..row(strip + 1));
    let mut found: Vec<usize> = (0..n_strips).into_par_iter().flat_map_iter(of_strip).collect();
    found.sort_unstable();
    found
}

/// The saddles that have their first node in `rows`.
fn saddles_from(
    graph: &CellGraph,
    clearance: &[u32],
    is_wanted: impl Fn(u32) -> bool,
    rows: Range<u32>,
) -> Vec<usize> {
    let nodes = graph.nodes_in_rows(rows.clone());
    let mut is_seen = vec![false; graph.n_nodes() - nodes.start];
    let mut found = Vec::new();
    let (mut level, mut higher): (Vec<(usize, Cell)>, Vec<Cell>) = (Vec::new(), Vec::new());
    for (start, cell) in nodes.clone().zip(graph.cells_in_rows(rows)) {
        if is_seen[start - nodes.start] || !is_wanted(clearance[start]) {
            continue;
        }
        is_seen[start - nodes.start] = true;
        level.clear();
        higher.clear();
        level.push((start, cell));
        let mut next = 0;
        let mut is_from_before = false;
        while let Some(&(node, cell)) = level.get(next) {
            next += 1;
            for (row, y) in graph.around(cell).into_iter().zip(-1..) {
                for (neighbor, x) in row.into_iter().zip(-1..).filter(|&(neighbor, _)| neighbor != NO_NODE) {
                    let neighbor = neighbor as usize;
                    match clearance[neighbor].cmp(&clearance[node]) {
                        Ordering::Greater => higher.push(cell.moved(x, y)),
                        Ordering::Equal if neighbor < nodes.start => is_from_before = true,
                        Ordering::Equal if !is_seen[neighbor - nodes.start] => {
                            is_seen[neighbor - nodes.start] = true;
                            level.push((neighbor, cell.moved(x, y)));
                        }
                        _ => {}
                    }
                }
            }
        }
        if !is_from_before && are_parted(&mut higher) {
            found.extend(level.iter().map(|(node, _)| node));
        }
    }
    found
}

/// Up to so many cells are compared each with each: most level stretches are one node.
const FEW: usize = 32;

/// Whether `cells` form two or more 8-connected groups; some may be there more than once.
fn are_parted(cells: &mut Vec<Cell>) -> bool {
    if cells.len() > FEW {
        return n_groups(cells) >= 2;
    }
    // Those that are connected with the first one come to the front.
    let mut n_reached = cells.len().min(1);
    let mut next = 0;
    while next < n_reached {
        let cell = cells[next];
        next += 1;
        let mut end = n_reached;
        for other in n_reached..cells.len() {
            if cell.x.abs_diff(cells[other].x) <= 1 && cell.y.abs_diff(cells[other].y) <= 1 {
                cells.swap(other, end);
                end += 1;
            }
        }
        n_reached = end;
    }
    n_reached < cells.len()
}

/// Number of 8-connected groups of `cells`.
fn n_groups(cells: &mut Vec<Cell>) -> usize {
    let key = |cell: &Cell| (cell.y, cell.x);
    cells.sort_unstable_by_key(key);
    cells.dedup();
    let mut is_seen = vec![false; cells.len()];
    let mut open = Vec::new();
    let mut n = 0;
    for start in 0..cells.len() {
        if std::mem::replace(&mut is_seen[start], true) {
            continue;
        }
        n += 1;
        open.push(cells[start]);
        while let Some(cell) = open.pop() {
            for step in Connectivity::Eight.steps() {
                if let Ok(position) = cells.binary_search_by_key(&key(&cell.moved(step.0, step.1)), key)
                    && !std::mem::replace(&mut is_seen[position], true)
                {
                    open.push(cells[position]);
                }
            }
        }
    }
    n
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_cells_are_parted_as_many_are() {
        let mut state = 1u32;
        for n in 0..=FEW {
            for side in 1..12 {
                let mut random = || {
                    state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    (state >> 16) % side
                };
                let cells: Vec<Cell> = (0..n).map(|_| Cell::new(random(), random())).collect();
                let expected = n_groups(&mut cells.clone()) >= 2;
                assert_eq!(are_parted(&mut cells.clone()), expected, "{cells:?}");
            }
        }
    }
}
