//! What was learned of pieces of free space: boosted stumps over their figures, in two rounds.

use std::sync::LazyLock;

use super::figures::REGISTRY;
use crate::boost::{Calibrated, CalibratedFileError, CalibratedFormat};

/// The file of a [`SpaceModel`].
const FORMAT: CalibratedFormat<2> = CalibratedFormat {
    name: "placegraph-spaces",
    classifiers: ["first", "second"],
    figures: || REGISTRY.iter().map(|figure| figure.name).collect(),
};

/// The model that the program comes with (`docs/default-model.md`).
const BUILTIN: &[u8] = include_bytes!("../../assets/spaces.json");

/// Which pieces of free space are passages, learned from buildings whose corridors are known.
#[derive(Clone, Debug, PartialEq)]
pub struct SpaceModel {
    /// Whether a piece is a passage, by itself.
    pub first: Calibrated,
    /// The same once the probabilities of the first round are known, of the piece and of its neighbors.
    pub second: Calibrated,
    /// Where the model comes from, for people.
    pub sources: Vec<String>,
}

impl SpaceModel {
    /// The model inside the program. Its file is read once.
    ///
    /// # Panics
    /// Never: a test reads it.
    #[expect(clippy::expect_used, reason = "the asset is read by a test")]
    pub fn builtin() -> Self {
        static MODEL: LazyLock<SpaceModel> =
            LazyLock::new(|| SpaceModel::from_json(BUILTIN).expect("the program's own model"));
        MODEL.clone()
    }

    /// Reads a model file.
    ///
    /// # Errors
    /// If the bytes are no model of this version, name an unknown figure, or hold a number out of range.
    pub fn from_json(bytes: &[u8]) -> Result<Self, CalibratedFileError> {
        let ([first, second], sources) = FORMAT.read(bytes)?;
        Ok(Self { first, second, sources })
    }

    /// The model as bytes of a file: the same model gives the same bytes.
    pub fn to_json(&self) -> Vec<u8> {
        FORMAT.write([&self.first, &self.second], &self.sources)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_read_back_and_checked() {
        let model = SpaceModel::builtin();
        assert!(model.first.classifier.stumps.len() > 10 && model.second.classifier.stumps.len() > 10);
        let bytes = model.to_json();
        assert_eq!(SpaceModel::from_json(&bytes).unwrap(), model);
        assert_eq!(bytes, BUILTIN);
        let text = String::from_utf8(bytes).unwrap();
        for (from, to) in [
            ("placegraph-spaces", "placegraph-gates"),
            ("\"version\":1", "\"version\":2"),
            ("\"first\"", "\"third\""),
            ("passage_scans", "passage_sounds"),
            ("\"slope\":", "\"slope\":1e9"),
        ] {
            assert!(SpaceModel::from_json(text.replacen(from, to, 1).as_bytes()).is_err(), "{from}");
        }
    }
}
