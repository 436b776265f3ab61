//! Many maps in one run: the table, what fails, and what is kept when a run is taken up again.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

use crate::running::{json, names, placegraph, start_batch, stderr};
use tempfile::TempDir;

/// A room of `columns` x 40 cells behind a doorway, with walls all around.
fn write_map(folder: &Path, name: &str, columns: usize) -> PathBuf {
    let (width, height) = (columns + 62, 42);
    let mut text = format!("P2\n{width} {height}\n255\n");
    for y in 0..height {
        for x in 0..width {
            let is_wall = y == 0 || y == height - 1 || x == 0 || x == width - 1;
            let is_divided = x == 60 && !(18..26).contains(&y);
            text += if is_wall || is_divided { "0 " } else { "254 " };
        }
        text += "\n";
    }
    fs::write(folder.join(format!("{name}.pgm")), text).unwrap();
    let path = folder.join(format!("{name}.yaml"));
    let yaml = format!(
        "image: {name}.pgm\nresolution: 0.1\norigin: [0.0, 0.0, 0.0]\nnegate: 0\n\
         occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    );
    fs::write(&path, yaml).unwrap();
    path
}

/// Rows of the table by name of the map, and the header.
fn table(out: &Path) -> (Vec<String>, BTreeMap<String, Vec<String>>) {
    let text = fs::read_to_string(out.join("summary.csv")).unwrap();
    // No field of these tests has a comma but the error, which is quoted.
    let fields = |line: &str| -> Vec<String> {
        let mut fields = vec![String::new()];
        let mut is_quoted = false;
        for character in line.chars() {
            match character {
                '"' => is_quoted = !is_quoted,
                ',' if !is_quoted => fields.push(String::new()),
                other => fields.last_mut().unwrap().push(other),
            }
        }
        fields
    };
    let mut lines = text.lines().map(fields);
    let header = lines.next().unwrap();
    let rows = lines.map(|row| {
        assert_eq!(row.len(), header.len(), "{row:?}");
        (Path::new(&row[0]).file_stem().unwrap().to_string_lossy().into_owned(), row)
    });
    let rows = rows.collect();
    (header, rows)
}

fn statuses(out: &Path) -> Vec<(String, String)> {
    table(out).1.into_iter().map(|(name, row)| (name, row[1].clone())).collect()
}

fn expected(pairs: &[(&str, &str)]) -> Vec<(String, String)> {
    pairs.iter().map(|&(name, status)| (name.to_owned(), status.to_owned())).collect()
}

#[test]
fn a_batch_tables_what_worked_and_what_did_not_and_resumes() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    let maps = ["a", "b", "c"].map(|name| write_map(folder.path(), name, 30));
    fs::write(folder.path().join("b.pgm"), "this, is no image").unwrap();
    let run = |options: &[&str]| {
        let mut args: Vec<&dyn AsRef<std::ffi::OsStr>> = vec![&"map", &"--out", &out];
        args.extend(maps.iter().map(|map| map as &dyn AsRef<std::ffi::OsStr>));
        args.extend(options.iter().map(|option| option as &dyn AsRef<std::ffi::OsStr>));
        placegraph(&args)
    };

    let output = run(&[]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert_eq!(stderr(&output).lines().count(), 3, "a line per map: {}", stderr(&output));
    assert_eq!(names(&out), ["a", "c", "summary.csv"]);
    let (header, rows) = table(&out);
    assert_eq!(
        header,
        ["map", "status", "error", "corridor", "room", "doorway", "connections", "area_m2", "seconds"]
    );
    assert!(rows["b"][2].contains("image"), "{rows:?}");
    let document = json(&out.join("a/topology.json"));
    let places = document["places"].as_array().unwrap();
    for (column, class) in ["corridor", "room", "doorway"].into_iter().enumerate() {
        let n_places = places.iter().filter(|place| place["class"] == class).count();
        assert_eq!(rows["a"][3 + column], n_places.to_string(), "{class}");
    }
    assert_eq!(rows["a"][6], document["connections"].as_array().unwrap().len().to_string());
    let area: f64 = places.iter().map(|place| place["area_m2"].as_f64().unwrap()).sum();
    assert!((rows["a"][7].parse::<f64>().unwrap() - area).abs() < 1e-3);
    assert!(rows["a"][8].parse::<f64>().unwrap() > 0.0);

    // The second map is put right; what a killed run leaves behind: no document, an unfinished folder.
    write_map(folder.path(), "b", 30);
    fs::remove_file(out.join("c/topology.json")).unwrap();
    fs::create_dir(out.join("c/.placegraph-left")).unwrap();
    let written = fs::metadata(out.join("a/topology.json")).unwrap().modified().unwrap();
    let output = run(&["--resume"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(statuses(&out), expected(&[("a", "kept"), ("b", "labeled"), ("c", "labeled")]));
    assert_eq!(fs::metadata(out.join("a/topology.json")).unwrap().modified().unwrap(), written);
    let (_, resumed) = table(&out);
    assert_eq!(resumed["a"][2..8], rows["a"][2..8], "the table tells the same of what was kept");
    assert_eq!(resumed["a"][8], "", "what was kept took no time");

    // Another map, a missing file, other options: done again.
    write_map(folder.path(), "a", 31);
    fs::remove_file(out.join("b/overview.png")).unwrap();
    assert_eq!(run(&["--resume"]).status.code(), Some(0));
    assert_eq!(statuses(&out), expected(&[("a", "labeled"), ("b", "labeled"), ("c", "kept")]));
    assert_eq!(run(&["--resume", "--export", "graphml,tmap2"]).status.code(), Some(0));
    assert_eq!(statuses(&out), expected(&[("a", "labeled"), ("b", "labeled"), ("c", "labeled")]));
    assert_eq!(run(&["--resume", "--export", "tmap2,graphml"]).status.code(), Some(0));
    assert_eq!(statuses(&out), expected(&[("a", "kept"), ("b", "kept"), ("c", "kept")]));
    assert!(out.join("c/c.tmap2.yaml").exists());
}

#[test]
fn a_killed_run_is_taken_up_where_it_ended() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    let maps: Vec<PathBuf> =
        ["a", "b", "c", "d", "e"].iter().map(|name| write_map(folder.path(), name, 60)).collect();
    let first = out.join("a/topology.json");
    let mut run = start_batch(&maps, &out);
    while !first.exists() && run.try_wait().unwrap().is_none() {
        thread::sleep(Duration::from_millis(2));
    }
    run.kill().unwrap();
    run.wait().unwrap();
    assert!(!out.join("summary.csv").exists(), "the table comes at the end");

    let mut args: Vec<&dyn AsRef<std::ffi::OsStr>> = vec![&"map", &"--resume", &"--out", &out];
    args.extend(maps.iter().map(|map| map as &dyn AsRef<std::ffi::OsStr>));
    assert_eq!(placegraph(&args).status.code(), Some(0));
    let statuses = statuses(&out);
    assert_eq!(statuses.len(), maps.len());
    assert_eq!(statuses[0], ("a".to_owned(), "kept".to_owned()));
    assert!(statuses.iter().any(|(_, status)| status == "labeled"), "{statuses:?}");
    assert!(["a", "b", "c", "d", "e"].iter().all(|map| out.join(map).join("overview.png").exists()));
}

#[test]
fn thousands_of_maps_may_be_named() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    let real = write_map(folder.path(), "real", 10);
    let missing: Vec<PathBuf> = (0..3000).map(|n| folder.path().join(format!("missing-{n}.yaml"))).collect();
    let mut args: Vec<&dyn AsRef<std::ffi::OsStr>> = vec![&"map", &"--out", &out, &real];
    args.extend(missing.iter().map(|map| map as &dyn AsRef<std::ffi::OsStr>));
    assert_eq!(placegraph(&args).status.code(), Some(1));
    let (_, rows) = table(&out);
    assert_eq!(rows.len(), 3001);
    assert_eq!(rows.values().filter(|row| row[1] == "failed").count(), 3000);
}

/// Every file of a folder and of those in it.
fn all_files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = BTreeMap::new();
    for name in names(folder) {
        let path = folder.join(&name);
        if path.is_dir() {
            files.extend(
                all_files(&path).into_iter().map(|(below, bytes)| (Path::new(&name).join(below), bytes)),
            );
        } else if name != "summary.csv" {
            files.insert(name.into(), fs::read(&path).unwrap());
        }
    }
    files
}

#[test]
fn with_a_fixed_time_neither_order_nor_threads_nor_company_change_a_byte() {
    let folder = TempDir::new().unwrap();
    let mut maps: Vec<PathBuf> = ["a", "b", "c"]
        .into_iter()
        .zip([20, 30, 40])
        .map(|(name, n)| write_map(folder.path(), name, n))
        .collect();
    let run = |maps: &[PathBuf], threads: &str| {
        let out = TempDir::new().unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_placegraph"));
        command.env("SOURCE_DATE_EPOCH", "1000000000").args(["map", "--export", "tmap2,report,nav2-zones"]);
        command.args(["--probabilities", "--threads", threads, "--out"]).arg(out.path()).args(maps);
        assert!(command.stderr(Stdio::null()).status().unwrap().success());
        all_files(out.path())
    };
    let expected = run(&maps, "1");
    assert_eq!(expected.len(), 3 * 12, "{:?}", expected.keys());
    maps.reverse();
    assert!(run(&maps, "4") == expected);
    assert!(run(&maps[..2], "2").iter().all(|(name, bytes)| expected[name] == *bytes));
}
