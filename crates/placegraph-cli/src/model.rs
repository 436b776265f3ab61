//! The model to label with: a file, or the one inside the program.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use placegraph::export::ModelInfo;
use placegraph::import;
use placegraph::model::{MAX_BYTES, Model};

use crate::args::MethodArg;

/// A model and what to call it.
#[derive(Debug)]
pub(crate) struct NamedModel {
    /// The model.
    pub(crate) model: Model,
    name: String,
}

impl NamedModel {
    /// The model in `path`, or the one inside the program.
    pub(crate) fn load(path: Option<&Path>) -> Result<Self> {
        let Some(path) = path else {
            return Ok(Self { model: Model::builtin(), name: "default".to_owned() });
        };
        let bytes = import::read(path, MAX_BYTES as u64)
            .with_context(|| format!("could not read the model {}", path.display()))?;
        let model = Model::from_json(&bytes).with_context(|| format!("in {}", path.display()))?;
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        Ok(Self { model, name })
    }

    /// Refuses a model of another method than the one asked for.
    pub(crate) fn check_method(&self, asked: Option<MethodArg>) -> Result<()> {
        let name = match asked {
            None => return Ok(()),
            Some(MethodArg::Boosted) => "boosted",
            Some(MethodArg::Iamn) => "iamn",
        };
        let found = self.model.method.name();
        ensure!(name == found, "expected a model of the method {name}, found {found} in {}", self.name);
        Ok(())
    }

    /// What results say of the model.
    pub(crate) fn info(&self) -> ModelInfo {
        ModelInfo { name: self.name.clone(), hash: self.model.hash() }
    }
}
