//! Results of earlier runs, read back.

use std::path::Path;

use anyhow::{Context, Result};
use placegraph::export::{MAX_DOCUMENT_BYTES, TopologyDocument};
use placegraph::import;

/// Reads the `topology.json` at `path`.
pub(crate) fn read(path: &Path) -> Result<TopologyDocument> {
    let could_not = || format!("could not read {}", path.display());
    let bytes = import::read(path, MAX_DOCUMENT_BYTES).with_context(could_not)?;
    TopologyDocument::from_json(&bytes).with_context(|| format!("in {}", path.display()))
}
