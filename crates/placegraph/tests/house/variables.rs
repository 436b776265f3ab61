//! `CONTRIBUTING.md` lists every variable of the environment that this project reads, and no other.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use crate::cited_files::files_below;

/// The names in `text` that begin with `PLACEGRAPH_`.
fn variables(text: &str) -> BTreeSet<String> {
    let name = |(at, _): (usize, &str)| -> String {
        text[at..].chars().take_while(|c| c.is_ascii_uppercase() || *c == '_').collect()
    };
    text.match_indices("PLACEGRAPH_").map(name).filter(|name| name.len() > "PLACEGRAPH_".len()).collect()
}

#[test]
fn every_variable_is_listed() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut files = Vec::new();
    files_below(&root, &[".rs", ".py"], &mut files);
    let texts = files.iter().map(|path| fs::read_to_string(path).unwrap());
    let used: BTreeSet<String> = texts.flat_map(|text| variables(&text)).collect();
    let page = fs::read_to_string(root.join("CONTRIBUTING.md")).unwrap();
    let rows: String = page.lines().filter(|line| line.starts_with("| `")).collect();
    assert_eq!(variables(&rows), used);
}
