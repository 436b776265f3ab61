//! The fuzz targets' bodies, which the library's own tests replay too.

#[path = "../../placegraph/tests/formats/fuzz_targets/mod.rs"]
mod fuzz_targets;

pub use fuzz_targets::*;
