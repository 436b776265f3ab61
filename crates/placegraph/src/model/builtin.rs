//! The model that comes with the library.

use super::Model;

/// Trained on generated buildings only: `docs/default-model.md`.
const FILE: &[u8] = include_bytes!("../../assets/default.model.json");

impl Model {
    /// The model inside the library: corridors, rooms and doorways, trained on generated buildings.
    ///
    /// Needs the feature `default-model`. Cost: a file of 47 kB is read.
    #[expect(clippy::expect_used, reason = "the file is part of the library, and a test reads it")]
    pub fn builtin() -> Self {
        Self::from_json(FILE).expect("the library's own model")
    }
}
