//! Maps and arguments at the edge of what they can be.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use crate::running::{done, json, names, placegraph, refused, shipped, stderr};
use tempfile::TempDir;

/// A gray image of `width` by `height` pixels.
fn write_map(
    folder: &Path,
    name: &str,
    (width, height): (usize, usize),
    pixel: impl Fn(usize) -> u8,
) -> PathBuf {
    let path = folder.join(format!("{name}.pgm"));
    let header = format!("P5\n{width} {height}\n255\n").into_bytes();
    fs::write(&path, [header, (0..width * height).map(pixel).collect()].concat()).unwrap();
    path
}

const FREE: u8 = 254;
const OCCUPIED: u8 = 0;
const UNKNOWN: u8 = 205;

#[test]
fn maps_at_the_edge_are_labeled_in_every_way() {
    let folder = TempDir::new().unwrap();
    let write = |name, size, pixel: &dyn Fn(usize) -> u8| write_map(folder.path(), name, size, pixel);
    let maps = [
        (write("one_free", (1, 1), &|_| FREE), 1),
        (write("one_occupied", (1, 1), &|_| OCCUPIED), 0),
        (write("one_unknown", (1, 1), &|_| UNKNOWN), 0),
        (write("one_free_cell", (50, 40), &|i| if i == 1025 { FREE } else { UNKNOWN }), 1),
        (write("one_free_in_walls", (50, 40), &|i| if i == 1025 { FREE } else { OCCUPIED }), 1),
        (write("all_free", (60, 50), &|_| FREE), 3000),
        (write("all_occupied", (60, 50), &|_| OCCUPIED), 0),
        (write("all_unknown", (60, 50), &|_| UNKNOWN), 0),
        (write("chessboard", (61, 50), &|i| if i % 2 == 0 { FREE } else { OCCUPIED }), 1525),
        (write("corner", (65, 9), &|i| if i == 0 || i == 584 { FREE } else { OCCUPIED }), 2),
        (write("row", (100_000, 1), &|_| FREE), 100_000),
        (write("column", (1, 100_000), &|i| if i % 50 == 0 { UNKNOWN } else { FREE }), 98_000),
    ];
    let out = folder.path().join("out");
    let mut args: Vec<&dyn AsRef<OsStr>> = vec![&"map", &"--resolution", &"0.1", &"--out", &out];
    let (stages, probabilities) = ("--stages", "--probabilities");
    args.extend([&stages as &dyn AsRef<OsStr>, &probabilities]);
    args.extend(maps.iter().map(|(map, _)| map as &dyn AsRef<OsStr>));
    // Maps without a free cell are errors, but have results.
    let output = placegraph(&args);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let formats = "nav2 nav2-keepout nav2-speed nav2-zones nav2-shapes rmf rmf-building tmap2 graphml dot geojson svg report";
    for (map, n_free) in &maps {
        let result = out.join(map.file_stem().unwrap());
        let topology = result.join("topology.json");
        let places = json(&topology)["places"].as_array().unwrap().clone();
        let n_cells: u64 = places.iter().map(|place| place["n_cells"].as_u64().unwrap()).sum();
        assert_eq!(n_cells, *n_free, "{}", map.display());
        for format in formats.split(' ') {
            let output = placegraph(&[&"export", &topology, &"--to", &format, &"-o", &result]);
            let message = stderr(&output);
            // Some formats have no word for a map without places or ways.
            assert!(
                output.status.success() || message.starts_with("error: "),
                "{} {format}: {message}",
                map.display()
            );
            assert!(!message.contains("this is a bug"), "{} {format}: {message}", map.display());
        }
        for command in ["where", "info"] {
            let about = if command == "where" { &topology } else { map };
            let output = match command {
                "where" => placegraph(&[&"where", about, &"--at", &"0.05,0.05"]),
                _ => placegraph(&[&"info", about, &"--resolution", &"0.1"]),
            };
            assert!(!stderr(&output).contains("this is a bug"), "{} {command}", map.display());
        }
    }
}

/// The same, of a million cells: most of a minute.
#[test]
fn a_million_cells_in_a_row_are_labeled() {
    let folder = TempDir::new().unwrap();
    for (name, size) in [("row", (1_000_000, 1)), ("column", (1, 1_000_000))] {
        let map = write_map(folder.path(), name, size, |_| FREE);
        done(&[&"map", &map, &"--resolution", &"0.05", &"--out", &folder.path().join(name)]);
    }
}

#[test]
fn sizes_that_no_memory_holds_are_refused_by_the_header() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("huge.png");
    let mut png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec();
    png.extend([100_000u32.to_be_bytes(), 100_000u32.to_be_bytes()].concat());
    png.extend([8, 0, 0, 0, 0]);
    fs::write(&path, &png).unwrap();
    let out = folder.path().join("out");
    refused(
        &[&"map", &path, &"--resolution", &"0.05", &"--out", &out],
        &["at most 400000000 cells", "100000 x 100000"],
    );
    fs::write(&path, b"P5 4294967295 4294967295 255\n").unwrap();
    refused(&[&"info", &path, &"--resolution", &"0.05", &"--max-cells", &u64::MAX.to_string()], &["at most"]);
    assert!(!out.exists());
}

#[test]
fn files_without_an_end_are_refused() {
    let zero = Path::new("/dev/zero");
    if !zero.exists() {
        return;
    }
    let map = shipped("home/map.yaml");
    let out = TempDir::new().unwrap();
    let out_path = out.path().to_owned();
    let result = TempDir::new().unwrap();
    done(&[&"map", &map, &"--out", &result.path()]);
    let topology = result.path().join("topology.json");
    let cases: [Vec<&dyn AsRef<OsStr>>; 19] = [
        vec![&"map", &map, &"--model", &zero],
        vec![&"map", &map, &"--masks", &zero],
        vec![&"map", &map, &"--edits", &zero],
        vec![&"map", &zero, &"--resolution", &"0.1", &"--max-cells", &"1000"],
        vec![&"train", &zero],
        vec![&"evaluate", &zero, &zero],
        vec![&"train", &"--map", &map, &"--labels", &zero, &"--max-cells", &"100000"],
        vec![&"map", &map, &"--previous", &zero],
        vec![&"info", &zero, &"--resolution", &"0.1"],
        vec![&"scan", &zero, &"--resolution", &"0.1", &"--at", &"1,1"],
        vec![&"scan", &map, &"--at", &"1,1", &"--model", &zero],
        vec![&"where", &zero, &"--at", &"1,1"],
        vec![&"route", &zero, &"1", &"2"],
        vec![&"list", &zero],
        vec![&"align", &zero, &topology],
        vec![&"align", &topology, &zero],
        vec![&"export", &zero, &"--to", &"dot"],
        vec![&"export", &topology, &"--to", &"nav2-keepout", &"--masks", &zero],
        vec![&"export", &topology, &"--to", &"report", &"--map", &zero, &"--resolution", &"0.1"],
    ];
    for mut args in cases {
        match args[0].as_ref().to_str() {
            Some("map") => args.extend([&"--out" as &dyn AsRef<OsStr>, &out_path]),
            Some("train" | "export") => args.extend([&"-o" as &dyn AsRef<OsStr>, &out_path]),
            _ => {}
        }
        refused(&args, &["a device"]);
    }
    refused(&[&"verify", &zero], &["expected a topology.json", "/dev/zero"]);
    assert!(names(out.path()).is_empty());
}

#[test]
fn numbers_that_are_none_are_refused_where_they_are_typed() {
    let (map, labels) = (shipped("home/map.yaml"), shipped("home/labels.png"));
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    for bad in ["nan", "inf", "-inf", "1e999", "-1", "1e300"] {
        let option = |name: &str| format!("--{name}={bad}");
        let train: Vec<&dyn AsRef<OsStr>> = vec![&"train", &"--map", &map, &"--labels", &labels, &"-o", &out];
        let with = |option: &String| -> std::process::Output {
            let mut args = train.clone();
            args.push(option);
            placegraph(&args)
        };
        let outputs = [
            placegraph(&[&"map", &map, &"--out", &out, &option("resolution")]),
            placegraph(&[&"scan", &map, &format!("--at={bad},0")]),
            placegraph(&[&"generate", &"--out", &out, &option("resolution")]),
            placegraph(&[&"evaluate", &labels, &labels, &option("min-accuracy")]),
            with(&option("scales")),
            with(&option("rounds")),
            with(&option("max-cells-per-class")),
        ];
        // A temperature of 1e300 is a number: all confidences are alike.
        let temperature = (bad != "1e300").then(|| with(&option("temperature")));
        for (index, output) in outputs.iter().chain(&temperature).enumerate() {
            let message = stderr(output);
            assert_eq!(output.status.code(), Some(2), "{bad}, case {index}: {message}");
            assert!(message.contains("error: "), "{bad}, case {index}: {message}");
        }
    }
    assert!(!out.exists());
}
