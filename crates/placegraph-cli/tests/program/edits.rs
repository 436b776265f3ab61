//! `list`, `edit` and `map --edits`: an operator corrects what he saw.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::running::{done, json, names, placegraph, refused, shipped, stderr};
use serde_json::Value;
use tempfile::TempDir;

fn label(folder: &Path, edits: Option<&Path>) -> (Value, String) {
    let map = shipped("home/map.yaml");
    let output = match edits {
        Some(edits) => {
            placegraph(&[&"map", &map, &"--out", &folder, &"--edits", &edits, &"--export", &"report"])
        }
        None => placegraph(&[&"map", &map, &"--out", &folder]),
    };
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    (json(&folder.join("topology.json")), stderr(&output))
}

/// Number and name of every place, by a point inside of it.
fn called(document: &Value) -> BTreeMap<String, (u64, String)> {
    let places = document["places"].as_array().unwrap().iter();
    let called =
        places.map(|place| (place["id"].as_u64().unwrap(), place["name"].as_str().unwrap().to_owned()));
    let anchors = document["places"].as_array().unwrap().iter().map(|place| place["anchor"].to_string());
    anchors.zip(called).collect()
}

#[test]
fn edits_written_by_the_program_apply_and_numbers_stay() {
    let out = TempDir::new().unwrap();
    let folder = out.path().join("plain");
    let (before, _) = label(&folder, None);
    let listed: Vec<Value> = serde_json::from_str(&done(&[&"list", &folder, &"--json"])).unwrap();
    assert_eq!(listed.len(), before["places"].as_array().unwrap().len());
    let doorway = listed.iter().find(|place| place["class"] == "doorway").unwrap();
    let rooms: Vec<&str> =
        listed.iter().filter(|p| p["class"] == "room").map(|p| p["name"].as_str().unwrap()).collect();
    let text = done(&[&"list", &folder]);
    assert!(text.contains(rooms[0]) && text.contains(" m wide, between "), "{text}");

    let file = out.path().join("edits.toml");
    fs::write(&file, "# the operator's own words\n").unwrap();
    let edit = |words: &[&str]| {
        let mut args: Vec<&dyn AsRef<std::ffi::OsStr>> = vec![&"edit"];
        args.extend(words.iter().map(|word| word as &dyn AsRef<std::ffi::OsStr>));
        args.extend([&"--file" as &dyn AsRef<_>, &file, &"--result", &folder]);
        done(&args)
    };
    edit(&["rename", rooms[0], "kitchen \"1\""]);
    edit(&["remove-doorway", doorway["name"].as_str().unwrap()]);
    edit(&["exclude", rooms[1]]);
    // The options after names and after points with negative coordinates are options.
    let merged = out.path().join("merge.toml");
    let at =
        |name: &str| before["places"].as_array().unwrap().iter().find(|p| p["name"] == name).unwrap().clone();
    let point = format!("{},{}", at(rooms[3])["anchor"]["x"], at(rooms[3])["anchor"]["y"]);
    done(&[&"edit", &"rename", &rooms[1], &"pantry", &"--file", &merged, &"--result", &folder]);
    done(&[&"edit", &"exclude", &"pantry", &"--file", &merged, &"--result", &folder]);
    done(&[&"edit", &"merge", &rooms[2], &point, &"--file", &merged, &"--result", &folder]);
    done(&[&"edit", &"merge", &"-1.5,-2", &"-3,4", &"--file", &merged]);
    let written = fs::read_to_string(&merged).unwrap();
    assert!(written.contains(&format!("# {}\n", rooms[2])) && !written.contains("--"), "{written}");
    assert!(
        written.contains("action = \"exclude\"\nat = \"pantry\""),
        "an earlier edit gives this name: {written}"
    );
    assert!(written.contains("at = [[-1.5, -2.0], [-3.0, 4.0]]"), "{written}");
    let written = fs::read_to_string(&file).unwrap();
    assert!(written.starts_with("# the operator's own words\n"), "{written}");
    assert!(written.contains(&format!("# {}\n[[edit]]\naction = \"rename\"\nat = [", rooms[0])), "{written}");
    assert_eq!(names(out.path()), ["edits.toml", "merge.toml", "plain"], "nothing else is left");

    let (after, told) = label(&out.path().join("edited"), Some(&file));
    assert_eq!(told.matches("does not apply").count(), 0, "{told}");
    assert!(told.contains(&format!("edit 1: rename: {} became kitchen \"1\"", rooms[0])), "{told}");
    let (before, after) = (called(&before), called(&after));
    assert_eq!(after.len(), before.len() - 2);
    for (anchor, (id, name)) in &after {
        // The neighbor of the removed doorway may have its middle elsewhere now.
        let Some((old_id, old_name)) = before.get(anchor) else { continue };
        assert_eq!(id, old_id);
        assert!(name == old_name || name == "kitchen \"1\"", "{name} {old_name}");
    }
}

#[test]
fn a_wall_and_an_opening_change_the_map_and_nothing_else() {
    let out = TempDir::new().unwrap();
    let (before, _) = label(&out.path().join("plain"), None);
    let doorway =
        before["places"].as_array().unwrap().iter().find(|place| place["class"] == "doorway").unwrap();
    let jambs = &doorway["doorway"]["jambs"];
    let line = format!("{}, {}, {}, {}", jambs[0]["x"], jambs[0]["y"], jambs[1]["x"], jambs[1]["y"]);
    let line = line.replace(' ', "");
    let file = out.path().join("edits.toml");
    done(&[&"edit", &"close", &line, &"--file", &file]);
    let (after, told) = label(&out.path().join("closed"), Some(&file));
    assert!(told.contains("edit 1: close, along ("), "{told}");
    let (before, after) = (called(&before), called(&after));
    let kept = after.iter().filter(|(anchor, called)| before.get(*anchor) == Some(called)).count();
    assert!(kept * 10 >= before.len() * 7, "most places are what they were: {kept} of {}", before.len());
    assert!(
        after.values().all(|(_, name)| Some(name.as_str()) != doorway["name"].as_str()),
        "the doorway is closed"
    );
}

#[test]
fn what_cannot_be_written_leaves_the_file_as_it_was() {
    let out = TempDir::new().unwrap();
    let folder = out.path().join("plain");
    label(&folder, None);
    let file: PathBuf = out.path().join("edits.toml");
    refused(&[&"edit", &"rename", &"hall", &"x", &"--file", &file, &"--result", &folder], &["hall", "room"]);
    refused(&[&"edit", &"rename", &"1,2", &"a/b", &"--file", &file], &["edit 1", "'/'"]);
    refused(
        &[&"edit", &"relabel", &"1,2", &"garage", &"--file", &file, &"--result", &folder],
        &["garage", "corridor"],
    );
    assert!(!file.exists());
    fs::write(&file, "[[edit]]\naction = 'paint'\n").unwrap();
    refused(&[&"edit", &"exclude", &"1,2", &"--file", &file], &["edits.toml", "paint"]);
    assert_eq!(fs::read_to_string(&file).unwrap(), "[[edit]]\naction = 'paint'\n");
    refused(&[&"list", &out.path().join("nothing")], &["nothing"]);
}
