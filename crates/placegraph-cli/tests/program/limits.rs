//! Limits: what is too much, waits for somebody, or never ends is refused at once.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use tempfile::TempDir;

use crate::readers::{YAML, folder};
use crate::running::{done, done_with, json, placegraph, refused, shipped, stderr};

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
        let message = stderr(&output);
        assert!(message.contains("SOURCE_DATE_EPOCH"), "{message}");
        assert!(message.ends_with(&format!("found {time:?}\n")), "{message}");
    }
    done_with(("SOURCE_DATE_EPOCH", "4294967296"), &[&"info", &map]);
}

/// A map of `side` by `side` cells, of which every other one is free and touches no other.
fn chessboard(folder: &Path, side: usize) -> PathBuf {
    let map = folder.join("chess.pgm");
    let cells = (0..side * side).map(|i| if (i / side + i % side).is_multiple_of(2) { 254 } else { 0 });
    fs::write(&map, [format!("P5 {side} {side} 255\n").into_bytes(), cells.collect()].concat()).unwrap();
    map
}

#[test]
fn a_map_of_nothing_but_specks_has_no_places() {
    let folder = TempDir::new().unwrap();
    let map = chessboard(folder.path(), 150);
    let out = folder.path().join("out");
    done(&[&"map", &map, &"--resolution", &"0.05", &"--out", &out]);
    assert_eq!(json(&out.join("topology.json"))["places"], serde_json::json!([]));
    assert!(Path::new(&out.join("regions.png")).exists());
}

#[test]
fn more_places_than_can_be_numbered_are_refused_at_once() {
    let folder = TempDir::new().unwrap();
    // 65 885 free cells: of 1 m² each a place, of 0.01 m² a speck, which is one where nothing is corrected.
    let map = chessboard(folder.path(), 363);
    let out = folder.path().join("out");
    let with = |resolution: &str, option: &str| {
        refused(&[&"map", &map, &"--resolution", &resolution, &option, &"--out", &out], &["65535", "65885"]);
    };
    with("1", "--threads=1");
    with("0.1", "--no-correction");
    assert!(!out.exists());
}
