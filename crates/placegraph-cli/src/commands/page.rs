//! `placegraph page`: the page for the browser as one file.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use placegraph::export::{ReportInput, view_json};
use placegraph::import::{self, NamedFiles, ros};
use placegraph::topology::edits::EditFile;
use placegraph_web::page::{LIBRARY, Start, page_html};

use super::Outcome;
use crate::args::PageArgs;
use crate::document::DOCUMENT;
use crate::output::write_file;
use crate::{document, read};

/// Most cells of a map that is put into a page: its files are in the page's text.
const MAX_CELLS: u64 = 36_000_000;

/// Writes the page, empty or with what it opens.
pub(crate) fn run(args: &PageArgs) -> Result<Outcome> {
    let library = LIBRARY.context(
        "this program was built without the page: run crates/placegraph-web/build-library target/web/library.lzma, \
         then build it again with PLACEGRAPH_WASM=target/web/library.lzma (docs/page.md)",
    )?;
    let inputs: Vec<PathBuf> = [&args.map, &args.edits].into_iter().flatten().cloned().collect();
    let view;
    let start = match (&args.map, &args.result) {
        (Some(map), _) => map_files(map, args)?,
        (None, Some(folder)) => {
            view = result_view(folder)?;
            Start::Result(&view)
        }
        (None, None) => Start::Empty,
    };
    write_file(&args.output, page_html(library, &start)?.as_bytes(), &inputs)?;
    Ok(Outcome::Done)
}

/// The files of the map at `path`, and its edits.
fn map_files(path: &Path, args: &PageArgs) -> Result<Start<'static>> {
    let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let is_yaml =
        path.extension().is_some_and(|e| e.eq_ignore_ascii_case("yaml") || e.eq_ignore_ascii_case("yml"));
    let mut files = Vec::new();
    if is_yaml {
        let text = read::text(path, "map file")?;
        let yaml = ros::parse_yaml(text.as_bytes()).with_context(|| format!("in {}", path.display()))?;
        let image = import::named_file(path, &yaml.image, NamedFiles::Inside)
            .with_context(|| format!("in {}", path.display()))?;
        files.push((name(path), text.into_bytes()));
        // By its last part the page finds it again.
        files.push((name(Path::new(&yaml.image)), read::image(&image, MAX_CELLS)?));
    } else {
        files.push((name(path), read::image(path, MAX_CELLS)?));
    }
    let edits = match &args.edits {
        Some(path) => {
            let text = read::text(path, "edit file")?;
            EditFile::from_toml(&text).with_context(|| format!("in {}", path.display()))?;
            Some(text)
        }
        None => None,
    };
    Ok(Start::Map { files, resolution_m: args.resolution, edits })
}

/// What a page shows of the result in `folder`.
fn result_view(folder: &Path) -> Result<String> {
    let path = folder.join(DOCUMENT);
    let document = document::read(&path, MAX_CELLS)?;
    let shape = document.map.shape().with_context(|| format!("in {}", path.display()))?;
    Ok(view_json(&ReportInput {
        title: &document.map.name,
        frame_id: &document.map.frame_id,
        map: &document.topology(),
        labels: &document.classes,
        shape: &shape,
        occupancy: None,
        probability: None,
        findings: &document.findings,
        provenance: "",
    }))
}
