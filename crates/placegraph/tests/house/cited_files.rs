//! Pages and comments cite source files, test programs and tests: each must exist.

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

/// Tests in backticks, `file::name` or `file::tests::name`: the last file or module, and the function.
fn cited_tests(text: &str) -> impl Iterator<Item = (&str, &str)> {
    let quoted = text.lines().flat_map(|line| line.split('`').skip(1).step_by(2));
    quoted.filter_map(|cited| {
        let (module, name) = cited.rsplit_once("::")?;
        let is_name =
            |text: &str| text.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_');
        let module = module.trim_end_matches("::tests");
        let module = module.rsplit("::").next().filter(|module| is_name(module))?;
        (is_name(name) && name.contains('_')).then_some((module, name))
    })
}

#[test]
fn cited_tests_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut sources = Vec::new();
    files_below(&root, &[".rs", ".py", ".mjs"], &mut sources);
    let sources: Vec<(String, String)> = sources
        .into_iter()
        .map(|path| (path.to_string_lossy().replace('\\', "/"), fs::read_to_string(path).unwrap()))
        .collect();
    let is_test = |module: &str, name: &str| {
        sources.iter().any(|(path, text)| {
            let is_of = path.contains(&format!("/{module}/")) || path.contains(&format!("/{module}."));
            let declarations = [format!("fn {name}("), format!("def {name}(")];
            is_of && declarations.iter().any(|declaration| text.contains(declaration))
        })
    };
    for (page, least) in [("docs/reliability.md", 20), ("docs/dev/faults.md", 80)] {
        let text = fs::read_to_string(root.join(page)).unwrap();
        let cited: Vec<_> = cited_tests(&text).collect();
        assert!(cited.len() >= least, "{page} cites only {} tests", cited.len());
        for (module, name) in cited {
            assert!(is_test(module, name), "{page} cites {module}::{name}");
        }
    }
}
