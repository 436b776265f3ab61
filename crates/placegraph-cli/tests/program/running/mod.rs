//! Runs the program.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests")]
#![allow(dead_code, reason = "every test file uses a part of it")]

pub(crate) mod site;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

/// A file of the example maps.
pub(crate) fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../maps").join(name)
}

/// Runs the program.
pub(crate) fn placegraph(args: &[&dyn AsRef<std::ffi::OsStr>]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_placegraph"));
    for arg in args {
        command.arg(arg);
    }
    command.output().expect("the program starts")
}

/// Runs the program to success with what a variable of the process says.
#[track_caller]
pub(crate) fn done_with(variable: (&str, &str), args: &[&dyn AsRef<std::ffi::OsStr>]) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_placegraph"));
    let output = command.env(variable.0, variable.1).args(args).output().expect("the program starts");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}

/// Begins to label `maps` into folders of `out`; what the program tells goes nowhere.
pub(crate) fn start_batch(maps: &[PathBuf], out: &Path) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_placegraph"));
    command.args(["map", "--out"]).arg(out).args(maps).stderr(Stdio::null());
    command.spawn().expect("the program starts")
}

/// What the program told people.
pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Runs the program to success and returns what it printed.
#[track_caller]
pub(crate) fn done(args: &[&dyn AsRef<std::ffi::OsStr>]) -> String {
    let output = placegraph(args);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    String::from_utf8(output.stdout).expect("results are text")
}

/// The program refuses with status 2 and one message that has all `words`.
#[track_caller]
pub(crate) fn refused(args: &[&dyn AsRef<std::ffi::OsStr>], words: &[&str]) {
    let output = placegraph(args);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{message}");
    let errors = message.lines().filter(|line| line.starts_with("error:")).count();
    assert_eq!(errors, 1, "one error, found: {message}");
    for word in words {
        assert!(message.contains(word), "expected {word:?} in: {message}");
    }
    assert!(!message.contains("panicked"), "{message}");
}

/// The files in a folder.
pub(crate) fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// A JSON file.
pub(crate) fn json(path: &Path) -> serde_json::Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}
