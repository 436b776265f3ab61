//! A new mapping session begins elsewhere: its map is turned and shifted.

use std::fs;

use crate::running::{done, json, placegraph, refused, shipped, stderr};
use serde_json::Value;
use tempfile::TempDir;

fn places(document: &Value) -> &Vec<Value> {
    document["places"].as_array().unwrap()
}

fn anchor(place: &Value) -> [f64; 2] {
    ["x", "y"].map(|axis| place["anchor"][axis].as_f64().unwrap())
}

#[test]
fn names_are_kept_from_another_frame_only_if_it_is_aligned() {
    let out = TempDir::new().unwrap();
    let path = |name: &str| out.path().join(name);
    // The picture turned by a quarter, its origin somewhere.
    let picture = image::open(shipped("home/map.png")).unwrap().into_luma8();
    image::imageops::rotate90(&picture).save(path("turned.png")).unwrap();
    let yaml = fs::read_to_string(shipped("home/map.yaml")).unwrap();
    let lines = yaml.lines().map(|line| match line.split_once(':') {
        Some(("image", _)) => "image: turned.png".to_owned(),
        Some(("origin", _)) => "origin: [-20.0, 5.0, 0.0]".to_owned(),
        _ => line.to_owned(),
    });
    fs::write(path("turned.yaml"), lines.collect::<Vec<_>>().join("\n")).unwrap();
    done(&[&"map", &shipped("home/map.yaml"), &"--out", &path("old")]);
    let previous = path("old/topology.json");
    let old = json(&previous);

    // As it is: nothing is handed out, and that is an error.
    let output =
        placegraph(&[&"map", &path("turned.yaml"), &"--out", &path("wrong"), &"--previous", &previous]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(stderr(&output).contains("do not agree"), "{}", stderr(&output));
    let highest = places(&old).iter().map(|place| place["id"].as_u64().unwrap()).max().unwrap();
    let wrong = json(&path("wrong/topology.json"));
    assert!(places(&wrong).iter().all(|place| place["id"].as_u64().unwrap() > highest));

    let found: Value =
        serde_json::from_str(&done(&[&"align", &path("old"), &path("wrong"), &"--json"])).unwrap();
    let pose = |key: &str| found["new_from_old"][key].as_f64().unwrap();
    let (sin, cos) = pose("yaw_rad").sin_cos();
    // Turned clockwise.
    assert!((sin + 1.0).abs() < 1e-3 && cos.abs() < 0.02 && found["certain"] == true, "{found}");

    let aligned = [&"map" as &dyn AsRef<std::ffi::OsStr>, &path("turned.yaml"), &"--out", &path("right")];
    let output = placegraph(&[aligned.as_slice(), &[&"--previous", &previous, &"--align"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let right = json(&path("right/topology.json"));
    let mut n_kept = 0;
    for place in places(&right) {
        let Some(before) = places(&old).iter().find(|before| before["id"] == place["id"]) else { continue };
        let ([x, y], [there_x, there_y]) = (anchor(before), anchor(place));
        let (x, y) = (pose("x") + x * cos - y * sin, pose("y") + x * sin + y * cos);
        // The same room: its middle may move a little, but not into another.
        assert!((x - there_x).hypot(y - there_y) < 1.5, "{} {}", before["name"], place["name"]);
        n_kept += usize::from(place["name"] == before["name"]);
    }
    assert!(n_kept * 10 >= places(&old).len() * 8, "{n_kept} of {}", places(&old).len());

    refused(&[&"map", &path("turned.yaml"), &"--out", &path("x"), &"--align"], &["--previous"]);
}

#[test]
fn another_building_is_not_aligned() {
    let out = TempDir::new().unwrap();
    for name in ["home", "office"] {
        done(&[&"map", &shipped(&format!("{name}/map.yaml")), &"--out", &out.path().join(name)]);
    }
    let output = placegraph(&[&"align", &out.path().join("home"), &out.path().join("office")]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("not certain"), "{}", stderr(&output));
}
