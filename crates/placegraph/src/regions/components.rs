//! Maximal connected sets of equal label (Sect. 4.7): two passes over runs with union–find.
//!
//! Cost: linear in nodes.
//!
//! **Deviation.** A diagonal step needs a free cell beside it by default: with plain 8-connectivity, regions
//! leak through diagonal walls that are one cell thick ([`DiagonalSteps`]).

use serde::{Deserialize, Serialize};

use super::disjoint_sets::DisjointSets;
use super::{Region, RegionId, RegionMap, Runs};
use crate::grid::CellGraph;
use crate::labels::Label;

/// When two cells that share only a corner are connected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DiagonalSteps {
    /// If at least one of the two cells beside the step is free, so that no step crosses a diagonal wall.
    #[default]
    ThroughFree,
    /// Always: plain 8-connectivity.
    Any,
    /// Never: 4-connectivity.
    Never,
}

/// The maximal connected sets of nodes with equal label, numbered by their first node in row-major order.
///
/// # Examples
/// ```
/// use placegraph::grid::{CellGraph, OccupancyGrid};
/// use placegraph::labels::Label;
/// use placegraph::regions::{DiagonalSteps, connected};
///
/// let map = OccupancyGrid::from_ascii(0.05, "
///     .#
///     #.
/// ");
/// let graph = CellGraph::new(&map.cells);
/// let labels = [Label(0), Label(0)];
/// assert_eq!(connected(&graph, &labels, DiagonalSteps::ThroughFree).regions.len(), 2);
/// assert_eq!(connected(&graph, &labels, DiagonalSteps::Any).regions.len(), 1);
/// ```
///
/// # Panics
/// If there is not one label per node.
pub fn connected(graph: &CellGraph, labeling: &[Label], diagonal: DiagonalSteps) -> RegionMap {
    assert_eq!(labeling.len(), graph.n_nodes(), "one label per node");
    let runs = Runs::new(graph, |node| labeling[node].0 as u32);
    let (component_of_run, n_components) = components(&runs, diagonal);

    let mut regions = vec![Region { label: Label(0), n_cells: 0 }; n_components];
    let mut region_of = Vec::with_capacity(graph.n_nodes());
    for (run, &id) in runs.all().iter().zip(&component_of_run) {
        let region = &mut regions[id.index()];
        region.label = Label(run.value as u8);
        region.n_cells += run.end - run.start;
        region_of.resize(run.nodes().end, id);
    }
    RegionMap { region_of, regions, diagonal }
}

/// The component of every run and the number of components, numbered by their first run.
pub(crate) fn components(runs: &Runs, diagonal: DiagonalSteps) -> (Vec<RegionId>, usize) {
    let all = runs.all();
    let mut sets = DisjointSets::new(all.len());
    runs.for_each_touch(diagonal, |touch| {
        let [a, b] = touch.runs;
        if all[a].value == all[b].value {
            sets.unite(a, b);
        }
    });
    let mut component_of = Vec::with_capacity(all.len());
    let mut n_components = 0;
    for run in 0..all.len() {
        // The representative is the first run of its set, so it was numbered before.
        let representative = sets.find(run);
        component_of.push(if representative == run {
            n_components += 1;
            RegionId(n_components - 1)
        } else {
            component_of[representative]
        });
    }
    (component_of, n_components as usize)
}
