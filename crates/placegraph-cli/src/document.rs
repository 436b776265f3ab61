//! Results of earlier runs, read back.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result, anyhow, bail, ensure};
use placegraph::export::{FORMAT, MAX_DOCUMENT_BYTES, TopologyDocument};
use placegraph::import::{self, has_memory};
use placegraph::model::sha256_hex;

/// The name of the file that says what a result was made of. It is put in place last: where it is, the others
/// are.
pub(crate) const DOCUMENT: &str = "topology.json";

/// Memory that a document takes at most while it is read, for each of its bytes: numbers of few digits become points.
const MEMORY_PER_BYTE: u64 = 8;

/// Reads the `topology.json` at `path`, of a map of at most `max_cells` cells.
pub(crate) fn read(path: &Path, max_cells: u64) -> Result<TopologyDocument> {
    Ok(parsed(path, max_cells)?.0)
}

/// [`read`]; also returns the hash of the bytes.
pub(crate) fn read_hashed(path: &Path, max_cells: u64) -> Result<(TopologyDocument, String)> {
    let (document, bytes) = parsed(path, max_cells)?;
    Ok((document, sha256_hex(&bytes)))
}

fn parsed(path: &Path, max_cells: u64) -> Result<(TopologyDocument, Vec<u8>)> {
    let could_not = || format!("could not read {}", path.display());
    let bytes = import::read(path, MAX_DOCUMENT_BYTES).with_context(could_not)?;
    let n_bytes = MEMORY_PER_BYTE * bytes.len() as u64;
    ensure!(has_memory(n_bytes), "not enough memory: reading {} takes {n_bytes} bytes", path.display());
    let in_file = || format!("in {}", path.display());
    let document = TopologyDocument::from_json(&bytes).with_context(in_file)?;
    document
        .check_size(max_cells)
        .map_err(|error| anyhow!("{error}; to read larger ones, use --max-cells N"))
        .with_context(in_file)?;
    Ok((document, bytes))
}

/// The time that results shall bear, from `SOURCE_DATE_EPOCH`: with it, nothing in them tells the clock.
pub(crate) fn fixed_time() -> Option<Duration> {
    seconds(&std::env::var(EPOCH).ok()?).map(Duration::from_secs)
}

/// The variable with the time that results shall bear.
const EPOCH: &str = "SOURCE_DATE_EPOCH";

/// Refuses a time that [`fixed_time`] would not follow.
pub(crate) fn check_fixed_time() -> Result<()> {
    match std::env::var(EPOCH) {
        Err(std::env::VarError::NotPresent) => Ok(()),
        Ok(text) if seconds(&text).is_some() => Ok(()),
        found => bail!("expected {EPOCH} to be seconds since 1970, up to the year 9999, found {found:?}"),
    }
}

/// Seconds since 1970, if the year has four digits.
fn seconds(text: &str) -> Option<u64> {
    text.parse().ok().filter(|seconds| *seconds <= 253_402_300_799)
}

/// The document of the result at `path`: the file itself, or that in a folder.
pub(crate) fn path_in(path: &Path) -> PathBuf {
    if path.is_dir() { path.join(DOCUMENT) } else { path.to_owned() }
}

/// What stands in a folder beside files that are to be written.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Beside {
    /// No document of this program.
    Nothing,
    /// A document of this program that cannot be read.
    Damaged,
    /// A result of this program.
    Result(Box<TopologyDocument>),
}

impl Beside {
    /// What stands in `folder`.
    pub(crate) fn of(folder: &Path) -> Self {
        let path = folder.join(DOCUMENT);
        if !path.is_file() {
            return Self::Nothing;
        }
        let Ok(bytes) = import::read(&path, MAX_DOCUMENT_BYTES) else { return Self::Nothing };
        let names_format =
            || bytes.windows(FORMAT.len()).take(4096).any(|window| window == FORMAT.as_bytes());
        match TopologyDocument::from_json(&bytes) {
            Ok(document) => Self::Result(Box::new(document)),
            Err(_) if names_format() => Self::Damaged,
            Err(_) => Self::Nothing,
        }
    }

    /// Whether a file called `name` belongs to the result; of a document that is damaged or lists no files, whether it
    /// may.
    pub(crate) fn vouches_for(&self, name: &str) -> bool {
        match self {
            Self::Nothing => false,
            Self::Damaged => true,
            Self::Result(document) => {
                document.files.is_empty() || document.files.iter().any(|file| file.name == name)
            }
        }
    }
}

/// What is wrong with the result in `folder` whose document was read from there; nothing where all is as it was
/// written.
pub(crate) fn faults(document: &TopologyDocument, folder: &Path) -> Vec<String> {
    let mut faults = Vec::new();
    if document.sha256.is_none() || document.files.is_empty() {
        faults.push(format!("{DOCUMENT} lists no files"));
    } else if !document.is_sealed() {
        faults.push(format!("{DOCUMENT} was changed"));
    }
    for file in &document.files {
        let path = folder.join(&file.name);
        let fault = match import::read(&path, file.bytes) {
            Ok(bytes) if file.matches(&bytes) => continue,
            _ if path.is_file() => "was changed",
            _ => "is missing",
        };
        faults.push(format!("{} {fault}", file.name));
    }
    faults
}

/// The first bytes of the file at `path`, where an export bears its stamp; none of what cannot be read.
pub(crate) fn head(path: &Path) -> Vec<u8> {
    let mut head = Vec::new();
    if let Ok(file) = File::open(path) {
        let _ = file.take(4096).read_to_end(&mut head);
    }
    head
}
