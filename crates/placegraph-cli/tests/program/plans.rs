//! Surveyed buildings through the program.

use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use crate::running::{done, json, names, placegraph, refused, stderr};

/// A plan of the tests.
fn plan(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../placegraph-generate/tests/plans").join(name)
}

#[test]
fn plans_and_flats_become_maps_with_truth() {
    let out = TempDir::new().unwrap();
    let (xml, flats, folder) = (plan("sample.xml"), plan("sample.jsonl"), out.path().join("maps"));
    let generate: [&dyn AsRef<std::ffi::OsStr>; 11] = [
        &"generate",
        &"--plan",
        &xml,
        &"--plan",
        &flats,
        &"--license",
        &"MIT",
        &"--mapping",
        &"clean",
        &"-o",
        &folder,
    ];
    done(&generate);
    assert_eq!(names(&folder), ["sample-0001_1_000", "sample_1_000"]);
    let files = ["graph.json", "labels.png", "map.png", "map.yaml", "objects.json", "rooms.png"];
    assert_eq!(names(&folder.join("sample_1_000")), files);
    let objects = json(&folder.join("sample_1_000/objects.json"));
    assert_eq!((&objects["license"], &objects["source"]), (&"MIT".into(), &"sample".into()));
    assert_eq!(objects["openings"].as_array().unwrap().len(), 6);
    done(&[&generate[..], &[&"--count", &"3"]].concat());
    assert_eq!(names(&folder).len(), 3, "the first plan a second time");
    assert_eq!(json(&folder.join("sample_1_000/objects.json")), objects, "the same bytes again");
}

#[test]
fn what_is_no_plan_is_told_with_its_file_and_its_line() {
    let out = TempDir::new().unwrap();
    let write = |name: &str, text: &str| {
        let path = out.path().join(name);
        fs::write(&path, text).unwrap();
        path
    };
    let folder = out.path().join("maps");
    let xml = write("broken.xml", "<building>");
    refused(&[&"generate", &"--plan", &xml, &"-o", &folder], &["broken.xml", "expected a floor plan"]);
    let other = write("plan.dxf", "");
    refused(&[&"generate", &"--plan", &other, &"-o", &folder], &["plan.dxf", ".xml, .jsonl or .json"]);
    let good = fs::read_to_string(plan("sample.jsonl")).unwrap();
    let flats = write("flats.jsonl", &format!("{{}}\n{good}"));
    let output = placegraph(&[&"generate", &"--plan", &flats, &"--mapping", &"clean", &"-o", &folder]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("line 1: expected a flat"), "{}", stderr(&output));
    assert_eq!(names(&folder), ["flats-0002_1_000"]);
}
