//! Maximal connected sets of equal label (Sect. 4.7): two passes over runs with union–find.
//!
//! Cost: linear in nodes.
//!
//! **Deviation.** A diagonal step needs a free cell next to it by default: with plain 8-connectivity, regions
//! leak through diagonal walls that are one cell thick ([`DiagonalSteps`]).

use super::{Region, RegionId, RegionMap};
use crate::grid::{CellGraph, DiagonalSteps, Runs, components};
use crate::labels::Label;

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
        let region = &mut regions[id as usize];
        region.label = Label(run.value as u8);
        region.n_cells += run.end - run.start;
        region_of.resize(run.nodes().end, RegionId(id));
    }
    RegionMap { region_of, regions, diagonal }
}
