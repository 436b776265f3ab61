//! Results of earlier runs, read back.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result, anyhow, ensure};
use placegraph::export::{FORMAT, FileRecord, MAX_DOCUMENT_BYTES, TopologyDocument};
use placegraph::import::{self, has_memory};
use placegraph::model::sha256_hex;
use placegraph::site::{SiteDocument, is_site};

/// The file that says what a result was made of. It is put in place last: where it is, the others are.
pub(crate) use placegraph::result::DOCUMENT;
/// The same for a site of several floors.
pub(crate) use placegraph::site::DOCUMENT as SITE;

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

/// The bytes of the document at `path`.
fn bytes_of(path: &Path) -> Result<Vec<u8>> {
    let could_not = || format!("could not read {}", path.display());
    let bytes = import::read(path, MAX_DOCUMENT_BYTES).with_context(could_not)?;
    let n_bytes = MEMORY_PER_BYTE * bytes.len() as u64;
    ensure!(has_memory(n_bytes), "not enough memory: reading {} takes {n_bytes} bytes", path.display());
    Ok(bytes)
}

/// The site at `path`; `None` if it is another file.
pub(crate) fn read_site(path: &Path) -> Result<Option<SiteDocument>> {
    let path = if path.join(SITE).is_file() { &path.join(SITE) } else { path };
    if !is_site(&head(path)) {
        return Ok(None);
    }
    let site = SiteDocument::from_json(&bytes_of(path)?);
    Ok(Some(site.with_context(|| format!("in {}", path.display()))?))
}

fn parsed(path: &Path, max_cells: u64) -> Result<(TopologyDocument, Vec<u8>)> {
    let bytes = bytes_of(path)?;
    let in_file = || format!("in {}", path.display());
    let document = TopologyDocument::from_json(&bytes).with_context(in_file)?;
    document
        .check_size(max_cells)
        .map_err(|error| anyhow!("{error}; to read larger ones, use --max-cells N"))
        .with_context(in_file)?;
    Ok((document, bytes))
}

/// The time to write into results, from `SOURCE_DATE_EPOCH`: with it, nothing in them depends on the clock.
pub(crate) fn fixed_time() -> Option<Duration> {
    seconds(&std::env::var(EPOCH).ok()?).map(Duration::from_secs)
}

/// The variable with the time that results shall bear.
const EPOCH: &str = "SOURCE_DATE_EPOCH";

/// Refuses a time that [`fixed_time`] would not follow.
pub(crate) fn check_fixed_time() -> Result<()> {
    let Some(found) = std::env::var_os(EPOCH) else { return Ok(()) };
    let text = found.to_string_lossy();
    ensure!(
        seconds(&text).is_some(),
        "expected {EPOCH} to be seconds since 1970, up to the year 9999, found {text:?}"
    );
    Ok(())
}

/// Seconds since 1970, if the year has four digits.
fn seconds(text: &str) -> Option<u64> {
    text.parse().ok().filter(|seconds| *seconds <= 253_402_300_799)
}

/// The document of the result at `path`: the file itself, or that in a folder.
pub(crate) fn path_in(path: &Path) -> PathBuf {
    if path.is_dir() { path.join(DOCUMENT) } else { path.to_owned() }
}

/// The other files of a folder that files are to be written to.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Beside {
    /// No document of this program.
    Nothing,
    /// A document of this program that cannot be read.
    Damaged,
    /// A result of this program: the files that it lists.
    Result(Vec<FileRecord>),
}

impl Beside {
    /// What stands in `folder`.
    pub(crate) fn of(folder: &Path) -> Self {
        let read = |name: &str| {
            let path = folder.join(name);
            path.is_file().then(|| import::read(&path, MAX_DOCUMENT_BYTES).ok()).flatten()
        };
        let files = |found: Option<Vec<FileRecord>>, is_ours: bool| match found {
            Some(files) => Self::Result(files),
            None if is_ours => Self::Damaged,
            None => Self::Nothing,
        };
        if let Some(bytes) = read(DOCUMENT) {
            let names_format =
                bytes.windows(FORMAT.len()).take(4096).any(|window| window == FORMAT.as_bytes());
            return files(
                TopologyDocument::from_json(&bytes).ok().map(|document| document.files),
                names_format,
            );
        }
        match read(SITE) {
            Some(bytes) => {
                files(SiteDocument::from_json(&bytes).ok().map(|site| site.files), is_site(&bytes))
            }
            None => Self::Nothing,
        }
    }

    /// Whether a file called `name` belongs to the result; of a document that is damaged or lists no files, whether it
    /// may.
    pub(crate) fn vouches_for(&self, name: &str) -> bool {
        match self {
            Self::Nothing => false,
            Self::Damaged => true,
            Self::Result(files) => files.is_empty() || files.iter().any(|file| file.name == name),
        }
    }
}

/// What is wrong with the result in `folder` whose document was read from there; nothing where all is as it was
/// written.
pub(crate) fn faults(document: &TopologyDocument, folder: &Path) -> Vec<String> {
    let seal = document.sha256.as_ref().map(|_| document.is_sealed());
    faults_of(DOCUMENT, seal, &document.files, folder)
}

/// As [`faults`], of a site and its floors.
pub(crate) fn faults_of_site(site: &SiteDocument, folder: &Path) -> Vec<String> {
    let seal = site.sha256.as_ref().map(|_| site.is_sealed());
    let mut faults = faults_of(SITE, seal, &site.files, folder);
    for level in &site.levels {
        let path = folder.join(&level.level).join(DOCUMENT);
        let is_same = TopologyDocument::from_json(&bytes_of(&path).unwrap_or_default())
            .is_ok_and(|document| document.sha256.as_ref() == Some(&level.document_sha256));
        if !is_same {
            faults.push(format!("{} is of another run", level.level));
        }
    }
    faults
}

/// What is wrong with a document, `is_sealed` if it was, and the `files` that it lists.
fn faults_of(name: &str, is_sealed: Option<bool>, files: &[FileRecord], folder: &Path) -> Vec<String> {
    let mut faults = Vec::new();
    if is_sealed.is_none() || files.is_empty() {
        faults.push(format!("{name} lists no files"));
    } else if is_sealed == Some(false) {
        faults.push(format!("{name} was changed"));
    }
    for file in files {
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

/// The first bytes of the file at `path`, where an export bears its stamp; none of what cannot be read. Opening a pipe would
/// wait for somebody to write.
pub(crate) fn head(path: &Path) -> Vec<u8> {
    let mut head = Vec::new();
    if path.is_file()
        && let Ok(file) = File::open(path)
    {
        let _ = file.take(4096).read_to_end(&mut head);
    }
    head
}
