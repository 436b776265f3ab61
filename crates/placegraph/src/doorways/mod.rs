//! Narrow passages between larger spaces, marked as doorways whatever their cells were labeled.
//!
//! A classifier that has seen no doorway between two corridors, or between two rooms, misses all of them as
//! a whole, and no smoothing brings them back. The map itself shows them: where the clearance has a saddle,
//! two walls stand opposite each other at the width of a door, and the two sides do not meet elsewhere in
//! the neighborhood. Such a *gate* becomes a clean rectangle of doorway cells from jamb to jamb; what else of
//! a doorway region lies around it joins the nearest other label. Doorway regions without a gate stay as they are.
//!
//! Cost: linear in nodes for the clearance, plus one look at the neighborhood (`neighborhood_m`) for every
//! pair of opposite walls.
//!
//! **Deviation.** The chapter has no such stage; it can be left out.

mod gate;
mod paint;
mod saddles;
mod sides;

use std::collections::VecDeque;

use crate::grid::{CellGraph, Connectivity};
use crate::labels::{Label, LabelField, LabelSet, Labeling, Role};
use gate::gates;

/// The sizes of doors and of the spaces beside them, in meters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoorwayConfig {
    /// Narrowest doorway between its jambs. Default 0.5: a robot's own width.
    pub min_width_m: f64,
    /// Widest doorway between its jambs. Default 2: a double door.
    pub max_width_m: f64,
    /// Longest narrow part in the direction of passage. Default 0.8: a thick wall with its frame; what is
    /// longer is a corridor.
    pub max_depth_m: f64,
    /// How far a doorway reaches beyond the faces of its wall. Default 0.25.
    pub margin_m: f64,
    /// Two sides that meet within this distance of the gate are one space. Default 2.5: around a desk.
    pub neighborhood_m: f64,
    /// How many times wider than the gate the space on both sides is somewhere in the neighborhood.
    /// Default 1.4.
    pub min_widening: f64,
}

impl Default for DoorwayConfig {
    fn default() -> Self {
        Self {
            min_width_m: 0.5,
            max_width_m: 2.0,
            max_depth_m: 0.8,
            margin_m: 0.25,
            neighborhood_m: 2.5,
            min_widening: 1.4,
        }
    }
}

/// `labeling` with the doorways of the map marked. `field` gives labels to cells that a clean doorway leaves
/// out where no other label is near. Without a class of role doorway nothing changes; with several, a doorway takes the
/// one that `field` finds most probable in it.
///
/// # Panics
/// If `field` or `labeling` do not belong to `graph`, or a label is not of `label_set`.
pub fn mark(
    graph: &CellGraph,
    resolution_m: f64,
    field: &LabelField,
    labeling: &[Label],
    label_set: &LabelSet,
    config: &DoorwayConfig,
) -> Labeling {
    assert!(field.n_nodes() == graph.n_nodes() && labeling.len() == graph.n_nodes(), "one label per node");
    let is_doorway = |label: Label| label_set.role(label) == Role::Doorway;
    let mut marked = labeling.to_vec();
    if !label_set.labels().any(is_doorway) {
        return marked;
    }
    let strips: Vec<Vec<usize>> = gates(graph, resolution_m, config)
        .iter()
        .map(|gate| paint::strip(graph, gate, config.margin_m / resolution_m))
        .collect();
    let leftovers = doorways_around(graph, &strips.concat(), &marked, &is_doorway);
    for strip in &strips {
        if let Some(label) = most_probable(field, strip, label_set, |role| role == Role::Doorway) {
            for &node in strip {
                marked[node] = label;
            }
        }
    }
    let mut in_strip = vec![false; graph.n_nodes()];
    strips.iter().flatten().for_each(|&node| in_strip[node] = true);
    let leftovers = leftovers.into_iter().filter(|&node| !in_strip[node]).collect();
    for node in join_neighbors(graph, leftovers, &mut marked, &is_doorway) {
        let other = most_probable(field, &[node], label_set, |role| role != Role::Doorway);
        marked[node] = other.unwrap_or(marked[node]);
    }
    marked
}

/// All nodes of doorway regions that touch `strip`, ascending.
fn doorways_around(
    graph: &CellGraph,
    strip: &[usize],
    labeling: &[Label],
    is_doorway: &impl Fn(Label) -> bool,
) -> Vec<usize> {
    let mut is_found = vec![false; graph.n_nodes()];
    let mut open = strip.to_vec();
    while let Some(node) = open.pop() {
        for next in graph.neighbors(node, Connectivity::Eight).chain([node]) {
            if is_doorway(labeling[next]) && !is_found[next] {
                is_found[next] = true;
                open.push(next);
            }
        }
    }
    (0..graph.n_nodes()).filter(|&node| is_found[node]).collect()
}

/// Gives `nodes` the label of the nearest node around them that is no doorway, step by step. Returns those that
/// no label reached.
fn join_neighbors(
    graph: &CellGraph,
    nodes: Vec<usize>,
    labeling: &mut [Label],
    is_doorway: &impl Fn(Label) -> bool,
) -> Vec<usize> {
    let mut is_open = vec![false; graph.n_nodes()];
    for &node in &nodes {
        is_open[node] = true;
    }
    let mut queue: VecDeque<usize> = nodes
        .iter()
        .flat_map(|&node| graph.neighbors(node, Connectivity::Four))
        .filter(|&next| !is_open[next] && !is_doorway(labeling[next]))
        .collect();
    while let Some(node) = queue.pop_front() {
        for next in graph.neighbors(node, Connectivity::Four) {
            if std::mem::take(&mut is_open[next]) {
                labeling[next] = labeling[node];
                queue.push_back(next);
            }
        }
    }
    nodes.into_iter().filter(|&node| is_open[node]).collect()
}

/// The label of a role that `wanted` accepts with the largest sum over `nodes`; ties go to the lower label.
fn most_probable(
    field: &LabelField,
    nodes: &[usize],
    label_set: &LabelSet,
    wanted: impl Fn(Role) -> bool,
) -> Option<Label> {
    let total = |label: Label| nodes.iter().map(|&node| field.row(node)[label.index()] as f64).sum::<f64>();
    let mut best: Option<(Label, f64)> = None;
    for label in label_set.labels().filter(|&label| wanted(label_set.role(label))) {
        let sum = total(label);
        if best.is_none_or(|(_, largest)| sum > largest) {
            best = Some((label, sum));
        }
    }
    best.map(|(label, _)| label)
}

#[cfg(test)]
mod tests;
