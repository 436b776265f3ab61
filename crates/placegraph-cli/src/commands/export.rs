//! `placegraph export`: a result in another program's format.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use placegraph::export::{Export, MapInfo};
use placegraph::import::has_memory;

use super::Outcome;
use crate::args::ExportArgs;
use crate::output::OutputSet;
use crate::{document, read};

/// Memory that an export takes at most for each cell of the map: a turned mask is twice as large as the map.
const EXPORT_BYTES_PER_CELL: u64 = 8;

/// Writes the file or the files of the format, all or none.
pub(crate) fn run(args: &ExportArgs) -> Result<Outcome> {
    let document = document::read(&args.topology, args.read.max_cells)?;
    let n_bytes = EXPORT_BYTES_PER_CELL * u64::from(document.map.width) * u64::from(document.map.height);
    ensure!(
        has_memory(n_bytes),
        "not enough memory: exporting {} takes {n_bytes} bytes",
        args.topology.display()
    );
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
    export.georeference = args.georeference.map(|place| place.0);
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
