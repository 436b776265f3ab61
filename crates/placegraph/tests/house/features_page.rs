//! The committed page of features is what the registry says.

use placegraph::features::markdown;

#[test]
fn the_page_is_current() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/features.md");
    if std::env::var_os("REGENERATE").is_some() {
        std::fs::write(path, markdown()).unwrap();
    }
    let committed = std::fs::read_to_string(path).unwrap();
    assert!(committed == markdown(), "docs/features.md is stale: run this test with REGENERATE=1");
}
