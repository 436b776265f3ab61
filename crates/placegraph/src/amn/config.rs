//! How a network is trained.

use super::learn::LearnConfig;
use crate::features::select::SelectConfig;

/// How an instance-based network is trained.
#[derive(Clone, Debug, PartialEq)]
pub struct IamnConfig {
    /// Which features are selected.
    pub select: SelectConfig,
    /// Values of M to try. Default 1 alone.
    pub n_neighbors: Vec<usize>,
    /// Values of C to try, ascending, for losses per cell. Default 10 and 100.
    pub costs: Vec<f64>,
    /// Exemplars closer than this to a training cell, along both axes of its map, do not count for it. Default 1 m.
    pub exclusion_m: f64,
    /// Parts of every map that validation holds out in turn. Default 4.
    pub n_blocks: usize,
    /// Of a class with more cells, evenly many in map order become exemplars. Default 8000.
    pub max_exemplars_per_class: usize,
    /// How weights are learned.
    pub learn: LearnConfig,
}

impl Default for IamnConfig {
    fn default() -> Self {
        Self {
            select: SelectConfig::default(),
            n_neighbors: vec![1],
            costs: vec![10.0, 100.0],
            exclusion_m: 1.0,
            n_blocks: 4,
            max_exemplars_per_class: 8000,
            learn: LearnConfig::default(),
        }
    }
}
