//! Pieces of free space between doorways and openings, labeled as a whole where most cells agree. Where they do not, patches are
//! joined to the place that surrounds them.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use super::pieces::Pieces;
use crate::grid::{Cell, CellGraph, Connectivity};
use crate::labels::{Label, LabelSet, Labeling};

/// `labeling` where every piece that is `given` a label has it throughout, and so every other one of which at least `share` of the cells
/// agree; every part of any other piece whose border is mostly with one other part has the label of that.
///
/// What is not free in `bare` is wall. Cells of cuts take the label of most of their neighbors, layer by layer.
pub(super) fn label_whole(
    graph: &CellGraph,
    bare: &CellGraph,
    mut labeling: Labeling,
    is_open: impl Fn(Label) -> bool,
    pieces: &Pieces,
    given: &[Option<Label>],
    share: f64,
) -> Labeling {
    for (piece, nodes) in pieces.nodes().into_iter().enumerate() {
        let mut n_of = [0usize; LabelSet::MAX];
        for &node in &nodes {
            n_of[labeling[node as usize].index()] += 1;
        }
        let (label, n_agree) = most(&n_of);
        let agreed = (n_agree as f64 >= share * nodes.len() as f64).then_some(label);
        match given[piece].or(agreed) {
            Some(label) => nodes.iter().for_each(|&node| labeling[node as usize] = label),
            None => join_patches(graph, bare, &mut labeling, &nodes),
        }
    }
    label_cuts(graph, &mut labeling, is_open, pieces.cut.clone());
    labeling
}

/// A part of a piece: connected cells of one label.
struct Part {
    label: Label,
    n_cells: usize,
    /// Sides of cells at walls, and at each other part.
    n_wall: usize,
    n_at: BTreeMap<usize, usize>,
    /// The part that it has joined.
    joined: Option<usize>,
}

/// Gives every part of `piece` the label of the one other part that it has most of its border with, the smallest first. A corridor
/// has walls along its sides: a patch in the middle of a hall has none.
fn join_patches(graph: &CellGraph, bare: &CellGraph, labeling: &mut Labeling, piece: &[u32]) {
    let (part_of, mut parts) = parts(graph, bare, labeling, piece);
    let surrounding = |part: &Part| {
        let n_border: usize = part.n_wall + part.n_at.values().sum::<usize>();
        let (&other, &n) = part.n_at.iter().max_by_key(|&(&other, &n)| (n, Reverse(other)))?;
        (2 * n > n_border).then_some(other)
    };
    loop {
        let open = (0..parts.len()).filter(|&index| parts[index].joined.is_none());
        let patch =
            open.filter_map(|index| Some((parts[index].n_cells, index, surrounding(&parts[index])?))).min();
        let Some((_, patch, place)) = patch else { break };
        // It becomes one with every neighbor of the new label.
        parts[patch].label = parts[place].label;
        let same: Vec<usize> = parts[patch]
            .n_at
            .keys()
            .copied()
            .filter(|&other| parts[other].label == parts[place].label)
            .collect();
        for other in same {
            join(&mut parts, other, patch);
        }
    }
    let label_of = |mut index: usize| {
        while let Some(joined) = parts[index].joined {
            index = joined;
        }
        parts[index].label
    };
    for (&node, &index) in piece.iter().zip(&part_of) {
        labeling[node as usize] = label_of(index);
    }
}

/// Joins part `from` to part `to`.
fn join(parts: &mut [Part], from: usize, to: usize) {
    let n_at = std::mem::take(&mut parts[from].n_at);
    parts[from].joined = Some(to);
    parts[to].n_cells += parts[from].n_cells;
    parts[to].n_wall += parts[from].n_wall;
    parts[to].n_at.remove(&from);
    for (other, n) in n_at {
        if other != to {
            *parts[to].n_at.entry(other).or_default() += n;
            parts[other].n_at.remove(&from);
            *parts[other].n_at.entry(to).or_default() += n;
        }
    }
}

/// The part of every node of `piece`, in its order, and the parts.
fn parts(graph: &CellGraph, bare: &CellGraph, labeling: &[Label], piece: &[u32]) -> (Vec<usize>, Vec<Part>) {
    let mut sorted: Vec<(u32, usize)> = piece.iter().enumerate().map(|(at, &node)| (node, at)).collect();
    sorted.sort_unstable();
    let position = |node: usize| {
        let found = sorted.binary_search_by_key(&(node as u32), |&(node, _)| node);
        found.ok().map(|at| sorted[at].1)
    };
    let mut part_of = vec![usize::MAX; piece.len()];
    let mut parts: Vec<Part> = Vec::new();
    let mut open = Vec::new();
    for start in 0..piece.len() {
        if part_of[start] != usize::MAX {
            continue;
        }
        let label = labeling[piece[start] as usize];
        part_of[start] = parts.len();
        open.push(start);
        let mut n_cells = 0;
        while let Some(at) = open.pop() {
            n_cells += 1;
            for neighbor in graph.neighbors(piece[at] as usize, Connectivity::Four) {
                if labeling[neighbor] == label
                    && let Some(next) = position(neighbor)
                    && part_of[next] == usize::MAX
                {
                    part_of[next] = parts.len();
                    open.push(next);
                }
            }
        }
        parts.push(Part { label, n_cells, n_wall: 0, n_at: BTreeMap::new(), joined: None });
    }
    for (&node, &index) in piece.iter().zip(&part_of) {
        let cell = graph.cell(node as usize);
        for &(x, y) in Connectivity::Four.steps() {
            let beside = beside(graph, cell, (x, y));
            match beside.and_then(|cell| graph.node_at(cell)) {
                Some(neighbor) => {
                    if let Some(other) =
                        position(neighbor).map(|at| part_of[at]).filter(|&other| other != index)
                    {
                        *parts[index].n_at.entry(other).or_default() += 1;
                    }
                }
                None => parts[index].n_wall += usize::from(!beside.is_some_and(|cell| bare.is_free(cell))),
            }
        }
    }
    (part_of, parts)
}

/// The cell a step from `cell`, if the map goes on there.
fn beside(graph: &CellGraph, cell: Cell, (x, y): (i32, i32)) -> Option<Cell> {
    let moved = |v: u32, step: i32, end: u32| v.checked_add_signed(step).filter(|&v| v < end);
    Some(Cell::new(moved(cell.x, x, graph.width())?, moved(cell.y, y, graph.height())?))
}

/// The label that is there most often; ties go to the lower label.
fn most(n_of: &[usize]) -> (Label, usize) {
    let mut best = (0, 0);
    for (label, &n) in n_of.iter().enumerate() {
        if n > best.1 {
            best = (label, n);
        }
    }
    (Label(best.0 as u8), best.1)
}

/// Labels the nodes `cut`, which are in order, from outside in.
fn label_cuts(
    graph: &CellGraph,
    labeling: &mut Labeling,
    is_open: impl Fn(Label) -> bool,
    mut cut: Vec<usize>,
) {
    while !cut.is_empty() {
        let found: Vec<Option<Label>> = cut
            .iter()
            .map(|&node| {
                let mut n_of = [0usize; LabelSet::MAX];
                let known =
                    |neighbor: &usize| cut.binary_search(neighbor).is_err() && is_open(labeling[*neighbor]);
                for neighbor in graph.neighbors(node, Connectivity::Eight).filter(known) {
                    n_of[labeling[neighbor].index()] += 1;
                }
                let (label, n) = most(&n_of);
                // Its own label wins a tie, whatever the order of the classes.
                let own = labeling[node];
                (n > 0).then_some(if n_of[own.index()] == n { own } else { label })
            })
            .collect();
        let mut rest = Vec::new();
        for (&node, label) in cut.iter().zip(&found) {
            match label {
                Some(label) => labeling[node] = *label,
                None => rest.push(node),
            }
        }
        if rest.len() == cut.len() {
            return;
        }
        cut = rest;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Grid, Occupancy};

    const CORRIDOR: Label = Label(0);
    const ROOM: Label = Label(1);
    const DOORWAY: Label = Label(2);

    fn whole(width: u32, cuts: &[Vec<usize>], label: impl Fn(u32) -> Label) -> Vec<Label> {
        let graph = CellGraph::new(&Grid::filled(width, 1, Occupancy::Free));
        let labeling: Labeling = graph.cells().iter().map(|cell| label(cell.x)).collect();
        let is_open = |label| label != DOORWAY;
        let pieces = Pieces::of(&graph, &labeling, is_open, cuts);
        label_whole(&graph, &graph, labeling, is_open, &pieces, &vec![None; pieces.len()], 0.7)
    }

    #[test]
    fn a_piece_takes_the_label_of_seven_in_ten_cells() {
        assert!(whole(10, &[], |x| if x < 3 { CORRIDOR } else { ROOM }).iter().all(|&label| label == ROOM));
        let mixed = whole(10, &[], |x| if x < 4 { CORRIDOR } else { ROOM });
        assert_eq!(mixed.iter().filter(|&&label| label == CORRIDOR).count(), 4);
    }

    #[test]
    fn doorways_and_cuts_part_pieces() {
        // Three of corridor, a doorway, two of room; a cut of two cells in eight of room and two of corridor.
        let label = |x: u32| [CORRIDOR, CORRIDOR, CORRIDOR, DOORWAY, ROOM, ROOM][x as usize];
        assert_eq!(whole(6, &[], label), (0..6).map(label).collect::<Vec<_>>());
        let found = whole(10, &[vec![4, 5]], |x| if x < 6 { CORRIDOR } else { ROOM });
        let n_corridor = found.iter().take_while(|&&label| label == CORRIDOR).count();
        assert_eq!(n_corridor, 5, "either cell of the cut joins its side: {found:?}");
        assert!(found[5..].iter().all(|&label| label == ROOM));
    }

    /// A hall of 20 x 10 cells, labeled by `label`; nothing agrees.
    fn hall(label: impl Fn(Cell) -> Label) -> Vec<Label> {
        let graph = CellGraph::new(&Grid::filled(20, 10, Occupancy::Free));
        let labeling: Labeling = graph.cells().iter().map(|&cell| label(cell)).collect();
        let pieces = Pieces::of(&graph, &labeling, |_| true, &[]);
        label_whole(&graph, &graph, labeling, |_| true, &pieces, &[None], 2.0)
    }

    #[test]
    fn a_corridor_has_walls() {
        // In the middle of the hall a patch of 12 x 6 has none.
        let is_patch = |cell: Cell| (4..16).contains(&cell.x) && (2..8).contains(&cell.y);
        let found = hall(|cell| if is_patch(cell) { CORRIDOR } else { ROOM });
        assert!(found.iter().all(|&label| label == ROOM));
        // Across the hall, 4 cells wide: 8 sides of wall and 20 at two rooms of 10 each, which is no majority.
        let found = hall(|cell| if (8..12).contains(&cell.x) { CORRIDOR } else { ROOM });
        assert_eq!(found.iter().filter(|&&label| label == CORRIDOR).count(), 40);
    }

    #[test]
    fn patches_join_one_after_the_other() {
        // A room inside of a corridor inside of a room: 36 + 24 + 40 cells.
        let ring = |cell: Cell| cell.x.min(19 - cell.x).min(cell.y).min(9 - cell.y);
        let found = hall(|cell| if ring(cell) == 2 { CORRIDOR } else { ROOM });
        assert!(found.iter().all(|&label| label == ROOM));
    }

    #[test]
    fn a_cut_that_nothing_is_beside_keeps_its_label() {
        assert_eq!(whole(2, &[vec![0, 1]], |_| ROOM), [ROOM, ROOM]);
    }
}
