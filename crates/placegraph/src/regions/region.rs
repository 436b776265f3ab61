//! Regions and the partition they form.

use super::DiagonalSteps;
use crate::labels::{Label, Labeling};

/// Position of a region in [`RegionMap::regions`]. Region images store `id + 1`, and 0 for cells without a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct RegionId(pub u32);

impl RegionId {
    /// The id as a position in arrays over regions.
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// A maximal connected set of free cells with one label.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// The label of all its cells.
    pub label: Label,
    /// Number of its cells.
    pub n_cells: u32,
}

/// A partition of the nodes into regions, numbered by their first node in row-major order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RegionMap {
    /// Region of every node.
    pub region_of: Vec<RegionId>,
    /// The regions.
    pub regions: Vec<Region>,
    /// Which diagonal steps connect cells, within regions and between them.
    pub diagonal: DiagonalSteps,
}

impl RegionMap {
    /// The label of every node.
    pub fn labeling(&self) -> Labeling {
        self.region_of.iter().map(|id| self.regions[id.index()].label).collect()
    }
}
