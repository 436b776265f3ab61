//! One experiment: a model in the chapter's setting and one in the best, on the same test map.
//!
//! The whole map is labeled, as users do it; only the cells of the test part count.

use anyhow::{Result, bail};
use placegraph::grid::{Cell, Grid};
use placegraph::labels::{Label, LabelSet};
use placegraph::model::{BoostedModel, Method, Model};
use placegraph::pipeline::{self, Analysis, Config};
use placegraph::progress::Progress;
use placegraph::training::{LabeledMap, TrainConfig, Trained, train};

use super::buildings::Building;
use super::results::{Setting, names, score};

/// A trained model and what it made of the test map.
#[derive(Debug)]
pub(super) struct Run {
    pub(super) trained: Trained,
    pub(super) analysis: Analysis,
    pub(super) setting: Setting,
}

/// Trains on `maps` and labels `test`, of which the cells in `truth` count.
pub(super) fn run(
    maps: &[LabeledMap],
    test: &Building,
    truth: &Grid<Option<Label>>,
    config: &TrainConfig,
    stages: &Config,
    progress: &dyn Progress,
) -> Result<Run> {
    let trained = train(maps, &LabelSet::default(), config, progress)?;
    label(trained, test, truth, stages, progress)
}

/// Labels `test` with a trained model.
pub(super) fn label(
    trained: Trained,
    test: &Building,
    truth: &Grid<Option<Label>>,
    stages: &Config,
    progress: &dyn Progress,
) -> Result<Run> {
    let analysis = pipeline::analyze(&test.map.grid, &trained.model, stages, progress);
    let cells: &[Cell] = analysis.space.graph.cells();
    let boosted = boosted(&trained.model)?;
    let setting = Setting {
        n_training_cells: trained.report.n_examples.iter().sum(),
        rounds: boosted.list.classifiers.iter().map(|c| c.stumps.len()).max().unwrap_or(0),
        temperature: boosted.list.temperature,
        order: names(&boosted.list.order),
        list: score(cells, &analysis.classified, truth),
        relaxed: score(cells, &analysis.smoothed.most_likely(), truth),
        corrected: score(cells, &analysis.labeling, truth),
        n_places: analysis.topology.places.len(),
    };
    Ok(Run { trained, analysis, setting })
}

/// The boosted method of a model that has it.
pub(super) fn boosted(model: &Model) -> Result<&BoostedModel> {
    match &model.method {
        Method::Boosted(boosted) => Ok(boosted),
        _ => bail!("expected a boosted model"),
    }
}
