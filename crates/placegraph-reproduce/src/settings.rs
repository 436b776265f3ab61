//! What is computed: the chapter's setting, the best one, and the points of the curves.

use placegraph::amn::IamnConfig;
use placegraph::features::select::{SelectConfig, Weighing};
use placegraph::training::{Choice, NetworkConfig, TrainConfig};
use serde::Serialize;

/// Numbers that the experiments use; tests take smaller ones.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Settings {
    /// T of the chapter's setting.
    pub(super) rounds: usize,
    /// Values of T that the best setting chooses from, on held-out training cells.
    pub(super) best_rounds: Vec<usize>,
    /// Points of the curve over T.
    pub(super) rounds_curve: Vec<usize>,
    /// Points of the curve over iterations of the relaxation.
    pub(super) iterations_curve: Vec<u32>,
    /// Scales of the training maps in Sect. 4.8.2.
    pub(super) scales: Vec<f64>,
    /// Most training cells of a class in the best setting, if not all are taken.
    pub(super) best_max_cells: Option<usize>,
    /// The same for a network's list, and where whole buildings are learned from.
    pub(super) max_cells: usize,
    /// The same where every cell is seen at all scales.
    pub(super) max_cells_scaled: usize,
    /// Side of the cells of the chapter's network, in cells of the map.
    pub(super) network_stride: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            rounds: 100,
            best_rounds: vec![25, 50, 100, 200, 400],
            rounds_curve: vec![10, 25, 50, 75, 100, 150, 200, 300, 400, 500],
            iterations_curve: vec![0, 1, 2, 5, 10, 20, 30, 40, 50, 60, 80, 100],
            scales: vec![0.7, 0.85, 1.0, 1.2, 1.4],
            best_max_cells: None,
            max_cells: 6000,
            max_cells_scaled: 3000,
            network_stride: 4,
        }
    }
}

impl Settings {
    /// 100 rounds, temperature 1, one scale, all training cells.
    pub(super) fn chapter(&self) -> TrainConfig {
        TrainConfig { rounds: Choice::Set(self.rounds), ..TrainConfig::chapter() }
    }

    /// Rounds and temperature chosen on held-out blocks of the training cells.
    pub(super) fn best(&self) -> TrainConfig {
        TrainConfig {
            rounds: Choice::Among(self.best_rounds.clone()),
            scales: vec![1.0],
            max_cells_per_class: self.best_max_cells,
            ..TrainConfig::default()
        }
    }

    /// `config` with at most as many training cells per class as the list of a network uses.
    pub(super) fn thinned(&self, config: TrainConfig) -> TrainConfig {
        TrainConfig { max_cells_per_class: Some(self.max_cells), ..config }
    }

    /// `config` with every training cell seen at several scales.
    pub(super) fn scaled(&self, config: TrainConfig) -> TrainConfig {
        TrainConfig {
            scales: self.scales.clone(),
            max_cells_per_class: Some(self.max_cells_scaled),
            ..config
        }
    }

    /// The network that sees distances alone.
    pub(super) fn chapter_network() -> IamnConfig {
        NetworkConfig::chapter().network
    }

    /// The same with Fisher ratios that are not made comparable with correlations.
    pub(super) fn printed_network() -> IamnConfig {
        let network = Self::chapter_network();
        IamnConfig { select: SelectConfig { weighing: Weighing::Printed, ..network.select }, ..network }
    }

    /// The network on a decision list that is trained as in the best setting, on fewer cells.
    pub(super) fn best_network(&self) -> NetworkConfig {
        NetworkConfig { base: self.thinned(self.best()), ..NetworkConfig::default() }
    }
}
