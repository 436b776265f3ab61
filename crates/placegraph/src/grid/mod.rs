//! The occupancy grid map and the graph of its free cells.
//!
//! Row 0 of every grid is the map's *bottom* row: x grows to the right, y grows up, as in ROS. Image files
//! are flipped in [`crate::import`] and [`crate::export`] and nowhere else.

mod cell_graph;
mod clearance;
mod disjoint_sets;
mod frame;
mod free_space;
#[expect(clippy::module_inception, reason = "the module's main type")]
mod grid;
mod neighbors;
mod obstacles;
mod occupancy;
mod runs;
mod shape;

pub use cell_graph::CellGraph;
pub(crate) use cell_graph::NO_NODE;
pub(crate) use clearance::squared_clearances;
pub(crate) use disjoint_sets::DisjointSets;
pub use frame::{FrameError, MAX_ORIGIN, MAX_RESOLUTION_M, MIN_RESOLUTION_M, MapFrame};
pub use free_space::FreeSpace;
pub use grid::{Cell, Grid};
pub use neighbors::{Connectivity, DiagonalSteps};
#[doc(hidden)]
pub use obstacles::Obstacles;
pub use occupancy::{Occupancy, OccupancyGrid};
pub(crate) use runs::{Run, Runs, components};
pub use shape::GridShape;
