//! What was learned of gates: boosted stumps over their figures, with calibrated probabilities, and its file.

use serde::{Deserialize, Serialize};

use super::figures::{self, REGISTRY};
use crate::boost::{DecisionStump, Polarity, StrongClassifier, WeightedStump};
use crate::features::FeatureId;

/// The format's name, first in the file.
const FORMAT: &str = "placegraph-gates";
/// The format's version.
const VERSION: u32 = 1;
/// The gates that the program comes with (`docs/default-model.md`).
const BUILTIN: &[u8] = include_bytes!("../../assets/gates.json");

/// A strong classifier with the logistic function that makes a probability of its score F: 1 / (1 + exp(−(slope F + offset))).
#[derive(Clone, Debug, PartialEq)]
pub struct Calibrated {
    /// Boosted stumps; features are positions in the registry of figures.
    pub classifier: StrongClassifier,
    /// Slope of the logistic function.
    pub slope: f64,
    /// Its offset.
    pub offset: f64,
}

impl Calibrated {
    /// The probability for a gate with these figures.
    pub fn probability(&self, figures: &[f32]) -> f64 {
        let score = self.classifier.score(|id| figures[id.0 as usize]);
        1.0 / (1.0 + (-(self.slope * score + self.offset)).exp())
    }
}

/// What a gate is, learned from buildings whose doors and rooms are known.
#[derive(Clone, Debug, PartialEq)]
pub struct GateModel {
    /// Whether a gate is a doorway.
    pub doorway: Calibrated,
    /// Whether a gate parts two spaces, as a doorway or as an opening without a door.
    pub parting: Calibrated,
    /// Where the model comes from, for people.
    pub sources: Vec<String>,
}

/// Why bytes are no model of gates.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GateModelError {
    /// No JSON, or not the fields of a model of gates.
    #[error("expected a model of gates, found {0}")]
    Json(String),
    /// Another format or version.
    #[error("expected the format {FORMAT:?}, version {VERSION}, found {format:?}, version {version}")]
    Format {
        /// The format that the file names.
        format: String,
        /// Its version.
        version: u32,
    },
    /// A figure that this program does not measure.
    #[error("expected a figure of this version's registry, found {0:?}")]
    Figure(String),
    /// A stump whose figure is not listed, or a number out of range.
    #[error("expected finite numbers, votes of at least 0 and listed figures, found {0}")]
    Stump(String),
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ModelFile {
    format: String,
    version: u32,
    sources: Vec<String>,
    /// Names of the figures; stumps give the position.
    figures: Vec<String>,
    doorway: CalibratedFile,
    parting: CalibratedFile,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CalibratedFile {
    slope: f64,
    offset: f64,
    /// Figure, threshold, polarity, alpha.
    stumps: Vec<(u16, f32, i8, f64)>,
}

impl GateModel {
    /// The model inside the program.
    ///
    /// # Panics
    /// Never: a test reads it.
    #[expect(clippy::expect_used, reason = "the asset is read by a test")]
    pub fn builtin() -> Self {
        Self::from_json(BUILTIN).expect("the program's own model")
    }

    /// Reads a model file.
    ///
    /// # Errors
    /// If the bytes are no model of this version, name an unknown figure, or hold a number out of range.
    pub fn from_json(bytes: &[u8]) -> Result<Self, GateModelError> {
        let file: ModelFile =
            serde_json::from_slice(bytes).map_err(|error| GateModelError::Json(error.to_string()))?;
        if file.format != FORMAT || file.version != VERSION {
            return Err(GateModelError::Format { format: file.format, version: file.version });
        }
        let position = |name: &String| {
            let found = figures::position(name).map(|at| FeatureId(at as u16));
            found.ok_or_else(|| GateModelError::Figure(name.clone()))
        };
        let figures = file.figures.iter().map(position).collect::<Result<Vec<_>, _>>()?;
        Ok(Self {
            doorway: file.doorway.into_classifier(&figures)?,
            parting: file.parting.into_classifier(&figures)?,
            sources: file.sources,
        })
    }

    /// The model as bytes of a file: the same model gives the same bytes.
    #[expect(clippy::expect_used, reason = "writing to memory cannot fail")]
    pub fn to_json(&self) -> Vec<u8> {
        let stumps = self.doorway.classifier.stumps.iter().chain(&self.parting.classifier.stumps);
        let mut used: Vec<FeatureId> = stumps.map(|weighted| weighted.stump.feature).collect();
        used.sort_unstable();
        used.dedup();
        let file = ModelFile {
            format: FORMAT.to_owned(),
            version: VERSION,
            sources: self.sources.clone(),
            figures: used.iter().map(|id| REGISTRY[id.0 as usize].name.to_owned()).collect(),
            doorway: CalibratedFile::new(&self.doorway, &used),
            parting: CalibratedFile::new(&self.parting, &used),
        };
        let mut bytes = serde_json::to_vec(&file).expect("a file in memory");
        bytes.push(b'\n');
        bytes
    }
}

impl CalibratedFile {
    fn new(of: &Calibrated, used: &[FeatureId]) -> Self {
        let row = |weighted: &WeightedStump| {
            let DecisionStump { feature, threshold, polarity } = weighted.stump;
            let sign = if polarity == Polarity::Below { 1 } else { -1 };
            (used.partition_point(|&id| id < feature) as u16, threshold, sign, weighted.alpha)
        };
        let stumps = of.classifier.stumps.iter().map(row).collect();
        Self { slope: of.slope, offset: of.offset, stumps }
    }

    fn into_classifier(self, figures: &[FeatureId]) -> Result<Calibrated, GateModelError> {
        if !(self.slope.is_finite() && self.offset.is_finite()) {
            return Err(GateModelError::Stump(format!("slope {}, offset {}", self.slope, self.offset)));
        }
        let stump = |(at, threshold, sign, alpha): (u16, f32, i8, f64)| {
            let polarity = match sign {
                1 => Polarity::Below,
                -1 => Polarity::Above,
                _ => return Err(GateModelError::Stump(format!("polarity {sign}"))),
            };
            let feature = figures.get(at as usize).copied();
            let feature = feature.ok_or_else(|| GateModelError::Stump(format!("figure {at}")))?;
            if !(threshold.is_finite() && alpha.is_finite() && alpha >= 0.0) {
                return Err(GateModelError::Stump(format!("threshold {threshold}, vote {alpha}")));
            }
            Ok(WeightedStump { stump: DecisionStump { feature, threshold, polarity }, alpha })
        };
        let stumps = self.stumps.into_iter().map(stump).collect::<Result<Vec<_>, _>>()?;
        Ok(Calibrated { classifier: StrongClassifier { stumps }, slope: self.slope, offset: self.offset })
    }
}
