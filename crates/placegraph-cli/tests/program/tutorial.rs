//! The tutorial of own classes, followed word for word.

use std::fs;
use std::path::Path;
use std::process::Command;

use placegraph::labels::{LabelSet, Role};
use tempfile::TempDir;

use crate::running::{json, shipped, stderr};

/// The lines of the page's shell blocks.
fn commands(page: &str) -> Vec<String> {
    let blocks = page.split("```sh\n").skip(1).filter_map(|rest| rest.split("```").next());
    blocks.flat_map(str::lines).map(str::to_owned).collect()
}

/// The first block of the page of this kind that contains `word`.
fn block<'a>(page: &'a str, kind: &str, word: &str) -> &'a str {
    let start = format!("```{kind}\n");
    let mut blocks = page.split(start.as_str()).skip(1).filter_map(|rest| rest.split("```").next());
    blocks.find(|block| block.contains(word)).unwrap()
}

#[test]
fn every_command_of_the_tutorial_works_as_it_stands() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let page = fs::read_to_string(root.join("docs/tutorial-own-classes.md")).unwrap();
    let folder = TempDir::new().unwrap();
    let home = folder.path().join("maps/home");
    fs::create_dir_all(&home).unwrap();
    for file in fs::read_dir(shipped("home")).unwrap() {
        let file = file.unwrap();
        fs::copy(file.path(), home.join(file.file_name())).unwrap();
    }
    let run = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        assert_eq!(words[0], "placegraph", "{line}");
        let mut command = Command::new(env!("CARGO_BIN_EXE_placegraph"));
        let output = command.args(&words[1..]).current_dir(folder.path()).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{line}: {}", stderr(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    let lines = commands(&page);
    assert_eq!(lines.len(), 6);
    let printed: Vec<String> = lines.iter().map(|line| run(line)).collect();

    // What the page shows of files is what they hold.
    let classes = fs::read_to_string(home.join("five-classes.toml")).unwrap();
    assert_eq!(block(&page, "toml", "kitchen"), classes);
    let training = block(&page, "toml", "[[map]]");
    assert!(training.ends_with(&classes), "{training}");
    fs::write(folder.path().join("training.toml"), training).unwrap();
    run("placegraph train training.toml -o again.model.json");

    let report = fs::read_to_string(folder.path().join("five.html")).unwrap();
    for part in [
        "What is taken for what",
        "Where it is wrong",
        "Would more labels help?",
        "Are the probabilities right?",
    ] {
        assert!(report.contains(part), "{part}");
    }
    assert!(!report.contains("<script") && !report.contains("http"), "one file");

    // Of the painted doorways half at least are found, and what is found is one.
    let judged =
        run("placegraph evaluate five/labels.png maps/home/labels-five.png --resolution 0.05 --json");
    let judged: serde_json::Value = serde_json::from_str(&judged).unwrap();
    assert!(printed[2].contains("kitchen"), "{}", printed[2]);
    let share = |name: &str| judged["doors"][name].as_f64().unwrap();
    assert!(share("recall") >= 0.6 && share("precision") >= 0.75, "{}", judged["doors"]);
    let document = json(&folder.path().join("five/topology.json"));
    let set: LabelSet = serde_json::from_value(document["classes"].clone()).unwrap();
    assert_eq!(set.classes().iter().filter(|class| class.role == Role::Place).count(), 3);
}
