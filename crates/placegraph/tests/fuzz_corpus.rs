//! Replays the committed corpus through the fuzz targets: whole, cut off at every byte, and with every byte
//! changed. No input may panic.
#![expect(clippy::unwrap_used, reason = "helpers of tests")]

#[expect(unreachable_pub, reason = "the fuzz crate exports them")]
mod fuzz_targets;

use std::fs;
use std::path::Path;

/// A file for every way into the readers is in `tests/corpus`; files that once crashed a target go there too.
fn replay(target: &str, run: fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus").join(target);
    let mut n_files = 0;
    for entry in fs::read_dir(&folder).unwrap() {
        let bytes = fs::read(entry.unwrap().path()).unwrap();
        assert!(bytes.len() <= 4096, "the corpus is small");
        run(&bytes);
        for at in 0..bytes.len() {
            run(&bytes[..at]);
            for change in [0x01, 0x80, 0xff] {
                let mut changed = bytes.clone();
                changed[at] ^= change;
                run(&changed);
            }
        }
        n_files += 1;
    }
    assert!(n_files > 0, "{} has files", folder.display());
}

#[test]
fn map_yaml() {
    replay("map_yaml", fuzz_targets::map_yaml);
}

#[test]
fn map_image() {
    replay("map_image", fuzz_targets::map_image);
}

#[test]
fn carmen() {
    replay("carmen", fuzz_targets::carmen);
}

#[test]
fn label_image() {
    replay("label_image", fuzz_targets::label_image);
}

#[test]
fn model() {
    replay("model", fuzz_targets::model);
}

#[test]
fn topology() {
    replay("topology", fuzz_targets::topology);
}

#[test]
fn training_file() {
    replay("training_file", fuzz_targets::training_file);
}

#[test]
fn edits() {
    replay("edits", fuzz_targets::edits);
}
