//! The tables of a batch, a row as soon as a map is done: comma-separated values, and a line of JSON each.

use std::collections::BTreeMap;
use std::fs::{self, File, TryLockError};
use std::io::{Read, Write};
use std::path::Path;

use anyhow::{Context, Result, ensure};
use placegraph::export::{SkippedFormat, TopologyDocument};
use serde::Serialize;

use super::batch::Done;
use super::jobs::Job;
use super::result::skipped;
use crate::output::{complain, csv_row};

/// The tables, in the folder of the run.
pub(super) const NAMES: [&str; 2] = ["summary.csv", "summary.jsonl"];

/// How each begins if it is ours.
const BEGINNINGS: [&str; 2] = ["map,status,", "{\"map\":"];

/// A row as JSON; its first member shows that placegraph wrote the file.
#[derive(Default, Serialize)]
struct Line<'a> {
    map: &'a str,
    status: &'a str,
    folder: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
    errors: &'a [String],
    skipped: &'a [SkippedFormat],
    findings: &'a [String],
    changes: &'a [String],
    places: BTreeMap<String, usize>,
    connections: usize,
    area_m2: f64,
    seconds: Option<f64>,
    sha256: Option<&'a str>,
}

/// Tables that are being written; other runs in the same folder wait.
pub(super) struct Table<'a> {
    classes: &'a [&'a str],
    files: [File; 2],
}

impl<'a> Table<'a> {
    /// Tables without rows in `out`, which is made if it does not exist. Those of an earlier run are replaced.
    pub(super) fn start(out: &Path, classes: &'a [&'a str], force: bool) -> Result<Self> {
        fs::create_dir_all(out).with_context(|| format!("cannot make the folder {}", out.display()))?;
        let open = |(name, beginning)| open(&out.join(name), beginning, force);
        let [rows, lines] = std::array::from_fn(|i| open((NAMES[i], BEGINNINGS[i])));
        let mut table = Self { classes, files: [rows?, lines?] };
        match table.files[0].try_lock() {
            Err(TryLockError::WouldBlock) => {
                complain(&format!("waiting for another run that writes its table into {}", out.display()));
                // If files cannot be locked, do not wait.
                let _ = table.files[0].lock();
            }
            Ok(()) | Err(TryLockError::Error(_)) => {}
        }
        for file in &table.files {
            file.set_len(0)?;
        }
        let header = ["map", "status", "error"].iter().chain(classes);
        let header = header.chain(&["connections", "area_m2", "seconds", "folder", "findings"]);
        table.write(&csv_row(header.map(|&name| name.to_owned())), "")?;
        Ok(table)
    }

    /// A row for the map of `job`.
    pub(super) fn add(&mut self, job: &Job, result: &Result<Done>) -> Result<()> {
        let map = plain_path(&job.map.display().to_string());
        let folder = plain_path(&job.place.display().to_string());
        let (fields, line) = match result {
            Ok(done) => (self.fields(&map, &folder, done), self.line(&map, &folder, done)),
            Err(error) => {
                let error = format!("{error:#}");
                let mut fields = vec![map.clone(), "failed".to_owned(), plain_text(error.clone())];
                fields.resize(self.classes.len() + 6, String::new());
                fields.extend([folder.clone(), String::new()]);
                let (map, folder) = (map.as_str(), folder.as_str());
                (fields, Line { map, folder, status: "failed", error: Some(error), ..Line::default() })
            }
        };
        let line = format!("{}\n", serde_json::to_string(&line)?);
        self.write(&csv_row(fields.into_iter()), &line)
    }

    fn fields(&self, map: &str, folder: &str, done: &Done) -> Vec<String> {
        let document = &done.document;
        let errors: Vec<String> = document.errors.iter().cloned().chain(skipped(document)).collect();
        let mut fields = vec![map.to_owned(), done.status().to_owned(), plain_text(errors.join("; "))];
        fields.extend(self.classes.iter().map(|class| n_places(document, class).to_string()));
        let seconds = done.seconds().map(|seconds| format!("{seconds:.3}"));
        fields.extend([
            document.connections.len().to_string(),
            format!("{:.3}", area_m2(document)),
            seconds.unwrap_or_default(),
            folder.to_owned(),
            plain_text(done.remarks().join("; ")),
        ]);
        fields
    }

    fn line<'b>(&self, map: &'b str, folder: &'b str, done: &'b Done) -> Line<'b> {
        let document = &done.document;
        let places = self.classes.iter().map(|&class| (class.to_owned(), n_places(document, class)));
        Line {
            map,
            status: done.status(),
            folder,
            error: None,
            errors: &document.errors,
            skipped: &document.skipped,
            findings: &document.findings,
            changes: &done.changes,
            places: places.collect(),
            connections: document.connections.len(),
            area_m2: area_m2(document),
            seconds: done.seconds(),
            sha256: document.sha256.as_deref(),
        }
    }

    fn write(&mut self, row: &str, line: &str) -> Result<()> {
        for (file, text) in self.files.iter_mut().zip([row, line]) {
            file.write_all(text.as_bytes()).context("cannot write the table of the maps")?;
        }
        Ok(())
    }
}

/// Opens a table to be written, unless it is a file of somebody else.
fn open(path: &Path, beginning: &str, force: bool) -> Result<File> {
    let shown = path.display();
    if let Ok(metadata) = fs::symlink_metadata(path) {
        ensure!(metadata.is_file(), "cannot write {shown}: something that is not a file has this name");
        let mut head = Vec::new();
        File::open(path)?.take(beginning.len() as u64).read_to_end(&mut head)?;
        ensure!(
            force || beginning.as_bytes().starts_with(&head),
            "cannot write {shown}: a file of this name exists and is not a table of placegraph; choose another folder, \
             or replace it with --force"
        );
    }
    let opened = File::options().create(true).append(true).open(path);
    opened.with_context(|| format!("cannot write {shown}"))
}

fn n_places(document: &TopologyDocument, class: &str) -> usize {
    document.places.iter().filter(|place| place.class == class).count()
}

fn area_m2(document: &TopologyDocument) -> f64 {
    // Adding zero turns the -0 of no places into 0.
    document.places.iter().map(|place| place.area_m2).sum::<f64>() + 0.0
}

/// Whether spreadsheet programs take a cell that begins like this for a formula.
fn is_formula(text: &str) -> bool {
    text.starts_with(['=', '+', '-', '@', '\t', '\r'])
}

/// A path that no spreadsheet program takes for a formula, and that still leads to the file.
fn plain_path(path: &str) -> String {
    if is_formula(path) { format!("./{path}") } else { path.to_owned() }
}

/// A text that no spreadsheet program takes for a formula.
fn plain_text(text: String) -> String {
    if is_formula(&text) { format!("'{text}") } else { text }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;

    fn job(map: &str) -> Job {
        Job { map: PathBuf::from(map), name: None, place: PathBuf::from("x") }
    }

    #[test]
    fn fields_are_escaped_and_rows_equally_long() {
        let fields = ["a", "b,c", "say \"d\"", "two\nlines", "or\rso"].map(str::to_owned);
        assert_eq!(csv_row(fields.into_iter()), "a,\"b,c\",\"say \"\"d\"\"\",\"two\nlines\",\"or\rso\"\n");
        let out = tempfile::tempdir().unwrap();
        let mut table = Table::start(&out.path().join("new"), &["corridor", "room"], false).unwrap();
        table.add(&job("x.yaml"), &Err(anyhow::anyhow!("expected a map, found none"))).unwrap();
        drop(table); // and with it the lock that the next run waits for
        let text = |name: &str| fs::read_to_string(out.path().join("new").join(name)).unwrap();
        let table = text("summary.csv");
        let lines: Vec<&str> = table.lines().collect();
        assert_eq!(lines[0], "map,status,error,corridor,room,connections,area_m2,seconds,folder,findings");
        assert_eq!(lines[1], "x.yaml,failed,\"expected a map, found none\",,,,,,x,");
        let line: serde_json::Value = serde_json::from_str(&text("summary.jsonl")).unwrap();
        assert_eq!((&line["map"], &line["status"]), (&"x.yaml".into(), &"failed".into()));
        // The next run knows its own tables.
        drop(Table::start(&out.path().join("new"), &["corridor", "room"], false).unwrap());
    }

    #[test]
    fn no_cell_is_a_formula() {
        let out = tempfile::tempdir().unwrap();
        let mut table = Table::start(out.path(), &[], false).unwrap();
        for map in ["=cmd|calc!A1.yaml", "@SUM(1).yaml", "+1.yaml", "-1.yaml"] {
            table.add(&job(map), &Err(anyhow::anyhow!("=1+1"))).unwrap();
        }
        let table = fs::read_to_string(out.path().join("summary.csv")).unwrap();
        let cells = table.lines().flat_map(|line| line.split(','));
        assert!(cells.clone().all(|cell| !is_formula(cell)), "{table}");
        assert!(table.contains("./=cmd|calc!A1.yaml,failed,'=1+1"), "{table}");
    }

    #[test]
    fn tables_of_others_are_left() {
        let out = tempfile::tempdir().unwrap();
        let path = out.path().join("summary.csv");
        fs::write(&path, "year,profit\n").unwrap();
        assert!(Table::start(out.path(), &[], false).is_err());
        assert_eq!(fs::read_to_string(&path).unwrap(), "year,profit\n");
        drop(Table::start(out.path(), &[], true).unwrap());
        drop(Table::start(out.path(), &[], false).unwrap());
    }
}
