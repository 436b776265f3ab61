//! Strong classifiers with calibrated probabilities over a registry of named figures, and their files.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{DecisionStump, Polarity, StrongClassifier, WeightedStump};
use crate::features::FeatureId;

/// Largest vote, slope and offset: with these bounds no sum or product is infinite.
const MAX_NUMBER: f64 = 1e6;

/// A strong classifier with the logistic function that makes a probability of its score F: 1 / (1 + exp(−(slope F + offset))).
#[derive(Clone, Debug, PartialEq)]
pub struct Calibrated {
    /// Boosted stumps; features are positions in a registry of figures.
    pub classifier: StrongClassifier,
    /// Slope of the logistic function.
    pub slope: f64,
    /// Its offset.
    pub offset: f64,
}

impl Calibrated {
    /// The probability for these figures.
    pub fn probability(&self, figures: &[f32]) -> f64 {
        let score = self.classifier.score(|id| figures[id.0 as usize]);
        1.0 / (1.0 + (-(self.slope * score + self.offset)).exp())
    }
}

/// Why bytes are no file of calibrated classifiers.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CalibratedFileError {
    /// No JSON, or not the fields of such a file.
    #[error("expected a model of stumps, found {0}")]
    Json(String),
    /// Another format or version.
    #[error("expected the format {expected:?}, version {VERSION}, found {format:?}, version {version}")]
    Format {
        /// The format that was expected.
        expected: &'static str,
        /// The format that the file names.
        format: String,
        /// Its version.
        version: u32,
    },
    /// Other classifiers than those of the format.
    #[error("expected the classifiers {expected}, found {found}")]
    Classifiers {
        /// Names of the expected classifiers.
        expected: String,
        /// Names of those in the file.
        found: String,
    },
    /// A figure that this program does not measure.
    #[error("expected a figure of this version's registry, found {0:?}")]
    Figure(String),
    /// A stump whose figure is not listed, or a number out of range.
    #[error("expected numbers up to {MAX_NUMBER}, votes of at least 0 and listed figures, found {0}")]
    Stump(String),
}

/// The version of all formats.
const VERSION: u32 = 1;

/// A kind of file: its name, its classifiers in alphabetical order, and the names of the figures.
pub(crate) struct CalibratedFormat<const N: usize> {
    pub(crate) name: &'static str,
    pub(crate) classifiers: [&'static str; N],
    pub(crate) figures: fn() -> Vec<&'static str>,
}

#[derive(Serialize, Deserialize)]
struct File {
    format: String,
    version: u32,
    sources: Vec<String>,
    /// Names of the figures; stumps give the position.
    figures: Vec<String>,
    #[serde(flatten)]
    classifiers: BTreeMap<String, Entry>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    slope: f64,
    offset: f64,
    /// Figure, threshold, polarity, alpha.
    stumps: Vec<(u16, f32, i8, f64)>,
}

impl<const N: usize> CalibratedFormat<N> {
    /// The classifiers and their sources.
    pub(crate) fn read(&self, bytes: &[u8]) -> Result<([Calibrated; N], Vec<String>), CalibratedFileError> {
        let mut file: File =
            serde_json::from_slice(bytes).map_err(|error| CalibratedFileError::Json(error.to_string()))?;
        if file.format != self.name || file.version != VERSION {
            let (format, version) = (file.format, file.version);
            return Err(CalibratedFileError::Format { expected: self.name, format, version });
        }
        let names: Vec<&str> = file.classifiers.keys().map(String::as_str).collect();
        if names != self.classifiers {
            let (expected, found) = (self.classifiers.join(", "), names.join(", "));
            return Err(CalibratedFileError::Classifiers { expected, found });
        }
        let registry = (self.figures)();
        let position = |name: &String| {
            let found = registry.iter().position(|known| known == name).map(|at| FeatureId(at as u16));
            found.ok_or_else(|| CalibratedFileError::Figure(name.clone()))
        };
        let figures = file.figures.iter().map(position).collect::<Result<Vec<_>, _>>()?;
        let mut read = Vec::with_capacity(N);
        while let Some((_, entry)) = file.classifiers.pop_first() {
            read.push(entry.into_classifier(&figures)?);
        }
        let read = read.try_into().map_err(|_| CalibratedFileError::Json("too few classifiers".into()))?;
        Ok((read, file.sources))
    }

    /// The bytes of the file: the same classifiers give the same bytes.
    #[expect(clippy::expect_used, reason = "writing to memory cannot fail")]
    pub(crate) fn write(&self, classifiers: [&Calibrated; N], sources: &[String]) -> Vec<u8> {
        let stumps = classifiers.iter().flat_map(|calibrated| &calibrated.classifier.stumps);
        let mut used: Vec<FeatureId> = stumps.map(|weighted| weighted.stump.feature).collect();
        used.sort_unstable();
        used.dedup();
        let registry = (self.figures)();
        let entries = self.classifiers.iter().zip(classifiers);
        let file = File {
            format: self.name.to_owned(),
            version: VERSION,
            sources: sources.to_vec(),
            figures: used.iter().map(|id| registry[id.0 as usize].to_owned()).collect(),
            classifiers: entries.map(|(&name, of)| (name.to_owned(), Entry::new(of, &used))).collect(),
        };
        let mut bytes = serde_json::to_vec(&file).expect("a file in memory");
        bytes.push(b'\n');
        bytes
    }
}

impl Entry {
    fn new(of: &Calibrated, used: &[FeatureId]) -> Self {
        let row = |weighted: &WeightedStump| {
            let DecisionStump { feature, threshold, polarity } = weighted.stump;
            let sign = if polarity == Polarity::Below { 1 } else { -1 };
            (used.partition_point(|&id| id < feature) as u16, threshold, sign, weighted.alpha)
        };
        let stumps = of.classifier.stumps.iter().map(row).collect();
        Self { slope: of.slope, offset: of.offset, stumps }
    }

    fn into_classifier(self, figures: &[FeatureId]) -> Result<Calibrated, CalibratedFileError> {
        let is_bounded = |v: f64| v.abs() <= MAX_NUMBER;
        if !(is_bounded(self.slope) && is_bounded(self.offset)) {
            return Err(CalibratedFileError::Stump(format!("slope {}, offset {}", self.slope, self.offset)));
        }
        let stump = |(at, threshold, sign, alpha): (u16, f32, i8, f64)| {
            let polarity = match sign {
                1 => Polarity::Below,
                -1 => Polarity::Above,
                _ => return Err(CalibratedFileError::Stump(format!("polarity {sign}"))),
            };
            let feature = figures.get(at as usize).copied();
            let feature = feature.ok_or_else(|| CalibratedFileError::Stump(format!("figure {at}")))?;
            if !(threshold.is_finite() && is_bounded(alpha) && alpha >= 0.0) {
                return Err(CalibratedFileError::Stump(format!("threshold {threshold}, vote {alpha}")));
            }
            Ok(WeightedStump { stump: DecisionStump { feature, threshold, polarity }, alpha })
        };
        let stumps = self.stumps.into_iter().map(stump).collect::<Result<Vec<_>, _>>()?;
        Ok(Calibrated { classifier: StrongClassifier { stumps }, slope: self.slope, offset: self.offset })
    }
}
