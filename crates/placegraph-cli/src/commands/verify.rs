//! `placegraph verify`: whether results are as they were written.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use placegraph::export::stamped_map;

use super::Outcome;
use crate::args::{MAX_CELLS, VerifyArgs};
use crate::document::{self, DOCUMENT, SITE};
use crate::output::print;

/// Prints a line per result; the check fails if a file was changed, is missing, or belongs to another map.
pub(crate) fn run(args: &VerifyArgs) -> Result<Outcome> {
    let mut outcome = Outcome::Done;
    for path in &args.results {
        let folder = if path.is_dir() { path.clone() } else { folder_of(path)? };
        let results = results_in(&folder)?;
        ensure!(!results.is_empty(), "expected a result in {}, found no {DOCUMENT}", folder.display());
        for result in results {
            let check = if result.join(SITE).is_file() { check_site } else { check };
            let faults = check(&result).unwrap_or_else(|error| vec![format!("{error:#}")]);
            let state =
                if faults.is_empty() { "complete and unchanged".to_owned() } else { faults.join("; ") };
            print(&format!("{}: {state}\n", result.display()))?;
            if !faults.is_empty() {
                outcome = Outcome::CheckFailed;
            }
        }
    }
    Ok(outcome)
}

fn folder_of(document: &Path) -> Result<PathBuf> {
    let is_document = document.file_name().is_some_and(|name| name == DOCUMENT || name == SITE);
    ensure!(
        is_document,
        "expected a {DOCUMENT}, a {SITE} or the folder of a result, found {}",
        document.display()
    );
    let folder = document.parent().filter(|folder| !folder.as_os_str().is_empty());
    Ok(folder.unwrap_or(Path::new(".")).to_owned())
}

/// All folders with a document, `folder` itself or below.
fn results_in(folder: &Path) -> Result<Vec<PathBuf>> {
    let cannot_read = || format!("cannot read the folder {}", folder.display());
    let mut results = Vec::new();
    if folder.join(DOCUMENT).is_file() || folder.join(SITE).is_file() {
        results.push(folder.to_owned());
    }
    let mut below: Vec<PathBuf> = Vec::new();
    for entry in fs::read_dir(folder).with_context(cannot_read)? {
        let entry = entry.with_context(cannot_read)?;
        if entry.file_type().with_context(cannot_read)?.is_dir() {
            below.push(entry.path());
        }
    }
    below.sort();
    for folder in below {
        results.extend(results_in(&folder)?);
    }
    Ok(results)
}

/// What is wrong with the site in `folder`.
fn check_site(folder: &Path) -> Result<Vec<String>> {
    let site =
        document::read_site(&folder.join(SITE))?.with_context(|| format!("expected a site in {SITE}"))?;
    Ok(document::faults_of_site(&site, folder))
}

/// What is wrong with the result in `folder`.
fn check(folder: &Path) -> Result<Vec<String>> {
    let document = document::read(&folder.join(DOCUMENT), MAX_CELLS)?;
    let mut faults = document::faults(&document, folder);
    let mut others: Vec<PathBuf> = fs::read_dir(folder)?.flatten().map(|entry| entry.path()).collect();
    others.sort();
    for path in others.iter().filter(|path| path.is_file()) {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let is_listed = document.files.iter().any(|file| file.name == name);
        let of_map = if is_listed { None } else { stamped_map(&document::head(path)) };
        if of_map.is_some_and(|map| map != document.map.hash) {
            faults.push(format!("{name} belongs to another map"));
        }
    }
    Ok(faults)
}
