//! What is not ours stays, and what cannot be written leaves what was there.

use std::fs;
use std::process::{Command, Stdio};

use placegraph::model::sha256_hex;

use crate::running::site::{content, labeled, site};
use crate::running::{done, json, names, placegraph, refused, stderr};

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
        refused(&[&"where", &path, &"--at", &"1,1"], &["without folders"]);
    }
    assert!(folder.path().join("precious").exists());
}

#[cfg(unix)]
#[test]
fn a_link_in_the_place_of_a_file_of_the_result_is_not_removed() {
    let folder = site("map.png");
    let out = labeled(folder.path(), "svg");
    let (file, moved) = (out.join("regions.svg"), folder.path().join("moved.svg"));
    fs::rename(&file, &moved).unwrap();
    std::os::unix::fs::symlink(&moved, &file).unwrap();
    labeled(folder.path(), "dot");
    assert!(file.is_symlink() && moved.is_file());
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
    text(&[&"features"]);
    // With and without a line end at their end: what stays in a buffer would be lost.
    for format in placegraph::export::FORMATS.iter().filter(|format| {
        let files = format.file_names(&format.usual_name("map"));
        files.is_ok_and(|files| files.len() == 1)
    }) {
        text(&[&"export", &topology, &"--to", &format.name, &"-o", &"-"]);
    }
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
