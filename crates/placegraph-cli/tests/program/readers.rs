//! What comes in: formats, releases, and what `info` and `scan` tell of a map.

use std::fs;

use crate::running::{done, json, placegraph, refused, shipped, stderr};
use placegraph::geom::Point2;
use placegraph::import::{ReadOptions, load_map};
use placegraph::model::Model;
use placegraph::scan::{self, ScanConfig};
use tempfile::TempDir;

pub(crate) const YAML: &str = "image: map.pgm\nresolution: 0.1\norigin: [-3, 2.5, 0]\nnegate: 0\n\
                    occupied_thresh: 0.65\nfree_thresh: 0.196\n";

/// A room of 60 x 40 pixels with a wall of `wall` pixels of gray `gray` in its middle, in unknown space.
fn pixels(gray: u8) -> Vec<u8> {
    let pixel = |x: u32, y: u32| match (x, y) {
        (0..2 | 58.., _) | (_, 0..2 | 38..) => 205,
        (2 | 57, _) | (_, 2 | 37) => 0,
        (30, 15..20) => gray,
        _ => 254,
    };
    (0..40).flat_map(|y| (0..60).map(move |x| pixel(x, y))).collect()
}

fn pgm(gray: u8) -> Vec<u8> {
    [b"P5 60 40 255\n".to_vec(), pixels(gray)].concat()
}

/// A folder with `map.yaml` and `map.pgm`.
pub(crate) fn folder(yaml: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("map.yaml"), yaml).unwrap();
    fs::write(folder.path().join("map.pgm"), pgm(0)).unwrap();
    folder
}

#[test]
fn info_tells_what_the_map_is() {
    let folder = folder(YAML);
    let map = folder.path().join("map.yaml");
    let text = done(&[&"info", &map]);
    for words in [
        ": map_server YAML, mode trinary, free up to 0.196, occupied from 0.65 (rules jazzy)\n",
        "60 x 40 cells of 0.1 m: 6.0 m x 4.0 m; lower left corner at (-3, 2.5), turned by 0.0°\n",
        "free space in 1 part\n",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
    assert!(text.ends_with('\n'));
    let far = self::folder(&YAML.replace("-3, 2.5", "-22.17923461416615, -0.0000001"));
    assert!(done(&[&"info", &far.path().join("map.yaml")]).contains("corner at (-22.179, 0), turned"));
    let found: serde_json::Value = serde_json::from_str(&done(&[&"info", &map, &"--json"])).unwrap();
    assert_eq!((&found["width"], &found["height"]), (&60.into(), &40.into()));
    assert_eq!(
        (&found["format"], &found["interpretation"]["rules"]),
        (&"map_server".into(), &"jazzy".into())
    );
    assert_eq!((&found["n_parts"], &found["origin"]["y"]), (&1.into(), &2.5.into()));
    assert_eq!(found["findings"], serde_json::json!([]));
}

#[test]
fn a_map_that_cannot_be_labeled_fails_the_check_of_info() {
    let folder = folder(&YAML.replace("negate: 0", "negate: 1"));
    fs::write(folder.path().join("map.pgm"), b"P5 3 1 255\n\xfe\xfe\xfe").unwrap();
    let output = placegraph(&[&"info", &folder.path().join("map.yaml")]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(String::from_utf8_lossy(&output.stdout).contains("error: no cell is free"));
}

#[test]
fn advice_names_options_that_are_taken() {
    let folder = folder(&YAML.replace("0.196", "0.25"));
    let map = folder.path().join("map.yaml");
    let text = done(&[&"info", &map]);
    assert!(text.contains("to trust them, use --trust-thresholds"), "{text}");
    let text = done(&[&"info", &map, &"--trust-thresholds"]);
    assert!(text.contains("leave out --trust-thresholds"), "{text}");
    let alone = folder.path().join("map.pgm");
    refused(&[&"info", &alone], &["read map.yaml next to it instead", "use --resolution METERS"]);
    done(&[&"info", &alone, &"--resolution", &"0.1"]);
    refused(&[&"info", &map, &"--max-cells", &"100"], &["60 x 40", "use --max-cells N"]);
}

#[test]
fn releases_read_a_transparent_map_in_their_own_ways() {
    let folder = folder(&YAML.replace("map.pgm", "map.png"));
    let image = folder.path().join("map.png");
    let rgba: Vec<u8> =
        pixels(0).into_iter().flat_map(|v| if v == 205 { [0; 4] } else { [v, v, v, 255] }).collect();
    image::save_buffer(&image, &rgba, 60, 40, image::ColorType::Rgba8).unwrap();
    let map = folder.path().join("map.yaml");
    let shares = |rules: &str| {
        let text = done(&[&"info", &map, &"--json", &"--rules", &rules]);
        serde_json::from_str::<serde_json::Value>(&text).unwrap()["shares"]["unknown"].as_f64().unwrap()
    };
    // Transparent black: unknown today, a wall before.
    assert!(shares("jazzy") > 0.1 && shares("nav2") > 0.1);
    assert!(shares("humble") < 1e-9 && shares("ros1") < 1e-9);
    for (rules, options) in
        [("jazzy", serde_json::json!(null)), ("humble", serde_json::json!(["--rules humble"]))]
    {
        let out = folder.path().join(rules);
        done(&[&"map", &map, &"--rules", &rules, &"--out", &out]);
        assert_eq!(json(&out.join("topology.json"))["program"]["options"], options);
    }
}

#[test]
fn crossed_thresholds_are_refused() {
    let folder = folder(&YAML.replace("0.65", "0.1"));
    let out = folder.path().join("out");
    let map = folder.path().join("map.yaml");
    refused(
        &[&"map", &map, &"--out", &out],
        &["free_thresh 0.196 must be below occupied_thresh 0.1", "map.yaml"],
    );
    assert!(!out.exists());
}

#[test]
fn a_path_from_another_machine_is_told_in_every_result() {
    let folder = folder(&YAML.replace("map.pgm", "/home/someone/maps/map.pgm"));
    let out = folder.path().join("out");
    let map = folder.path().join("map.yaml");
    let output = placegraph(&[&"map", &map, &"--out", &out]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("map.pgm next to the YAML file was read"), "{}", stderr(&output));
    assert!(json(&out.join("topology.json"))["findings"][0].as_str().unwrap().contains("/home/someone/maps"));
}

#[test]
fn an_error_in_a_text_is_told_once() {
    let folder = folder(&format!("{YAML}resolution: 0.2\n"));
    let map = folder.path().join("map.yaml");
    let once = |args: &[&dyn AsRef<std::ffi::OsStr>], words: &[&str]| {
        let output = placegraph(args);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert_eq!((message.lines().count(), message.matches("line ").count()), (1, 1), "{message}");
        for word in words.iter().chain(&["line "]) {
            assert!(message.contains(word), "{word}: {message}");
        }
        for foreign in ["Options", "Policy", "struct ", "^"] {
            assert!(!message.contains(foreign), "{foreign}: {message}");
        }
    };
    once(&[&"info", &map], &["line 7, column 1: the key resolution stands twice", "map.yaml"]);
    let text = folder.path().join("text.toml");
    let (good, out) = (shipped("home/map.yaml"), folder.path().join("out"));
    fs::write(&text, "[[edit]]\naction = \"renam\"\nat = [1, 2]\n").unwrap();
    once(&[&"map", &good, &"--out", &out, &"--edits", &text], &["text.toml", "renam"]);
    fs::write(&text, "zones = 3\n").unwrap();
    once(&[&"map", &good, &"--out", &out, &"--masks", &text], &["text.toml"]);
    fs::write(&text, "map = 3\n").unwrap();
    once(&[&"train", &text, &"-o", &out], &["text.toml"]);
    assert!(!out.exists());
}

#[test]
fn a_bmp_is_labeled_like_its_pgm() {
    let folder = folder(YAML);
    let mut bmp = b"BM".to_vec();
    bmp.extend([0u32, 0, 1078, 40, 60, 40].map(u32::to_le_bytes).as_flattened());
    bmp.extend([1u16, 8].map(u16::to_le_bytes).as_flattened());
    bmp.extend([0u32, 0, 0, 0, 256, 0].map(u32::to_le_bytes).as_flattened());
    bmp.extend((0..=255u8).flat_map(|v| [v, v, v, 0]));
    bmp.extend(pixels(0).chunks(60).rev().flatten());
    fs::write(folder.path().join("map.bmp"), bmp).unwrap();
    fs::write(folder.path().join("bmp.yaml"), YAML.replace("map.pgm", "map.bmp")).unwrap();
    let labels = ["map.yaml", "bmp.yaml"].map(|name| {
        let out = folder.path().join(name).with_extension("out");
        done(&[&"map", &folder.path().join(name), &"--out", &out]);
        fs::read(out.join("labels.png")).unwrap()
    });
    assert_eq!(labels[0], labels[1]);
}

#[test]
fn the_segments_of_a_vacuum_are_the_truth_of_its_rooms() {
    let folder = TempDir::new().unwrap();
    let map = folder.path().join("home.json");
    // Two rooms of 3 m x 3 m beside one another, with a door of 0.8 m.
    let rows = |x: u32, n: u32, ys: std::ops::Range<u32>| {
        ys.map(|y| format!("{x}, {y}, {n}")).collect::<Vec<_>>().join(", ")
    };
    let wall =
        [rows(99, 127, 99..100), rows(99, 127, 160..161), rows(99, 1, 100..160), rows(225, 1, 100..160)]
            .join(", ");
    let between = [rows(160, 5, 100..120), rows(160, 5, 136..160)].join(", ");
    let text = format!(
        r#"{{"__class": "ValetudoMap", "pixelSize": 5, "layers": [
            {{"type": "segment", "metaData": {{"segmentId": "17"}}, "compressedPixels": [{}]}},
            {{"type": "segment", "metaData": {{"segmentId": "18"}}, "compressedPixels": [{}]}},
            {{"type": "floor", "compressedPixels": [{}]}},
            {{"type": "wall", "compressedPixels": [{wall}, {between}]}}]}}"#,
        rows(100, 60, 100..160),
        rows(165, 60, 100..160),
        rows(160, 5, 120..136),
    );
    fs::write(&map, text).unwrap();
    assert!(done(&[&"info", &map]).contains("Valetudo JSON"));
    let out = folder.path().join("out");
    done(&[&"map", &map, &"--out", &out]);
    let (labels, regions) = (out.join("labels.png"), out.join("regions.png"));
    let report = done(&[&"evaluate", &labels, &labels, &"--rooms", &map, &"--regions", &regions, &"--json"]);
    let rooms = &serde_json::from_str::<serde_json::Value>(&report).unwrap()["rooms"];
    assert!(rooms.is_object(), "{report}");
    refused(
        &[&"evaluate", &labels, &labels, &"--rooms", &map, &"--regions", &shipped("home/labels.png")],
        &["pixels"],
    );
}

#[test]
fn a_map_that_went_through_a_recording_is_the_same_map() {
    let folder = TempDir::new().unwrap();
    let [out, again] = ["out", "again"].map(|name| folder.path().join(name));
    done(&[&"map", &shipped("home/map.yaml"), &"--out", &out, &"--export", &"mcap"]);
    let recording = out.join("semantic_map.mcap");
    refused(
        &[&"map", &recording, &"--out", &again],
        &["several topics", "/map, /placegraph/labels, /placegraph/regions", "--topic TOPIC"],
    );
    refused(&[&"info", &recording, &"--topic", &"/scan"], &["expected maps on the topic /scan"]);
    assert!(done(&[&"info", &recording, &"--topic", &"/map"]).contains("recording, free up to 0.196"));
    done(&[&"map", &recording, &"--topic", &"map", &"--out", &again]);
    for file in ["labels.png", "regions.png", "labels.yaml"] {
        assert_eq!(fs::read(out.join(file)).unwrap(), fs::read(again.join(file)).unwrap(), "{file}");
    }
    // Without the map's cells, all but the map is there.
    let alone = folder.path().join("alone.mcap");
    done(&[&"export", &out.join("topology.json"), &"--to", &"mcap", &"-o", &alone]);
    refused(
        &[&"info", &alone, &"--topic", &"/map"],
        &["found them on /placegraph/labels, /placegraph/regions"],
    );
}

#[test]
fn a_growing_map_is_replayed() {
    let folder = TempDir::new().unwrap();
    let [buildings, out] = ["buildings", "out"].map(|name| folder.path().join(name));
    let generate: [&dyn AsRef<std::ffi::OsStr>; 11] = [
        &"generate",
        &"--style",
        &"home",
        &"--seed",
        &"1",
        &"--resolution",
        &"0.1",
        &"--growing",
        &"6",
        &"-o",
        &buildings,
    ];
    done(&generate);
    let growing = buildings.join("home_1_000/growing");
    let n_maps = fs::read_dir(&growing).unwrap().count() / 2;
    assert!(n_maps > 2, "{n_maps}");
    let table = done(&[&"replay", &growing, &"--check", &"--out", &out]);
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), n_maps + 1);
    assert_eq!(fs::read_to_string(out.join("replay.csv")).unwrap(), table);
    assert_eq!(rows[1][1], "0001.yaml");
    let column = |name: &str| rows[0].iter().position(|column| *column == name).unwrap();
    let number = |row: usize, name: &str| rows[row][column(name)].parse::<f64>().unwrap();
    assert!(number(1, "reused") == 0.0 && number(n_maps, "reused") > 0.0, "{table}");
    assert!(number(n_maps, "kept") > 0.0 && number(n_maps, "kept") <= number(n_maps, "places"), "{table}");
    for step in 1..=n_maps {
        assert!(out.join(format!("step-{step:04}.png")).exists());
    }
    // The last result is one to go on from, and what was written is vouched for.
    let next = folder.path().join("next");
    done(&[
        &"map",
        &growing.join(format!("{n_maps:04}.yaml")),
        &"--previous",
        &out.join("topology.json"),
        &"--out",
        &next,
    ]);
    done(&[&"verify", &out]);
    refused(&[&"replay", &folder.path().join("none.mcap"), &"--out", &out], &["none.mcap"]);
    fs::create_dir(folder.path().join("empty")).unwrap();
    refused(&[&"replay", &folder.path().join("empty"), &"--out", &out], &["empty", "found none"]);
}

#[test]
fn a_scan_is_the_one_that_the_model_classifies() {
    let folder = folder(YAML);
    // A single cell that stands free: 0.1 m, which the default model's scans pass through.
    let mut image = pgm(254);
    let at = image.len() - 60 * 40 + 60 * 20 + 20;
    image[at] = 0;
    fs::write(folder.path().join("map.pgm"), image).unwrap();
    let map = folder.path().join("map.yaml");
    let grid = load_map(&map, &ReadOptions::default()).unwrap().grid;
    let at = Point2::new(-1.55, 4.45);
    let cell = grid.frame.cell_at(at).unwrap();
    let ranges = |config: &ScanConfig| serde_json::json!(scan::cast(&grid, cell, config).ranges_m());
    let model = Model::builtin().scan;
    assert_ne!(ranges(&model), ranges(&ScanConfig::default()), "the obstacle is seen from there");
    let scan = |model: &[&dyn AsRef<std::ffi::OsStr>]| {
        let at = format!("--at={},{}", at.x, at.y);
        let mut args: Vec<&dyn AsRef<std::ffi::OsStr>> = vec![&"scan", &map, &at, &"--json"];
        args.extend_from_slice(model);
        serde_json::from_str::<serde_json::Value>(&done(&args)).unwrap()["ranges_m"].clone()
    };
    assert_eq!(scan(&[]), ranges(&model));
    // A model that sees everything.
    let mut other = Model::builtin().clone();
    other.scan.max_speck_m = 0.0;
    let path = folder.path().join("other.json");
    fs::write(&path, other.to_json()).unwrap();
    assert_eq!(scan(&[&"--model", &path]), ranges(&ScanConfig { max_speck_m: 0.0, ..model }));
}

#[test]
fn features_with_parameters_tell_them() {
    let text = done(&[&"features"]);
    let mut lines: Vec<&str> = text.lines().filter(|line| line.starts_with("A3(")).collect();
    assert_eq!(lines.len(), 10);
    assert!(lines.iter().any(|line| line.contains("cut at 7 meters")), "{lines:?}");
    lines.dedup();
    assert_eq!(lines.len(), 10);
    assert!(done(&[&"--help"]).starts_with("Turns the occupancy grid map"));
}
