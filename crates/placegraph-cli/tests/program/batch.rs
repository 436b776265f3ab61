//! Many maps in one run: the table, what fails, and the edits and earlier results of a fleet.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::running::{self, json, names, placegraph, stderr};
use tempfile::TempDir;

/// A room of `columns` x 40 cells behind a doorway, with walls all around.
pub(crate) fn write_map(folder: &Path, name: &str, columns: usize) -> PathBuf {
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
pub(crate) fn table(out: &Path) -> (Vec<String>, BTreeMap<String, Vec<String>>) {
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

pub(crate) fn statuses(out: &Path) -> Vec<(String, String)> {
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
    assert_eq!(names(&out), ["a", "c", "summary.csv", "summary.jsonl"]);
    let (header, rows) = table(&out);
    assert_eq!(
        header,
        [
            "map",
            "status",
            "error",
            "corridor",
            "room",
            "doorway",
            "connections",
            "area_m2",
            "seconds",
            "folder",
            "findings"
        ]
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

    // The second map is put right; of the third, an unfinished first run was killed before its first file.
    write_map(folder.path(), "b", 30);
    for name in names(&out.join("c")) {
        fs::remove_file(out.join("c").join(name)).unwrap();
    }
    fs::create_dir(out.join("c/.placegraph-unfinished-123456")).unwrap();
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
    let all = |status: &'static str| expected(&[("a", status), ("b", status), ("c", status)]);
    assert_eq!(run(&["--resume", "--export", "graphml,tmap2"]).status.code(), Some(0));
    assert_eq!(statuses(&out), all("extended"), "made from the document");
    assert_eq!(run(&["--resume", "--export", "tmap2,graphml"]).status.code(), Some(0));
    assert_eq!(statuses(&out), all("kept"));
    assert!(out.join("c/c.tmap2.yaml").exists());
    // As if labeled with them at once.
    let again = folder.path().join("again");
    let with_formats: [&dyn AsRef<std::ffi::OsStr>; 4] = [&"map", &"--export", &"graphml,tmap2", &"--out"];
    let paths: [&dyn AsRef<std::ffi::OsStr>; 4] = [&again, &maps[0], &maps[1], &maps[2]];
    assert_eq!(placegraph(&[&with_formats[..], &paths[..]].concat()).status.code(), Some(0));
    for name in names(&again.join("c")) {
        let [one, other] = [&out, &again].map(|out| fs::read(out.join("c").join(&name)).unwrap());
        assert!(one == other || name == "topology.json", "{name}");
    }
    let [one, other] = [&out, &again].map(|out| json(&out.join("c/topology.json"))["sha256"].clone());
    assert_eq!(one, other, "all but the times is the same");
    // One format goes, one comes.
    assert_eq!(run(&["--resume", "--export", "graphml,dot"]).status.code(), Some(0));
    assert_eq!(statuses(&out), all("extended"));
    assert!(!out.join("c/c.tmap2.yaml").exists() && out.join("c/graph.dot").exists());
    // A report shows cells and probabilities, which only labeling has.
    assert_eq!(run(&["--resume", "--export", "report"]).status.code(), Some(0));
    assert_eq!(statuses(&out), all("labeled"));
    assert!(!out.join("c/graph.dot").exists() && out.join("c/report.html").exists());
    assert_eq!(run(&["--resume", "--export", "report", "--no-doorways"]).status.code(), Some(0));
    assert_eq!(statuses(&out), all("labeled"), "an option that adds no file");
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
pub(crate) fn all_files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = BTreeMap::new();
    for name in names(folder) {
        let path = folder.join(&name);
        if path.is_dir() {
            files.extend(
                all_files(&path).into_iter().map(|(below, bytes)| (Path::new(&name).join(below), bytes)),
            );
        } else if !name.starts_with("summary.") {
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

#[test]
fn edits_and_earlier_results_of_a_fleet_are_found_and_compared() {
    let folder = TempDir::new().unwrap();
    let (sites, out) = (folder.path().join("sites"), folder.path().join("out"));
    for site in ["north", "south"] {
        fs::create_dir_all(sites.join(site)).unwrap();
        write_map(&sites.join(site), "map", 30);
    }
    let edits = sites.join("north/edits.toml");
    let rename = |name: &str| format!("[[edit]]\naction = 'rename'\nat = [7.0, 2.0]\nname = '{name}'\n");
    fs::write(&edits, rename("kitchen")).unwrap();
    let run = |out: &Path, options: &[&str]| -> Vec<(String, String)> {
        let mut command = Command::new(env!("CARGO_BIN_EXE_placegraph"));
        let output = command.arg("map").arg(&sites).args(options).arg("--out").arg(out).output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        let text = fs::read_to_string(out.join("summary.jsonl")).unwrap();
        let row = |line: &str| -> (String, String) {
            let row: serde_json::Value = serde_json::from_str(line).unwrap();
            (row["folder"].as_str().unwrap().to_owned(), row["status"].as_str().unwrap().to_owned())
        };
        text.lines().map(row).collect()
    };
    let named = |out: &Path, site: &str, name: &str| {
        let document = json(&out.join(site).join("topology.json"));
        document["places"].as_array().unwrap().iter().any(|place| place["name"] == name)
    };
    let both = |north: &str, south: &str| expected(&[("north", north), ("south", south)]);
    let fleet = ["--edits", "edits.toml", "--resume"];
    assert_eq!(run(&out, &fleet), both("labeled", "labeled"));
    assert!(named(&out, "north", "kitchen") && !named(&out, "south", "kitchen"));
    assert_eq!(json(&out.join("south/topology.json"))["map"]["name"], "south");
    assert_eq!(run(&out, &fleet), both("kept", "kept"));
    // Other edits, of the same length: only that site.
    fs::write(&edits, rename("pantry!")).unwrap();
    assert_eq!(run(&out, &fleet), both("labeled", "kept"));
    assert!(named(&out, "north", "pantry!"));

    // The next night, into the same folder: the names last without the edits, and nothing is done twice.
    let nightly = ["--resume", "--previous", out.to_str().unwrap()];
    fs::remove_file(&edits).unwrap();
    assert_eq!(run(&out, &nightly), both("labeled", "kept"), "an option of one site is gone");
    assert!(named(&out, "north", "pantry!"));
    assert_eq!(run(&out, &nightly), both("kept", "kept"));
    write_map(&sites.join("south"), "map", 31);
    assert_eq!(run(&out, &nightly), both("kept", "labeled"));
    // Into another folder; a new site has no earlier result.
    fs::create_dir(sites.join("west")).unwrap();
    write_map(&sites.join("west"), "map", 32);
    let next = folder.path().join("next");
    let rows = run(&next, &nightly);
    assert_eq!(rows, expected(&[("north", "labeled"), ("south", "labeled"), ("west", "labeled")]));
    assert!(named(&next, "north", "pantry!"));
    assert_eq!(run(&next, &nightly), expected(&[("north", "kept"), ("south", "kept"), ("west", "kept")]));
}

#[test]
fn edits_beside_two_maps_belong_to_one_of_them() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    let maps = [write_map(folder.path(), "up", 20), write_map(folder.path(), "down", 20)];
    let edit = "[[edit]]\naction = 'rename'\nat = [7.0, 2.0]\nname = 'attic'\n";
    fs::write(folder.path().join("edits.toml"), edit).unwrap();
    let args: [&dyn AsRef<std::ffi::OsStr>; 7] =
        [&"map", &maps[0], &maps[1], &"--edits", &"edits.toml", &"--out", &out];
    let output = placegraph(&args);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("next to 2 maps") && stderr(&output).contains("up.edits.toml"));
    fs::rename(folder.path().join("edits.toml"), folder.path().join("up.edits.toml")).unwrap();
    assert_eq!(placegraph(&args).status.code(), Some(0));
    let has_attic =
        |map: &str| fs::read_to_string(out.join(map).join("topology.json")).unwrap().contains("attic");
    assert!(has_attic("up") && !has_attic("down"));
    let elsewhere =
        [&args[..4], &[&folder.path().join("up.edits.toml") as &dyn AsRef<std::ffi::OsStr>], &args[5..]];
    running::refused(&elsewhere.concat(), &["next to each map"]);
}

#[test]
fn warnings_and_errors_are_told_line_by_line_and_in_the_table() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    let maps = [write_map(folder.path(), "good", 20), write_map(folder.path(), "blind", 20)];
    let yaml = fs::read_to_string(&maps[1]).unwrap();
    fs::write(&maps[1], yaml.replace("negate: 0", "negate: 1")).unwrap();
    // Negated, walls alone are free: warnings, and perhaps nothing to label.
    let output = placegraph(&[&"map", &maps[0], &maps[1], &"--out", &out]);
    let (header, rows) = table(&out);
    let findings = header.iter().position(|name| name == "findings").unwrap();
    assert!(!rows["blind"][findings].is_empty(), "{rows:?}");
    let line = stderr(&output).lines().find(|line| line.contains("blind.yaml")).unwrap().to_owned();
    assert!(line.contains(rows["blind"][findings].split(';').next().unwrap()), "{line}");

    // Nothing is free: an error, status 1 in every way to ask.
    fs::write(folder.path().join("blind.pgm"), format!("P2\n4 4\n255\n{}\n", "0 ".repeat(16))).unwrap();
    fs::write(&maps[1], yaml).unwrap();
    let output = placegraph(&[&"map", &maps[0], &maps[1], &"--out", &out]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let (_, rows) = table(&out);
    assert_eq!(rows["blind"][1], "labeled");
    assert!(rows["blind"][2].contains("free") && rows["good"][2].is_empty(), "{rows:?}");
    assert_eq!(placegraph(&[&"info", &maps[1]]).status.code(), Some(1));
    assert_eq!(placegraph(&[&"map", &maps[1], &"--out", &folder.path().join("one")]).status.code(), Some(1));
    // Kept, it still is.
    let again = placegraph(&[&"map", &maps[0], &maps[1], &"--resume", &"--out", &out]);
    assert_eq!(again.status.code(), Some(1), "{}", stderr(&again));
    assert!(table(&out).1["blind"][2].contains("free"));
}
