//! Puts the library that `build-library` made into the crate, if `PLACEGRAPH_WASM` names it.

use std::path::PathBuf;
use std::{env, fs, io};

/// Blocks of scans are worked on in large arrays.
const STACK_BYTES: u32 = 8 << 20;

fn main() -> io::Result<()> {
    if env::var("CARGO_CFG_TARGET_ARCH").as_deref() == Ok("wasm32") {
        println!("cargo::rustc-link-arg-cdylib=-zstack-size={STACK_BYTES}");
        println!("cargo::rustc-link-arg-cdylib=--strip-all");
    }
    println!("cargo::rerun-if-env-changed=PLACEGRAPH_WASM");
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or_else(|| io::Error::other("OUT_DIR is not set"))?);
    let library = match env::var_os("PLACEGRAPH_WASM") {
        Some(path) if env::var("CARGO_CFG_TARGET_ARCH").as_deref() != Ok("wasm32") => {
            let path = fs::canonicalize(path)?;
            println!("cargo::rerun-if-changed={}", path.display());
            format!("Some(include_bytes!({:?}))", path.display().to_string())
        }
        _ => "None".to_owned(),
    };
    fs::write(out.join("library.rs"), library)
}
