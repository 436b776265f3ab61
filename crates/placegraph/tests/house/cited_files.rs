//! Pages and comments cite source files and test programs: each must exist.

use std::fs;
use std::path::{Path, PathBuf};

/// All files below `folder` with one of these endings, without what Cargo or Git keep.
pub(crate) fn files_below(folder: &Path, endings: &[&str], found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            if name != "target" && !name.starts_with('.') {
                files_below(&path, endings, found);
            }
        } else if endings.iter().any(|ending| name.ends_with(ending)) {
            found.push(path);
        }
    }
}

/// What stands in backticks and ends like a Rust file.
fn cited(text: &str) -> impl Iterator<Item = &str> {
    text.lines().flat_map(|line| line.split('`').skip(1).step_by(2)).filter(|cited| {
        let is_rust = Path::new(cited).extension().is_some_and(|extension| extension == "rs");
        is_rust && cited.bytes().all(|b| b.is_ascii_alphanumeric() || b"_-./".contains(&b))
    })
}

#[test]
fn cited_source_files_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let (mut sources, mut pages) = (Vec::new(), Vec::new());
    files_below(&root, &[".rs"], &mut sources);
    files_below(&root, &[".rs", ".md"], &mut pages);
    let mut n_cited = 0;
    for page in &pages {
        for name in cited(&fs::read_to_string(page).unwrap()) {
            assert!(sources.iter().any(|path| path.ends_with(name)), "{} cites {name}", page.display());
            n_cited += 1;
        }
    }
    assert!(n_cited > 20, "only {n_cited} cited files were found");
}

#[test]
fn cited_test_programs_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut pages = Vec::new();
    files_below(&root, &[".md"], &mut pages);
    let mut n_cited = 0;
    for page in &pages {
        let text = fs::read_to_string(page).unwrap();
        for command in text.lines().filter(|line| line.contains("cargo test")) {
            let after = |option: &str| {
                command.split_whitespace().skip_while(move |word| *word != option).nth(1).unwrap_or_default()
            };
            let (package, program) = (after("-p"), after("--test"));
            if !program.is_empty() {
                let exists = fs::read_dir(root.join("crates")).unwrap().any(|entry| {
                    let folder = entry.unwrap().path();
                    (package.is_empty() || folder.ends_with(package))
                        && folder.join("tests").join(program).join("main.rs").exists()
                });
                assert!(exists, "{} cites {package} --test {program}", page.display());
                n_cited += 1;
            }
        }
    }
    assert!(n_cited > 3, "only {n_cited} cited commands were found");
}
