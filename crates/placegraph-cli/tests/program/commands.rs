//! The program as its users run it: files in, files out, exit status, one clear message for every mistake.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::running::{done, done_with, names, placegraph, refused, shipped, stderr};
use placegraph::scan::Instructions;
use tempfile::TempDir;

#[test]
fn one_map_goes_into_the_folder_itself() {
    let out = TempDir::new().unwrap();
    done(&[&"map", &shipped("office/map.yaml"), &"--out", &out.path()]);
    let contract =
        ["labels.png", "labels.yaml", "overview.png", "regions.png", "regions.yaml", "topology.json"];
    assert_eq!(names(out.path()), contract);
    // What it writes, it reads: the label image is a map_server map.
    done(&[&"info", &out.path().join("labels.yaml")]);
}

#[test]
fn several_maps_get_a_folder_each_and_one_that_fails_stops_nobody() {
    let out = TempDir::new().unwrap();
    let missing = out.path().join("missing.yaml");
    let output = placegraph(&[
        &"map",
        &shipped("office/map.yaml"),
        &missing,
        &shipped("home/map.yaml"),
        &"--out",
        &out.path().join("all"),
    ]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(stderr(&output).contains("missing.yaml"));
    assert_eq!(names(&out.path().join("all")), ["home", "office", "summary.csv", "summary.jsonl"]);
}

#[test]
fn stages_and_probabilities_are_written_on_request() {
    let out = TempDir::new().unwrap();
    done(&[&"map", &shipped("home/map.yaml"), &"--out", &out.path(), &"--stages", &"--probabilities"]);
    for name in ["labels.1-classified.png", "labels.2-smoothed.png", "probabilities.npy"] {
        assert!(out.path().join(name).exists(), "{name}");
    }
    let npy = fs::read(out.path().join("probabilities.npy")).unwrap();
    assert!(npy.starts_with(b"\x93NUMPY\x01\x00"));
}

/// Everything but the clock.
fn results(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let read = |name: String| {
        let mut bytes = fs::read(folder.join(&name)).unwrap();
        if name == "topology.json" {
            let mut document: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
            document.as_object_mut().unwrap().remove("timings_ms").expect("timings are told");
            bytes = serde_json::to_vec(&document).unwrap();
        }
        (name, bytes)
    };
    names(folder).into_iter().map(read).collect()
}

#[test]
fn the_bytes_do_not_depend_on_the_threads() {
    let out = TempDir::new().unwrap();
    let results = ["1", "4"].map(|n| {
        let folder = out.path().join(n);
        done(&[
            &"map",
            &shipped("home/map.yaml"),
            &"--out",
            &folder,
            &"--probabilities",
            &"--export",
            &"all",
            &"--threads",
            &n,
        ]);
        results(&folder)
    });
    assert!(results[0].len() > 20);
    for ((name, bytes), (_, other)) in results[0].iter().zip(&results[1]) {
        assert!(bytes == other, "{name} differs");
    }
}

#[test]
fn the_bytes_do_not_depend_on_the_instructions() {
    let out = TempDir::new().unwrap();
    let (map, labels) = (shipped("home/map.yaml"), shipped("home/labels.png"));
    let results = Instructions::ALL.map(|instructions| {
        let folder = out.path().join(instructions.name());
        let with = (Instructions::VARIABLE, instructions.name());
        // Scans, features, boosting and its scores; then relaxation and all that follows.
        let model = folder.join("home.model.json");
        fs::create_dir(&folder).unwrap();
        let few: [&dyn AsRef<std::ffi::OsStr>; 4] = [&"--rounds", &"20", &"--max-cells-per-class", &"400"];
        let train: [&dyn AsRef<std::ffi::OsStr>; 7] =
            [&"train", &"--map", &map, &"--labels", &labels, &"-o", &model];
        done_with(with, &[&train[..], &few].concat());
        done_with(with, &[&"map", &map, &"--out", &folder, &"--probabilities", &"--export", &"all"]);
        results(&folder)
    });
    assert!(results[0].len() > 20);
    for other in &results[1..] {
        for ((name, bytes), (_, other)) in results[0].iter().zip(other) {
            assert!(bytes == other, "{name} differs");
        }
    }
    let variable = (Instructions::VARIABLE, "widest of all");
    let refused =
        Command::new(env!("CARGO_BIN_EXE_placegraph")).env(variable.0, variable.1).arg("features").output();
    assert!(stderr(&refused.unwrap()).contains("widest, avx2, plain"));
}

#[test]
fn a_model_trained_here_labels_and_is_judged() {
    let out = TempDir::new().unwrap();
    let model = out.path().join("home.model.json");
    let manifest = out.path().join("training.toml");
    let home = fs::canonicalize(shipped("home")).unwrap();
    fs::write(
        &manifest,
        format!(
            "[[map]]\nmap = '{0}/map.yaml'\nlabels = '{0}/labels.png'\n\
             [classes]\nhall = {{ value = 1, role = 'passage' }}\nroom = {{ value = 2, role = 'place' }}\n\
             door = {{ color = [3, 3, 3], role = 'doorway' }}\n",
            home.display()
        ),
    )
    .unwrap();
    let report = done(&[
        &"train",
        &manifest,
        &"-o",
        &model,
        &"--rounds",
        &"30",
        &"--temperature",
        &"1",
        &"--max-cells-per-class",
        &"800",
    ]);
    assert!(report.contains("orders of the decision list"), "{report}");
    let folder = out.path().join("out");
    done(&[&"map", &home.join("map.yaml"), &"--model", &model, &"--out", &folder]);
    let evaluate: [&dyn AsRef<std::ffi::OsStr>; 9] = [
        &"evaluate",
        &folder.join("labels.png"),
        &home.join("labels.png"),
        &"--rooms",
        &home.join("rooms.png"),
        &"--regions",
        &folder.join("regions.png"),
        &"--model",
        &model,
    ];
    let json: serde_json::Value =
        serde_json::from_str(&done(&[&evaluate[..], &[&"--json"]].concat())).expect("JSON");
    let accuracy = json["cells"]["accuracy"].as_f64().expect("an accuracy");
    assert!(accuracy > 0.8, "trained on this very map, found {accuracy}");
    assert!(json["rooms"]["recall"].is_number(), "{json}");
    let strict = placegraph(&[&evaluate[..], &[&"--min-accuracy", &"1.0"]].concat());
    assert_eq!(strict.status.code(), Some(1), "a requested check failed");
}

#[test]
fn a_network_trained_here_labels_and_its_method_is_checked() {
    let out = TempDir::new().unwrap();
    let model = out.path().join("network.model.json");
    let home = shipped("home");
    let (map, labels) = (home.join("map.yaml"), home.join("labels.png"));
    let train: [&dyn AsRef<std::ffi::OsStr>; 15] = [
        &"train",
        &"--crop",
        &"0,0,110,105",
        &"--map",
        &map,
        &"--labels",
        &labels,
        &"-o",
        &model,
        &"--method",
        &"iamn",
        &"--rounds",
        &"20",
        &"--max-cells-per-class",
        &"400",
    ];
    let report = done(&train);
    assert!(report.contains("orders of the decision list") && report.contains("chosen: M"), "{report}");
    let folder = out.path().join("out");
    done(&[&"map", &map, &"--model", &model, &"--method", &"iamn", &"--out", &folder]);
    let crop: [&dyn AsRef<std::ffi::OsStr>; 3] = [&"--crop", &"0,0,110,105", &"--json"];
    let labeled = folder.join("labels.png");
    let judged: [&dyn AsRef<std::ffi::OsStr>; 3] = [&"evaluate", &labeled, &labels];
    let score = done(&[&judged[..], &crop].concat());
    let score: serde_json::Value = serde_json::from_str(&score).expect("JSON");
    let accuracy = score["cells"]["accuracy"].as_f64().expect("an accuracy");
    assert!(accuracy > 0.8, "trained on this very part, found {accuracy}");
    let other: [&dyn AsRef<std::ffi::OsStr>; 8] =
        [&"map", &map, &"--model", &model, &"--method", &"boosted", &"--out", &folder];
    refused(&other, &["method boosted", "iamn", "network.model.json"]);
    refused(&[&train[..], &[&"--scales", &"1,1.2"]].concat(), &["1 alone", "scales"]);
}

#[test]
fn a_scan_is_numbers_and_a_picture() {
    let out = TempDir::new().unwrap();
    let picture = out.path().join("scan.png");
    let map = shipped("home/map.yaml");
    let document: serde_json::Value = {
        let labeled = out.path().join("out");
        done(&[&"map", &map, &"--out", &labeled]);
        serde_json::from_slice(&fs::read(labeled.join("topology.json")).unwrap()).unwrap()
    };
    let anchor = &document["places"][0]["anchor"];
    let at = format!("{},{}", anchor["x"], anchor["y"]);
    let text = done(&[&"scan", &map, &"--at", &at, &"-o", &picture, &"--json"]);
    let scan: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(scan["ranges_m"].as_array().map(Vec::len), Some(360));
    assert!(scan["features"]["A5"].as_f64().is_some_and(|mean| mean > 0.0));
    assert!(picture.exists());
    refused(&[&"scan", &map, &"--at", &"1e6,0"], &["inside the map"]);
}

#[test]
fn the_registry_is_listed() {
    let text = done(&[&"features"]);
    assert!(text.lines().count() > 203 && text.contains("A9"), "{text}");
}

/// A folder with a small map that is right, to be spoiled.
fn small_map() -> TempDir {
    let folder = TempDir::new().unwrap();
    let rows = ["0 0 0 0", "0 254 254 0", "0 254 254 0", "0 0 0 0"].join("\n");
    fs::write(folder.path().join("map.pgm"), format!("P2\n4 4\n255\n{rows}\n")).unwrap();
    fs::write(folder.path().join("map.yaml"), YAML).unwrap();
    folder
}

const YAML: &str = "image: map.pgm\nresolution: 0.05\norigin: [0.0, 0.0, 0.0]\nnegate: 0\n\
                    occupied_thresh: 0.65\nfree_thresh: 0.196\n";

#[test]
fn bad_maps_are_refused_and_nothing_is_written() {
    let cases: [(&str, &str, &[&str]); 7] = [
        ("map.yaml", &YAML.replace("map.pgm", "gone.pgm"), &["gone.pgm"]),
        ("map.yaml", "image: [map.pgm\n", &["map.yaml"]),
        ("map.yaml", &YAML.replace("negate: 0\n", ""), &["negate"]),
        ("map.yaml", &YAML.replace("0.05", "0"), &["resolution above 0"]),
        ("map.yaml", &YAML.replace("0.05", ".nan"), &["map.yaml"]),
        ("map.yaml", &YAML.replace("map.pgm", "../../etc/passwd"), &["--allow-outside"]),
        ("map.pgm", "this is no image", &["text"]),
    ];
    for (file, content, words) in cases {
        let folder = small_map();
        fs::write(folder.path().join(file), content).unwrap();
        let out = folder.path().join("out");
        refused(&[&"map", &folder.path().join("map.yaml"), &"--out", &out], words);
        assert!(!out.exists(), "nothing is written for {content:?}");
    }
    let folder = small_map();
    let image = folder.path().join("map.pgm");
    refused(&[&"map", &image, &"--out", &folder.path().join("out")], &["--resolution"]);
    refused(
        &[
            &"map",
            &image,
            &"--resolution",
            &"0.05",
            &"--max-cells",
            &"15",
            &"--out",
            &folder.path().join("out"),
        ],
        &["at most 15 cells"],
    );
}

#[test]
fn bad_labels_and_models_are_refused() {
    let folder = small_map();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("small.pgm"), "P2\n2 2\n255\n1 1 1 1\n").unwrap();
    fs::write(path("nine.pgm"), format!("P2\n4 4\n255\n{}\n", "9 ".repeat(16))).unwrap();
    fs::write(path("one.pgm"), format!("P2\n4 4\n255\n{}\n", "1 ".repeat(16))).unwrap();
    let (map, model) = (path("map.yaml"), path("model.json"));
    let train = |labels: &str, words: &[&str]| {
        refused(&[&"train", &"--map", &map, &"--labels", &path(labels), &"-o", &model], words);
        assert!(!model.exists(), "no partial model");
    };
    train("small.pgm", &["4 x 4", "2 x 2"]);
    train("nine.pgm", &["9"]);
    train("one.pgm", &["room"]);
    train("gone.pgm", &["gone.pgm"]);

    let labels = |content: &[u8], words: &[&str]| {
        fs::write(&model, content).unwrap();
        refused(&[&"map", &map, &"--model", &model, &"--out", &path("out")], words);
        assert!(!path("out").exists());
    };
    labels(b"no JSON", &["model.json"]);
    labels(br#"{"format": "placegraph-model", "version": 99}"#, &["version 99"]);
    labels(br#"{"format": "something else", "version": 1}"#, &["something else"]);
}

#[test]
fn a_map_without_free_cells_is_told_and_labeled() {
    let folder = small_map();
    fs::write(folder.path().join("map.pgm"), format!("P2\n4 4\n255\n{}\n", "0 ".repeat(16))).unwrap();
    let out = folder.path().join("out");
    let output = placegraph(&[&"map", &folder.path().join("map.yaml"), &"--out", &out]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("no cell is free") || stderr(&output).contains("no free cell"),
        "{}",
        stderr(&output)
    );
    let document: serde_json::Value =
        serde_json::from_slice(&fs::read(out.join("topology.json")).unwrap()).unwrap();
    assert_eq!(document["places"].as_array().map(Vec::len), Some(0));
}
