//! A module uses only what stands to its left in the order that `ARCHITECTURE.md` gives.

use std::fs;
use std::path::{Path, PathBuf};

/// The order as the page writes it, `a → {b, c} → d`: modules that do not see each other in braces.
fn layers() -> Vec<Vec<String>> {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../ARCHITECTURE.md");
    let page = fs::read_to_string(page).unwrap();
    let line = page.lines().find(|line| line.contains(" → ") && line.starts_with('`')).unwrap();
    let names = |layer: &str| layer.trim_matches(['{', '}']).split(", ").map(str::to_owned).collect();
    line.trim_matches('`').split(" → ").map(names).collect()
}

fn layer(layers: &[Vec<String>], module: &str) -> usize {
    layers
        .iter()
        .position(|names| names.iter().any(|name| name == module))
        .unwrap_or_else(|| panic!("module {module} has no place in the order of ARCHITECTURE.md"))
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files.sort();
    files
}

/// Names after `crate::` in code (not in docs), also those of a group `crate::{a, b::c}`.
fn used_modules(code: &str) -> Vec<String> {
    let code: String =
        code.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n");
    let mut names = Vec::new();
    for (position, _) in code.match_indices("crate::") {
        let rest = &code[position + "crate::".len()..];
        let name: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
        assert!(!name.is_empty(), "write `use crate::module::…`, one line a module");
        names.push(name);
    }
    names
}

#[test]
fn modules_use_only_what_stands_to_their_left() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let layers = layers();
    for name in layers.iter().flatten() {
        assert!(
            source.join(name).is_dir() || source.join(format!("{name}.rs")).is_file(),
            "ARCHITECTURE.md names the module {name}, which does not exist"
        );
    }
    let mut arrows = 0;
    for file in rust_files(&source) {
        let relative = file.strip_prefix(&source).unwrap();
        let module =
            relative.components().next().unwrap().as_os_str().to_str().unwrap().trim_end_matches(".rs");
        if module == "lib" {
            continue;
        }
        let code = fs::read_to_string(&file).unwrap();
        for used in used_modules(&code) {
            arrows += 1;
            assert!(
                used == module || layer(&layers, &used) < layer(&layers, module),
                "{} uses crate::{used}, which does not stand to the left of {module}",
                relative.display()
            );
        }
    }
    assert!(arrows > 0, "the test reads the source");
}
