//! Killed at any moment, no room, no right to write, no memory: results are whole or absent, and told as errors.

use std::collections::BTreeMap;
use std::env;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use crate::running::{done, names, placegraph, refused, shipped, stderr};
use tempfile::TempDir;

/// How often programs are killed: `PLACEGRAPH_KILLS`, by default 10 times each.
fn n_kills() -> u32 {
    env::var("PLACEGRAPH_KILLS").map_or(10, |n| n.parse().expect("a number of kills"))
}

/// The files of a folder and their content, without what a clock wrote; hidden folders are not looked into.
fn content(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let visible = |name: &String| !name.starts_with('.');
    let files = names(folder).into_iter().filter(visible).map(|name| {
        let bytes = fs::read(folder.join(&name)).unwrap();
        let bytes = if name == "topology.json" { without_timings(&bytes) } else { bytes };
        (name, bytes)
    });
    files.collect()
}

/// Fails if the bytes are not a whole document.
fn without_timings(bytes: &[u8]) -> Vec<u8> {
    let mut document: serde_json::Value = serde_json::from_slice(bytes).expect("a whole document");
    document.as_object_mut().unwrap().remove("timings_ms");
    serde_json::to_vec(&document).unwrap()
}

type Args<'a> = Vec<&'a dyn AsRef<OsStr>>;

fn command(args: &Args<'_>) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_placegraph"));
    command.args(args.iter().map(AsRef::as_ref)).stdout(Stdio::null()).stderr(Stdio::null());
    command
}

/// Starts the program again and again, and kills it at moments spread over the time it takes, later and earlier ones
/// mixed. Calls `check` after each.
fn kill_often(args: &Args<'_>, takes: Duration, mut check: impl FnMut(u32)) {
    for n in 0..n_kills() {
        let mut run = command(args).spawn().unwrap();
        // Steps of the golden ratio fill the time evenly, in no order. Some come after the end.
        let share = (f64::from(n) * 0.618_033_988).fract() * 1.1;
        thread::sleep(takes.mul_f64(share));
        run.kill().unwrap();
        run.wait().unwrap();
        check(n);
    }
}

fn time_of(args: &Args<'_>) -> Duration {
    let start = Instant::now();
    done(args);
    start.elapsed()
}

fn hidden(folder: &Path) -> Vec<String> {
    names(folder).into_iter().filter(|name| name.starts_with('.')).collect()
}

#[test]
fn a_killed_map_leaves_the_old_result_or_the_new_one_or_none() {
    let folder = TempDir::new().unwrap();
    let (old, new, out) = (folder.path().join("old"), folder.path().join("new"), folder.path().join("out"));
    let map = shipped("home/map.yaml");
    let with_out = |out| -> Args<'_> { vec![&"map", &map, &"--out", out] };
    let without_doorways = |out| -> Args<'_> { vec![&"map", &map, &"--no-doorways", &"--out", out] };
    done(&without_doorways(&old));
    let takes = time_of(&with_out(&new));
    let (old, new) = (content(&old), content(&new));
    assert_ne!(old, new);
    done(&without_doorways(&out));
    let (mut n_old, mut n_new, mut n_none) = (0, 0, 0);
    kill_often(&with_out(&out), takes, |n| {
        let found = content(&out);
        match found.get("topology.json") {
            Some(_) if found == old => n_old += 1,
            Some(_) if found == new => n_new += 1,
            Some(_) => panic!("kill {n}: files of two results beside a document"),
            None => n_none += 1,
        }
        for (name, bytes) in &found {
            assert!(old[name] == *bytes || new[name] == *bytes, "kill {n}: {name} is whole");
        }
        if n % 3 == 2 {
            done(&without_doorways(&out));
            assert_eq!(hidden(&out), [""; 0], "the next run cleans up");
        }
    });
    println!("map: {n_old} times the old result, {n_new} times the new one, {n_none} times none");
    done(&with_out(&out));
    assert_eq!(content(&out), new);
    assert_eq!(hidden(&out), [""; 0]);
}

#[test]
fn a_killed_training_leaves_a_whole_model_or_none() {
    let folder = TempDir::new().unwrap();
    let (expected, model) = (folder.path().join("expected.json"), folder.path().join("model.json"));
    let (map, labels) = (shipped("home/map.yaml"), shipped("home/labels.png"));
    let train = |output| -> Args<'_> {
        let fixed: [&dyn AsRef<OsStr>; 9] = [
            &"train",
            &"--rounds",
            &"5",
            &"--temperature",
            &"1",
            &"--max-cells-per-class",
            &"200",
            &"--map",
            &map,
        ];
        let mut args = Args::from(fixed);
        args.extend([&"--labels" as &dyn AsRef<OsStr>, &labels, &"-o", output]);
        args
    };
    let takes = time_of(&train(&expected));
    let expected = fs::read(&expected).unwrap();
    let mut n_models = 0;
    kill_often(&train(&model), takes, |n| {
        if model.exists() {
            assert!(fs::read(&model).unwrap() == expected, "kill {n}: the model is whole");
            fs::remove_file(&model).unwrap();
            n_models += 1;
        }
    });
    println!("train: {n_models} times a model");
    done(&train(&model));
    assert_eq!(fs::read(&model).unwrap(), expected);
    assert_eq!(hidden(folder.path()), [""; 0]);
}

/// Small maps that take a few milliseconds each.
fn small_maps(folder: &Path, n: u32) -> Vec<PathBuf> {
    let rooms = |n: u32| {
        let (width, height) = (60 + n, 40);
        let is_wall = |x: u32, y: u32| {
            x == 0 || y == 0 || x == width - 1 || y == height - 1 || x == 30 && !(15..24).contains(&y)
        };
        let cells = (0..height).flat_map(|y| (0..width).map(move |x| if is_wall(x, y) { 0 } else { 254 }));
        [format!("P5\n{width} {height}\n255\n").into_bytes(), cells.collect()].concat()
    };
    let write = |n: u32| {
        let path = folder.join(format!("m{n:05}.pgm"));
        fs::write(&path, rooms(n % 7)).unwrap();
        path
    };
    (0..n).map(write).collect()
}

#[test]
fn a_killed_batch_is_completed_by_resume() {
    let folder = TempDir::new().unwrap();
    let (expected, out) = (folder.path().join("expected"), folder.path().join("out"));
    let maps = small_maps(folder.path(), 12);
    let batch = |out| -> Args<'_> {
        let mut args: Args<'_> = vec![&"map", &"--resolution", &"0.1", &"--resume", &"--out", out];
        args.extend(maps.iter().map(|map| map as &dyn AsRef<OsStr>));
        args
    };
    let takes = time_of(&batch(&expected));
    let results = |out: &Path| -> BTreeMap<String, BTreeMap<String, Vec<u8>>> {
        let folders = names(out).into_iter().filter(|name| out.join(name).is_dir() && !name.starts_with('.'));
        folders.map(|name| (name.clone(), content(&out.join(name)))).collect()
    };
    let all = results(&expected);
    let mut n_complete = 0;
    kill_often(&batch(&out), takes, |n| {
        if n % 4 == 0 {
            let _ = fs::remove_dir_all(&out);
            return;
        }
        if !out.exists() {
            return;
        }
        for (name, files) in results(&out) {
            if files.contains_key("topology.json") {
                assert!(files == all[&name], "kill {n}: {name} is complete");
                n_complete += 1;
            }
            assert!(
                files.iter().all(|(file, bytes)| all[&name][file] == *bytes),
                "kill {n}: {name} is whole"
            );
        }
    });
    println!("batch: {n_complete} complete results in folders of killed runs");
    done(&batch(&out));
    assert_eq!(results(&out), all);
    assert!(results(&out).keys().all(|name| hidden(&out.join(name)).is_empty()));
    assert!(out.join("summary.csv").exists());
}

/// A file system of a few pages; unmounted when dropped.
struct SmallDisk(TempDir);

impl SmallDisk {
    /// `None`, and a line that says so, where mounting is not permitted.
    fn mount(options: &str) -> Option<Self> {
        let folder = TempDir::new().unwrap();
        let mut mount = Command::new("mount");
        mount.args(["-t", "tmpfs", "-o", options, "tmpfs"]).arg(folder.path());
        if mount.output().is_ok_and(|output| output.status.success()) {
            return Some(Self(folder));
        }
        println!("SKIPPED: a tmpfs cannot be mounted here; run this test as root");
        None
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(self.0.path()).output();
    }
}

#[test]
fn a_full_disk_leaves_what_was_there() {
    let Some(disk) = SmallDisk::mount("size=160k") else { return };
    let out = disk.0.path().join("out");
    let map = shipped("home/map.yaml");
    let args: Args<'_> = vec![&"map", &map, &"--out", &out];
    refused(&args, &["No space left on device", "out"]);
    assert!(!out.exists(), "nothing is left of a folder made for nothing");
    // An older result, whole, stays whole.
    let maps = TempDir::new().unwrap();
    let small = small_maps(maps.path(), 2);
    let older: Args<'_> = vec![&"map", &small[0], &"--resolution", &"0.1", &"--out", &out];
    done(&older);
    let before = content(&out);
    assert!(before.len() > 5);
    refused(&args, &["No space left on device"]);
    assert_eq!(content(&out), before);
    assert_eq!(hidden(&out), [""; 0]);
    done(&[&"verify", &out]);
    fs::remove_dir_all(&out).unwrap();
    // A batch tells the map that failed and goes on; its table may find room.
    let batch = placegraph(&[&"map", &map, &small[0], &small[1], &"--resolution", &"0.1", &"--out", &out]);
    assert!(matches!(batch.status.code(), Some(1 | 2)), "{}", stderr(&batch));
    assert!(stderr(&batch).contains("No space left on device"), "{}", stderr(&batch));
    assert!(!out.join("home/topology.json").exists());
}

#[test]
fn a_folder_that_cannot_be_written_is_an_error() {
    let map = shipped("home/map.yaml");
    let expect = |out: &Path| {
        let before = out.exists();
        refused(&[&"map", &map, &"--out", &out], &[&out.display().to_string()]);
        assert_eq!(out.exists(), before);
    };
    let file = tempfile::NamedTempFile::new().unwrap();
    expect(&file.path().join("below/a/file"));
    if Path::new("/proc/self").exists() {
        expect(Path::new("/proc/placegraph"));
    }
    if let Some(disk) = SmallDisk::mount("size=1m,ro") {
        expect(&disk.0.path().join("out"));
        expect(disk.0.path());
    }
}

/// Runs the program with at most so many KiB of address space.
fn with_memory(kib: u64, args: &Args<'_>) -> Output {
    let mut shell = Command::new("sh");
    shell.args(["-c", &format!("ulimit -v {kib}; exec \"$@\""), "sh", env!("CARGO_BIN_EXE_placegraph")]);
    shell.args(args.iter().map(AsRef::as_ref)).output().unwrap()
}

/// A gray image of `side` by `side` pixels.
fn square_map(folder: &Path, name: &str, side: usize, is_wall: impl Fn(usize, usize) -> bool) -> PathBuf {
    let path = folder.join(name);
    let cells = (0..side * side).map(|i| if is_wall(i % side, i / side) { 0 } else { 254 });
    fs::write(&path, [format!("P5\n{side} {side}\n255\n").into_bytes(), cells.collect()].concat()).unwrap();
    path
}

/// The least memory, to 10 MiB, in which the program starts at all.
fn least_mib() -> u64 {
    let starts = |mib: &u64| with_memory(mib << 10, &vec![&"--version"]).status.success();
    (20..100).step_by(10).find(starts).expect("a program that starts in 100 MiB")
}

/// Runs the program with every number of MiB: it succeeds, or says in one line that there is too little memory.
fn succeeds_or_refuses(name: &str, limits: impl Iterator<Item = u64>, args: &Args<'_>) {
    let (mut n_refused, mut n_done) = (0, 0);
    for mib in limits {
        let output = with_memory(mib << 10, args);
        let message = stderr(&output);
        match output.status.code() {
            Some(0) => n_done += 1,
            Some(2) => {
                assert!(message.starts_with("error: "), "{name}, {mib} MiB: {message}");
                n_refused += 1;
            }
            other => panic!("{name}, {mib} MiB: {other:?} {:?}: {message}", output.status),
        }
    }
    println!("memory for {name}: {n_done} times enough, {n_refused} times refused");
    assert!(n_refused > 0, "{name}: some of it was too little");
}

#[test]
fn too_little_memory_is_an_error() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    let rooms = square_map(folder.path(), "rooms.pgm", 1500, |x, y| x % 100 == 0 || y % 100 == 0);
    let info: Args<'_> = vec![&"info", &rooms, &"--resolution", &"0.1"];
    let least = least_mib();
    succeeds_or_refuses("info", (least..=220).step_by(20), &info);
    // And one that takes more for its places than for its cells.
    let cells = square_map(folder.path(), "cells.pgm", 500, |x, y| x % 6 == 0 || y % 6 == 0);
    for map in [&rooms, &cells] {
        let labeled: Args<'_> = vec![&"map", map, &"--resolution", &"0.1", &"--out", &out];
        succeeds_or_refuses("map", (least..=220).step_by(20), &labeled);
    }
}

#[test]
fn too_little_memory_for_training_and_documents_is_an_error() {
    let folder = TempDir::new().unwrap();
    let path = |name: &str| folder.path().join(name);
    let (map, labels, model) = (shipped("office/map.yaml"), shipped("office/labels.png"), path("model.json"));
    let train: [&dyn AsRef<OsStr>; 9] =
        [&"train", &"--rounds", &"1", &"--map", &map, &"--labels", &labels, &"-o", &model];
    let least = least_mib();
    succeeds_or_refuses("train", (least..=150).step_by(10), &train.to_vec());

    done(&[&"map", &shipped("home/map.yaml"), &"--out", &path("out")]);
    let document: serde_json::Value =
        serde_json::from_slice(&fs::read(path("out/topology.json")).unwrap()).unwrap();
    let written = |name: &str, change: &dyn Fn(&mut serde_json::Value)| {
        let mut document = document.clone();
        change(&mut document);
        fs::write(path(name), document.to_string()).unwrap();
        path(name)
    };
    let wide = written("wide.json", &|document| {
        document["map"]["width"] = 20_000.into();
        document["map"]["height"] = 19_000.into();
    });
    let mask = path("mask.yaml");
    let export: [&dyn AsRef<OsStr>; 6] = [&"export", &wide, &"--to", &"nav2-keepout", &"-o", &mask];
    succeeds_or_refuses("export", [100, 200, 300, 400, 600, 800].into_iter(), &export.to_vec());
    // A point takes more memory than its text, and a list that grows more than its points.
    let long = written("long.json", &|document| {
        document["places"][0]["outline"][0]["exterior"] =
            serde_json::Value::Array(vec![serde_json::json!({ "x": 1, "y": 1 }); 1 << 20]);
    });
    let at: [&dyn AsRef<OsStr>; 4] = [&"where", &long, &"--at", &"1,1"];
    for mib in (least..=200).step_by(10) {
        let output = with_memory(mib << 10, &at.to_vec());
        assert_eq!(
            output.status.code(),
            Some(2),
            "where, {mib} MiB: {:?} {}",
            output.status,
            stderr(&output)
        );
    }
}
