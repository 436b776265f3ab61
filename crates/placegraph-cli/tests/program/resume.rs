//! What is kept of a run that is taken up again, and what is made again.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;
use std::time::Duration;

use crate::batch::{all_files, statuses, table, write_map};
use crate::running::{placegraph, start_batch, stderr};
use tempfile::TempDir;

#[test]
fn a_killed_run_is_taken_up_where_it_ended() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    let maps: Vec<PathBuf> =
        ["a", "b", "c", "d", "e"].iter().map(|name| write_map(folder.path(), name, 60)).collect();
    let n_rows = || fs::read_to_string(out.join("summary.jsonl")).map_or(0, |text| text.lines().count());
    let mut run = start_batch(&maps, &out);
    while n_rows() == 0 && run.try_wait().unwrap().is_none() {
        thread::sleep(Duration::from_millis(2));
    }
    run.kill().unwrap();
    run.wait().unwrap();
    // The table has what was done so far, and a line of JSON each.
    let (_, rows) = table(&out);
    assert!((1..=maps.len()).contains(&rows.len()), "{rows:?}");
    assert_eq!(rows["a"][1], "labeled");
    let lines = fs::read_to_string(out.join("summary.jsonl")).unwrap();
    let first: serde_json::Value = serde_json::from_str(lines.lines().next().unwrap()).unwrap();
    assert_eq!((&first["status"], &first["folder"]), (&"labeled".into(), &"a".into()));
    assert!(first["places"]["room"].as_u64().is_some(), "{first}");

    let mut args: Vec<&dyn AsRef<std::ffi::OsStr>> = vec![&"map", &"--resume", &"--out", &out];
    args.extend(maps.iter().map(|map| map as &dyn AsRef<std::ffi::OsStr>));
    assert_eq!(placegraph(&args).status.code(), Some(0));
    let statuses = statuses(&out);
    assert_eq!(statuses.len(), maps.len());
    assert_eq!(statuses[0], ("a".to_owned(), "kept".to_owned()));
    assert!(statuses.iter().any(|(_, status)| status == "labeled"), "{statuses:?}");
    assert!(["a", "b", "c", "d", "e"].iter().all(|map| out.join(map).join("overview.png").exists()));
}

/// Runs a batch and returns the status of every map.
fn resumed(out: &Path, maps: &[PathBuf], options: &[&str]) -> Vec<(String, String)> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_placegraph"));
    let output =
        command.arg("map").args(maps).args(options).args(["--resume", "--out"]).arg(out).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    statuses(out)
}

#[test]
fn what_a_killed_run_left_beside_a_whole_result_is_removed_and_the_result_kept() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    let maps = [write_map(folder.path(), "a", 20), write_map(folder.path(), "b", 20)];
    assert_eq!(resumed(&out, &maps, &[])[0].1, "labeled");
    // Killed after the last file had been put into place.
    let left = out.join("a/.placegraph-unfinished-killed");
    fs::create_dir_all(left.join("new")).unwrap();
    fs::create_dir(left.join("old")).unwrap();
    fs::write(left.join("mark"), "placegraph: removed by the next run that writes into the folder above\n")
        .unwrap();
    fs::write(left.join("journal"), "{\"new\":[\"topology.json\"]}").unwrap();
    assert_eq!(resumed(&out, &maps, &[])[0].1, "kept");
    assert!(!left.exists());
}

#[test]
fn a_damaged_result_is_made_again() {
    let folder = TempDir::new().unwrap();
    let (out, fresh) = (folder.path().join("out"), folder.path().join("fresh"));
    let maps = [write_map(folder.path(), "a", 20), write_map(folder.path(), "b", 20)];
    let status = |options: &[&str]| resumed(&out, &maps, options)[0].1.clone();
    resumed(&fresh, &maps, &["--export", "svg"]);
    assert_eq!(status(&["--export", "svg"]), "labeled");
    let whole = all_files(&fresh.join("a"));
    let is_whole = || {
        let found = all_files(&out.join("a"));
        found.keys().eq(whole.keys())
            && found.iter().all(|(name, bytes)| name.ends_with("topology.json") || *bytes == whole[name])
    };
    for name in whole.keys() {
        let path = out.join("a").join(name);
        let bytes = fs::read(&path).unwrap();
        let mut flipped = bytes.clone();
        flipped[bytes.len() / 2] ^= 4;
        let mut damages = vec![bytes[..bytes.len() / 2].to_vec(), flipped];
        // Of an empty document nobody knows whose it is.
        damages.extend((!name.ends_with("topology.json")).then(Vec::new));
        for damage in damages {
            assert_eq!(status(&["--export", "svg"]), "kept", "{}", name.display());
            fs::write(&path, &damage).unwrap();
            assert_eq!(
                status(&["--export", "svg"]),
                "labeled",
                "{} of {} bytes",
                name.display(),
                damage.len()
            );
            assert!(is_whole(), "{}", name.display());
        }
    }
    // A name that was changed by hand.
    let path = out.join("a/topology.json");
    let text = fs::read_to_string(&path).unwrap();
    let renamed = text.replacen("room 1", "salon", 1);
    assert_ne!(text, renamed);
    fs::write(&path, renamed).unwrap();
    assert_eq!(status(&["--export", "svg"]), "labeled");
}
