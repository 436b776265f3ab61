//! The graph G = (V, E) of Sect. 4.5: a node per free cell, edges between neighboring free cells.

use super::{Cell, Connectivity, Grid, Occupancy};

/// Free cells in row-major order and, for every cell of the map, its node.
///
/// Nodes are numbered in row-major order from the bottom left, so node ids are deterministic and neighbors
/// are near in memory. Edges are implicit: [`CellGraph::neighbors`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CellGraph {
    cells: Vec<Cell>,
    node_of: Grid<u32>,
}

/// Marks a cell that is no node.
const NO_NODE: u32 = u32::MAX;

impl CellGraph {
    /// The graph over the free cells of a map. Cost: one pass over the map.
    ///
    /// # Panics
    /// If the map has 2³² − 1 cells or more; readers refuse such maps.
    pub fn new(map: &Grid<Occupancy>) -> Self {
        assert!(map.values().len() < NO_NODE as usize, "node ids fit in 32 bits");
        let mut cells = Vec::new();
        let mut node_of = Grid::filled(map.width(), map.height(), NO_NODE);
        for (index, _) in map.values().iter().enumerate().filter(|(_, value)| **value == Occupancy::Free) {
            node_of.values_mut()[index] = cells.len() as u32;
            cells.push(map.cell(index));
        }
        Self { cells, node_of }
    }

    /// Number of nodes.
    pub fn n_nodes(&self) -> usize {
        self.cells.len()
    }

    /// Cell of every node, in the order of the nodes.
    pub fn cells(&self) -> &[Cell] {
        &self.cells
    }

    /// Number of columns of the map.
    pub fn width(&self) -> u32 {
        self.node_of.width()
    }

    /// Number of rows of the map.
    pub fn height(&self) -> u32 {
        self.node_of.height()
    }

    /// The node in `cell`, or `None` if the cell is not free.
    pub fn node_at(&self, cell: Cell) -> Option<usize> {
        let node = self.node_of[cell];
        (node != NO_NODE).then_some(node as usize)
    }

    /// The node `step` away from `node`, or `None` where there is no free cell.
    pub fn node_at_step(&self, node: usize, step: (i32, i32)) -> Option<usize> {
        self.node_at(self.node_of.offset(self.cells[node], step)?)
    }

    /// The nodes next to `node`, in the order of [`Connectivity::steps`].
    pub fn neighbors(&self, node: usize, connectivity: Connectivity) -> impl Iterator<Item = usize> + '_ {
        connectivity.steps().iter().filter_map(move |&step| self.node_at_step(node, step))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::OccupancyGrid;

    #[test]
    fn nodes_are_free_cells_in_row_major_order() {
        let map = OccupancyGrid::from_ascii(
            1.0,
            "
            .#.
            ..?
            ",
        );
        let graph = CellGraph::new(&map.cells);
        assert_eq!(graph.cells(), [Cell::new(0, 0), Cell::new(1, 0), Cell::new(0, 1), Cell::new(2, 1)]);
        assert_eq!(graph.neighbors(1, Connectivity::Eight).collect::<Vec<_>>(), [0, 2, 3]);
        assert_eq!(graph.neighbors(1, Connectivity::Four).collect::<Vec<_>>(), [0]);
        assert_eq!(graph.node_at(Cell::new(1, 1)), None);
    }
}
