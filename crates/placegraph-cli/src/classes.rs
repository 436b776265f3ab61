//! The classes of label files, and labels of any kind for a map.

use std::path::Path;

use anyhow::{Context, Result, anyhow};
use placegraph::export::TopologyDocument;
use placegraph::grid::Grid;
use placegraph::import::{self, LabelCoding, LabelTarget, LabelsYaml, read_classes};
use placegraph::labels::{LabelCell, LabelSet};
use placegraph::model::{MAX_BYTES, Model};

use crate::document::DOCUMENT;
use crate::read;

/// Classes, and what pixels and names in label files mean.
#[derive(Clone, Debug)]
pub(crate) struct Classes {
    pub(crate) label_set: LabelSet,
    pub(crate) coding: LabelCoding,
}

impl Default for Classes {
    /// Corridor, room, doorway.
    fn default() -> Self {
        LabelSet::default().into()
    }
}

impl From<LabelSet> for Classes {
    fn from(label_set: LabelSet) -> Self {
        let coding = LabelCoding::of(&label_set);
        Self { label_set, coding }
    }
}

impl Classes {
    /// The classes in a TOML file with `[classes]`, a model, the `labels.yaml` or the `topology.json` of a result.
    pub(crate) fn read(path: &Path) -> Result<Self> {
        let in_file = || format!("in {}", path.display());
        let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
        match extension {
            "yaml" | "yml" => {
                let bytes = read_bytes(path, import::MAX_TEXT_BYTES)?;
                let classes = LabelsYaml::parse(&bytes).with_context(in_file)?.label_set();
                classes
                    .map(Self::from)
                    .ok_or_else(|| anyhow!("expected classes, found none"))
                    .with_context(in_file)
            }
            "json" => {
                let bytes = read_bytes(path, placegraph::export::MAX_DOCUMENT_BYTES.min(MAX_BYTES as u64))?;
                match Model::from_json(&bytes) {
                    Ok(model) => Ok(model.label_set.into()),
                    Err(error) => {
                        let document =
                            TopologyDocument::from_json(&bytes).map_err(|_| error).with_context(in_file)?;
                        Ok(document.classes.into())
                    }
                }
            }
            _ => {
                let (label_set, coding) =
                    read_classes(&read::text(path, "file of classes")?).with_context(in_file)?;
                Ok(Self { label_set, coding })
            }
        }
    }

    /// The classes of the label image at `path` as the files next to it say: its own YAML file, or the document of its result. `None`
    /// if there is no such file.
    pub(crate) fn beside(path: &Path) -> Result<Option<Self>> {
        let yaml = path.with_extension("yaml");
        if yaml != path && yaml.is_file() {
            let bytes = read_bytes(&yaml, import::MAX_TEXT_BYTES)?;
            // A YAML file of another program says nothing of classes.
            let found = LabelsYaml::parse(&bytes).ok().and_then(|found| found.label_set());
            if found.is_some() {
                return Ok(found.map(Self::from));
            }
        }
        let document = path.with_file_name(DOCUMENT);
        Ok(if document.is_file() {
            Some(crate::document::read(&document, crate::args::MAX_CELLS)?.classes.into())
        } else {
            None
        })
    }

    /// The names of the classes, in their order.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.label_set.classes().iter().map(|class| class.name.as_str())
    }

    /// The classes in `file`, or those that stand next to `labels`, or the default ones.
    pub(crate) fn of(file: Option<&Path>, labels: &Path) -> Result<Self> {
        match file {
            Some(file) => Self::read(file),
            None => Ok(Self::beside(labels)?.unwrap_or_default()),
        }
    }
}

fn read_bytes(path: &Path, max_bytes: u64) -> Result<Vec<u8>> {
    import::read(path, max_bytes).with_context(|| format!("could not read {}", path.display()))
}

/// Reads the labels at `path` for a map; `target` says which.
pub(crate) fn labels(path: &Path, max_cells: u64, target: &LabelTarget<'_>) -> Result<Grid<LabelCell>> {
    import::load_labels(path, max_cells, target).with_context(|| format!("in the labels {}", path.display()))
}
