//! How the nodes of a map are labeled, whatever the method.

use super::{BoostedModel, Method, Model};
use crate::amn;
use crate::boost::{CompiledClassifiers, cell_scores};
use crate::grid::{CellGraph, OccupancyGrid};
use crate::labels::{LabelField, Labeling};
use crate::progress::{Progress, Stage};
use crate::relax::relax;

/// What a method says of the nodes of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct Labeled {
    /// Distribution of every node by its own scan (Sect. 4.3 or 4.6.1).
    pub classified: LabelField,
    /// The same after the neighbors were heard (Sect. 4.5 or 4.6).
    pub smoothed: LabelField,
    /// The label of every node after the neighbors were heard.
    pub labeling: Labeling,
}

impl Model {
    /// Labels the nodes of `graph`, the free cells of `map`: [`Stage::Classify`] and [`Stage::Smooth`] of the pipeline.
    pub fn label(&self, map: &OccupancyGrid, graph: &CellGraph, progress: &dyn Progress) -> Labeled {
        progress.begin(Stage::Classify);
        match &self.method {
            Method::Boosted(BoostedModel { list, relaxation, compatibility }) => {
                let classifiers = CompiledClassifiers::new(&list.classifiers);
                let scores = cell_scores(map, graph.cells(), &classifiers, &self.scan, progress);
                let classified = list.classify(&scores);
                progress.begin(Stage::Smooth);
                let smoothed = relax(graph, &classified, compatibility, relaxation).field;
                Labeled { labeling: smoothed.most_likely(), classified, smoothed }
            }
            Method::Iamn(model) => {
                let features = model.node_features(map, graph.cells(), &self.scan, progress);
                progress.begin(Stage::Smooth);
                let found = amn::label(graph, &features, &model.network);
                Labeled { classified: found.alone, smoothed: found.field, labeling: found.labeling }
            }
        }
    }
}
