//! The free cells of a map and their positions.

use super::{CellGraph, MapFrame, OccupancyGrid};

/// The free cells of a map as the graph G = (V, E) of Sect. 4.5, with their positions.
///
/// Stages that measure in meters take it; those that only step from cell to cell take the [`CellGraph`].
///
/// # Examples
/// ```
/// use placegraph::grid::{FreeSpace, OccupancyGrid};
///
/// let map = OccupancyGrid::from_ascii(0.5, "####\n#..#\n####");
/// let space = FreeSpace::of(&map);
/// assert_eq!(space.graph.n_nodes(), 2);
/// assert_eq!(space.in_cells(1.0), 2.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct FreeSpace {
    /// Where the cells are.
    pub frame: MapFrame,
    /// The free cells and their neighbors.
    pub graph: CellGraph,
}

impl FreeSpace {
    /// The free space of `map`. Cost: one pass over the map.
    ///
    /// # Panics
    /// As [`CellGraph::new`].
    pub fn of(map: &OccupancyGrid) -> Self {
        Self { frame: map.frame, graph: CellGraph::new(&map.cells) }
    }

    /// Side of a cell, in meters.
    pub fn resolution_m(&self) -> f64 {
        self.frame.resolution_m()
    }

    /// Converts a length in meters to cells.
    pub fn in_cells(&self, meters: f64) -> f64 {
        meters / self.frame.resolution_m()
    }
}
