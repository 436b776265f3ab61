//! Not a number, infinite, out of range: in the place of every number of every kind of file.

use crate::fuzz_targets;
use std::fs;
use std::ops::Range;
use std::path::Path;

use placegraph::export::TopologyDocument;
use placegraph::import::{TrainingFile, ros};
use placegraph::model::Model;
use placegraph::topology::edits::EditFile;

const JSON: &[&str] = &["NaN", "Infinity", "-Infinity", "1e999", "-1e999"];
const TOML: &[&str] = &["nan", "-nan", "inf", "-inf", "1e999"];
const YAML: &[&str] = &[".nan", ".NaN", ".inf", "-.inf", "1e999"];
/// Finite, but nothing that a file means.
const HUGE: &[&str] = &["1e300", "-1e300", "-1", "0", "1e-300", "4294967295", "18446744073709551616"];

/// Where the numbers of a text stand, outside of quotes, comments and words.
fn numbers(text: &str) -> Vec<Range<usize>> {
    let bytes = text.as_bytes();
    let is_part = |b: u8| b.is_ascii_alphanumeric() || matches!(b, b'.' | b'+' | b'-' | b'_');
    let (mut found, mut quote, mut at) = (Vec::new(), None, 0);
    while at < bytes.len() {
        let byte = bytes[at];
        if quote.is_some() {
            quote = quote.filter(|&open| open != byte);
        } else if matches!(byte, b'"' | b'\'') {
            quote = Some(byte);
        } else if byte == b'#' {
            // A comment ends with its line.
            quote = Some(b'\n');
        } else if is_part(byte) {
            let end = at + bytes[at..].iter().position(|&b| !is_part(b)).unwrap_or(bytes.len() - at);
            if text[at..end].parse::<f64>().is_ok() {
                found.push(at..end);
            }
            at = end;
            continue;
        }
        at += 1;
    }
    found
}

/// Reads every file of the corpus that is good with each of its numbers replaced by each of `bad`, which must be
/// refused, and by huge ones, which must not crash. Returns how often.
fn refused(kind: &str, bad: &[&str], is_read: fn(&[u8]) -> bool, run: fn(&[u8])) -> usize {
    let mut n_cases = 0;
    for entry in fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus").join(kind)).unwrap()
    {
        let path = entry.unwrap().path();
        let Ok(text) = String::from_utf8(fs::read(&path).unwrap()) else { continue };
        if !is_read(text.as_bytes()) {
            continue;
        }
        for place in numbers(&text) {
            let with = |number: &str| [&text[..place.start], number, &text[place.end..]].concat();
            for number in bad {
                let shown = path.display();
                assert!(!is_read(with(number).as_bytes()), "{number} at {place:?} of {shown} is refused");
            }
            for number in HUGE {
                run(with(number).as_bytes());
            }
            n_cases += bad.len() + HUGE.len();
        }
    }
    n_cases
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

#[test]
fn in_a_map_yaml() {
    let n = refused("map_yaml", YAML, |bytes| ros::parse_yaml(bytes).is_ok(), fuzz_targets::map_yaml);
    assert!(n > 200, "{n} cases");
}

#[test]
fn in_a_model() {
    let n = refused("model", JSON, |bytes| Model::from_json(bytes).is_ok(), fuzz_targets::model);
    assert!(n > 500, "{n} cases");
}

#[test]
fn in_a_topological_map() {
    let is_read: fn(&[u8]) -> bool = |bytes| TopologyDocument::from_json(bytes).is_ok();
    let n = refused("topology", JSON, is_read, fuzz_targets::topology);
    assert!(n > 500, "{n} cases");
}

#[test]
fn in_a_training_file() {
    let is_read: fn(&[u8]) -> bool = |bytes| TrainingFile::from_toml(text(bytes)).is_ok();
    let n = refused("training_file", TOML, is_read, fuzz_targets::training_file);
    assert!(n > 100, "{n} cases");
}

#[test]
fn in_an_edit_file() {
    let is_read: fn(&[u8]) -> bool = |bytes| EditFile::from_toml(text(bytes)).is_ok();
    let n = refused("edits", TOML, is_read, fuzz_targets::edits);
    assert!(n > 100, "{n} cases");
}

#[test]
fn numbers_are_told_from_words_and_texts() {
    let text = "a1 = -1.5e3 # 7\n\"2\": [3,4.0], '6', room 4: {x: -.5}";
    let found: Vec<&str> = numbers(text).into_iter().map(|place| &text[place]).collect();
    assert_eq!(found, ["-1.5e3", "3", "4.0", "4", "-.5"]);
}
