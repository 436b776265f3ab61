//! What was learned of gates: boosted stumps over their figures, with calibrated probabilities.

use std::sync::LazyLock;

use super::figures::REGISTRY;
use crate::boost::{Calibrated, CalibratedFileError, CalibratedFormat};

/// The file of a [`GateModel`].
const FORMAT: CalibratedFormat<2> = CalibratedFormat {
    name: "placegraph-gates",
    classifiers: ["doorway", "parting"],
    figures: || REGISTRY.iter().map(|figure| figure.name).collect(),
};

/// The gates that the program comes with (`docs/default-model.md`).
const BUILTIN: &[u8] = include_bytes!("../../assets/gates.json");

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

impl GateModel {
    /// The model inside the program. Its file is read once.
    ///
    /// # Panics
    /// Never: a test reads it.
    #[expect(clippy::expect_used, reason = "the asset is read by a test")]
    pub fn builtin() -> Self {
        static MODEL: LazyLock<GateModel> =
            LazyLock::new(|| GateModel::from_json(BUILTIN).expect("the program's own model"));
        MODEL.clone()
    }

    /// Reads a model file.
    ///
    /// # Errors
    /// If the bytes are no model of this version, name an unknown figure, or hold a number out of range.
    pub fn from_json(bytes: &[u8]) -> Result<Self, CalibratedFileError> {
        let ([doorway, parting], sources) = FORMAT.read(bytes)?;
        Ok(Self { doorway, parting, sources })
    }

    /// The model as bytes of a file: the same model gives the same bytes.
    pub fn to_json(&self) -> Vec<u8> {
        FORMAT.write([&self.doorway, &self.parting], &self.sources)
    }
}
