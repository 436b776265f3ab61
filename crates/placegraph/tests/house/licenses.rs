//! Whoever gets a crate gets its licenses.

use std::fs;
use std::path::Path;

#[test]
fn every_published_crate_has_both_licenses() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let text = |path: &Path| fs::read_to_string(path).unwrap_or_else(|_| panic!("{}", path.display()));
    let mut n_crates = 0;
    for entry in fs::read_dir(root.join("crates")).unwrap() {
        let folder = entry.unwrap().path();
        let manifest = text(&folder.join("Cargo.toml"));
        if manifest.contains("publish = false") {
            continue;
        }
        n_crates += 1;
        for name in ["LICENSE-MIT", "LICENSE-APACHE"] {
            assert_eq!(text(&folder.join(name)), text(&root.join(name)), "{name} of {}", folder.display());
        }
    }
    assert!(n_crates >= 4, "only {n_crates} crates are published");
}
