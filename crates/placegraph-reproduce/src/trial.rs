//! The experiments of Sect. 4.8.1 and 4.8.2, and every building as training map of every other one.

use anyhow::Result;
use placegraph::grid::Grid;
use placegraph::labels::{Label, LabelSet};
use placegraph::pipeline::Config;
use placegraph::progress::Progress;
use placegraph::training::{LabeledMap, TrainConfig, train};

use super::buildings::Building;
use super::errors::errors;
use super::experiment::{Run, label, run};
use super::results::{Experiment, Pair, Published};
use super::settings::Settings;
use super::stages;

/// An experiment before it is made.
#[derive(Debug)]
pub(super) struct Trial<'a> {
    section: &'static str,
    id: &'static str,
    pub(super) title: &'static str,
    published: Published,
    training: Vec<LabeledMap>,
    pub(super) test: &'a Building,
    /// First column of the test part.
    pub(super) first: u32,
    chapter: TrainConfig,
    best: TrainConfig,
}

/// An experiment after it was made.
#[derive(Debug)]
pub(super) struct Made {
    pub(super) result: Experiment,
    pub(super) chapter: Run,
    pub(super) best: Run,
    pub(super) truth: Grid<Option<Label>>,
}

/// The chapter's three experiments with the decision list.
pub(super) fn trials<'a>([b79, b52, sdr]: &'a [Building; 3], settings: &Settings) -> [Trial<'a>; 3] {
    let within = |id, title, published, building: &'a Building| Trial {
        section: "4.8.1",
        id,
        title,
        published,
        training: vec![building.left()],
        test: building,
        first: building.split,
        chapter: settings.chapter(),
        best: settings.best(),
    };
    let published = |list, corrected| Published { list, corrected };
    [
        within("building-79", "Building 79, left part to right part", published(97.27, 98.95), b79),
        within("building-52", "Building 52, left part to right part", published(97.0, 98.66), b52),
        Trial {
            section: "4.8.2",
            id: "sdr-site-b",
            title: "Both left parts at several scales to SDR site B",
            published: published(92.36, 96.94),
            training: vec![b79.left(), b52.left()],
            test: sdr,
            first: 0,
            chapter: settings.scaled(settings.chapter()),
            best: settings.scaled(settings.best()),
        },
    ]
}

impl Trial<'_> {
    /// Trains and labels in both settings.
    pub(super) fn make(&self, progress: &dyn Progress) -> Result<Made> {
        let truth = self.test.truth_from(self.first);
        let chapter = run(&self.training, self.test, &truth, &self.chapter, &Config::chapter(), progress)?;
        let best = run(&self.training, self.test, &truth, &self.best, &Config::default(), progress)?;
        let result = Experiment {
            section: self.section,
            id: self.id,
            title: self.title,
            published: self.published,
            chapter: chapter.setting.clone(),
            best: best.setting.clone(),
            corrections: stages::corrections(&chapter, &truth),
            errors: errors(self.test, &chapter.analysis, &truth),
        };
        Ok(Made { result, chapter, best, truth })
    }
}

/// Every building in turn for training, whole, and the others for the test.
pub(super) fn pairs(
    buildings: &[Building; 3],
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<Vec<Pair>> {
    let chapter = settings.thinned(settings.chapter());
    let best = settings.thinned(settings.best());
    let label_set = LabelSet::default();
    let mut pairs = Vec::new();
    for (number, training) in buildings.iter().enumerate() {
        let maps = std::slice::from_ref(&training.map);
        let chapter = train(maps, &label_set, &chapter, progress)?;
        let best = train(maps, &label_set, &best, progress)?;
        for (_, test) in buildings.iter().enumerate().filter(|(other, _)| *other != number) {
            let truth = test.truth_from(0);
            pairs.push(Pair {
                train: training.title,
                test: test.title,
                chapter: label(chapter.clone(), test, &truth, &Config::chapter(), progress)?.setting,
                best: label(best.clone(), test, &truth, &Config::default(), progress)?.setting,
            });
        }
    }
    Ok(pairs)
}
