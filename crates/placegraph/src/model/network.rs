//! An instance-based network together with the classifier whose scores its nodes see.

use crate::amn::{self, IamnModel};
use crate::boost::{CompiledClassifiers, DecisionList, table_scores};
use crate::features::{FeatureId, FeatureTable, extract};
use crate::grid::{Cell, OccupancyGrid};
use crate::labels::LabelField;
use crate::progress::{Progress, Silent};
use crate::scan::ScanConfig;

/// Cells whose features are in memory at once.
const CHUNK: usize = 1 << 15;

/// An instance-based network, alone as in the chapter or on top of a decision list.
#[derive(Clone, Debug, PartialEq)]
pub struct NetworkModel {
    /// The list whose log-probabilities are node features besides the distances; without it the network is the chapter's.
    pub list: Option<DecisionList>,
    /// The network.
    pub network: IamnModel,
}

impl NetworkModel {
    /// The node features of `cells`, free cells of the map in row-major order: the distances of Eq. (4.11), then the
    /// list's log-probabilities. Cost: that of the features, the distances and the stumps; features are forgotten chunk
    /// by chunk.
    pub fn node_features(
        &self,
        map: &OccupancyGrid,
        cells: &[Cell],
        scan: &ScanConfig,
        progress: &dyn Progress,
    ) -> Vec<f32> {
        let classifiers = self.list.as_ref().map(|list| CompiledClassifiers::new(&list.classifiers));
        let mut columns: Vec<FeatureId> = self.network.standardization.features.clone();
        columns.extend(classifiers.iter().flat_map(|classifiers| classifiers.columns()));
        columns.sort_unstable();
        columns.dedup();
        let mut features = Vec::new();
        for (number, chunk) in cells.chunks(CHUNK).enumerate() {
            progress.advance(number * CHUNK, cells.len());
            let table = extract(map, chunk, &columns, scan, &Silent);
            let scores = match (&self.list, &classifiers) {
                (Some(list), Some(classifiers)) => {
                    let rows: Vec<u32> = (0..chunk.len() as u32).collect();
                    log_probabilities(&list.classify(&table_scores(&table, &rows, classifiers)))
                }
                _ => Vec::new(),
            };
            features.extend(self.features_of(&table, &scores));
        }
        features
    }

    fn features_of(&self, table: &FeatureTable, scores: &[f32]) -> Vec<f32> {
        let n_distances = self.network.weights.n_labels() * self.network.n_neighbors;
        amn::side_by_side(self.network.transform(table), n_distances, scores)
    }
}

/// ln p of all nodes and labels; the decision list floors p, so that none is infinite.
pub(crate) fn log_probabilities(field: &LabelField) -> Vec<f32> {
    field.values().iter().map(|p| p.ln()).collect()
}
