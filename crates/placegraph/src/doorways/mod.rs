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

mod config;
mod evidence;
mod gate;
mod paint;
mod saddles;
mod sides;
mod walls;

use rayon::prelude::*;

use crate::grid::{FreeSpace, Obstacles};
use crate::labels::{Label, LabelField, LabelSet, Labeling, Role};
use evidence::Evidence;

pub use config::{DoorwayConfig, GateRule, WalkConfig, WallConfig};

/// `labeling` with the doorways of the map marked, and no others left. `field` supports gates, and gives
/// its next best label to what was doorway. Without a class of role doorway nothing changes;
/// with several, a doorway takes the one that `field` finds most probable in it.
///
/// # Examples
/// ```
/// use placegraph::doorways::{DoorwayConfig, mark};
/// use placegraph::grid::{FreeSpace, OccupancyGrid};
/// use placegraph::labels::{Label, LabelField, LabelSet};
///
/// let map = OccupancyGrid::from_ascii(
///     0.25,
///     "
///     ?###########################
///     ?#............#............#
///     ?#............#............#
///     ?#............#............#
///     ?#............#............#
///     ?#............#............#
///     ?#.........................#
///     ?#.........................#
///     ?#.........................#
///     ?#.........................#
///     ?#............#............#
///     ?#............#............#
///     ?#............#............#
///     ?#............#............#
///     ?#............#............#
///     ?###########################
///     ",
/// );
/// let space = FreeSpace::of(&map);
/// // All cells were labeled room, without a doubt. The doorway reaches a cell beyond the wall.
/// let n = space.graph.n_nodes();
/// let field = LabelField::from_rows(3, [0.0, 1.0, 0.0].repeat(n));
/// let marked = mark(&space, &field, &vec![Label(1); n], &LabelSet::default(), &DoorwayConfig::default());
/// let drawn = space.graph.to_ascii(|node| ['c', 'r', 'd'][marked[node].index()]);
/// assert_eq!(drawn.lines().nth(6), Some("##rrrrrrrrrrrdddrrrrrrrrrrr#"));
/// ```
///
/// # Panics
/// If `field` or `labeling` do not belong to `space`, or a label is not of `label_set`.
pub fn mark(
    space: &FreeSpace,
    field: &LabelField,
    labeling: &[Label],
    label_set: &LabelSet,
    config: &DoorwayConfig,
) -> Labeling {
    let graph = &space.graph;
    assert!(field.n_nodes() == graph.n_nodes() && labeling.len() == graph.n_nodes(), "one label per node");
    let is_doorway = |label: Label| label_set.role(label) == Role::Doorway;
    let mut marked = labeling.to_vec();
    if !label_set.labels().any(is_doorway) {
        return marked;
    }
    let strips = strips(space, field, label_set, config);
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
    space: &FreeSpace,
    field: &LabelField,
    label_set: &LabelSet,
    config: &DoorwayConfig,
) -> Vec<Vec<usize>> {
    let (graph, resolution_m) = (&space.graph, space.resolution_m());
    let cells = |meters: f64| space.in_cells(meters);
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
        let turned = walls::aligned(&cleared, &clearance, resolution_m, &config.walls, *gate);
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
