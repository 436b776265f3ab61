//! The model file: versioned JSON that names classes and features. It is read exactly or not at all.

use serde::{Deserialize, Serialize};

use super::{BoostedModel, Method, Model, NetworkModel, TrainingRecord, sha256_hex};
use crate::amn::IamnModel;
use crate::boost::{DecisionList, DecisionStump, Polarity, StrongClassifier, WeightedStump};
use crate::doorways::figure_table;
use crate::features::FeatureId;
use crate::labels::{Label, LabelSet};
use crate::regions::Thresholds;
use crate::relax::{Compatibility, RelaxConfig};
use crate::scan::{OutOfRange, ScanConfig};
use crate::syntax::SyntaxError;

/// The name of the format, first in the file.
pub const FORMAT: &str = "placegraph-model";
/// The version of the format that this program writes, and the only one that it reads.
pub const VERSION: u32 = 1;
/// Largest file that is read, in bytes.
pub const MAX_BYTES: usize = 64 << 20;
/// Largest vote of a stump: perfect ones have about 20, and sums of votes are of 32 bits.
const MAX_ALPHA: f64 = 1e6;
/// Largest number of relaxation iterations that a model may ask for.
const MAX_ITERATIONS: u32 = 100_000;

/// Why bytes are not a model that this program can use.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// More bytes than any model has.
    #[error("expected a model of at most {MAX_BYTES} bytes, found {found}")]
    TooLarge {
        /// Number of bytes.
        found: usize,
    },
    /// No JSON, or not the fields of a model.
    #[error("this is not a placegraph model: {source}")]
    Json {
        /// What is wrong, with line and column.
        source: SyntaxError,
    },
    /// JSON of something else.
    #[error("expected the format {FORMAT:?}, found {found:?}")]
    Format {
        /// The format that the file names.
        found: String,
    },
    /// A model of another version.
    #[error("expected version {VERSION} of the model format, found version {found}")]
    Version {
        /// The version that the file names.
        found: u64,
    },
    /// A feature that this program cannot compute.
    #[error("the model uses the feature {name:?}, which this version of placegraph does not have")]
    Feature {
        /// Its name.
        name: String,
    },
    /// A class that the label set lacks.
    #[error("the order of the decision list names {name:?}, which is not a class of the model")]
    Class {
        /// The name found.
        name: String,
    },
    /// A list of another length.
    #[error("expected {expected} {of}, found {found}")]
    Count {
        /// What is counted.
        of: &'static str,
        /// How many there must be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// A name or class occurs twice in a list that may have it once.
    #[error("expected each of the {of} once, found {name:?} twice")]
    Twice {
        /// What is listed.
        of: &'static str,
        /// What is there twice.
        name: String,
    },
    /// A number outside its range.
    #[error("expected {expected} as {field}, found {found}")]
    Value {
        /// The number's name in the file.
        field: &'static str,
        /// Its range.
        expected: &'static str,
        /// The number found.
        found: f64,
    },
}

/// The fields that decide whether the rest can be read.
#[derive(Deserialize)]
struct Header {
    format: String,
    version: u64,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ModelFile {
    format: String,
    version: u32,
    label_set: LabelSet,
    scan: ScanConfig,
    method: MethodFile,
    /// Figure, threshold, polarity, alpha.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    doorways: Vec<(String, f32, i8, f64)>,
    thresholds: Thresholds,
    record: TrainingRecord,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum MethodFile {
    Boosted(BoostedFile),
    Iamn(NetworkFile),
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct NetworkFile {
    list: Option<ListFile>,
    network: IamnModel,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ListFile {
    order: Vec<String>,
    temperature: f64,
    /// Names of the features; stumps give the position.
    features: Vec<String>,
    /// Per class: feature, threshold, polarity, alpha.
    classifiers: Vec<Vec<(u32, f32, i8, f64)>>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct BoostedFile {
    /// The fields of the list are on one level with the others: serde cannot both flatten them and refuse unknown ones.
    order: Vec<String>,
    temperature: f64,
    features: Vec<String>,
    classifiers: Vec<Vec<(u32, f32, i8, f64)>>,
    relaxation: RelaxConfig,
    compatibility: Compatibility,
}

impl Model {
    /// Reads a model file.
    ///
    /// # Errors
    /// If the bytes are not a model of this version, name an unknown feature, or hold a number out of range.
    pub fn from_json(bytes: &[u8]) -> Result<Self, ModelError> {
        if bytes.len() > MAX_BYTES {
            return Err(ModelError::TooLarge { found: bytes.len() });
        }
        let json = |error: serde_json::Error| ModelError::Json { source: SyntaxError::of(&error) };
        let header: Header = serde_json::from_slice(bytes).map_err(json)?;
        if header.format != FORMAT {
            return Err(ModelError::Format { found: header.format });
        }
        if header.version != u64::from(VERSION) {
            return Err(ModelError::Version { found: header.version });
        }
        let file: ModelFile = serde_json::from_slice(bytes).map_err(json)?;
        check_scan(&file.scan)?;
        check_thresholds(&file.thresholds)?;
        positive("resolution_m", file.record.resolution_m)?;
        let method = match file.method {
            MethodFile::Boosted(boosted) => Method::Boosted(boosted.into_model(&file.label_set)?),
            MethodFile::Iamn(network) => Method::Iamn(network.into_model(&file.label_set)?),
        };
        let doorways = file.doorways.into_iter().map(read_gate_stump).collect::<Result<_, _>>()?;
        let (label_set, scan) = (file.label_set, file.scan);
        Ok(Self { label_set, scan, method, doorways, thresholds: file.thresholds, record: file.record })
    }

    /// The model as bytes of a file; equal models give equal bytes.
    ///
    /// # Panics
    /// If a feature is not in the registry.
    #[expect(clippy::expect_used, reason = "all keys are strings and writing to memory cannot fail")]
    pub fn to_json(&self) -> Vec<u8> {
        let method = match &self.method {
            Method::Boosted(boosted) => MethodFile::Boosted(BoostedFile::new(boosted, &self.label_set)),
            Method::Iamn(NetworkModel { list, network }) => MethodFile::Iamn(NetworkFile {
                list: list.as_ref().map(|list| ListFile::new(list, &self.label_set)),
                network: network.clone(),
            }),
        };
        let file = ModelFile {
            format: FORMAT.to_owned(),
            version: VERSION,
            label_set: self.label_set.clone(),
            scan: self.scan,
            method,
            doorways: self.doorways.iter().map(gate_stump).collect(),
            thresholds: self.thresholds,
            record: self.record.clone(),
        };
        let mut bytes = serde_json::to_vec(&file).expect("a model is representable as JSON");
        bytes.push(b'\n');
        bytes
    }

    /// SHA-256 of the model file, in hexadecimal, by which results name the model.
    pub fn hash(&self) -> String {
        sha256_hex(&self.to_json())
    }
}

impl BoostedFile {
    fn new(model: &BoostedModel, label_set: &LabelSet) -> Self {
        let ListFile { order, temperature, features, classifiers } = ListFile::new(&model.list, label_set);
        let (relaxation, compatibility) = (model.relaxation, model.compatibility.clone());
        Self { order, temperature, features, classifiers, relaxation, compatibility }
    }

    fn into_model(self, label_set: &LabelSet) -> Result<BoostedModel, ModelError> {
        let Self { order, temperature, features, classifiers, relaxation, compatibility } = self;
        count("classes in the compatibilities", label_set.len(), compatibility.n_labels())?;
        range("iterations", "at most 100000", relaxation.iterations <= MAX_ITERATIONS, || {
            relaxation.iterations.into()
        })?;
        let list = ListFile { order, temperature, features, classifiers }.into_list(label_set)?;
        Ok(BoostedModel { list, relaxation, compatibility })
    }
}

impl NetworkFile {
    fn into_model(self, label_set: &LabelSet) -> Result<NetworkModel, ModelError> {
        count("classes in the network", label_set.len(), self.network.weights.n_labels())?;
        let list = self.list.map(|list| list.into_list(label_set)).transpose()?;
        let n_scores = list.as_ref().map_or(0, |list| 2 * list.order.len());
        count("scores per node that the network weighs", n_scores, self.network.n_scores())?;
        Ok(NetworkModel { list, network: self.network })
    }
}

impl ListFile {
    fn new(list: &DecisionList, label_set: &LabelSet) -> Self {
        let columns = list.columns();
        let stump = |w: &WeightedStump| {
            let column = columns.partition_point(|&id| id < w.stump.feature) as u32;
            let polarity = match w.stump.polarity {
                Polarity::Below => 1,
                Polarity::Above => -1,
            };
            (column, w.stump.threshold, polarity, w.alpha)
        };
        Self {
            order: list.order.iter().map(|&label| label_set.class(label).name.clone()).collect(),
            temperature: list.temperature,
            features: columns.iter().map(|id| id.feature().name.clone()).collect(),
            classifiers: list.classifiers.iter().map(|c| c.stumps.iter().map(stump).collect()).collect(),
        }
    }

    fn into_list(self, label_set: &LabelSet) -> Result<DecisionList, ModelError> {
        let n_labels = label_set.len();
        count("classes in the list's order", n_labels, self.order.len())?;
        count("classifiers", n_labels, self.classifiers.len())?;
        unique("classes in the list's order", &self.order)?;
        unique("features", &self.features)?;
        positive("temperature", self.temperature)?;
        let label = |name: &String| label_set.label(name).ok_or(ModelError::Class { name: name.clone() });
        let order = self.order.iter().map(label).collect::<Result<Vec<Label>, _>>()?;
        let feature =
            |name: &String| FeatureId::from_name(name).ok_or(ModelError::Feature { name: name.clone() });
        let features = self.features.iter().map(feature).collect::<Result<Vec<FeatureId>, _>>()?;
        let classifier = |stumps: &Vec<(u32, f32, i8, f64)>| {
            let stumps =
                stumps.iter().map(|&stump| read_stump(stump, &features)).collect::<Result<_, _>>()?;
            Ok(StrongClassifier { stumps })
        };
        let classifiers = self.classifiers.iter().map(classifier).collect::<Result<_, ModelError>>()?;
        Ok(DecisionList { order, classifiers, temperature: self.temperature })
    }
}

/// A stump over the figures of gates, by name.
fn gate_stump(w: &WeightedStump) -> (String, f32, i8, f64) {
    let name = figure_table().get(w.stump.feature.0 as usize).map_or("", |(name, _)| name).to_owned();
    (name, w.stump.threshold, if w.stump.polarity == Polarity::Below { 1 } else { -1 }, w.alpha)
}

fn read_gate_stump(
    (name, threshold, polarity, alpha): (String, f32, i8, f64),
) -> Result<WeightedStump, ModelError> {
    let position = figure_table().iter().position(|(known, _)| *known == name);
    let figure = position.ok_or(ModelError::Feature { name })? as u16;
    read_stump((0, threshold, polarity, alpha), &[FeatureId(figure)])
}

fn read_stump(stump: (u32, f32, i8, f64), features: &[FeatureId]) -> Result<WeightedStump, ModelError> {
    let (column, threshold, polarity, alpha) = stump;
    let Some(&feature) = features.get(column as usize) else {
        let expected = "a position in the features";
        return Err(ModelError::Value { field: "a stump's feature", expected, found: column.into() });
    };
    range("a stump's threshold", "a finite number", threshold.is_finite(), || threshold.into())?;
    range("a stump's alpha", "a number from 0 to 1e6", (0.0..=MAX_ALPHA).contains(&alpha), || alpha)?;
    let polarity = match polarity {
        1 => Polarity::Below,
        -1 => Polarity::Above,
        other => {
            let (field, expected) = ("a stump's polarity", "1 or -1");
            return Err(ModelError::Value { field, expected, found: other.into() });
        }
    };
    Ok(WeightedStump { stump: DecisionStump { feature, threshold, polarity }, alpha })
}

fn check_scan(scan: &ScanConfig) -> Result<(), ModelError> {
    let value = |OutOfRange { field, expected, found }| ModelError::Value { field, expected, found };
    scan.check().map_err(value)
}

fn check_thresholds(thresholds: &Thresholds) -> Result<(), ModelError> {
    for (field, value) in [
        ("min_place_m2", thresholds.min_place_m2),
        ("min_doorway_m2", thresholds.min_doorway_m2),
        ("min_island_m2", thresholds.min_island_m2),
    ] {
        range(field, "a number from 0", value.is_finite() && value >= 0.0, || value)?;
    }
    Ok(())
}

fn positive(field: &'static str, value: f64) -> Result<(), ModelError> {
    range(field, "a number above 0", value.is_finite() && value > 0.0, || value)
}

fn range(
    field: &'static str,
    expected: &'static str,
    holds: bool,
    found: impl Fn() -> f64,
) -> Result<(), ModelError> {
    if holds { Ok(()) } else { Err(ModelError::Value { field, expected, found: found() }) }
}

fn count(of: &'static str, expected: usize, found: usize) -> Result<(), ModelError> {
    if expected == found { Ok(()) } else { Err(ModelError::Count { of, expected, found }) }
}

fn unique(of: &'static str, names: &[String]) -> Result<(), ModelError> {
    let mut sorted: Vec<&String> = names.iter().collect();
    sorted.sort_unstable();
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(ModelError::Twice { of, name: pair[0].clone() }),
        None => Ok(()),
    }
}
