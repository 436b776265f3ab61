//! Whether a result that is there is the one that would be made now.

use std::path::Path;

use placegraph::export::TopologyDocument;
use placegraph::import::{self, LoadedMap};

use super::setup::{Context, Setup};
use crate::document::{self, DOCUMENT};

/// The result in `folder` if it is whole and made from `map` just as it would be made now.
pub(super) fn kept(
    map: &LoadedMap,
    folder: &Path,
    setup: &Setup<'_>,
    context: &Context,
) -> Option<TopologyDocument> {
    let found = document::read(&folder.join(DOCUMENT), setup.args.read.max_cells).ok()?;
    let is_same = found.program.version == env!("CARGO_PKG_VERSION")
        && found.program.options == context.options
        && found.map.hash == map.hash
        && found.map.name == map.name
        && found.model.as_ref() == Some(&setup.model.info());
    (is_same && is_whole(&found, folder)).then_some(found)
}

/// Whether the document and all files that it lists are as they were written.
fn is_whole(document: &TopologyDocument, folder: &Path) -> bool {
    let is_as_written = |file: &placegraph::export::FileRecord| {
        import::read(&folder.join(&file.name), file.bytes).is_ok_and(|bytes| file.matches(&bytes))
    };
    document.is_sealed() && !document.files.is_empty() && document.files.iter().all(is_as_written)
}
