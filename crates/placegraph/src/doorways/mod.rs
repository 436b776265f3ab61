//! Narrow passages between larger spaces: doorways, marked as such whatever their cells were labeled, and openings without a
//! door.
//!
//! A classifier that has seen no doorway between two corridors, or between two rooms, misses all of them as
//! a whole, and calls doorway what only looks like one from where it stands; no smoothing mends either. The map
//! itself shows doorways: where the clearance has a saddle, two walls stand opposite each other. Such a *gate* is measured: its
//! jambs, the space on both sides, the way around it, and what the labels say ([`figure_table`]). Boosted stumps over these figures
//! give the probability that it is a doorway, and that it parts two spaces at all ([`GateModel`]). A gate that has the form of a
//! doorway is one unless the model is sure that it is none; any other must be probable. A doorway becomes a clean
//! rectangle of doorway cells from jamb to jamb, in the line of the walls around it. Cells labeled doorway outside of all gates take
//! their next best label.
//!
//! Obstacles that stand free and are as small as a chair's leg are taken for free while gates are sought.
//!
//! Cost: linear in the cells of the map, plus one look at the neighborhood for every pair of opposite walls, and at the cells
//! within 3 m of every gate.
//!
//! **Deviation.** The chapter has no such stage; it can be left out. Boosting is the chapter's (Sect. 4.2), of gates instead of
//! cells.

mod config;
mod figures;
mod flood;
mod gate;
mod model;
mod paint;
mod saddles;
mod walls;

use rayon::prelude::*;

use crate::geom::{Point2, Vec2};
use crate::grid::{CellGraph, FreeSpace, NO_NODE, Obstacles};
use crate::labels::{Held, Label, LabelField, LabelSet, Labeling, Role};
use figures::Surroundings;
use gate::Narrow;
use walls::Directions;

pub use config::{DoorwayConfig, WallConfig};
pub use model::GateModel;

/// A narrow place between two walls, with all that was measured of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Gate {
    narrow: Narrow,
    /// The values of [`figure_table`], in its order.
    pub figures: Vec<f32>,
}

impl Gate {
    /// Its middle, in cells from the lower left corner.
    pub fn center(&self) -> Point2 {
        self.narrow.center
    }

    /// Unit vector from one jamb to the other.
    pub fn across(&self) -> Vec2 {
        self.narrow.across
    }

    /// Free width between the jambs, in cells.
    pub fn width_cells(&self) -> f64 {
        self.narrow.width - 1.0
    }

    /// Length of the narrow part in the direction of passage, in cells.
    pub fn depth_cells(&self) -> f64 {
        self.narrow.depth
    }
}

/// What [`mark`] returns.
#[derive(Clone, Debug, PartialEq)]
pub struct Marked {
    /// The label of every node, with the doorways of the map and no others.
    pub labeling: Labeling,
    /// The nodes on the line of every gate that parts two spaces, as a doorway or as an opening.
    pub cuts: Vec<Vec<usize>>,
}

/// Names and meanings of the figures of a gate.
pub fn figure_table() -> Vec<(&'static str, &'static str)> {
    figures::REGISTRY.iter().map(|figure| (figure.name, figure.about)).collect()
}

/// `labeling` with the doorways of the map marked, and no others left. `fields` are the distributions by single scans and smoothed;
/// the latter gives its next best label to what was doorway. Without a class of role doorway no label changes;
/// with several, a doorway takes the one that the smoothed field finds most probable in it.
///
/// `held` are the labels of an earlier result: a doorway that was there stays with less evidence than a new one needs
/// ([`DoorwayConfig::held_lead`]).
///
/// # Panics
/// If `fields`, `labeling` or `held` do not belong to `space`, or a label is not of `label_set`.
pub fn mark(
    space: &FreeSpace,
    fields: [&LabelField; 2],
    labeling: &[Label],
    label_set: &LabelSet,
    config: &DoorwayConfig,
    held: Held<'_>,
) -> Marked {
    let n_nodes = space.graph.n_nodes();
    let [_, smoothed] = fields;
    assert!(
        fields.iter().all(|field| field.n_nodes() == n_nodes) && labeling.len() == n_nodes,
        "one label per node"
    );
    let is_doorway = |label: Label| label_set.role(label) == Role::Doorway;
    let marked = labeling.to_vec();
    if !label_set.labels().any(is_doorway) {
        return Marked { labeling: marked, cuts: Vec::new() };
    }
    let search = Search::of(space, config);
    let gates = search.gates(fields, label_set);
    search.mark(&gates, smoothed, marked, label_set, held)
}

/// [`mark`] with the `gates` of the map, found before by the same `config` but for what decides which of them are marked.
///
/// # Panics
/// If `smoothed` or `labeling` do not belong to `space`, or a label is not of `label_set`.
pub fn mark_gates(
    space: &FreeSpace,
    gates: &[Gate],
    smoothed: &LabelField,
    labeling: &[Label],
    label_set: &LabelSet,
    config: &DoorwayConfig,
) -> Marked {
    Search::of(space, config).mark(gates, smoothed, labeling.to_vec(), label_set, None)
}

/// All gates of a map, narrowest first, with their figures.
pub fn gates(
    space: &FreeSpace,
    fields: [&LabelField; 2],
    label_set: &LabelSet,
    config: &DoorwayConfig,
) -> Vec<Gate> {
    Search::of(space, config).gates(fields, label_set)
}

/// The nodes of the doorway that `gate` may be: from jamb to jamb, through the whole wall.
pub fn strips(space: &FreeSpace, gates: &[Gate], config: &DoorwayConfig) -> Vec<Vec<usize>> {
    let search = Search::of(space, config);
    gates.par_iter().map(|gate| search.strip(&gate.narrow)).collect()
}

/// The map as gates are sought in it.
struct Search<'a> {
    space: &'a FreeSpace,
    config: &'a DoorwayConfig,
    /// The free cells, and those of specks.
    cleared: CellGraph,
    clearance: Vec<u32>,
    directions: Directions,
}

impl<'a> Search<'a> {
    fn of(space: &'a FreeSpace, config: &'a DoorwayConfig) -> Self {
        let max_speck = space.in_cells(config.max_speck_m).round() as u32;
        let cleared = Obstacles::of(&space.graph).cleared(max_speck);
        let clearance = saddles::squared_clearance(&cleared);
        let directions = Directions::of(&cleared, &clearance, &config.walls);
        Self { space, config, cleared, clearance, directions }
    }

    fn gates(&self, fields: [&LabelField; 2], label_set: &LabelSet) -> Vec<Gate> {
        let Self { space, config, cleared, clearance, directions } = self;
        let resolution_m = space.resolution_m();
        let found = gate::candidates(cleared, clearance, resolution_m, config);
        let found = gate::with_ends(cleared, &found, space.in_cells(config.deep_m));
        let found = gate::merged(&found, space.in_cells(config.merge_m));
        let max_furniture = space.in_cells(config.max_furniture_m).round() as u32;
        let bare = Obstacles::of(&space.graph).cleared(max_furniture);
        let surroundings = Surroundings {
            graph: &space.graph,
            cleared,
            clearance,
            bare: &bare,
            directions,
            node_of: &self.nodes_of_map(),
            fields,
            label_set,
            walls: &config.walls,
            resolution_m,
        };
        let measured = |narrow: &Narrow| Gate {
            narrow: *narrow,
            figures: figures::figures(&surroundings.measure(narrow, &found)),
        };
        found.par_iter().map(measured).collect()
    }

    fn mark(
        &self,
        gates: &[Gate],
        smoothed: &LabelField,
        mut marked: Labeling,
        label_set: &LabelSet,
        held: Held<'_>,
    ) -> Marked {
        let Self { space, config, .. } = self;
        let is_doorway = |label: Label| label_set.role(label) == Role::Doorway;
        let lead = |gate: &Gate| held.map_or(0.0, |held| self.lead(gate, held, is_doorway));
        let doorways = doorways(gates, config, space.in_cells(config.margin_m), lead);
        // Turned into the line of its walls is only what is marked.
        let strips: Vec<Vec<usize>> = doorways.par_iter().map(|gate| self.strip(&gate.narrow)).collect();
        let mut in_strip = vec![false; marked.len()];
        for strip in &strips {
            if let Some(label) = most_probable(smoothed, strip, label_set, |role| role == Role::Doorway) {
                for &node in strip {
                    marked[node] = label;
                    in_strip[node] = true;
                }
            }
        }
        for node in 0..marked.len() {
            if is_doorway(marked[node]) && !in_strip[node] {
                let other = most_probable(smoothed, &[node], label_set, |role| role != Role::Doorway);
                marked[node] = other.unwrap_or(marked[node]);
            }
        }
        let parts = |gate: &Gate| config.model.parting.probability(&gate.figures) >= config.min_parting;
        let cuts = gates.iter().filter(|gate| parts(gate)).map(|gate| self.line(&gate.narrow)).collect();
        Marked { labeling: marked, cuts }
    }

    /// How much less evidence a gate needs to be a doorway: negative where there was none in cells that were known.
    fn lead(&self, gate: &Gate, held: &[Option<Label>], is_doorway: impl Fn(Label) -> bool) -> f64 {
        let line = self.line(&gate.narrow);
        let n = |is: &dyn Fn(Label) -> bool| line.iter().filter(|&&node| held[node].is_some_and(is)).count();
        let (n_doorway, n_known) = (n(&is_doorway), n(&|_| true));
        match (2 * n_doorway > line.len(), 2 * n_known > line.len() && n_doorway == 0) {
            (true, _) => self.config.held_lead,
            (false, true) => -self.config.new_lag,
            (false, false) => 0.0,
        }
    }

    fn strip(&self, narrow: &Narrow) -> Vec<usize> {
        let Self { space, config, cleared, directions, .. } = self;
        let turned = walls::aligned(directions, space.resolution_m(), &config.walls, *narrow);
        // Where the turned line runs along a wall it is not the gate any more.
        let turned = gate::with_depth(cleared, turned, space.in_cells(config.max_depth_m))
            .filter(|turned| turned.depth <= narrow.depth + space.in_cells(0.3))
            .unwrap_or(*narrow);
        self.of_map(&paint::strip(cleared, &turned, space.in_cells(config.margin_m)))
    }

    /// The nodes on the line between the jambs: no step of four crosses it.
    fn line(&self, narrow: &Narrow) -> Vec<usize> {
        self.of_map(&paint::nodes_in(&self.cleared, &narrow.with_jambs(), 0.75))
    }

    /// The map's node in the cell of every node of `cleared`, [`NO_NODE`] in a speck.
    fn nodes_of_map(&self) -> Vec<u32> {
        let graph = &self.space.graph;
        let cells = self.cleared.cells_in_rows(0..graph.height());
        let mut next = 0;
        let numbered = cells.map(|cell| {
            if graph.is_free(cell) {
                next += 1;
                next - 1
            } else {
                NO_NODE
            }
        });
        numbered.collect()
    }

    fn of_map(&self, nodes: &[usize]) -> Vec<usize> {
        nodes.iter().filter_map(|&node| self.space.graph.node_at(self.cleared.cell(node))).collect()
    }
}

/// The gates that are doorways, the most probable first, but none that begins in the strip of a more probable one: seen from aside,
/// a door has a second line. A gate counts as more probable by its `lead`.
fn doorways<'a>(
    gates: &'a [Gate],
    config: &DoorwayConfig,
    margin: f64,
    lead: impl Fn(&Gate) -> f64,
) -> Vec<&'a Gate> {
    let probability = |gate: &Gate| config.model.doorway.probability(&gate.figures) + lead(gate);
    let mut found: Vec<(f64, &Gate)> = gates.iter().map(|gate| (probability(gate), gate)).collect();
    found.retain(|&(p, gate)| {
        figure(gate, "depth") <= config.max_doorway_depth_m
            && (p >= config.min_doorway && gate.narrow.width >= config.min_learned_cells
                || p >= config.min_well_formed && is_well_formed(gate, config))
    });
    found.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    let mut doorways: Vec<(f64, &Gate)> = Vec::new();
    for (p, gate) in found {
        let begins_in = |&(better, other): &(f64, &Gate)| {
            better > p && gate::begins_in(&gate.narrow, &other.narrow, margin)
        };
        if !doorways.iter().any(begins_in) {
            doorways.push((p, gate));
        }
    }
    doorways.into_iter().map(|(_, gate)| gate).collect()
}

/// The value of the figure called `name`.
fn figure(gate: &Gate, name: &str) -> f64 {
    figures::position(name).map_or(0.0, |at| gate.figures[at] as f64)
}

/// Whether a gate has the form of a doorway: by itself, or well enough for the labels to support it.
fn is_well_formed(gate: &Gate, config: &DoorwayConfig) -> bool {
    let figure = |name| figure(gate, name);
    let [narrowest, widest] = config.well_formed_width_m;
    (narrowest..=widest).contains(&figure("width"))
        && figure("depth") <= config.well_formed_depth_m
        && figure("form_clear").max(figure("form_supported")) >= 1.0
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
