//! How long work reports where it is. The library itself neither prints nor reads a clock.

use std::fmt;

/// The stages of the pipeline and of training, in the words shown to people.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Stage {
    /// Scans are simulated, features computed and cells classified.
    Classify,
    /// Relaxation labeling, or the network's inference.
    Smooth,
    /// Regions are formed and corrected.
    Correct,
    /// The topological map is built.
    Topology,
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
            Self::Correct => "correct",
            Self::Topology => "topology",
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

/// Hears where the work is. Calls may come from several threads.
pub trait Progress: Sync {
    /// `stage` begins; the one before it is done.
    fn begin(&self, stage: Stage);
    /// `done` of `total` units of the stage are finished.
    fn advance(&self, done: usize, total: usize);
}

/// Hears nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn begin(&self, _: Stage) {}
    fn advance(&self, _: usize, _: usize) {}
}
