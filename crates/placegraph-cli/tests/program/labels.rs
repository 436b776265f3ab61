//! Labels from one format to another, and classes of one's own through `train`, `map` and `evaluate`.

use std::fs;
use std::path::PathBuf;

use tempfile::TempDir;

use crate::running::{done, json, refused, shipped};

const FORMATS: [(&str, &str); 4] =
    [("png", "l.png"), ("labelme", "l.json"), ("coco", "c.json"), ("geojson", "l.geojson")];

#[test]
fn pre_labels_go_out_and_come_back_cell_for_cell() {
    let out = TempDir::new().unwrap();
    let (map, file) = (shipped("office/map.yaml"), |name: &str| out.path().join(name));
    done(&[&"map", &map, &"--out", &out.path()]);
    for (format, name) in FORMATS {
        let (there, back) = (file(name), file("back.png"));
        done(&[&"labels", &map, &"--from", &out.path(), &"--to", &format, &"-o", &there]);
        done(&[&"labels", &map, &"--from", &there, &"--to", &"png", &"-o", &back]);
        let report = done(&[&"evaluate", &file("labels.png"), &back, &"--json"]);
        let report: serde_json::Value = serde_json::from_str(&report).unwrap();
        assert_eq!(report["cells"]["accuracy"], 1.0, "{format}");
        let found = report["cells"]["n_cells"].as_u64().unwrap();
        assert!(found > 90_000, "{format}: {found} cells");
    }
    // The document of the result says the same of all cells that belong to places.
    let back = file("document.png");
    done(&[&"labels", &map, &"--from", &file("topology.json"), &"--to", &"png", &"-o", &back]);
    let report = done(&[&"evaluate", &file("labels.png"), &back, &"--min-accuracy", &"1"]);
    assert!(report.contains("100.00 %"), "{report}");
    // labelme opens the image that the file names.
    let named = json(&file("l.json"))["imagePath"].as_str().map(PathBuf::from).unwrap();
    assert!(named.is_file() && named.ends_with("map.png"), "{}", named.display());
}

#[test]
fn edits_of_a_result_become_labels() {
    let out = TempDir::new().unwrap();
    let (map, edits) = (shipped("home/map.yaml"), out.path().join("edits.toml"));
    done(&[&"map", &map, &"--out", &out.path()]);
    let place = |document: &serde_json::Value| {
        let places = document["places"].as_array().unwrap();
        let room = places.iter().find(|place| place["class"] == "room").unwrap();
        let at = |axis: &str| room["anchor"][axis].as_f64().unwrap();
        (format!("[{:?}, {:?}]", at("x"), at("y")), room["n_cells"].as_u64().unwrap())
    };
    let (at, n_cells) = place(&json(&out.path().join("topology.json")));
    fs::write(&edits, format!("[[edit]]\naction = \"relabel\"\nat = {at}\nclass = \"corridor\"\n")).unwrap();
    done(&[&"map", &map, &"--out", &out.path().join("edited"), &"--edits", &edits]);
    let labels = out.path().join("corrected.png");
    let document = out.path().join("edited/topology.json");
    done(&[&"labels", &map, &"--from", &document, &"--to", &"png", &"-o", &labels]);
    let report = done(&[&"evaluate", &out.path().join("edited/labels.png"), &labels, &"--json"]);
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["cells"]["accuracy"], 1.0);
    let before = done(&[&"evaluate", &out.path().join("labels.png"), &labels, &"--json"]);
    let before: serde_json::Value = serde_json::from_str(&before).unwrap();
    let moved = before["cells"]["confusion"]["counts"][0][1].as_u64().unwrap();
    assert_eq!(moved, n_cells, "the cells of the room that is a corridor now");
}

#[test]
fn wrong_labels_are_refused_with_a_way_out() {
    let out = TempDir::new().unwrap();
    let (map, file) = (shipped("home/map.yaml"), out.path().join("labels.json"));
    let try_with = |text: &str, words: &[&str]| {
        fs::write(&file, text).unwrap();
        refused(
            &[&"labels", &map, &"--from", &file, &"--to", &"png", &"-o", &out.path().join("l.png")],
            words,
        );
        refused(&[&"train", &"--map", &map, &"--labels", &file, &"-o", &out.path().join("m.json")], words);
    };
    let shapes = |label: &str, size: &str| {
        format!(
            r#"{{"imageWidth": 293, "imageHeight": {size}, "shapes":
                [{{"label": "{label}", "points": [[0, 0], [9, 9], [0, 9]], "shape_type": "polygon"}}]}}"#
        )
    };
    try_with(
        &shapes("kitchen", "211"),
        &["labels.json", "shape 1", "\"kitchen\"", "corridor, room, doorway"],
    );
    try_with(&shapes("room", "210"), &["293 x 211", "293 x 210"]);
    try_with("{\"places\": []}", &["topology.json"]);
    try_with("{}", &["labelme", "GeoJSON"]);
    assert!(!out.path().join("l.png").exists() && !out.path().join("m.json").exists());
}
