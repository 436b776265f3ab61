//! The model that comes with the library.

use std::sync::LazyLock;

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

    /// Whether this model labels cells as the built-in one does, whatever it has learned of doorways since.
    pub(crate) fn labels_as_builtin(&self) -> bool {
        static BUILTIN: LazyLock<Model> = LazyLock::new(Model::builtin);
        self.label_set == BUILTIN.label_set && self.scan == BUILTIN.scan && self.method == BUILTIN.method
    }
}

#[cfg(test)]
mod tests {
    use super::super::Method;
    use super::*;
    use crate::doorways::GateModel;

    #[test]
    fn what_is_known_of_the_built_in_model_holds_for_no_other() {
        let mut own = Model::builtin();
        own.doorways = GateModel::builtin().doorway.classifier.stumps[..2].to_vec();
        assert!(own.labels_as_builtin(), "doors that were painted change no label of a cell");
        let Method::Boosted(boosted) = &mut own.method else { panic!("the built-in model is boosted") };
        boosted.list.order.reverse();
        assert!(!own.labels_as_builtin());
    }
}
