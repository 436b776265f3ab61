//! What is ours belongs together, and a result vouches for itself.

use std::fs;

use placegraph::model::sha256_hex;
use serde_json::Value;
use tempfile::TempDir;

use crate::running::site::{labeled, site, write_map};
use crate::running::{done, json, names, placegraph, refused, stderr};

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
        let bytes = fs::read(out.join(&main)).unwrap();
        assert!(String::from_utf8_lossy(&bytes).contains(hash), "{main} does not name the map");
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
    assert_eq!(text.matches("complete and unchanged").count(), 2, "{text}");

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
