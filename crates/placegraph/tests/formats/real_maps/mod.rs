//! The folder of real maps, which is no part of the repository.

use std::path::PathBuf;

/// The folder that the variable `PLACEGRAPH_DATA` names; without it, says that the test is skipped.
#[expect(clippy::print_stdout, reason = "a skipped test says so")]
pub(crate) fn folder() -> Option<PathBuf> {
    let folder = std::env::var_os("PLACEGRAPH_DATA").map(PathBuf::from);
    if folder.is_none() {
        println!("skipped: PLACEGRAPH_DATA is not set");
    }
    folder
}
