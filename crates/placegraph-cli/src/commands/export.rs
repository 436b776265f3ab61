//! `placegraph export`: a result in another program's format.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use placegraph::export::MapInfo;

use super::Outcome;
use crate::args::{ExportArgs, Format};
use crate::exports::{Subject, usual_name};
use crate::masks::Masks;
use crate::output::OutputSet;
use crate::{document, read};

/// Writes the file or the files of the format, all or none.
pub(crate) fn run(args: &ExportArgs) -> Result<Outcome> {
    let document = document::read(&args.topology)?;
    let masks = Masks::load(args.masks.as_deref())?;
    let map = args.map.as_deref().map(|path| read::map(path, &args.read)).transpose()?;
    if let Some(map) = &map {
        ensure!(args.to == Format::Report, "expected --map with the format report only, found {}", args.to);
        let found = MapInfo::of(&map.grid, &document.map.name, &map.hash);
        ensure!(
            (found.hash == document.map.hash)
                && (found.width, found.height) == (document.map.width, document.map.height),
            "expected the map that {} was made from, found one with hash {} instead of {}",
            args.topology.display(),
            found.hash,
            document.map.hash
        );
    }
    let mut subject = Subject::new(&document, &masks)?;
    subject.occupancy = map.as_ref().map(|map| &map.grid.cells);
    let (folder, main) = if args.output.is_dir() {
        (args.output.as_path(), usual_name(args.to, &document.map.name))
    } else {
        let name = args.output.file_name().with_context(|| {
            format!("expected the path of a file or an existing folder, found {}", args.output.display())
        })?;
        let folder = args.output.parent().filter(|folder| !folder.as_os_str().is_empty());
        (folder.unwrap_or(Path::new(".")), name.to_string_lossy().into_owned())
    };
    let mut files = OutputSet::default();
    for (name, bytes) in subject.files(args.to, &main)? {
        files.add(name, bytes);
    }
    files.commit(folder)?;
    Ok(Outcome::Done)
}
