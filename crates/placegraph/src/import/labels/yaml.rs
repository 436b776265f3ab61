//! The classes in a `labels.yaml`, next to a label image of this program.

use serde::Deserialize;

use super::super::ros::yaml_error;
use crate::import::MapError;
use crate::labels::{Class, LabelSet};

/// What a `labels.yaml` says of its image beyond what map_server reads.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct LabelsYaml {
    /// The image.
    pub image: String,
    /// Side of a pixel, in meters.
    #[serde(rename = "resolution")]
    pub resolution_m: f64,
    /// The classes in order, from value 1; absent in files of map_server.
    #[serde(default)]
    classes: Option<Vec<Class>>,
}

impl LabelsYaml {
    /// Parses the text of a `labels.yaml`.
    ///
    /// # Errors
    /// If it is no YAML, or lacks image or resolution.
    pub fn parse(bytes: &[u8]) -> Result<Self, MapError> {
        serde_saphyr::from_slice(bytes).map_err(|error| yaml_error(&error))
    }

    /// The classes of the image; `None` if the file has none, or none that form a label set.
    pub fn label_set(&self) -> Option<LabelSet> {
        self.classes.clone().and_then(|classes| LabelSet::new(classes).ok())
    }
}
