//! Results of earlier runs, read back.

use std::path::Path;

use anyhow::{Context, Result};
use placegraph::export::TopologyDocument;

/// Reads the `topology.json` at `path`.
pub(crate) fn read(path: &Path) -> Result<TopologyDocument> {
    let bytes = std::fs::read(path).with_context(|| format!("could not read {}", path.display()))?;
    TopologyDocument::from_json(&bytes).with_context(|| format!("in {}", path.display()))
}
