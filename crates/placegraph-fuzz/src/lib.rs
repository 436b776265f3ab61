//! The fuzz targets' bodies, which the library's own tests replay too.

#[path = "../../placegraph/tests/formats/fuzz_targets/mod.rs"]
mod fuzz_targets;

pub use fuzz_targets::*;

/// Runs the target called `name`.
///
/// # Panics
/// If there is none, or if the target finds what it looks for.
pub fn run(name: &str, bytes: &[u8]) {
    let target = TARGETS.iter().find(|(target, _)| *target == name);
    let (_, run) = target.unwrap_or_else(|| panic!("no target is called {name}"));
    run(bytes);
}
