//! Many label images against their truths.

use std::fs;

use tempfile::TempDir;

use crate::running::{done, placegraph, refused, shipped, stderr};

#[test]
fn folders_are_judged_map_by_map_and_together() {
    let out = TempDir::new().unwrap();
    let results = out.path().join("results");
    for (map, labels_of) in [("home", "home"), ("office", "office")] {
        fs::create_dir_all(results.join(map)).unwrap();
        let labels = shipped(labels_of).join("labels.png");
        fs::copy(labels, results.join(map).join("labels.png")).unwrap();
    }
    let (truth, csv) = (shipped(""), out.path().join("table.csv"));
    let text = done(&[&"evaluate", &results, &truth, &"--csv", &csv]);
    assert!(
        text.contains("mean") && text.contains("0.8 to 1.2 m") && text.contains("corridor / room"),
        "{text}"
    );
    let table = fs::read_to_string(&csv).unwrap();
    let rows: Vec<&str> = table.lines().collect();
    assert_eq!(rows.len(), 3, "a header and two maps: {table}");
    assert!(rows[1].starts_with("home,1,1,1,1,") && rows[2].starts_with("office,1,1,1,1,"), "{table}");

    let report = done(&[&"evaluate", &results, &truth, &"--json"]);
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["means"]["door_recall"], 1.0);
    let doors = |of: &serde_json::Value| of["doors"]["n_true"].as_u64().unwrap();
    let maps = report["maps"].as_array().unwrap();
    assert_eq!(doors(&report["together"]), maps.iter().map(doors).sum::<u64>());
    assert!(doors(&maps[0]) > 2, "{report}");

    // One map alone, with the resolution that its map.yaml says.
    let (prediction, labels) = (results.join("home/labels.png"), shipped("home/labels.png"));
    let yaml = fs::read_to_string(shipped("home/map.yaml")).unwrap();
    let resolution = yaml.lines().find_map(|line| line.strip_prefix("resolution: ")).unwrap().to_owned();
    let one = done(&[&"evaluate", &prediction, &labels, &"--resolution", &resolution, &"--json"]);
    let one: serde_json::Value = serde_json::from_str(&one).unwrap();
    assert_eq!(one["doors"], maps[0]["doors"]);
}

#[test]
fn a_map_without_a_result_fails_the_check_and_is_named() {
    let out = TempDir::new().unwrap();
    let home = out.path().join("home");
    fs::create_dir_all(&home).unwrap();
    fs::copy(shipped("home/labels.png"), home.join("labels.png")).unwrap();
    let output = placegraph(&[&"evaluate", &out.path(), &shipped(""), &"--json"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("office: no labels.png"), "{}", stderr(&output));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["missing"], serde_json::json!(["office"]));

    let empty = TempDir::new().unwrap();
    refused(&[&"evaluate", &empty.path(), &shipped("")], &["expected results", "found none"]);
    refused(&[&"evaluate", &out.path(), &empty.path()], &["expected folders with labels.png", "found none"]);
    let image = home.join("labels.png");
    refused(&[&"evaluate", &image, &shipped("")], &["expected a folder of results"]);
    refused(&[&"evaluate", &image, &image, &"--csv", &empty.path().join("t.csv")], &["expected folders"]);
    refused(&[&"evaluate", &image, &image, &"--resolution", &"0"], &["resolution above 0"]);
}
