//! What is not ours stays, what is ours belongs together, and a result vouches for itself.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use placegraph::model::sha256_hex;
use serde_json::Value;
use tempfile::TempDir;

use crate::running::{done, json, names, placegraph, refused, stderr};

/// A folder with a small map called `map.yaml`, its image called `image`, and a result of it in `out`.
fn site(image: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    write_map(folder.path(), image, 60);
    folder
}

/// Two rooms and a doorway, `columns` wide.
fn write_map(folder: &Path, image: &str, columns: u32) {
    let is_wall = |x: u32, y: u32| {
        x == 0 || y == 0 || x == columns - 1 || y == 39 || x == columns / 2 && !(15..24).contains(&y)
    };
    let pixels =
        image::GrayImage::from_fn(columns, 40, |x, y| image::Luma([if is_wall(x, y) { 0 } else { 254 }]));
    pixels.save(folder.join(image)).unwrap();
    let yaml = format!(
        "image: {image}\nresolution: 0.1\norigin: [0.0, 0.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n\
         free_thresh: 0.196\n"
    );
    fs::write(folder.join("map.yaml"), yaml).unwrap();
}

fn labeled(folder: &Path, formats: &str) -> PathBuf {
    let out = folder.join("out");
    done(&[&"map", &folder.join("map.yaml"), &"--out", &out, &"--export", &formats]);
    out
}

/// The files of a folder with their content, by name.
fn content(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let files = names(folder).into_iter().filter(|name| folder.join(name).is_file());
    files.map(|name| (name.clone(), fs::read(folder.join(&name)).unwrap())).collect()
}

#[test]
fn an_input_is_never_an_output() {
    // A truth beside the map; the map's own image by the names of results; the picture of a result as the map.
    for (image, out) in [("map.png", "."), ("labels.png", "."), ("regions.png", "."), ("overview.png", ".")] {
        let folder = site(image);
        if image == "map.png" {
            fs::write(folder.path().join("labels.png"), "truth").unwrap();
        }
        let before = content(folder.path());
        refused(
            &[&"map", &folder.path().join("map.yaml"), &"--out", &folder.path().join(out)],
            &["--force", ".png"],
        );
        assert_eq!(content(folder.path()), before, "{image}");
    }
    let folder = site("map.png");
    let out = labeled(folder.path(), "svg");
    let before = content(&out);
    refused(&[&"map", &out.join("labels.yaml"), &"--out", &out], &["input of this run"]);
    let topology = out.join("topology.json");
    refused(&[&"export", &topology, &"--to", &"svg", &"-o", &topology], &["input of this run"]);
    let scan: [&dyn AsRef<std::ffi::OsStr>; 6] = [
        &"scan",
        &folder.path().join("map.yaml"),
        &"--at",
        &"1.5,1.5",
        &"-o",
        &folder.path().join("map.png"),
    ];
    refused(&scan, &["input of this run"]);
    assert_eq!(content(&out), before);
    // Not an input, but somebody's: the map file that was named, and the image that was not.
    let map = content(folder.path());
    for name in ["map.yaml", "other.yaml"] {
        fs::write(folder.path().join("other.png"), "somebody's").unwrap();
        refused(
            &[&"export", &topology, &"--to", &"nav2-keepout", &"-o", &folder.path().join(name)],
            &["--force"],
        );
        fs::remove_file(folder.path().join("other.png")).unwrap();
        assert_eq!(content(folder.path()), map, "{name}");
    }
}

#[test]
fn force_replaces_files_of_others() {
    let folder = site("map.png");
    let out = folder.path().join("out");
    fs::create_dir(&out).unwrap();
    fs::write(out.join("labels.png"), "truth").unwrap();
    let map: [&dyn AsRef<std::ffi::OsStr>; 4] = [&"map", &folder.path().join("map.yaml"), &"--out", &out];
    refused(&map, &["labels.png", "--force"]);
    assert_eq!(names(&out), ["labels.png"]);
    done(&[&map[..], &[&"--force"]].concat());
    // Now it is ours.
    done(&map);
    done(&[&"verify", &out]);
}

#[cfg(unix)]
#[test]
fn devices_pipes_and_links_are_not_replaced() {
    use std::os::unix::fs::{FileTypeExt, symlink};

    let folder = site("map.png");
    let topology = labeled(folder.path(), "dot").join("topology.json");
    let path = |name: &str| folder.path().join(name);
    assert!(Command::new("mkfifo").arg(path("pipe")).status().unwrap().success());
    let is_root =
        Command::new("mknod").arg(path("null")).args(["c", "1", "3"]).stderr(Stdio::null()).status();
    let made_null = is_root.is_ok_and(|status| status.success());
    let mut special = vec!["pipe"];
    special.extend(made_null.then_some("null"));
    for name in special {
        refused(&[&"export", &topology, &"--to", &"svg", &"-o", &path(name)], &["a device or a pipe"]);
        let kind = fs::symlink_metadata(path(name)).unwrap().file_type();
        assert!(kind.is_fifo() || kind.is_char_device(), "{name}");
    }
    symlink("real.svg", path("link.svg")).unwrap();
    refused(&[&"export", &topology, &"--to", &"svg", &"-o", &path("link.svg")], &["link.svg"]);
    done(&[&"export", &topology, &"--to", &"svg", &"-o", &path("real.svg")]);
    done(&[&"export", &topology, &"--to", &"svg", &"-o", &path("link.svg")]);
    assert!(path("link.svg").is_symlink() && path("real.svg").is_file());
    // A link in the place of a result's file.
    symlink(path("map.png"), path("out/regions.svg")).unwrap();
    let again: [&dyn AsRef<std::ffi::OsStr>; 6] =
        [&"map", &path("map.yaml"), &"--out", &path("out"), &"--export", &"svg"];
    refused(&again, &["symbolic link"]);
    // Standard output has what a file would have.
    let printed = done(&[&"export", &topology, &"--to", &"svg", &"-o", &"-"]);
    assert_eq!(printed, fs::read_to_string(path("real.svg")).unwrap());
    refused(&[&"export", &topology, &"--to", &"nav2-keepout", &"-o", &"-"], &["folder"]);
}

#[test]
fn a_folder_never_holds_files_of_two_results() {
    let folder = site("map.png");
    let out = labeled(folder.path(), "nav2,nav2-keepout,rmf-building");
    let name = json(&out.join("topology.json"))["map"]["name"].as_str().unwrap().to_owned();
    let building = format!("{name}.building.yaml");
    fs::write(out.join("notes.txt"), "mine").unwrap();
    // Written by nobody else, but changed since.
    fs::write(out.join("keepout_params.yaml"), "edited by hand").unwrap();

    let other = TempDir::new().unwrap();
    write_map(other.path(), "map.png", 80);
    let output = placegraph(&[&"map", &other.path().join("map.yaml"), &"--out", &out, &"--export", &"dot"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let removed = ["route_graph.geojson", "keepout.yaml", "keepout.png", building.as_str()];
    for name in removed {
        assert!(!out.join(name).exists(), "{name}");
        assert!(stderr(&output).contains(name), "{}", stderr(&output));
    }
    assert_eq!(fs::read_to_string(out.join("notes.txt")).unwrap(), "mine");
    assert_eq!(fs::read_to_string(out.join("keepout_params.yaml")).unwrap(), "edited by hand");
    done(&[&"verify", &out]);

    // An export into the folder of its result belongs to it, and goes with it.
    done(&[&"export", &out.join("topology.json"), &"--to", &"geojson", &"-o", &out]);
    done(&[&"verify", &out]);
    let files = json(&out.join("topology.json"))["files"].to_string();
    assert!(files.contains("regions.geojson") && files.contains("graph.dot"), "{files}");
    labeled(folder.path(), "svg");
    assert!(!out.join("regions.geojson").exists() && !out.join("graph.dot").exists());
}

#[test]
fn every_export_names_its_map() {
    let folder = site("map.png");
    let out = labeled(folder.path(), "all");
    let document = json(&out.join("topology.json"));
    let hash = document["map"]["hash"].as_str().unwrap();
    for format in placegraph::export::FORMATS {
        let main = format.usual_name(document["map"]["name"].as_str().unwrap());
        if document["skipped"].to_string().contains(&format!("\"{}\"", format.name)) {
            continue;
        }
        if ["segments.json", "valetudo.json"].contains(&main.as_str()) {
            continue; // these formats have no member for it; the document lists the files
        }
        let text = fs::read_to_string(out.join(&main)).unwrap();
        assert!(text.contains(hash), "{main} does not name the map");
    }
    // A stray one of another map is found.
    let other = TempDir::new().unwrap();
    write_map(other.path(), "map.png", 80);
    let stray = labeled(other.path(), "tmap2,nav2-shapes").join("shapes.yaml");
    fs::remove_file(out.join("shapes.yaml")).unwrap();
    fs::copy(stray, out.join("stray.yaml")).unwrap();
    let output = placegraph(&[&"verify", &out]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(
        text.contains("shapes.yaml is missing") && text.contains("stray.yaml belongs to another map"),
        "{text}"
    );
}

#[test]
fn a_result_lists_its_files_and_verify_compares_them() {
    let folder = site("map.png");
    let out = labeled(folder.path(), "svg,nav2-speed");
    let document = json(&out.join("topology.json"));
    let mut listed: Vec<String> = Vec::new();
    for file in document["files"].as_array().unwrap() {
        let name = file["name"].as_str().unwrap().to_owned();
        let bytes = fs::read(out.join(&name)).unwrap();
        assert_eq!(file["bytes"], bytes.len(), "{name}");
        assert_eq!(file["sha256"], sha256_hex(&bytes), "{name}");
        listed.push(name);
    }
    listed.push("topology.json".to_owned());
    listed.sort();
    assert_eq!(listed, names(&out));
    let text = done(&[&"verify", &folder.path(), &out.join("topology.json")]);
    assert_eq!(text.matches("as written").count(), 2, "{text}");

    let check = |expected: &str| {
        let output = placegraph(&[&"verify", &out]);
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert_eq!(output.status.code(), Some(1), "{text}");
        assert!(text.contains(expected), "{expected}: {text}");
    };
    let svg = fs::read(out.join("regions.svg")).unwrap();
    fs::write(out.join("regions.svg"), [svg.as_slice(), b"\n"].concat()).unwrap();
    check("regions.svg was changed");
    fs::write(out.join("regions.svg"), &svg).unwrap();
    fs::remove_file(out.join("labels.yaml")).unwrap();
    check("labels.yaml is missing");
    let text = fs::read_to_string(out.join("topology.json")).unwrap();
    fs::write(out.join("topology.json"), text.replacen("room", "salon", 1)).unwrap();
    assert_eq!(placegraph(&[&"verify", &out]).status.code(), Some(1));
    refused(&[&"verify", &folder.path().join("map.png")], &["topology.json"]);
    refused(&[&"verify", &TempDir::new().unwrap().path()], &["topology.json"]);
}

#[test]
fn the_document_names_the_bytes_that_were_read() {
    let folder = site("map.png");
    let (edits, masks) = (folder.path().join("edits.toml"), folder.path().join("masks.toml"));
    fs::write(&edits, "[[edit]]\naction = 'rename'\nat = [1.5, 1.5]\nname = 'kitchen'\n").unwrap();
    fs::write(&masks, "[keepout]\nelsewhere = 100\n").unwrap();
    let (first, out) = (labeled(folder.path(), "svg").join("topology.json"), folder.path().join("second"));
    let map = folder.path().join("map.yaml");
    done(&[&"map", &map, &"--out", &out, &"--edits", &edits, &"--masks", &masks, &"--previous", &first]);
    let document = json(&out.join("topology.json"));
    let options: Vec<String> = serde_json::from_value(document["program"]["options"].clone()).unwrap();
    for (name, path) in [("--edits", &edits), ("--masks", &masks), ("--previous", &first)] {
        let expected = format!("{name} sha256:{}", sha256_hex(&fs::read(path).unwrap()));
        assert!(options.contains(&expected), "{expected}: {options:?}");
    }
    let map_bytes = [fs::read(&map).unwrap(), fs::read(folder.path().join("map.png")).unwrap()].concat();
    assert_eq!(document["map"]["hash"], sha256_hex(&map_bytes));
}

#[test]
fn a_result_may_continue_itself_from_the_first_night_on() {
    let folder = site("map.png");
    let (map, out) = (folder.path().join("map.yaml"), folder.path().join("out"));
    let edits = folder.path().join("edits.toml");
    fs::write(&edits, "[[edit]]\naction = 'rename'\nat = [1.5, 1.5]\nname = 'kitchen'\n").unwrap();
    let nightly: [&dyn AsRef<std::ffi::OsStr>; 6] = [&"map", &map, &"--out", &out, &"--previous", &out];
    done(&[&nightly[..], &[&"--edits", &edits]].concat());
    let changes = done(&nightly);
    assert_eq!(changes, "");
    assert!(fs::read_to_string(out.join("topology.json")).unwrap().contains("kitchen"));
    refused(&[&"map", &map, &"--out", &out, &"--previous", &folder.path().join("gone")], &["gone"]);
}

#[test]
fn a_document_of_a_stranger_removes_nothing() {
    let folder = site("map.png");
    let out = labeled(folder.path(), "svg");
    fs::write(folder.path().join("precious"), "mine").unwrap();
    fs::write(out.join("thesis.txt"), "mine").unwrap();
    let mut document = json(&out.join("topology.json"));
    let record = |name: &str| serde_json::json!({ "name": name, "bytes": 4, "sha256": sha256_hex(b"your") });
    document["files"].as_array_mut().unwrap().push(record("thesis.txt"));
    fs::write(out.join("topology.json"), document.to_string()).unwrap();
    labeled(folder.path(), "dot");
    assert_eq!(fs::read_to_string(out.join("thesis.txt")).unwrap(), "mine", "not what the document tells of");
    for name in ["../precious", "/etc/hostname", "..", "a\\b", ""] {
        let mut document = json(&out.join("topology.json"));
        document["files"].as_array_mut().unwrap().push(record(name));
        let path = folder.path().join("hostile.json");
        fs::write(&path, document.to_string()).unwrap();
        refused(&[&"where", &path, &"--at", &"1,1"], &["plain name"]);
    }
    assert!(folder.path().join("precious").exists());
}

#[test]
fn a_value_for_a_place_that_is_none_is_an_error() {
    let folder = site("map.png");
    let topology = labeled(folder.path(), "svg").join("topology.json");
    let masks = folder.path().join("masks.toml");
    let mask = |text: &str, format: &str| {
        fs::write(&masks, text).unwrap();
        let out = folder.path().join("mask.yaml");
        refused(&[&"export", &topology, &"--to", &format, &"-o", &out, &"--masks", &masks], &["nope"]);
        assert!(!out.exists());
        // Of a run of `map`, that format alone is skipped.
        let (map, out) = (folder.path().join("map.yaml"), folder.path().join("masked"));
        let both = format!("{format},dot");
        let run: [&dyn AsRef<std::ffi::OsStr>; 8] =
            [&"map", &map, &"--out", &out, &"--masks", &masks, &"--export", &both];
        let output = placegraph(&run);
        assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
        assert!(stderr(&output).contains("nope") && out.join("graph.dot").exists(), "{}", stderr(&output));
    };
    mask("[keepout]\ncost = { place = { nope = 100 } }\n", "nav2-keepout");
    mask("[keepout]\ncost = { place = { nope = 100 } }\n", "nav2-shapes");
    mask("[speed]\nunit = 'percent'\nlimit = { place = { nope = 10 } }\n", "nav2-speed");
    fs::write(&masks, "[keepout]\nelsewhere = 101\n").unwrap();
    let out = folder.path().join("mask.yaml");
    refused(
        &[&"export", &topology, &"--to", &"nav2-keepout", &"-o", &out, &"--masks", &masks],
        &["elsewhere", "100", "101"],
    );
}

#[cfg(target_os = "linux")]
#[test]
fn what_does_not_arrive_is_an_error() {
    let folder = site("map.png");
    let topology = labeled(folder.path(), "svg").join("topology.json");
    let map = folder.path().join("map.yaml");
    let text = |args: &[&dyn AsRef<std::ffi::OsStr>]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_placegraph"));
        command.args(args).stdout(fs::File::options().write(true).open("/dev/full").unwrap());
        let output = command.output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        assert!(stderr(&output).contains("No space left"), "{}", stderr(&output));
    };
    text(&[&"info", &map]);
    text(&[&"info", &map, &"--json"]);
    text(&[&"where", &topology, &"--at", &"1,1"]);
    text(&[&"export", &topology, &"--to", &"svg", &"-o", &"-"]);
    text(&[&"features"]);
}

/// As an administrator may forbid, or a container's mount.
#[cfg(target_os = "linux")]
#[test]
fn if_a_file_cannot_be_replaced_the_old_result_stays_whole() {
    let folder = site("map.png");
    let out = labeled(folder.path(), "svg");
    let before = content(&out);
    let chattr = |change: &str| {
        Command::new("chattr").arg(change).arg(out.join("regions.png")).stderr(Stdio::null()).status()
    };
    if !chattr("+i").is_ok_and(|status| status.success()) {
        println!("SKIPPED: files cannot be made immutable here; run this test as root");
        return;
    }
    let output = placegraph(&[&"map", &folder.path().join("map.yaml"), &"--out", &out, &"--no-doorways"]);
    let found = content(&out);
    chattr("-i").unwrap();
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("regions.png"), "{}", stderr(&output));
    assert_eq!(found, before);
    assert!(names(&out).iter().all(|name| !name.starts_with('.')), "{:?}", names(&out));
    done(&[&"verify", &out]);
}

/// A power cut must find on the disk what the program said that it wrote: asked of the system calls.
#[cfg(target_os = "linux")]
#[test]
fn files_are_on_the_disk_before_their_names_are_and_names_before_the_end() {
    let folder = site("map.png");
    let (out, log) = (folder.path().join("out"), folder.path().join("log"));
    let mut strace = Command::new("strace");
    strace.args(["-f", "-y", "-e", "trace=fsync,rename,renameat,renameat2", "-o"]).arg(&log);
    strace.arg(env!("CARGO_BIN_EXE_placegraph")).arg("map").arg(folder.path().join("map.yaml"));
    if !strace.arg("--out").arg(&out).stderr(Stdio::null()).status().is_ok_and(|status| status.success()) {
        println!("SKIPPED: strace cannot run here");
        return;
    }
    let log = fs::read_to_string(log).unwrap();
    let calls: Vec<&str> =
        log.lines().filter(|line| line.contains("fsync(") || line.contains("rename")).collect();
    let is_move = |call: &str| call.contains("rename") && !call.contains("ENOENT");
    let first_move = calls.iter().position(|call| is_move(call)).unwrap();
    let document = names(&out).into_iter().filter(|name| !name.starts_with('.'));
    for name in document {
        let synced = calls[..first_move]
            .iter()
            .any(|call| call.contains("fsync") && call.contains(&format!("/{name}>")));
        assert!(synced, "{name} is synced before the first move: {calls:#?}");
    }
    // The folder itself: before the document is put in place, and after.
    let is_sync = |call: &&str| call.contains("fsync") && call.contains(&format!("{}>", out.display()));
    let last_move = calls.iter().rposition(|call| is_move(call)).unwrap();
    let other_move = calls[..last_move].iter().rposition(|call| is_move(call)).unwrap();
    assert!(calls[last_move].contains("topology.json"), "{calls:#?}");
    assert!(calls[other_move..last_move].iter().any(is_sync), "{calls:#?}");
    assert!(calls[last_move..].iter().any(is_sync), "{calls:#?}");
}

#[test]
fn hidden_folders_of_others_stay() {
    let folder = site("map.png");
    let topology = labeled(folder.path(), "svg").join("topology.json");
    let models = folder.path().join("home/.placegraph-models");
    fs::create_dir_all(&models).unwrap();
    fs::write(models.join("m.json"), "precious").unwrap();
    done(&[&"export", &topology, &"--to", &"dot", &"-o", &folder.path().join("home/g.dot")]);
    assert_eq!(fs::read_to_string(models.join("m.json")).unwrap(), "precious");
}

#[test]
fn a_batch_writes_nowhere_but_in_its_folder() {
    let folder = site("map.png");
    let path = |name: &str| folder.path().join(name);
    for name in ["x.yaml", "...yaml", "..yaml", "summary.csv.yaml"] {
        fs::copy(path("map.yaml"), path(name)).unwrap();
    }
    let out = path("deep/out");
    for bad in ["...yaml", "..yaml", "summary.csv.yaml"] {
        refused(&[&"map", &path("x.yaml"), &path(bad), &"--out", &out], &["map"]);
        assert!(!path("deep").exists(), "{bad}");
    }
    let table = path("summary.csv");
    fs::write(&table, "year,profit\n").unwrap();
    refused(
        &[&"map", &path("x.yaml"), &path("map.yaml"), &"--out", &folder.path()],
        &["summary.csv", "--force"],
    );
    assert_eq!(fs::read_to_string(&table).unwrap(), "year,profit\n");
}

#[test]
fn verbose_tells_the_stages_of_every_map_of_a_batch() {
    let folder = site("map.png");
    fs::copy(folder.path().join("map.yaml"), folder.path().join("other.yaml")).unwrap();
    let [one, other] = ["map.yaml", "other.yaml"].map(|name| folder.path().join(name));
    let output = placegraph(&[&"map", &"-v", &one, &other, &"--out", &folder.path().join("many")]);
    assert_eq!(stderr(&output).lines().filter(|line| line.ends_with(" ms")).count() % 2, 0);
    assert!(stderr(&output).contains(" ms"), "{}", stderr(&output));
}

#[test]
fn statuses_follow_one_rule() {
    let folder = site("map.png");
    let path = |name: &str| folder.path().join(name);
    let topology = labeled(folder.path(), "svg").join("topology.json");
    fs::write(path("edits.toml"), "[[edit]]\naction = 'rename'\nat = [99.0, 99.0]\nname = 'x'\n").unwrap();
    let status = |args: &[&dyn AsRef<std::ffi::OsStr>]| placegraph(args).status.code().unwrap();
    let map: [&dyn AsRef<std::ffi::OsStr>; 4] = [&"map", &path("map.yaml"), &"--out", &path("out")];
    // 0: all that was asked for.
    assert_eq!(status(&map), 0);
    assert_eq!(status(&[&"verify", &path("out")]), 0);
    // 1: done, and something must be looked at.
    assert_eq!(status(&[&map[..], &[&"--edits", &path("edits.toml")]].concat()), 1);
    let labels = path("out/labels.png");
    assert_eq!(status(&[&"evaluate", &labels, &labels, &"--min-accuracy", &"1"]), 0);
    // 2: not done.
    assert_eq!(status(&[&"map", &path("gone.yaml"), &"--out", &path("gone")]), 2);
    assert_eq!(status(&[&"where", &topology, &"--at", &"nowhere"]), 2);
    assert_eq!(status(&[&"fly"]), 2);
    let document: Value = json(&topology);
    assert_eq!(document["errors"].as_array().map(Vec::len), Some(1), "of the run with edits");
}
