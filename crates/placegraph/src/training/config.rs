//! The settings of training.

use serde::Serialize;

use super::TrainError;
use crate::boost::{DecisionList, StrongClassifier};
use crate::features::{self, FeatureId};
use crate::labels::LabelSet;
use crate::model::{Method, Model};
use crate::regions::Thresholds;
use crate::relax::{LEAST_COMPATIBLE, RelaxConfig};
use crate::scan::{OutOfRange, ScanConfig};

/// Rounds of boosting in the chapter's setting.
pub(super) const CHAPTER_ROUNDS: usize = 100;
/// Temperature of Eq. (4.2).
pub(super) const CHAPTER_TEMPERATURE: f64 = 1.0;

/// Scales at which the cells of one building teach others.
const BUILDING_SCALES: [f64; 4] = [0.7, 1.0, 1.4, 2.0];
/// Cells of a class that are enough: neighbors see nearly the same.
const CELLS_PER_CLASS: usize = 3000;

/// A number that is given, or chosen from candidates on held-out examples.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Choice<T> {
    /// This one.
    Set(T),
    /// The one of these that does best, in ascending order.
    Among(Vec<T>),
}

impl<T: Copy> Choice<T> {
    /// The numbers to choose from.
    pub fn candidates(&self) -> &[T] {
        match self {
            Self::Set(value) => std::slice::from_ref(value),
            Self::Among(values) => values,
        }
    }

    /// The number that is given, or `default` where nothing can be chosen.
    pub(super) fn set_or(&self, default: T) -> T {
        match self {
            Self::Set(value) => *value,
            Self::Among(_) => default,
        }
    }
}

/// What is held out as a whole, to judge what was not learned from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum HoldOut {
    /// All maps of a building; square blocks where that leaves a class without a cell.
    #[default]
    Buildings,
    /// Square blocks of the maps.
    Blocks,
}

/// The settings of training.
#[derive(Clone, Debug, PartialEq)]
pub struct TrainConfig {
    /// Features that boosting may use. Default: all.
    pub features: Vec<FeatureId>,
    /// How scans are simulated. Training scans always end at specks, whatever this says.
    pub scan: ScanConfig,
    /// Every scan is seen at each of these scales: its ranges are multiplied (Sect. 4.8.2). Default:
    /// 0.7, 1, 1.4 and 2, so that a building of another size is like one that was seen; the chapter's setting: 1 alone.
    pub scales: Vec<f64>,
    /// Number of boosting rounds T. Default: one of 25, 50, 100, 200, 400.
    pub rounds: Choice<usize>,
    /// Temperature of the confidences. Default: one of 1 to 16.
    pub temperature: Choice<f64>,
    /// What is held out as a whole. Default: buildings, where there are two or more.
    pub hold_out: HoldOut,
    /// Number of parts that are held out, one after the other. Default 4; fewer where there are fewer buildings.
    pub n_folds: usize,
    /// Side of the square blocks that are held out where no building can be, in meters. Default 4.
    pub block_m: f64,
    /// Of a class with more cells, every n-th is taken, so that at most so many remain. Default: 3000; the
    /// chapter's setting: all are taken.
    pub max_cells_per_class: Option<usize>,
    /// Whether models that see less are trained too, for the report ([`TrainingReport::curve`](super::TrainingReport::curve)).
    /// Default: no.
    pub learning_curve: bool,
    /// The model to start from: boosting goes on from its stumps, with its features, scans, order, temperature and compatibilities.
    /// Default: none.
    pub base: Option<Model>,
    /// Least compatibility coefficient. Default −0.999.
    pub least_compatible: f64,
    /// The relaxation's length, for the model.
    pub relaxation: RelaxConfig,
    /// When a region is too small for its class, for the model.
    pub thresholds: Thresholds,
}

impl Default for TrainConfig {
    fn default() -> Self {
        Self {
            features: features::all(),
            scan: ScanConfig::default(),
            scales: BUILDING_SCALES.to_vec(),
            rounds: Choice::Among(vec![25, 50, 100, 200, 400]),
            temperature: Choice::Among(vec![1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0]),
            hold_out: HoldOut::Buildings,
            n_folds: 4,
            block_m: 4.0,
            max_cells_per_class: Some(CELLS_PER_CLASS),
            learning_curve: false,
            base: None,
            least_compatible: LEAST_COMPATIBLE,
            relaxation: RelaxConfig::default(),
            thresholds: Thresholds::default(),
        }
    }
}

impl TrainConfig {
    /// The chapter's own setting: 100 rounds, confidences as in Eq. (4.2), compatibilities as in Eq. (4.8).
    pub fn chapter() -> Self {
        Self {
            rounds: Choice::Set(CHAPTER_ROUNDS),
            temperature: Choice::Set(CHAPTER_TEMPERATURE),
            scales: vec![1.0],
            max_cells_per_class: None,
            least_compatible: -1.0,
            thresholds: Thresholds { min_island_m2: 0.0, ..Thresholds::default() },
            ..Self::default()
        }
    }

    /// The default settings for more maps on top of `base`: as many rounds as help on held-out cells, none if none does.
    pub fn from_base(base: Model) -> Self {
        let boosted = match &base.method {
            Method::Boosted(boosted) => Some(boosted),
            Method::Iamn(_) => None,
        };
        Self {
            features: boosted.map_or_else(Vec::new, |boosted| boosted.list.columns()),
            scan: base.scan,
            rounds: Choice::Among(vec![0, 5, 10, 25, 50, 100]),
            temperature: Choice::Set(boosted.map_or(CHAPTER_TEMPERATURE, |boosted| boosted.list.temperature)),
            relaxation: boosted.map_or_else(RelaxConfig::default, |boosted| boosted.relaxation),
            thresholds: base.thresholds,
            base: Some(base),
            ..Self::default()
        }
    }

    /// The decision list to start from.
    pub(super) fn base_list(&self) -> Option<&DecisionList> {
        match &self.base.as_ref()?.method {
            Method::Boosted(boosted) => Some(&boosted.list),
            Method::Iamn(_) => None,
        }
    }

    /// The classifiers to start from, one for each class.
    pub(super) fn base_classifiers(&self, n_labels: usize) -> Vec<StrongClassifier> {
        let none = || vec![StrongClassifier::default(); n_labels];
        self.base_list().map_or_else(none, |list| list.classifiers.clone())
    }

    /// `classifiers` as they were `n_rounds` after those to start from.
    pub(super) fn truncated(
        &self,
        classifiers: &[StrongClassifier],
        n_rounds: usize,
    ) -> Vec<StrongClassifier> {
        let base = self.base_classifiers(classifiers.len());
        classifiers.iter().zip(&base).map(|(c, base)| c.truncated(base.stumps.len() + n_rounds)).collect()
    }

    /// # Errors
    /// If the model to start from has other classes, or is of another method.
    pub(super) fn check_base(&self, label_set: &LabelSet) -> Result<(), TrainError> {
        let Some(base) = &self.base else { return Ok(()) };
        if self.base_list().is_none() {
            return Err(TrainError::BaseMethod { found: base.method.name() });
        }
        let names = |set: &LabelSet| set.classes().iter().map(|class| class.name.clone()).collect::<Vec<_>>();
        let (expected, found) = (names(&base.label_set), names(label_set));
        if expected == found { Ok(()) } else { Err(TrainError::BaseClasses { expected, found }) }
    }

    /// # Errors
    /// If a number is outside the range in which training means anything.
    pub fn validate(&self) -> Result<(), TrainError> {
        let check = |holds: bool, field, expected| {
            if holds { Ok(()) } else { Err(TrainError::Setting { field, expected }) }
        };
        let above_0 = |value: &f64| value.is_finite() && *value > 0.0;
        let mut distinct = self.features.clone();
        distinct.sort_unstable();
        distinct.dedup();
        check(!distinct.is_empty(), "features", "at least one")?;
        check(distinct.len() == self.features.len(), "features", "every feature once")?;
        let setting = |OutOfRange { field, expected, .. }| TrainError::Setting { field, expected };
        self.scan.check().map_err(setting)?;
        check(
            (1..=255).contains(&self.scales.len())
                && self.scales.iter().all(|&s| above_0(&s) && s <= ScanConfig::MAX_SCALE),
            "scales",
            "one or more numbers above 0 to 100",
        )?;
        let rounds = self.rounds.candidates();
        let least = usize::from(self.base.is_none());
        let are_enough = !rounds.is_empty() && rounds.iter().all(|&t| t >= least);
        check(are_enough, "rounds", "one or more numbers above 0")?;
        let temperatures = self.temperature.candidates();
        check(
            !temperatures.is_empty() && temperatures.iter().all(above_0),
            "temperature",
            "one or more numbers above 0",
        )?;
        check((2..=64).contains(&self.n_folds), "n_folds", "2 to 64")?;
        check(above_0(&self.block_m), "block_m", "a number above 0")?;
        check(self.max_cells_per_class != Some(0), "max_cells_per_class", "a number above 0")?;
        check((-1.0..=0.0).contains(&self.least_compatible), "least_compatible", "a number from -1 to 0")
    }

    /// The settings for the model's record; features by number only, because the model names those it uses.
    pub(super) fn settings(&self) -> serde_json::Value {
        serde_json::json!({
            "n_features": self.features.len(),
            "scales": self.scales,
            "rounds": self.rounds,
            "temperature": self.temperature,
            "hold_out": self.hold_out,
            "base": self.base.as_ref().map(Model::hash),
            "n_folds": self.n_folds,
            "block_m": self.block_m,
            "max_cells_per_class": self.max_cells_per_class,
            "least_compatible": self.least_compatible,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_valid_and_nonsense_is_refused() {
        assert_eq!(TrainConfig::default().validate(), Ok(()));
        assert_eq!(TrainConfig::chapter().validate(), Ok(()));
        let bad = [
            TrainConfig { features: vec![], ..Default::default() },
            TrainConfig { features: vec![FeatureId(0); 2], ..Default::default() },
            TrainConfig { scales: vec![1.0, f64::NAN], ..Default::default() },
            TrainConfig { rounds: Choice::Set(0), ..Default::default() },
            TrainConfig { temperature: Choice::Among(vec![]), ..Default::default() },
            TrainConfig { n_folds: 1, ..Default::default() },
            TrainConfig { block_m: 0.0, ..Default::default() },
            TrainConfig { max_cells_per_class: Some(0), ..Default::default() },
            TrainConfig { least_compatible: 0.5, ..Default::default() },
        ];
        for config in bad {
            assert!(matches!(config.validate(), Err(TrainError::Setting { .. })), "{config:?}");
        }
    }
}
