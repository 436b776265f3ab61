//! The files of a result, as the program writes them for the same map, edits and formats.

use std::time::Duration;

use placegraph::export::{Format, MaskSettings, ModelInfo, TopologyDocument};
use placegraph::import::{LoadedMap, ReadOptions, check};
use placegraph::model::{Model, sha256_hex};
use placegraph::pipeline::{Analysis, Config};
use placegraph::result::{Files, InputHashes, LabeledMap, ResultContents, ResultOptions};
use placegraph::topology::edits::Edit;
use placegraph::topology::reach::Robot;

use crate::session::in_words;

/// Name of the edit file that the page hands out.
pub(crate) const EDITS: &str = "edits.toml";

/// Most cells of a map that a browser labels: WebAssembly has 4 GB of memory.
const MAX_CELLS: u64 = 36_000_000;

/// How maps are read.
pub(crate) fn read_options(resolution_m: Option<f64>) -> ReadOptions {
    ReadOptions { resolution_m, max_cells: MAX_CELLS, ..ReadOptions::default() }
}

/// How maps are labeled.
pub(crate) fn config(edits: Vec<Edit>) -> Config {
    Config { edits, ..Config::default() }
}

fn contents<'a>(formats: &'a [&'static Format], masks: &'a MaskSettings) -> ResultContents<'a> {
    ResultContents {
        stages: false,
        probabilities: false,
        formats,
        masks,
        georeference: None,
        written: Duration::ZERO,
    }
}

/// A model and what results call it: its file, as for the program.
#[derive(Clone, Debug)]
pub(crate) struct NamedModel {
    pub(crate) name: String,
    pub(crate) model: Model,
}

impl NamedModel {
    /// The library's own.
    pub(crate) fn builtin() -> Self {
        Self { name: "default".to_owned(), model: Model::builtin() }
    }
}

/// What a result is made of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ResultOf<'a> {
    pub(crate) map: &'a LoadedMap,
    pub(crate) resolution_m: Option<f64>,
    pub(crate) model: &'a NamedModel,
    pub(crate) analysis: &'a Analysis,
    /// The text of the edit file; empty without one.
    pub(crate) edits_toml: &'a str,
}

impl<'a> ResultOf<'a> {
    pub(crate) fn labeled(&self) -> LabeledMap<'a> {
        LabeledMap { map: self.map, classes: &self.model.model.label_set, analysis: self.analysis }
    }

    /// The document, before it lists files. Its options are those with which the program makes the same result.
    pub(crate) fn document(&self, formats: &[&'static Format]) -> TopologyDocument {
        let model = ModelInfo { name: self.model.name.clone(), hash: self.model.model.hash() };
        let findings = check(self.map).findings;
        let mut document = self.labeled().document(model, &findings, &Robot::default(), EDITS);
        let edits = (!self.edits_toml.is_empty()).then(|| sha256_hex(self.edits_toml.as_bytes()));
        document.program.options = ResultOptions {
            read: &read_options(self.resolution_m),
            config: &config(Vec::new()),
            contents: &contents(formats, &MaskSettings::default()),
            inputs: &InputHashes { edits, ..InputHashes::default() },
        }
        .words();
        document
    }

    /// All files, and the document that lists them.
    pub(crate) fn files(&self, formats: &[&'static Format]) -> Result<(TopologyDocument, Files), String> {
        let mut document = self.document(formats);
        let masks = MaskSettings::default();
        let contents = contents(formats, &masks);
        let files = self.labeled().files(&mut document, &contents).map_err(in_words)?;
        Ok((document, files))
    }
}
