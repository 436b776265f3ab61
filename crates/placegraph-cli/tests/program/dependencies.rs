//! What the crates that placegraph is made of may be, as `deny.toml` says: their licenses, where they come from, and
//! which there are none of. `cargo deny check` asks the same and more, where it is installed.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

/// All crates of the lock file: of the program, its tests and its tools.
fn packages() -> Vec<Value> {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--locked", "--format-version", "1", "--manifest-path"])
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml"))
        .output()
        .expect("cargo starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    metadata["packages"].as_array().unwrap().clone()
}

fn rules() -> toml::Table {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../deny.toml");
    std::fs::read_to_string(path).unwrap().parse().unwrap()
}

fn strings<'a>(
    values: &'a toml::Value,
    of: impl Fn(&'a toml::Value) -> &'a toml::Value,
) -> BTreeSet<&'a str> {
    values.as_array().unwrap().iter().map(|value| of(value).as_str().unwrap()).collect()
}

#[test]
fn licenses_are_those_allowed() {
    let rules = rules();
    let allowed = strings(&rules["licenses"]["allow"], |name| name);
    let mut n_judged = 0;
    for package in packages() {
        let name = package["name"].as_str().unwrap();
        let license = package["license"].as_str().unwrap_or_else(|| panic!("{name} names no license"));
        let expression = spdx::Expression::parse_mode(license, spdx::ParseMode::LAX).unwrap();
        let is_allowed = expression.evaluate(|license| allowed.contains(license.to_string().as_str()));
        assert!(is_allowed, "{name}: {license}");
        n_judged += 1;
    }
    assert!(n_judged > 50, "the crates of a whole program, not {n_judged}");
}

#[test]
fn crates_come_from_the_registry_of_the_language_and_none_brings_the_network() {
    let rules = rules();
    let banned = strings(&rules["bans"]["deny"], |entry| &entry["crate"]);
    assert!(banned.contains("reqwest"), "{banned:?}");
    for package in packages() {
        let name = package["name"].as_str().unwrap();
        assert!(!banned.contains(name), "{name} is banned");
        // Our own crates have no source.
        let source = package["source"].as_str().unwrap_or("registry+");
        assert!(source.starts_with("registry+"), "{name} comes from {source}");
    }
}
