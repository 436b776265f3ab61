//! `placegraph export`: a result in another program's format.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use placegraph::export::{Export, MapInfo};

use super::Outcome;
use crate::args::ExportArgs;
use crate::output::OutputSet;
use crate::{document, read};

/// Writes the file or the files of the format, all or none.
pub(crate) fn run(args: &ExportArgs) -> Result<Outcome> {
    let document = document::read(&args.topology)?;
    let masks = read::masks(args.masks.as_deref())?.0;
    let map = args.map.as_deref().map(|path| read::map(path, &args.read)).transpose()?;
    if let Some(map) = &map {
        ensure!(args.to.needs_cells, "expected --map with the format report only, found {}", args.to.name);
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
    let mut export = Export::new(&document, &masks)?;
    export.written = document::fixed_time().unwrap_or_default();
    export.occupancy = map.as_ref().map(|map| &map.grid.cells);
    let (folder, main) = if args.output.is_dir() {
        (args.output.as_path(), args.to.usual_name(&document.map.name))
    } else {
        let name = args.output.file_name().with_context(|| {
            format!("expected the path of a file or an existing folder, found {}", args.output.display())
        })?;
        let folder = args.output.parent().filter(|folder| !folder.as_os_str().is_empty());
        (folder.unwrap_or(Path::new(".")), name.to_string_lossy().into_owned())
    };
    let mut files = OutputSet::default();
    for (name, bytes) in args.to.write(&export, &main).with_context(|| format!("cannot write {main}"))? {
        files.add(name, bytes);
    }
    files.commit(folder)?;
    Ok(Outcome::Done)
}
