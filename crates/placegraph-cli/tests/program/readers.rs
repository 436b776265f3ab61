//! What comes in: formats, releases, limits, and what `info` tells of a map.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use crate::running::{done, done_with, json, placegraph, refused, shipped, stderr};
use placegraph::geom::Point2;
use placegraph::import::{ReadOptions, load_map};
use placegraph::model::Model;
use placegraph::scan::{self, ScanConfig};
use tempfile::TempDir;

const YAML: &str = "image: map.pgm\nresolution: 0.1\norigin: [-3, 2.5, 0]\nnegate: 0\n\
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
fn folder(yaml: &str) -> TempDir {
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
    refused(&[&"info", &alone], &["read map.yaml, which lies beside it", "use --resolution METERS"]);
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
    assert!(stderr(&output).contains("map.pgm beside it was read"), "{}", stderr(&output));
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

/// Runs the program and fails if it waits for anybody.
fn at_once(args: &[&dyn AsRef<std::ffi::OsStr>]) -> (Option<i32>, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_placegraph"));
    command.args(args.iter().map(AsRef::as_ref)).stdin(std::process::Stdio::null());
    let mut run =
        command.stdout(std::process::Stdio::null()).stderr(std::process::Stdio::piped()).spawn().unwrap();
    let start = Instant::now();
    while run.try_wait().unwrap().is_none() {
        if start.elapsed() > Duration::from_secs(120) {
            run.kill().unwrap();
            panic!("{} waits", args[0].as_ref().display());
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    let output = run.wait_with_output().unwrap();
    (output.status.code(), stderr(&output))
}

#[cfg(unix)]
#[test]
fn pipes_are_refused_and_not_waited_for() {
    let folder = folder(YAML);
    let path = |name: &str| -> PathBuf { folder.path().join(name) };
    let pipe = path("pipe.yaml");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    fs::write(path("named.yaml"), YAML.replace("map.pgm", "pipe.yaml")).unwrap();
    let (map, out) = (path("map.yaml"), path("out"));
    let cases: [Vec<&dyn AsRef<std::ffi::OsStr>>; 9] = [
        vec![&"info", &pipe],
        vec![&"info", &"named.yaml"],
        vec![&"map", &map, &"--out", &out, &"--model", &pipe],
        vec![&"map", &map, &"--out", &out, &"--edits", &pipe],
        vec![&"map", &map, &"--out", &out, &"--masks", &pipe],
        vec![&"map", &map, &"--out", &out, &"--previous", &pipe],
        vec![&"train", &pipe, &"-o", &out],
        vec![&"where", &pipe, &"--at", &"1,1"],
        vec![&"route", &pipe, &"1", &"2"],
    ];
    let named = path("named.yaml");
    for mut args in cases {
        if args[1].as_ref() == "named.yaml" {
            args[1] = &named;
        }
        let (status, message) = at_once(&args);
        assert!(status == Some(2) && message.contains("a pipe"), "{status:?} {message}");
    }
    assert!(!out.exists());
    // In the place of an older result, it is none.
    fs::create_dir(&out).unwrap();
    assert!(Command::new("mkfifo").arg(out.join("topology.json")).status().unwrap().success());
    let (status, message) = at_once(&[&"map", &map, &"--out", &out, &"--resume"]);
    assert!(status.is_some(), "{message}");
    // What a shell hands over is read.
    let script = format!(
        "cat {} | exec {} info /dev/stdin --resolution 0.1",
        path("map.pgm").display(),
        env!("CARGO_BIN_EXE_placegraph")
    );
    let output = Command::new("sh").args(["-c", &script]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}

#[test]
fn a_run_that_waits_for_another_says_so() {
    let folder = folder(YAML);
    let out = folder.path().join("out");
    fs::create_dir(&out).unwrap();
    let lock = fs::File::open(&out).unwrap();
    lock.lock().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_placegraph"));
    command.arg("map").arg(folder.path().join("map.yaml")).arg("--out").arg(&out);
    let mut run = command.stderr(std::process::Stdio::piped()).spawn().unwrap();
    let mut told = String::new();
    let mut lines = std::io::BufReader::new(run.stderr.take().unwrap());
    while !told.contains("waiting for another program") {
        told.clear();
        assert!(std::io::BufRead::read_line(&mut lines, &mut told).unwrap() > 0, "it ended without a word");
    }
    assert!(told.contains(&out.display().to_string()), "{told}");
    lock.unlock().unwrap();
    assert!(run.wait().unwrap().success());
}

#[test]
fn documents_are_bounded_as_maps_are() {
    let folder = folder(YAML);
    let out = folder.path().join("out");
    done(&[&"map", &folder.path().join("map.yaml"), &"--out", &out]);
    let text = fs::read_to_string(out.join("topology.json")).unwrap();
    // The same places in a map of 4 billion cells.
    let huge = folder.path().join("huge.json");
    let text =
        text.replace("\"width\": 60", "\"width\": 40000").replace("\"height\": 40", "\"height\": 100000");
    fs::write(&huge, text).unwrap();
    let (svg, good) = (folder.path().join("a.svg"), shipped("home/map.yaml"));
    let cases: [Vec<&dyn AsRef<std::ffi::OsStr>>; 4] = [
        vec![&"export", &huge, &"--to", &"svg", &"-o", &svg],
        vec![&"where", &huge, &"--at", &"0,3"],
        vec![&"route", &huge, &"1", &"1"],
        vec![&"map", &good, &"--out", &svg, &"--previous", &huge],
    ];
    for args in cases {
        refused(&args, &["40000 x 100000", "--max-cells"]);
    }
    assert!(!svg.exists());
    done(&[&"route", &out.join("topology.json"), &"1", &"1", &"--max-cells", &"2400"]);
    refused(&[&"route", &out.join("topology.json"), &"1", &"1", &"--max-cells", &"2399"], &["60 x 40"]);
}

#[test]
fn numbers_out_of_all_bounds_are_refused_where_they_are_typed() {
    let folder = folder(YAML);
    let map = folder.path().join("map.yaml");
    for threads in ["257", "1000", "100000", "-1", "many"] {
        let output = placegraph(&[&"info", &map, &"--threads", &threads]);
        assert_eq!(output.status.code(), Some(2), "{threads}");
        assert!(stderr(&output).contains("error: "), "{}", stderr(&output));
    }
    done(&[&"info", &map, &"--threads", &"2"]);
    for at in ["--at=1e308,1e308", "--at=-1e9,0"] {
        let output = placegraph(&[&"scan", &map, &at]);
        assert_eq!(output.status.code(), Some(2), "{at}");
    }
    for time in ["", "yesterday", "-1", "253402300800", "1.5"] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_placegraph"));
        let output = command.env("SOURCE_DATE_EPOCH", time).arg("info").arg(&map).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{time:?}");
        assert!(stderr(&output).contains("SOURCE_DATE_EPOCH"), "{}", stderr(&output));
    }
    done_with(("SOURCE_DATE_EPOCH", "4294967296"), &[&"info", &map]);
}

/// A chessboard of single free cells: 11 250 places, none of which leads to another.
#[test]
fn a_map_of_nothing_but_specks_has_no_places() {
    let folder = TempDir::new().unwrap();
    let map = folder.path().join("chess.pgm");
    let side = 150;
    let cells = (0..side * side).map(|i| if (i / side + i % side) % 2 == 0 { 254 } else { 0 });
    fs::write(&map, [format!("P5 {side} {side} 255\n").into_bytes(), cells.collect()].concat()).unwrap();
    let out = folder.path().join("out");
    done(&[&"map", &map, &"--resolution", &"0.05", &"--out", &out]);
    assert_eq!(json(&out.join("topology.json"))["places"], serde_json::json!([]));
    assert!(Path::new(&out.join("regions.png")).exists());
}
