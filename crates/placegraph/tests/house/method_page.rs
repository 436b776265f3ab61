//! `docs/method.md` names every equation of the chapter, with a function that quotes it, a plain twin and a test.

use std::fs;
use std::path::{Path, PathBuf};

/// Path and text of the Rust files below `folder`.
fn code_below(folder: &Path) -> Vec<(PathBuf, String)> {
    let mut code = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            code.extend(code_below(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text = fs::read_to_string(&path).unwrap();
            code.push((path, text));
        }
    }
    code
}

fn defines(text: &str, path: &str) -> bool {
    let name = path.rsplit("::").next().unwrap();
    text.contains(&format!("fn {name}(")) || text.contains(&format!("fn {name}<"))
}

#[test]
fn every_equation_has_a_function_that_quotes_it_and_a_test() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = fs::read_to_string(root.join("../../docs/method.md")).unwrap();
    let (source, tests) = (code_below(&root.join("src")), code_below(&root.join("tests")));
    let twins = code_below(&root.join("../placegraph-testkit/src"));
    for number in 1..=13 {
        let equation = format!("(4.{number})");
        let row = page
            .lines()
            .find(|line| line.starts_with(&format!("| {equation} ")))
            .unwrap_or_else(|| panic!("equation {equation} has no row in docs/method.md"));
        let cells: Vec<&str> = row.split('|').map(|cell| cell.trim().trim_matches('`')).collect();
        let [_, _, _, function, twin, test, _] = cells[..] else { panic!("expected five columns in {row}") };
        let quotes = |(_, text): &(PathBuf, String)| defines(text, function) && text.contains(&equation);
        assert!(source.iter().any(quotes), "no file that defines {function} quotes equation {equation}");
        let is_test = |(_, text): &(PathBuf, String)| text.contains(&format!("fn {test}("));
        assert!(source.iter().chain(&tests).any(is_test), "{test} of equation {equation} does not exist");
        if !twin.is_empty() {
            let file = twin.split("::").nth(1).unwrap();
            let is_twin = |(path, text): &(PathBuf, String)| {
                path.ends_with(format!("{file}.rs")) && defines(text, twin)
            };
            assert!(twins.iter().any(is_twin), "the twin {twin} of equation {equation} does not exist");
        }
    }
}
