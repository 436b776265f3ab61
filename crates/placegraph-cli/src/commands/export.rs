//! `placegraph export`: a result in another program's format.

use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use placegraph::export::{Export, FileRecord, Format, MapInfo, TopologyDocument};
use placegraph::import::has_memory;
use placegraph::result::{Files, export_word};

use super::Outcome;
use crate::args::ExportArgs;
use crate::commands::map;
use crate::document::{self, DOCUMENT};
use crate::output::{Existing, OutputSet, Target, print_bytes};
use crate::read;

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
        ensure!(
            args.to.needs_cells,
            "--map works only with formats that show cells, which {} does not",
            args.to.name
        );
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
    let usual = args.to.usual_name(&document.map.name);
    let (folder, main) = match Target::of(&args.output)? {
        Target::StandardOutput => (None, usual.clone()),
        Target::Folder(folder) => (Some(folder), usual.clone()),
        Target::File { folder, name } => (Some(folder), name),
    };
    let exported = args.to.write(&export, &main).with_context(|| format!("cannot write {main}"))?;
    let Some(folder) = folder else {
        let [(_, bytes)] = exported.as_slice() else {
            bail!("expected a folder for the files of {}, found standard output", args.to.name);
        };
        print_bytes(bytes)?;
        return Ok(Outcome::Done);
    };
    let joins = main == usual && is_document_of(&args.topology, &folder) && document.is_sealed();
    let mut files = OutputSet::new(if joins { Existing::ReplaceResult } else { Existing::ReplaceOurs });
    let maps =
        map.iter().flat_map(|map| &map.files).chain(&args.masks).chain(std::iter::once(&args.topology));
    files.keep_inputs(&maps.cloned().collect::<Vec<_>>(), args.force);
    if joins {
        join(&mut files, exported, document, args.to)?;
    } else {
        files.extend(exported);
    }
    files.commit(&folder)?;
    Ok(Outcome::Done)
}

fn is_document_of(path: &Path, folder: &Path) -> bool {
    same_file::is_same_file(path, folder.join(DOCUMENT)).unwrap_or(false)
}

/// Adds the files of `format` and the document that has them too: they belong to the result beside which they will lie.
fn join(
    files: &mut OutputSet,
    exported: Files,
    mut document: TopologyDocument,
    format: &Format,
) -> Result<()> {
    let is_replaced = |file: &FileRecord| exported.iter().any(|(name, _)| *name == file.name);
    let kept: Vec<FileRecord> = document.files.iter().filter(|file| !is_replaced(file)).cloned().collect();
    let option = export_word(format);
    if !document.program.options.contains(&option) {
        document.program.options.push(option);
    }
    document.skipped.retain(|skipped| skipped.format != format.name);
    map::join(files, exported, &mut document, kept)
}
