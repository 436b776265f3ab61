//! The settings of training.

use serde::Serialize;

use super::TrainError;
use crate::features::{self, FeatureId};
use crate::regions::Thresholds;
use crate::relax::{LEAST_COMPATIBLE, RelaxConfig};
use crate::scan::ScanConfig;

/// Rounds of boosting in the chapter's setting.
pub(super) const CHAPTER_ROUNDS: usize = 100;
/// Temperature of Eq. (4.2).
pub(super) const CHAPTER_TEMPERATURE: f64 = 1.0;

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

/// The settings of training.
#[derive(Clone, Debug, PartialEq)]
pub struct TrainConfig {
    /// Features that boosting may use. Default: all.
    pub features: Vec<FeatureId>,
    /// How scans are simulated. The scans that are learned from see specks, whatever it says of them.
    pub scan: ScanConfig,
    /// Every scan is seen at each of these scales: its ranges are multiplied (Sect. 4.8.2). Default: 1 alone.
    pub scales: Vec<f64>,
    /// Number of boosting rounds T. Default: one of 25, 50, 100, 200, 400.
    pub rounds: Choice<usize>,
    /// Temperature of the confidences. Default: one of 1 to 16.
    pub temperature: Choice<f64>,
    /// Number of parts that are held out, one after the other. Default 4.
    pub n_folds: usize,
    /// Side of the square blocks that are held out as a whole, in meters. Default 4.
    pub block_m: f64,
    /// Of a class with more cells, every n-th is taken, so that at most so many remain. Default: all are taken.
    pub max_cells_per_class: Option<usize>,
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
            scales: vec![1.0],
            rounds: Choice::Among(vec![25, 50, 100, 200, 400]),
            temperature: Choice::Among(vec![1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0]),
            n_folds: 4,
            block_m: 4.0,
            max_cells_per_class: None,
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
            least_compatible: -1.0,
            thresholds: Thresholds { min_island_m2: 0.0, ..Thresholds::default() },
            ..Self::default()
        }
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
        check(
            self.scan.is_valid(),
            "scan",
            "ranges above 0 to 10000 m, a scale above 0 to 100, specks to 2 m",
        )?;
        check(
            !self.scales.is_empty() && self.scales.iter().all(|&s| above_0(&s) && s <= ScanConfig::MAX_SCALE),
            "scales",
            "one or more numbers above 0 to 100",
        )?;
        let rounds = self.rounds.candidates();
        check(!rounds.is_empty() && rounds.iter().all(|&t| t > 0), "rounds", "one or more numbers above 0")?;
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
