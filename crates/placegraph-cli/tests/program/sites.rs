//! Sites of several floors: `placegraph site`, and what other commands do with its result.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use crate::running::{done, json, names, placegraph, refused, shipped, stderr};
use tempfile::TempDir;

fn site_file() -> PathBuf {
    shipped("site.toml")
}

/// The example site, made once.
static SITE: LazyLock<TempDir> = LazyLock::new(|| {
    let folder = TempDir::new().unwrap();
    done(&[&"site", &site_file(), &"--out", &folder.path()]);
    folder
});

/// The documents of two folders, without the times of their stages.
fn assert_same_files(a: &Path, b: &Path) {
    assert_eq!(names(a), names(b));
    for name in names(a) {
        let [left, right] = [a, b].map(|folder| {
            let bytes = fs::read(folder.join(&name)).unwrap();
            if name != "topology.json" {
                return bytes;
            }
            let mut document: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
            document.as_object_mut().unwrap().remove("timings_ms");
            document.to_string().into_bytes()
        });
        assert!(left == right, "{name}");
    }
}

#[test]
fn floors_are_labeled_as_their_maps_are() {
    for (level, map) in [("L1", "office/map.yaml"), ("L2", "home/map.yaml")] {
        let alone = TempDir::new().unwrap();
        done(&[&"map", &shipped(map), &"--out", &alone.path()]);
        assert_same_files(&SITE.path().join(level), alone.path());
    }
    let site = json(&SITE.path().join("site.json"));
    assert_eq!(
        site["findings"].as_array().unwrap().len(),
        0,
        "the lifts of the example stand upon each other"
    );
    assert!(done(&[&"verify", &SITE.path()]).lines().all(|line| line.ends_with("complete and unchanged")));
}

#[test]
fn a_route_leads_from_floor_to_floor() {
    let site = json(&SITE.path().join("site.json"));
    let room = |level: usize| {
        let places = site["levels"][level]["places"].as_array().unwrap();
        places.iter().find(|place| place["class"] == "room").unwrap()["name"].as_str().unwrap()
    };
    let (from, to) = (room(0), room(1));
    let text = done(&[&"route", &SITE.path().join("site.json"), &from, &to]);
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], format!("L1: {from}"));
    assert_eq!(lines[lines.len() - 2], format!("L2: {to}"));
    assert_eq!(lines.iter().filter(|line| line.ends_with(": L1 to L2")).count(), 1, "{text}");
    assert!(!text.contains("stairs: "), "{text}");
    // The folder stands for its document; legs have lines.
    let route: serde_json::Value =
        serde_json::from_str(&done(&[&"route", &SITE.path(), &from, &to, &"--json"])).unwrap();
    assert_eq!(route["legs"].as_array().unwrap().len(), 3);
    assert_eq!(lines[lines.len() - 1], format!("{:.2} m", route["length_m"].as_f64().unwrap()));
    refused(&[&"route", &SITE.path(), &"L1 roo", &to], &["\"L1 roo\"", "there are L1 room"]);
}

/// A copy of the example site file with changes, beside links to its maps.
fn changed(folder: &Path, change: impl Fn(String) -> String) -> PathBuf {
    for map in ["home", "office"] {
        fs::create_dir_all(folder.join(map)).unwrap();
        for file in ["map.yaml", "map.png"] {
            fs::copy(shipped(&format!("{map}/{file}")), folder.join(map).join(file)).unwrap();
        }
    }
    let path = folder.join("site.toml");
    fs::write(&path, change(fs::read_to_string(site_file()).unwrap())).unwrap();
    path
}

#[test]
fn what_does_not_fit_is_refused_and_nothing_is_written() {
    let cases: [(&str, &str, &[&str]); 6] = [
        ("L2 = [3.12, 3.86]", "L2 = [0.0, 100.0]", &["lift A on L2", "0 100", "not free", "site.toml"]),
        ("L2 = [3.12, 3.86]", "L3 = [3.12, 3.86]", &["lift A stops on \"L3\"", "there are L1, L2"]),
        ("\"goods lift\"", "\"lift A\"", &["\"lift A\" twice"]),
        ("home/map.yaml", "home/none.yaml", &["level L2", "none.yaml"]),
        ("elevation_m = 3.5", "height = 3.5", &["site.toml", "line 13", "height"]),
        ("home/map.yaml", "home", &["level L2", "expected the file of a map, found the folder"]),
    ];
    for (old, new, words) in cases {
        let folder = TempDir::new().unwrap();
        let site = changed(folder.path(), |text| text.replace(old, new));
        let out = folder.path().join("out");
        refused(&[&"site", &site, &"--out", &out], words);
        assert!(!out.exists(), "{new}");
    }
}

#[test]
fn a_later_run_keeps_names_and_a_floor_of_another_run_is_noticed() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    let edits = "[[edit]]\naction = \"rename\"\nat = [9.52, 2.71]\nname = \"bath\"\n";
    fs::write(folder.path().join("home.toml"), edits).unwrap();
    let with_edits =
        |text: String| text.replace("elevation_m = 3.5", "elevation_m = 3.5\nedits = \"home.toml\"");
    done(&[&"site", &changed(folder.path(), with_edits), &"--out", &out]);
    let name = |site: &serde_json::Value| {
        let places = site["levels"][1]["places"].as_array().unwrap().clone();
        places.iter().any(|place| place["name"] == "bath")
    };
    assert!(name(&json(&out.join("site.json"))));
    // Without the edits, the name is carried over; a level less, and its files of the site go.
    let plain = changed(folder.path(), |text| text);
    let output = placegraph(&[&"site", &plain, &"--out", &out, &"--previous", &out]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(name(&json(&out.join("site.json"))));
    let renamed = changed(folder.path(), |text| text.replace("townhouse", "house"));
    done(&[&"site", &renamed, &"--out", &out]);
    assert!(names(&out).iter().all(|name| !name.contains("townhouse")), "{:?}", names(&out));
    done(&[&"verify", &out]);
    // The floor alone, labeled with other options.
    done(&[&"map", &folder.path().join("home/map.yaml"), &"--out", &out.join("L2"), &"--no-correction"]);
    let output = placegraph(&[&"verify", &out]);
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stdout).contains("L2 is of another run"));
    // A file of somebody else is not replaced.
    let other = folder.path().join("other");
    fs::create_dir(&other).unwrap();
    fs::write(other.join("site.json"), "mine").unwrap();
    refused(&[&"site", &plain, &"--out", &other], &["site.json", "not known to be a result"]);
    assert_eq!(names(&other), ["site.json"], "no floor is written either");
    assert_eq!(fs::read_to_string(other.join("site.json")).unwrap(), "mine");
}

#[test]
fn lifts_that_do_not_stand_upon_each_other_are_an_error_of_the_result() {
    let folder = TempDir::new().unwrap();
    let site = changed(folder.path(), |text| text.replace("L2 = [5.67, 1.86]", "L2 = [9.52, 2.71]"));
    let output = placegraph(&[&"site", &site, &"--out", &folder.path().join("out")]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(stderr(&output).contains("beside where it is on L1"), "{}", stderr(&output));
}
