//! The parts of the program that the Python package uses in addition to [`run`](crate::run): its guard against panics, its way of writing
//! files, its words.

use std::path::Path;
use std::time::Duration;

use anyhow::Result;
use placegraph::export::MaskSettings;

use crate::output::{Existing, OutputSet};

/// Keeps panics from being printed where they happen: [`guarded`] reports them.
pub fn install_guard() {
    crate::guard::install();
}

/// What `work` returns, or an error that asks for a report if it panics, on whatever thread.
///
/// # Errors
/// Those of `work`, and one for a panic.
pub fn guarded<T>(work: impl FnOnce() -> Result<T>) -> Result<T> {
    crate::guard::guarded(work)
}

/// Writes a file completely or not at all.
///
/// # Errors
/// If `path` names no file, or the system does not let it be written.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    crate::output::write_file(path, bytes, &[])
}

/// Writes `files` into `folder`, all of them or none; the last vouches for the others. Returns their names.
///
/// # Errors
/// If a name is no plain file name or stands twice, or the system does not let a file be written.
pub fn write_result(folder: &Path, files: Vec<(String, Vec<u8>)>) -> Result<Vec<String>> {
    let mut set = OutputSet::new(Existing::ReplaceResult);
    for (name, bytes) in files {
        set.add(name, bytes);
    }
    Ok(set.commit(folder)?.written)
}

/// The mask file at `path` and the hash of its bytes, or what holds without one.
///
/// # Errors
/// If the file cannot be read, or is no mask file.
pub fn masks(path: Option<&Path>) -> Result<(MaskSettings, Option<String>)> {
    crate::read::masks(path)
}

/// The time that results shall bear, from `SOURCE_DATE_EPOCH`.
pub fn fixed_time() -> Option<Duration> {
    crate::document::fixed_time()
}
