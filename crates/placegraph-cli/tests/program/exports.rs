//! What is made of a result: other programs' formats, answers to questions, names that last, edits.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use crate::running::{done, json, names, placegraph, refused, shipped, stderr};
use placegraph::export::FORMATS;
use serde_json::Value;
use tempfile::TempDir;

fn home() -> PathBuf {
    shipped("home/map.yaml")
}

/// The example home with all exports, labeled once.
static RESULT: LazyLock<TempDir> = LazyLock::new(|| {
    let folder = TempDir::new().unwrap();
    done(&[&"map", &home(), &"--out", &folder.path(), &"--export", &"all"]);
    folder
});

fn topology() -> PathBuf {
    RESULT.path().join("topology.json")
}

fn places(document: &Value) -> &Vec<Value> {
    document["places"].as_array().unwrap()
}

/// The first place with this class.
fn place_of<'a>(document: &'a Value, class: &str) -> &'a Value {
    places(document).iter().find(|place| place["class"] == class).unwrap()
}

fn anchor(place: &Value) -> String {
    format!("{},{}", place["anchor"]["x"], place["anchor"]["y"])
}

fn in_toml(place: &Value) -> String {
    format!("[{}]", anchor(place))
}

#[test]
fn map_and_export_write_the_same_files() {
    let out = TempDir::new().unwrap();
    let document = json(&topology());
    let listed: Vec<&str> =
        document["files"].as_array().unwrap().iter().map(|file| file["name"].as_str().unwrap()).collect();
    for format in FORMATS {
        let folder = out.path().join(format.name);
        fs::create_dir(&folder).unwrap();
        done(&[&"export", &topology(), &"--to", &format.name, &"-o", &folder]);
        let files = format.file_names(&format.usual_name(document["map"]["name"].as_str().unwrap())).unwrap();
        let mut expected = files.clone();
        expected.sort_unstable();
        assert_eq!(names(&folder), expected, "{}", format.name);
        assert!(files.iter().all(|file| listed.contains(&file.as_str())), "{} of {listed:?}", format.name);
        for file in files {
            let [with, from] = [RESULT.path(), &folder].map(|folder| fs::read(folder.join(&file)).unwrap());
            assert!(!with.is_empty());
            // A document does not hold the report's pictures.
            if !format.needs_cells {
                assert!(with == from, "{file} differs");
            }
        }
    }
    let page = |map: &[&dyn AsRef<std::ffi::OsStr>]| {
        let path = out.path().join("report.html");
        done(
            &[
                &[&"export" as &dyn AsRef<std::ffi::OsStr>, &topology(), &"--to", &"report", &"-o", &path],
                map,
            ]
            .concat(),
        );
        fs::read_to_string(path).unwrap()
    };
    assert!(!page(&[]).contains("data:image/png"));
    assert!(page(&[&"--map", &home()]).contains("data:image/png"));
}

#[test]
fn a_format_that_cannot_hold_a_map_is_skipped_and_told() {
    let folder = TempDir::new().unwrap();
    let path = |name: &str| folder.path().join(name);
    let is_wall = |i: usize| !(40..1160).contains(&i) || i.is_multiple_of(40) || i % 40 == 39;
    let pixel = |i: usize| if is_wall(i) { 0 } else { 254 };
    fs::write(path("room.pgm"), [b"P5\n40 30\n255\n".to_vec(), (0..1200).map(pixel).collect()].concat())
        .unwrap();
    let room = path("room.pgm");
    let map: [&dyn AsRef<std::ffi::OsStr>; 6] =
        [&"map", &room, &"--resolution", &"0.1", &"--export", &"nav2,dot"];
    let out = path("out");
    let output = placegraph(&[&map[..], &[&"--out", &out]].concat());
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(stderr(&output).contains("nav2 is skipped: "), "{}", stderr(&output));
    let found = names(&out);
    assert!(found.contains(&"graph.dot".to_owned()) && found.contains(&"topology.json".to_owned()));
    assert!(!found.contains(&"route_graph.geojson".to_owned()), "{found:?}");
    let skipped = json(&out.join("topology.json"))["skipped"].clone();
    assert_eq!(skipped[0]["format"], "nav2");
    assert!(skipped[0]["reason"].as_str().unwrap().contains("route"), "{skipped}");

    let both = path("both");
    let office = shipped("office/map.yaml");
    let many = [&map[..2], &[&office as &dyn AsRef<std::ffi::OsStr>], &map[4..], &[&"--out", &both]].concat();
    let many = [&many[..], &[&"--resolution", &"0.1"]].concat();
    assert_eq!(placegraph(&many).status.code(), Some(1));
    assert!(both.join("office/route_graph.geojson").exists());
    let table = fs::read_to_string(both.join("summary.csv")).unwrap();
    assert!(table.contains("labeled") && table.contains("nav2 is skipped"), "{table}");
    let again = placegraph(&[&many[..], &[&"--resume"]].concat());
    assert_eq!(again.status.code(), Some(1), "what stays tells the same: {}", stderr(&again));
    let table = fs::read_to_string(both.join("summary.csv")).unwrap();
    assert!(table.contains("kept") && table.contains("nav2 is skipped"), "{table}");
}

#[test]
fn a_mask_may_have_another_name_and_other_values() {
    let out = TempDir::new().unwrap();
    let masks = out.path().join("masks.toml");
    fs::write(&masks, "[keepout]\nelsewhere = 7\ncost = { class = { room = 42 } }\n").unwrap();
    let path = out.path().join("forbidden.yaml");
    done(&[&"export", &topology(), &"--to", &"nav2-keepout", &"-o", &path, &"--masks", &masks]);
    assert_eq!(names(out.path()), ["forbidden.png", "forbidden.yaml", "forbidden_params.yaml", "masks.toml"]);
    assert!(fs::read_to_string(path).unwrap().contains("forbidden.png"));
    assert_ne!(
        fs::read(out.path().join("forbidden.png")).unwrap(),
        fs::read(RESULT.path().join("keepout.png")).unwrap()
    );
}

#[test]
fn what_cannot_be_exported_is_refused_and_nothing_is_written() {
    let out = TempDir::new().unwrap();
    let path = |name: &str| out.path().join(name);
    let yaml = fs::read_to_string(home()).unwrap();
    let turned =
        yaml.lines().map(|line| if line.starts_with("origin") { "origin: [1, 2, 0.3]" } else { line });
    fs::write(path("map.yaml"), turned.collect::<Vec<_>>().join("\n")).unwrap();
    fs::copy(shipped("home/map.png"), path("map.png")).unwrap();
    done(&[&"map", &path("map.yaml"), &"--out", &path("turned")]);
    fs::copy(path("turned/topology.json"), path("turned.json")).unwrap();
    let mut document = json(&topology());
    document["connections"] = Value::Array(Vec::new());
    document["shortcuts"] = Value::Array(Vec::new());
    fs::write(path("lonely.json"), document.to_string()).unwrap();
    fs::write(path("masks.toml"), "[keepout]\ncost = { class = { garage = 1 } }\n").unwrap();
    fs::write(path("resample.toml"), "rotated = 'resample'\n").unwrap();
    let before = names(out.path());

    let (mask, graph) = (path("mask.yaml"), path("graph.geojson"));
    refused(
        &[&"export", &path("turned.json"), &"--to", &"nav2-keepout", &"-o", &mask],
        &["mask.yaml", "is rotated by 0.3 rad"],
    );
    refused(&[&"export", &topology(), &"--to", &"nav2-keepout", &"-o", &path("mask.png")], &[".yaml"]);
    refused(&[&"export", &path("lonely.json"), &"--to", &"nav2", &"-o", &graph], &["route"]);
    refused(&[&"export", &path("gone.json"), &"--to", &"nav2", &"-o", &graph], &["gone.json"]);
    refused(&[&"export", &path("masks.toml"), &"--to", &"nav2", &"-o", &graph], &["masks.toml"]);
    let keepout: [&dyn AsRef<std::ffi::OsStr>; 7] =
        [&"export", &topology(), &"--to", &"nav2-keepout", &"-o", &mask, &"--masks"];
    refused(&[&keepout[..], &[&path("masks.toml")]].concat(), &["garage"]);
    refused(&[&keepout[..], &[&path("gone.toml")]].concat(), &["gone.toml"]);
    let report: [&dyn AsRef<std::ffi::OsStr>; 8] =
        [&"export", &topology(), &"--to", &"report", &"-o", &graph, &"--map", &shipped("office/map.yaml")];
    refused(&report, &["hash"]);
    // One of the same size, of which a single cell differs.
    let other = path("other");
    fs::create_dir(&other).unwrap();
    fs::copy(home(), other.join("map.yaml")).unwrap();
    let mut image = image::open(shipped("home/map.png")).unwrap().to_luma8();
    let pixel = image.get_pixel_mut(0, 0);
    pixel.0[0] = if pixel.0[0] == 0 { 254 } else { 0 };
    image.save(other.join("map.png")).unwrap();
    let other_map = other.join("map.yaml");
    let report = [&report[..7], &[&other_map as &dyn AsRef<std::ffi::OsStr>]].concat();
    refused(&report, &["expected the map", "hash"]);
    fs::remove_dir_all(&other).unwrap();
    assert_eq!(names(out.path()), before);

    let turned = path("turned.json");
    done(&[&"export", &turned, &"--to", &"nav2-keepout", &"-o", &mask, &"--masks", &path("resample.toml")]);
    assert!(path("mask.png").exists());
}

#[test]
fn where_names_the_place_and_the_two_sides_of_a_doorway() {
    let document = json(&topology());
    for class in ["room", "doorway"] {
        let place = place_of(&document, class);
        let text = done(&[&"where", &topology(), &"--at", &format!("{},map", anchor(place))]);
        assert!(
            text.starts_with(&format!(
                "{} ({class}, number {}",
                place["name"].as_str().unwrap(),
                place["id"]
            )),
            "{text}"
        );
        let answer: Value =
            serde_json::from_str(&done(&[&"where", &topology(), &"--at", &anchor(place), &"--json"]))
                .unwrap();
        assert_eq!((&answer["inside"], &answer["place"]["id"]), (&true.into(), &place["id"]));
        assert_eq!(answer["place"]["probability"], place["probability"]);
        let (found, expected) =
            (answer["border_m"].as_f64().unwrap(), place["clearance_m"].as_f64().unwrap());
        assert!((found - expected).abs() < 1e-3, "the anchor's clearance, {expected}: {found}");
        if class == "doorway" {
            let sides = answer["place"]["sides"].as_array().unwrap();
            let ids: Vec<&Value> = sides.iter().map(|side| &side["id"]).collect();
            assert_eq!(ids, place["doorway"]["sides"].as_array().unwrap().iter().take(2).collect::<Vec<_>>());
            assert!(text.contains("between "), "{text}");
        }
    }
    let outside = done(&[&"where", &topology(), &"--at", &"1e4,0"]);
    assert!(outside.starts_with("outside of all places; "), "{outside}");
    refused(&[&"where", &topology(), &"--at", &"1,1,odom"], &["odom", "map"]);
}

#[test]
fn route_tells_the_places_on_the_way() {
    let document = json(&topology());
    let connection =
        document["connections"].as_array().unwrap().iter().find(|c| c["route"].is_object()).unwrap();
    let name = |id: &Value| {
        places(&document).iter().find(|place| place["id"] == *id).unwrap()["name"]
            .as_str()
            .unwrap()
            .to_owned()
    };
    let (a, b) = (&connection["a"], &connection["b"]);
    let text = done(&[&"route", &topology(), &name(a), &b.to_string()]);
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!((lines[0], lines[lines.len() - 2]), (name(a).as_str(), name(b).as_str()));
    let answer: Value =
        serde_json::from_str(&done(&[&"route", &topology(), &a.to_string(), &b.to_string(), &"--json"]))
            .unwrap();
    let (found, direct) =
        (&answer["length_m"].as_f64().unwrap(), connection["route"]["length_m"].as_f64().unwrap());
    assert!(*found > 0.0 && *found <= direct + 1e-6, "{found} of {direct}");
    assert!(answer["line"].as_array().unwrap().len() > 1);
    refused(&[&"route", &topology(), &"nowhere", &"1"], &["nowhere"]);
}

#[test]
fn numbers_and_names_last_and_the_region_image_follows() {
    let out = TempDir::new().unwrap();
    let mut earlier = json(&topology());
    // Other numbers and names than the map would get by itself.
    for place in earlier["places"].as_array_mut().unwrap() {
        place["id"] = (place["id"].as_u64().unwrap() + 40).into();
        place["name"] = format!("named {}", place["id"]).into();
        for side in place.pointer_mut("/doorway/sides").and_then(Value::as_array_mut).into_iter().flatten() {
            *side = (side.as_u64().unwrap() + 40).into();
        }
    }
    for (member, ends) in [("connections", &["a", "b"][..]), ("shortcuts", &["within", "a", "b"])] {
        for way in earlier[member].as_array_mut().unwrap() {
            for &end in ends {
                way[end] = (way[end].as_u64().unwrap() + 40).into();
            }
        }
    }
    let previous = out.path().join("previous.json");
    fs::write(&previous, earlier.to_string()).unwrap();
    let folder = out.path().join("again");
    let changes = done(&[&"map", &home(), &"--out", &folder, &"--previous", &previous]);
    assert_eq!(changes, "");
    let document = json(&folder.join("topology.json"));
    for member in ["places", "connections", "shortcuts"] {
        assert_eq!(document[member], earlier[member]);
    }
    let ids = |folder: &Path| {
        let image = image_values(&folder.join("regions.png"));
        let mut ids: Vec<u32> = image.into_iter().filter(|&id| id > 0).collect();
        ids.sort_unstable();
        ids.dedup();
        ids
    };
    assert_eq!(ids(&folder), ids(RESULT.path()).iter().map(|id| id + 40).collect::<Vec<_>>());

    // A place less: it was not there before.
    let gone = earlier["places"].as_array_mut().unwrap().pop().unwrap();
    let refers = |connection: &Value| connection["a"] == gone["id"] || connection["b"] == gone["id"];
    earlier["connections"].as_array_mut().unwrap().retain(|connection| !refers(connection));
    for place in earlier["places"].as_array_mut().unwrap() {
        if let Some(sides) = place.pointer_mut("/doorway/sides").and_then(Value::as_array_mut) {
            sides.retain(|side| *side != gone["id"]);
        }
    }
    fs::write(&previous, earlier.to_string()).unwrap();
    let changes = done(&[&"map", &home(), &"--out", &folder, &"--previous", &previous]);
    assert_eq!(changes.lines().count(), 1, "{changes}");
    assert!(changes.starts_with("appeared: "), "{changes}");
    refused(
        &[&"map", &home(), &shipped("office/map.yaml"), &"--out", &folder, &"--previous", &previous],
        &["the folder of an earlier run"],
    );
}

fn image_values(path: &Path) -> Vec<u32> {
    let bytes = fs::read(path).unwrap();
    let size = placegraph::import::image_size(&bytes, 1 << 24).unwrap();
    placegraph::import::read_rooms(&bytes, size).unwrap().values().iter().map(|&id| id.into()).collect()
}

#[test]
fn edits_are_replayed_and_what_does_not_apply_is_told() {
    let out = TempDir::new().unwrap();
    let before = json(&topology());
    let (room, doorway) = (place_of(&before, "room"), place_of(&before, "doorway"));
    let edits = out.path().join("edits.toml");
    fs::write(
        &edits,
        format!(
            "[[edit]]\naction = 'rename'\nat = {}\nname = 'kitchen'\n\
             [[edit]]\naction = 'rename'\nat = [1e4, 0.0]\nname = 'nowhere'\n\
             [[edit]]\naction = 'remove_doorway'\nat = {}\n",
            in_toml(room),
            in_toml(doorway)
        ),
    )
    .unwrap();
    let folder = out.path().join("edited");
    let output = placegraph(&[&"map", &home(), &"--out", &folder, &"--edits", &edits]);
    assert_eq!(output.status.code(), Some(1), "an edit does not apply: {}", stderr(&output));
    let told: Vec<String> =
        stderr(&output).lines().filter(|line| line.contains("does not apply")).map(str::to_owned).collect();
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].contains("edit 2") && told[0].contains("no free cell"), "{told:?}");

    let after = json(&folder.join("topology.json"));
    assert_eq!(places(&after).len(), places(&before).len() - 1);
    let kitchen = done(&[&"where", &folder.join("topology.json"), &"--at", &anchor(room)]);
    assert!(kitchen.starts_with("kitchen (room"), "{kitchen}");
    assert!(
        after["findings"]
            .as_array()
            .unwrap()
            .iter()
            .any(|finding| finding.as_str().unwrap().contains("edit 2"))
    );
    assert_eq!(after["errors"].as_array().unwrap().len(), 1);

    // Edited and carried over: the name by hand stays, and nothing is new.
    let again = out.path().join("again");
    let previous = folder.join("topology.json");
    let output =
        placegraph(&[&"map", &home(), &"--out", &again, &"--edits", &edits, &"--previous", &previous]);
    assert_eq!((output.status.code(), output.stdout.as_slice()), (Some(1), &b""[..]));
    assert_eq!(json(&again.join("topology.json"))["places"], after["places"]);
    fs::write(&edits, "[[edit]]\naction = 'paint'\n").unwrap();
    refused(&[&"map", &home(), &"--out", &again, &"--edits", &edits], &["edits.toml", "paint"]);
}

#[test]
fn shells_and_manuals_know_the_arguments() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = done(&[&"completions", &shell]);
        assert!(script.contains("placegraph") && script.contains("resume"), "{shell}");
    }
    assert!(done(&[&"man"]).contains(".TH placegraph"));
    let page = done(&[&"man", &"map"]);
    let head = page.lines().find(|line| line.starts_with(".TH")).unwrap();
    assert!(head.contains("placegraph-map") && head.contains(env!("CARGO_PKG_VERSION")), "{head}");
    assert!(page.contains("previous"));
    refused(&[&"man", &"fly"], &["fly"]);
}
