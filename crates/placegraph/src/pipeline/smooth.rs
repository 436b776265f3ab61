//! Sect. 4.5 or 4.6: what the neighbors of a cell say of it.

use super::Classified;
use crate::grid::FreeSpace;
use crate::labels::{LabelField, Labeling};
use crate::model::{Method, Model};
use crate::relax::relax_in_place;

/// Every node's distribution before and after smoothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Smoothed {
    /// Distribution of every node by its own scan (Sect. 4.3 or 4.6.1).
    pub classified: LabelField,
    /// The same after smoothing over its neighbors (Sect. 4.5 or 4.6).
    pub smoothed: LabelField,
    /// The label of every node after smoothing.
    pub labeling: Labeling,
}

/// Smooths `classified` over the neighbors of every node: by relaxation (Sect. 4.5), or as the network infers it (Sect. 4.6).
///
/// # Panics
/// If `classified` does not belong to `space` and `model`.
pub fn smooth(space: &FreeSpace, classified: Classified, model: &Model) -> Smoothed {
    let Classified { field: classified, potentials } = classified;
    match (&model.method, potentials) {
        (Method::Boosted(model), None) => {
            let mut smoothed = classified.clone();
            relax_in_place(&space.graph, &mut smoothed, &model.compatibility, &model.relaxation);
            Smoothed { labeling: smoothed.most_likely(), classified, smoothed }
        }
        (Method::Iamn(model), Some(potentials)) => {
            let (labeling, smoothed) = model.network.infer(&space.graph, &potentials);
            Smoothed { classified, smoothed, labeling }
        }
        _ => panic!("classified by the model that smooths"),
    }
}
