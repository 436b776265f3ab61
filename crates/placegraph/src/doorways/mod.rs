//! Narrow passages between larger spaces, marked as doorways whatever their cells were labeled.
//!
//! A classifier that has seen no doorway between two corridors, or between two rooms, misses all of them as
//! a whole, and calls doorway what only looks like one from where it stands; no smoothing mends either. The map
//! itself shows doorways: where the clearance has a saddle, two walls stand opposite each other at the width
//! of a door, and the space on both sides is wider and not one around the corner. Such a *gate* is a doorway where its
//! form is clear, or where it is plausible and the labels support it ([`GateRule`]). It becomes a clean
//! rectangle of doorway cells from jamb to jamb, in the line of the walls around it. Cells labeled doorway outside of all gates take
//! their next best label.
//!
//! Obstacles that stand free and are as small as a chair's leg are taken for free while gates are sought.
//!
//! Cost: linear in the cells of the map, plus one look at the neighborhood for every pair of opposite walls.
//!
//! **Deviation.** The chapter has no such stage; it can be left out. The numbers of its rules were chosen on
//! generated buildings.

mod evidence;
mod gate;
mod paint;
mod saddles;
mod sides;
mod walls;

use rayon::prelude::*;

use crate::grid::{CellGraph, Obstacles};
use crate::labels::{Label, LabelField, LabelSet, Labeling, Role};
use evidence::Evidence;

/// The sizes of doors and of the spaces beside them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoorwayConfig {
    /// Narrowest doorway between its jambs, in meters. Default 0.6.
    pub min_width_m: f64,
    /// Widest doorway between its jambs, in meters. Default 2: a double door.
    pub max_width_m: f64,
    /// Longest narrow part in the direction of passage, in meters. Default 0.8: a thick wall with its frame; what is
    /// longer is a corridor.
    pub max_depth_m: f64,
    /// How far a doorway reaches beyond the faces of its wall, in meters. Default 0.2; people who label maps draw
    /// 0.1 to 0.5.
    pub margin_m: f64,
    /// Obstacles that stand free and are at most this long and wide are not seen, in meters. Default 0.4.
    pub max_speck_m: f64,
    /// What makes a gate a doorway whatever the labels are.
    pub clear: GateRule,
    /// What makes a gate a doorway that the labels support.
    pub plausible: GateRule,
    /// The support of the labels that is enough, 0 to 1: the mean probability of a doorway in it, or the
    /// difference of the two sides in the mean probability of another class. Default 0.5.
    pub min_support: f64,
}

/// What is asked of the surroundings of a gate, on both of its sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GateRule {
    /// Shortest way from one side to the other around the gate, in meters.
    pub min_bypass_m: f64,
    /// Least length of the walls or other obstacles that are its jambs, in meters.
    pub min_jamb_m: f64,
    /// How many times wider than the gate the space is somewhere within a walk of 0.6 m.
    pub near_widening: f64,
    /// The same within a walk of 1 m.
    pub far_widening: f64,
    /// Least area within a walk of 1 m, in square meters.
    pub min_area_m2: f64,
}

impl Default for DoorwayConfig {
    fn default() -> Self {
        Self {
            min_width_m: 0.6,
            max_width_m: 2.0,
            max_depth_m: 0.8,
            margin_m: 0.2,
            max_speck_m: 0.4,
            clear: GateRule {
                min_bypass_m: 6.0,
                min_jamb_m: 2.0,
                near_widening: 1.3,
                far_widening: 1.5,
                min_area_m2: 1.0,
            },
            plausible: GateRule {
                min_bypass_m: 2.5,
                min_jamb_m: 0.8,
                near_widening: 1.1,
                far_widening: 1.33,
                min_area_m2: 1.0,
            },
            min_support: 0.5,
        }
    }
}

/// `labeling` with the doorways of the map marked, and no others left. `field` supports gates, and gives
/// its next best label to what was doorway. Without a class of role doorway nothing changes;
/// with several, a doorway takes the one that `field` finds most probable in it.
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
    let strips = strips(graph, resolution_m, field, label_set, config);
    for strip in &strips {
        if let Some(label) = most_probable(field, strip, label_set, |role| role == Role::Doorway) {
            for &node in strip {
                marked[node] = label;
            }
        }
    }
    let mut in_strip = vec![false; graph.n_nodes()];
    for &node in strips.iter().flatten() {
        in_strip[node] = true;
    }
    for node in 0..graph.n_nodes() {
        if is_doorway(marked[node]) && !in_strip[node] {
            let other = most_probable(field, &[node], label_set, |role| role != Role::Doorway);
            marked[node] = other.unwrap_or(marked[node]);
        }
    }
    marked
}

/// The nodes of every doorway of the map.
fn strips(
    graph: &CellGraph,
    resolution_m: f64,
    field: &LabelField,
    label_set: &LabelSet,
    config: &DoorwayConfig,
) -> Vec<Vec<usize>> {
    let cells = |meters: f64| meters / resolution_m;
    let obstacles = Obstacles::of(graph);
    let cleared = obstacles.cleared(cells(config.max_speck_m).round() as u32);
    let clearance = saddles::squared_clearance(&cleared);
    let candidates = gate::candidates(&cleared, &clearance, resolution_m, config);
    let evidence = Evidence { graph, field, label_set, obstacles, resolution_m, config };
    let margin = cells(config.margin_m);
    let is_doorway = |gate: &gate::Gate| evidence.is_doorway(&cleared, &clearance, gate);
    let gates: Vec<gate::Gate> = candidates.into_par_iter().filter(is_doorway).collect();
    let of_map = |node: usize| graph.node_at(cleared.cell(node));
    let strip = |gate: &gate::Gate| {
        let turned = walls::aligned(&cleared, &clearance, resolution_m, *gate);
        let gate = gate::with_depth(&cleared, turned, cells(config.max_depth_m)).unwrap_or(*gate);
        paint::strip(&cleared, &gate, margin).into_iter().filter_map(of_map).collect()
    };
    gate::distinct(&gates, margin).par_iter().map(strip).collect()
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
