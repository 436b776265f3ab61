//! The most probable labeling of a network: maximum of the score (4.9) by α-expansion (Sect. 4.6).
//!
//! One minimum cut decides which nodes change to a label α at once. Because rewards are never negative, every
//! such move is a cut problem without further conditions, whatever the rewards of the single labels. With two
//! labels one cut finds the exact maximum; with more the result is a labeling that no expansion improves
//! (Boykov, Veksler and Zabih, PAMI 2001), in practice within a thousandth of the best. Cost: a handful of cuts
//! per label.
//!
//! Deviation: the chapter names linear programming and graph cuts; only the cuts are here. Potentials are rounded to a power
//! of two, 2⁻²³ of the largest edge reward or less, so that cuts are exact and moves cannot cycle. Whole numbers stay whole,
//! and what is equally good stays so.

use rayon::prelude::*;

use super::capacity::Capacity;
use super::maxflow::GridCut;
use crate::grid::{CellGraph, Connectivity};
use crate::labels::{Label, Labeling};

/// The score of a labeling y: Σ_i θ_i(y_i) + Σ_(ij) λ(k) [y_i = y_j = k], over the nodes and edges of a cell graph.
#[derive(Clone, Debug, PartialEq)]
pub struct Potentials {
    /// θ, node-major, one per node and label; any finite numbers.
    pub node: Vec<f64>,
    /// λ, one per label, none negative: the reward of an edge if both of its ends have the label.
    pub edge: Vec<f64>,
    /// Which cells share an edge.
    pub connectivity: Connectivity,
}

impl Potentials {
    /// Number of labels K.
    pub fn n_labels(&self) -> usize {
        self.edge.len()
    }

    /// θ of all labels at `node`.
    pub fn row(&self, node: usize) -> &[f64] {
        &self.node[node * self.n_labels()..(node + 1) * self.n_labels()]
    }

    /// The score of `labeling`, Eq. (4.9) without its normalization.
    pub fn score(&self, graph: &CellGraph, labeling: &[Label]) -> f64 {
        let edges = agreeing_edges(graph, self.connectivity, labeling, self.n_labels());
        let nodes: f64 = labeling.iter().enumerate().map(|(i, y)| self.row(i)[y.index()]).sum();
        nodes + edges.iter().zip(&self.edge).map(|(&n, lambda)| n as f64 * lambda).sum::<f64>()
    }

    /// The best label of every node on its own; ties go to the lower label.
    pub fn best_alone(&self) -> Labeling {
        let best = |row: &[f64]| (1..row.len()).fold(0, |best, k| if row[k] > row[best] { k } else { best });
        self.node.chunks_exact(self.n_labels()).map(|row| Label(best(row) as u8)).collect()
    }
}

/// Number of edges whose ends both have label k, for every k.
pub fn agreeing_edges(
    graph: &CellGraph,
    connectivity: Connectivity,
    labeling: &[Label],
    n_labels: usize,
) -> Vec<u64> {
    let mut counts = vec![0; n_labels];
    for (i, &label) in labeling.iter().enumerate() {
        for &step in connectivity.steps_back() {
            if graph.node_at_step(i, step).is_some_and(|j| labeling[j] == label) {
                counts[label.index()] += 1;
            }
        }
    }
    counts
}

/// The labeling of highest score that α-expansion reaches from `start`.
///
/// Deterministic; labels expand in order until no expansion improves the score. With two labels the result is the
/// exact maximum, wherever it starts.
///
/// # Panics
/// If potentials and `start` do not fit the graph.
pub fn expand(graph: &CellGraph, potentials: &Potentials, start: &[Label]) -> Labeling {
    assert_eq!(
        potentials.node.len(),
        graph.n_nodes() * potentials.n_labels(),
        "a potential per node and label"
    );
    assert_eq!(start.len(), graph.n_nodes(), "a label per node");
    if potentials.edge.iter().all(|&lambda| lambda == 0.0) {
        return potentials.best_alone();
    }
    let row = |node: usize, out: &mut Vec<f64>| out.extend_from_slice(potentials.row(node));
    match potentials.connectivity {
        Connectivity::Four => Expansion::<4, i32, _>::new(graph, &potentials.edge, start, row).run(),
        Connectivity::Eight => Expansion::<8, i32, _>::new(graph, &potentials.edge, start, row).run(),
    }
}

/// [`expand`] over the 8-neighborhood in little memory, 38 bytes per cell of the map of `graph`: with equal rewards `edge`, above 0,
/// potentials rounded to 2⁻¹³ of them or less, and potentials that are not stored: `row` appends those of a node, one per label.
pub(crate) struct SmallExpansion<'a, R>(Expansion<'a, 8, u16, R>);

impl<'a, R: Fn(usize, &mut Vec<f64>)> SmallExpansion<'a, R> {
    /// An expansion from `start`.
    pub(crate) fn new(graph: &'a CellGraph, edge: &[f64], start: &[Label], row: R) -> Self {
        Self(Expansion::new(graph, edge, start, row))
    }

    /// The best labeling that is reached.
    pub(crate) fn best(self) -> Labeling {
        self.0.run()
    }

    /// With two labels: the best labeling where nodes around those of the graph have a label already, `given` by their
    /// column and row as counted from a frame of one cell around the map; labels given to nodes of the graph are forgotten.
    /// Where several are best, the one with most nodes of the first label.
    pub(crate) fn best_within(&mut self, given: impl Iterator<Item = ((u32, u32), Label)>) -> Labeling {
        let expansion = &mut self.0;
        assert_eq!(expansion.n_labels, 2, "an expansion of the first label is exact for two");
        for ((column, row), label) in given {
            let position = expansion.cut.framed_position(column, row);
            expansion.labels[position] = if label.index() == 0 { 0 } else { SECOND };
        }
        expansion.expand_first();
        expansion.labeling()
    }
}

/// The best labeling that α-expansion reaches from every node's best label alone and from each label everywhere; ties go
/// to the earlier start. Costs K + 1 times [`expand`], in parallel. From one start it may end a few millionths below.
pub fn expand_from_all(graph: &CellGraph, potentials: &Potentials) -> Labeling {
    let n_labels = potentials.n_labels();
    if n_labels == 2 {
        return expand(graph, potentials, &potentials.best_alone());
    }
    let found: Vec<(f64, Labeling)> = (0..=n_labels)
        .into_par_iter()
        .map(|start| {
            let start = match start {
                0 => potentials.best_alone(),
                k => vec![Label(k as u8 - 1); graph.n_nodes()],
            };
            let labeling = expand(graph, potentials, &start);
            (potentials.score(graph, &labeling), labeling)
        })
        .collect();
    let best = found.into_iter().reduce(|best, other| if other.0 > best.0 { other } else { best });
    best.map_or_else(Vec::new, |(_, labeling)| labeling)
}

/// Most steps that the largest reward is divided into: all sums then fit in 31 bits, and with 16 bits for an edge twice as many
/// steps into those.
const fn steps_of_largest_reward<C>() -> i32 {
    if size_of::<C>() == 2 { 1 << 14 } else { 1 << 24 }
}

/// The largest power of two that is not above `value`, which is above 0.
fn power_of_two_below(value: f64) -> f64 {
    let mantissa = (1 << (f64::MANTISSA_DIGITS - 1)) - 1;
    f64::from_bits(value.to_bits() & !mantissa)
}

/// Label of the cells that are no nodes.
const NONE: u8 = u8::MAX;
/// Label of a cell that keeps the second of two labels.
const SECOND: u8 = u8::MAX - 1;

struct Expansion<'a, const D: usize, C, R> {
    graph: &'a CellGraph,
    n_labels: usize,
    /// Appends the potentials of a node.
    row: R,
    steps_per_unit: f64,
    /// Half the reward of every label, in whole steps.
    half_reward: Vec<i32>,
    /// The labels of all positions in the cut's rectangle.
    labels: Vec<u8>,
    cut: GridCut<D, C>,
}

impl<'a, const D: usize, C: Capacity, R: Fn(usize, &mut Vec<f64>)> Expansion<'a, D, C, R> {
    fn new(graph: &'a CellGraph, edge: &[f64], start: &[Label], row: R) -> Self {
        let cut = GridCut::<D, C>::new(graph.width(), graph.height());
        let mut labels = vec![NONE; cut.n_positions()];
        for (cell, label) in graph.cells_in_rows(0..graph.height()).zip(start) {
            labels[cut.position(cell)] = label.0;
        }
        let largest = edge.iter().fold(0.0, |a: f64, &b| a.max(b));
        let steps_per_unit = power_of_two_below(f64::from(steps_of_largest_reward::<C>()) / largest);
        let half_reward: Vec<i32> =
            edge.iter().map(|lambda| (lambda / 2.0 * steps_per_unit).round() as i32).collect();
        Self { graph, n_labels: edge.len(), row, steps_per_unit, half_reward, labels, cut }
    }

    /// Puts the potentials of `node` into `steps`, in whole steps below the best.
    fn below_best(&self, node: usize, theta: &mut Vec<f64>, steps: &mut Vec<i32>) {
        theta.clear();
        (self.row)(node, theta);
        let best = theta.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b));
        // A label this far below the best is never worth its edges: clipping there changes no optimum.
        let lowest = -2.0 * D as f64 * f64::from(steps_of_largest_reward::<C>());
        steps.clear();
        steps.extend(theta.iter().map(|t| ((t - best) * self.steps_per_unit).round().max(lowest) as i32));
    }

    fn run(mut self) -> Labeling {
        if self.n_labels == 2 {
            self.expand_first();
        } else {
            self.expand_in_turn();
        }
        self.labeling()
    }

    fn labeling(&self) -> Labeling {
        let cells = self.graph.cells_in_rows(0..self.graph.height());
        cells.map(|cell| Label(self.labels[self.cut.position(cell)])).collect()
    }

    /// Of two labels, the first one expands over the second: every labeling is one such expansion away.
    fn expand_first(&mut self) {
        for cell in self.graph.cells_in_rows(0..self.graph.height()) {
            self.labels[self.cut.position(cell)] = 1;
        }
        self.expand(0);
    }

    fn expand_in_turn(&mut self) {
        let mut unchanged = 0;
        for alpha in (0..self.n_labels).cycle() {
            // A label that has just expanded cannot expand again.
            unchanged = if self.expand(alpha) { 1 } else { unchanged + 1 };
            if unchanged >= self.n_labels {
                break;
            }
        }
    }

    /// Lets the nodes change to `alpha` if this is best for them together; returns whether the score rose.
    fn expand(&mut self, alpha: usize) -> bool {
        let from_source = self.set_capacities(alpha);
        let gain = from_source - self.cut.solve();
        // With two labels even nodes go to the first one, whatever else changes.
        if gain == 0 && self.n_labels > 2 {
            return false;
        }
        for (position, label) in self.labels.iter_mut().enumerate() {
            if *label < SECOND && !self.cut.is_sink_side(position) {
                *label = alpha as u8;
            }
        }
        true
    }

    /// The source side of the cut is the nodes that change. An edge between two nodes with labels β and γ other
    /// than α earns a = λ(β)[β = γ] if both stay, b = λ(α) if both change, nothing otherwise: a cut edge of
    /// (a + b)/2 and (b − a)/2 for the change of each end. Returns the capacity out of the source.
    fn set_capacities(&mut self, alpha: usize) -> i64 {
        self.cut.clear();
        let mut from_source = 0;
        let (mut theta, mut row) = (Vec::new(), Vec::new());
        let alpha_label = alpha as u8;
        let gain = self.half_reward[alpha];
        for (i, cell) in self.graph.cells_in_rows(0..self.graph.height()).enumerate() {
            let p = self.cut.position(cell);
            let label = self.labels[p];
            if label == alpha_label {
                continue;
            }
            self.below_best(i, &mut theta, &mut row);
            let loss = self.half_reward[label as usize];
            let mut excess = row[alpha] - row[label as usize];
            for d in 0..D {
                let q = self.cut.neighbor(p, d);
                let other = self.labels[q];
                if other == NONE {
                    continue;
                }
                let (stay, change) = match other {
                    SECOND => (2 * loss, 0),
                    _ if other == alpha_label => (0, 2 * gain),
                    _ if other == label => (loss, gain),
                    _ => (0, gain),
                };
                excess += change - stay;
                if d >= D / 2 && other != alpha_label && other != SECOND {
                    self.cut.set_edge(p, d, stay + change);
                }
            }
            self.cut.add_excess(p, excess);
            from_source += i64::from(excess.max(0));
        }
        from_source
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::OccupancyGrid;

    #[test]
    fn a_node_follows_its_neighbors_where_they_pay_more_than_it_loses() {
        let graph = CellGraph::new(&OccupancyGrid::from_ascii(1.0, "...").cells);
        let labeling = |reward: f64| {
            let node = vec![3.0, 0.0, 0.0, 0.0, 1.0, 0.0, 3.0, 0.0, 0.0];
            let potentials = Potentials { node, edge: vec![reward; 3], connectivity: Connectivity::Four };
            let found = expand(&graph, &potentials, &potentials.best_alone());
            assert_eq!(expand_from_all(&graph, &potentials), found);
            found
        };
        // Two edges against a loss of 1.
        assert_eq!(labeling(0.4), [0, 1, 0].map(Label));
        assert_eq!(labeling(0.6), [0, 0, 0].map(Label));
    }

    #[test]
    fn steps_are_powers_of_two() {
        let found = [1.0, 1.5, 4.0, 419_430.4, 0.3].map(power_of_two_below);
        assert!(found.iter().zip([1.0, 1.0, 4.0, 262_144.0, 0.25]).all(|(a, b)| a.total_cmp(&b).is_eq()));
    }

    #[test]
    fn only_edges_with_equal_ends_are_rewarded() {
        let graph = CellGraph::new(&OccupancyGrid::from_ascii(1.0, "..\n..").cells);
        let labels = [0, 0, 1, 0].map(Label);
        assert_eq!(agreeing_edges(&graph, Connectivity::Four, &labels, 2), [2, 0]);
        assert_eq!(agreeing_edges(&graph, Connectivity::Eight, &labels, 2), [3, 0]);
        let potentials = Potentials {
            node: vec![1.0, 0.0, 2.0, 0.0, 0.0, 4.0, 8.0, 0.0],
            edge: vec![0.5, 9.0],
            connectivity: Connectivity::Eight,
        };
        assert!((potentials.score(&graph, &labels) - (15.0 + 3.0 * 0.5)).abs() < 1e-12);
    }
}
