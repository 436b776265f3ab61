//! From labeled maps to a model that knows their doorways too: training, then what its stages say of the maps' gates.
//!
//! Doorways are found in the geometry of the map, by what the program knows of gates ([`crate::doorways`]). Somebody who paints
//! doorways among classes of their own means by one what they paint: perhaps wide openings too, or only doors with a leaf. So the
//! gates of the training maps are compared with what was painted, and boosting goes on from the program's own stumps where they disagree.

use crate::doorways::{DoorwayConfig, gates};
use crate::grid::FreeSpace;
use crate::labels::{LabelSet, Role};
use crate::model::{Method, Model};
use crate::pipeline::{classify, smooth};
use crate::progress::Progress;
use crate::training::{
    GateExample, LabeledMap, TrainConfig, TrainError, Trained, gate_examples, heed_doorways, train,
};

/// Trains the boosted method on `maps`, and what their painted doorways say of gates. Cost: that of [`train`], and of labeling every
/// map up to its gates.
///
/// # Errors
/// As [`train`].
pub fn learn(
    maps: &[LabeledMap],
    label_set: &LabelSet,
    config: &TrainConfig,
    progress: &dyn Progress,
) -> Result<Trained, TrainError> {
    let mut trained = train(maps, label_set, config, progress)?;
    trained.model.doorways = painted_doorways(maps, &trained.model, progress);
    Ok(trained)
}

fn painted_doorways(
    maps: &[LabeledMap],
    model: &Model,
    progress: &dyn Progress,
) -> Vec<crate::boost::WeightedStump> {
    let has_doorways = model.label_set.labels().any(|label| model.label_set.role(label) == Role::Doorway);
    // What the default classes mean by a doorway is what the program's own gates were learned from.
    if !has_doorways || model.label_set == LabelSet::default() {
        return Vec::new();
    }
    let config = DoorwayConfig::default().heeding(&model.doorways).into_owned();
    let examples: Vec<Vec<GateExample>> =
        maps.iter().map(|map| gates_of(map, model, &config, progress)).collect();
    let known = model.doorways.iter().copied();
    known.chain(heed_doorways(&examples, &config.model, &config)).collect()
}

/// The gates of a map, with what was painted there.
fn gates_of(
    map: &LabeledMap,
    model: &Model,
    config: &DoorwayConfig,
    progress: &dyn Progress,
) -> Vec<GateExample> {
    let space = FreeSpace::of(&map.grid);
    let smoothed = smooth(&space, classify(&map.grid, &space, model, progress), model);
    let scans =
        if let Method::Boosted(_) = &model.method { &smoothed.classified } else { &smoothed.smoothed };
    let found = gates(&space, [scans, &smoothed.smoothed], &model.label_set, config);
    let labels = map.inside_window(map.labels.clone());
    gate_examples(&space, &found, &labels, None, &model.label_set, config)
}
