//! Results of earlier runs, read back.

use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result};
use placegraph::export::{MAX_DOCUMENT_BYTES, TopologyDocument};
use placegraph::import;
use placegraph::model::sha256_hex;

/// The name of the file that says what a result was made of. It is put in place last: where it is, the others
/// are.
pub(crate) const DOCUMENT: &str = "topology.json";

/// Reads the `topology.json` at `path`.
pub(crate) fn read(path: &Path) -> Result<TopologyDocument> {
    Ok(parsed(path)?.0)
}

/// Reads the `topology.json` at `path`; also returns the hash of its bytes.
pub(crate) fn read_hashed(path: &Path) -> Result<(TopologyDocument, String)> {
    let (document, bytes) = parsed(path)?;
    Ok((document, sha256_hex(&bytes)))
}

fn parsed(path: &Path) -> Result<(TopologyDocument, Vec<u8>)> {
    let could_not = || format!("could not read {}", path.display());
    let bytes = import::read(path, MAX_DOCUMENT_BYTES).with_context(could_not)?;
    let document = TopologyDocument::from_json(&bytes).with_context(|| format!("in {}", path.display()))?;
    Ok((document, bytes))
}

/// The time that results shall bear, from `SOURCE_DATE_EPOCH`: with it, nothing in them tells the clock.
pub(crate) fn fixed_time() -> Option<Duration> {
    let seconds: u32 = std::env::var("SOURCE_DATE_EPOCH").ok()?.parse().ok()?;
    Some(Duration::from_secs(seconds.into()))
}

/// The document of the result at `path`: the file itself, or that in a folder.
pub(crate) fn path_in(path: &Path) -> PathBuf {
    if path.is_dir() { path.join(DOCUMENT) } else { path.to_owned() }
}
