//! Many maps in one run: a line each, a table at the end, and what is done stays done.

use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Result, ensure};
use placegraph::export::TopologyDocument;

use super::Outcome;
use crate::args::MapArgs;
use crate::guard::guarded;
use crate::labeling::{Setup, summary};
use crate::output::write_file;
use crate::progress::{MapCounter, Watch};
use crate::read;

/// Labels all maps into their `folders` and writes `summary.csv`; a map that fails does not stop the rest.
pub(crate) fn run(folders: &[PathBuf], setup: &Setup<'_>, args: &MapArgs) -> Result<Outcome> {
    let counter = MapCounter::start(args.maps.len());
    let classes = setup.classes();
    let mut table = Table::new(&classes);
    let (mut n_failed, mut n_incomplete) = (0, 0);
    for (path, folder) in args.maps.iter().zip(folders) {
        let name = path.display().to_string();
        counter.begin(&name);
        let result = guarded(|| label(path, folder, setup, args));
        counter.end(&match &result {
            Ok(Done { time, document, left_out }) => {
                let kept = time.is_none().then(|| "kept".to_owned());
                let parts = kept.into_iter().chain([summary(document)]).chain(left_out.iter().cloned());
                format!("{name}: {}", parts.collect::<Vec<_>>().join("; "))
            }
            Err(error) => format!("error: {name}: {error:#}"),
        });
        n_failed += usize::from(result.is_err());
        n_incomplete += usize::from(result.as_ref().is_ok_and(|done| !done.left_out.is_empty()));
        table.add(&name, &result);
    }
    drop(counter);
    write_file(&args.out.join("summary.csv"), table.text.as_bytes())?;
    ensure!(n_failed < args.maps.len(), "none of the {n_failed} maps could be labeled");
    Ok(if n_failed + n_incomplete == 0 { Outcome::Done } else { Outcome::CheckFailed })
}

/// A map that has its results.
struct Done {
    /// How long its stages took, reading and writing files not among them; `None` if an earlier run labeled it.
    time: Option<Duration>,
    document: TopologyDocument,
    /// Formats that were left out, and why.
    left_out: Vec<String>,
}

fn label(path: &Path, folder: &Path, setup: &Setup<'_>, args: &MapArgs) -> Result<Done> {
    let map = read::map(path, &args.read)?;
    if args.resume
        && let Some(document) = setup.kept(&map, folder)
    {
        let left_out = setup.left_out_of(&document);
        return Ok(Done { time: None, document, left_out });
    }
    let mut labeled = setup.label(&map, &Watch::without_bar())?;
    setup.files(&map, &mut labeled)?.commit(folder)?;
    let time = labeled.timings.iter().map(|(_, time)| *time).sum();
    Ok(Done { time: Some(time), document: labeled.document, left_out: labeled.left_out })
}

/// A row per map, as comma-separated values.
struct Table<'a> {
    classes: &'a [&'a str],
    text: String,
}

impl<'a> Table<'a> {
    fn new(classes: &'a [&'a str]) -> Self {
        let header = ["map", "status", "error"].iter().chain(classes);
        let header = header.chain(&["connections", "area_m2", "seconds"]).map(|&name| name.to_owned());
        Self { classes, text: row(header) }
    }

    fn add(&mut self, map: &str, result: &Result<Done>) {
        let fields = match result {
            Ok(Done { time, document, left_out }) => {
                let status = if time.is_some() { "labeled" } else { "kept" };
                let seconds = time.map(|time| format!("{:.3}", time.as_secs_f64())).unwrap_or_default();
                let mut fields = vec![map.to_owned(), status.to_owned(), left_out.join("; ")];
                let n_places = |class: &&str| document.places.iter().filter(|p| p.class == **class).count();
                fields.extend(self.classes.iter().map(|class| n_places(class).to_string()));
                let area_m2: f64 = document.places.iter().map(|place| place.area_m2).sum();
                let connections = document.connections.len().to_string();
                fields.extend([connections, format!("{area_m2:.3}"), seconds]);
                fields
            }
            Err(error) => {
                let mut fields = vec![map.to_owned(), "failed".to_owned(), format!("{error:#}")];
                fields.resize(self.classes.len() + 6, String::new());
                fields
            }
        };
        self.text += &row(fields.into_iter());
    }
}

/// `fields` as a line of comma-separated values (RFC 4180, with plain line ends).
fn row(fields: impl Iterator<Item = String>) -> String {
    let escaped = |field: String| {
        if field.contains(['"', ',', '\n', '\r']) {
            format!("\"{}\"", field.replace('"', "\"\""))
        } else {
            field
        }
    };
    fields.map(escaped).collect::<Vec<_>>().join(",") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_escaped_and_rows_equally_long() {
        assert_eq!(
            row(["a", "b,c", "say \"d\""].map(str::to_owned).into_iter()),
            "a,\"b,c\",\"say \"\"d\"\"\"\n"
        );
        let mut table = Table::new(&["corridor", "room"]);
        table.add("x.yaml", &Err(anyhow::anyhow!("expected a map, found none")));
        let lines: Vec<&str> = table.text.lines().collect();
        assert_eq!(lines[0], "map,status,error,corridor,room,connections,area_m2,seconds");
        assert_eq!(lines[1], "x.yaml,failed,\"expected a map, found none\",,,,,");
    }
}
