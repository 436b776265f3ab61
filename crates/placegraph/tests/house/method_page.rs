//! `docs/method.md` names every equation of the chapter, with a function and a test that exist.

use std::fs;
use std::path::Path;

/// All text of the Rust files below `folder`.
fn code_below(folder: &Path) -> String {
    let mut code = String::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            code += &code_below(&path);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            code += &fs::read_to_string(&path).unwrap();
        }
    }
    code
}

#[test]
fn every_equation_has_a_function_and_a_test() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = fs::read_to_string(root.join("../../docs/method.md")).unwrap();
    let (source, tests) = (code_below(&root.join("src")), code_below(&root.join("tests")));
    for number in 1..=13 {
        let row = page
            .lines()
            .find(|line| line.starts_with(&format!("| (4.{number}) ")))
            .unwrap_or_else(|| panic!("equation 4.{number} has no row in docs/method.md"));
        let names: Vec<&str> = row.split('`').skip(1).step_by(2).collect();
        let [function, test] = names[..] else { panic!("expected a function and a test in {row}") };
        let name = function.rsplit("::").next().unwrap();
        let defines =
            |name: &str| source.contains(&format!("fn {name}(")) || source.contains(&format!("fn {name}<"));
        assert!(defines(name), "{function} of equation 4.{number} does not exist");
        assert!(
            defines(test) || tests.contains(&format!("fn {test}(")),
            "{test} of equation 4.{number} does not exist"
        );
    }
}
