//! Progress reports of long work. The library itself neither prints nor reads a clock.

use std::fmt;

/// The stages of the pipeline and of training, in the words shown to people.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Stage {
    /// Scans are simulated, features computed and cells classified (Sect. 4.2 to 4.4, or 4.6.1).
    Classify,
    /// Relaxation labeling (Sect. 4.5), or the network's inference (Sect. 4.6).
    Smooth,
    /// Narrow passages become doorways (not in the chapter).
    Doorways,
    /// The spaces between doorways are labeled as a whole (not in the chapter).
    Spaces,
    /// Regions are formed (Sect. 4.7).
    Regions,
    /// Regions that are too small are relabeled (Sect. 4.7).
    Correct,
    /// Corrections by hand are applied.
    Edits,
    /// The topological map is built (Sect. 4.7).
    Topology,
    /// Places keep the numbers and names of an earlier result.
    Identity,
    /// Training: features of the labeled cells.
    Features,
    /// Training: boosting, one classifier per class.
    Boost,
    /// Training: cross-validation of order, rounds and temperature.
    Validate,
    /// Training: features of the network are selected and distances to the exemplars computed.
    Select,
    /// Training: the network is validated and its weights learned.
    Learn,
}

impl Stage {
    /// Name for people and files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Classify => "classify",
            Self::Smooth => "smooth",
            Self::Doorways => "doorways",
            Self::Spaces => "spaces",
            Self::Regions => "regions",
            Self::Correct => "correct",
            Self::Edits => "edits",
            Self::Topology => "topology",
            Self::Identity => "identity",
            Self::Features => "features",
            Self::Boost => "boost",
            Self::Validate => "validate",
            Self::Select => "select",
            Self::Learn => "learn",
        }
    }
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Receives progress. Calls may come from several threads.
pub trait Progress: Sync {
    /// `stage` begins; the one before it is done.
    fn begin(&self, stage: Stage);
    /// `done` of `total` units of the stage are finished.
    fn advance(&self, done: usize, total: usize);
}

/// Reports the work on one of several equal parts of a stage as progress of the whole stage.
pub(crate) struct Part<'a> {
    pub(crate) of: &'a dyn Progress,
    /// Number of the part, from 0.
    pub(crate) number: usize,
    pub(crate) n_parts: usize,
}

impl Progress for Part<'_> {
    fn begin(&self, _: Stage) {}

    fn advance(&self, done: usize, total: usize) {
        self.of.advance(self.number * total + done, self.n_parts * total);
    }
}

/// Ignores progress.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn begin(&self, _: Stage) {}
    fn advance(&self, _: usize, _: usize) {}
}
