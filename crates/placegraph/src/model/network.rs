//! An instance-based network, together with the classifier whose scores its nodes use.

use crate::amn::{self, IamnModel};
use crate::boost::{CompiledClassifiers, DecisionList, P_FLOOR, Scores, confidence, table_scores};
use crate::features::{FeatureId, FeatureTable, extract};
use crate::grid::{Cell, OccupancyGrid};
use crate::progress::{Progress, Silent};
use crate::scan::ScanConfig;

/// Cells whose features are in memory at once.
const CHUNK: usize = 1 << 15;

/// An instance-based network, alone as in the chapter or on top of a decision list.
#[derive(Clone, Debug, PartialEq)]
pub struct NetworkModel {
    /// The list whose [`log_confidences`] are node features in addition to the distances; without it, the network is
    /// the chapter's. Its order is ignored.
    pub list: Option<DecisionList>,
    /// The network.
    pub network: IamnModel,
}

impl NetworkModel {
    /// The node features of `cells`, free cells of the map in row-major order: the distances of Eq. (4.11), then the
    /// list's [`log_confidences`]. Cost: that of the features, the distances and the stumps; features are forgotten chunk
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
        columns.extend(classifiers.iter().flat_map(CompiledClassifiers::columns));
        columns.sort_unstable();
        columns.dedup();
        let mut features = Vec::new();
        for (number, chunk) in cells.chunks(CHUNK).enumerate() {
            progress.advance(number * CHUNK, cells.len());
            let table = extract(map, chunk, &columns, scan, &Silent);
            let scores = match (&self.list, &classifiers) {
                (Some(list), Some(classifiers)) => {
                    let rows: Vec<u32> = (0..chunk.len() as u32).collect();
                    log_confidences(&table_scores(&table, &rows, classifiers), list.temperature)
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

/// ln C⁺ and ln C⁻ of every class (Eqs. 4.2 to 4.4), one example after the other: the log-probabilities of a decision
/// list in any order are sums of them. Floored as in the list, so that none is infinite.
pub fn log_confidences(scores: &Scores, temperature: f64) -> Vec<f32> {
    let of_score = |&score: &f32| {
        let (yes, no) = confidence(score.into(), temperature);
        [yes, no].map(|p| p.max(P_FLOOR).ln() as f32)
    };
    scores.values().iter().flat_map(of_score).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn log_confidences_are_those_of_a_yes_and_of_a_no() {
        // F = ln 2 at temperature 1: 4/5 and 1/5; a certain yes has a floor under its no.
        let found = log_confidences(&Scores::from_rows(2, vec![std::f32::consts::LN_2, 100.0]), 1.0);
        let expected = [0.8f64.ln(), 0.2f64.ln(), 0.0, P_FLOOR.ln()];
        assert!(found.iter().zip(expected).all(|(&a, b)| (f64::from(a) - b).abs() < 1e-6), "{found:?}");
    }
}
