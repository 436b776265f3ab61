//! Many label images against their truths.

use std::fs;

use tempfile::TempDir;

use crate::running::{done, placegraph, refused, shipped, stderr};

#[test]
fn folders_are_judged_map_by_map_and_together() {
    let out = TempDir::new().unwrap();
    let results = out.path().join("results");
    for (map, labels_of) in [("home", "home"), ("office", "office")] {
        fs::create_dir_all(results.join(map)).unwrap();
        let labels = shipped(labels_of).join("labels.png");
        fs::copy(labels, results.join(map).join("labels.png")).unwrap();
    }
    let (truth, csv) = (shipped(""), out.path().join("table.csv"));
    let text = done(&[&"evaluate", &results, &truth, &"--csv", &csv]);
    assert!(
        text.contains("mean") && text.contains("0.8 to 1.2 m") && text.contains("corridor / room"),
        "{text}"
    );
    let table = fs::read_to_string(&csv).unwrap();
    let rows: Vec<&str> = table.lines().collect();
    assert_eq!(rows.len(), 3, "a header and two maps: {table}");
    assert!(rows[1].starts_with("home,1,1,1,1,") && rows[2].starts_with("office,1,1,1,1,"), "{table}");

    let report = done(&[&"evaluate", &results, &truth, &"--json"]);
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["means"]["door_recall"], 1.0);
    let doors = |of: &serde_json::Value| of["doors"]["n_true"].as_u64().unwrap();
    let maps = report["maps"].as_array().unwrap();
    assert_eq!(doors(&report["together"]), maps.iter().map(doors).sum::<u64>());
    assert!(doors(&maps[0]) > 2, "{report}");

    // One map alone, with the resolution that its map.yaml says.
    let (prediction, labels) = (results.join("home/labels.png"), shipped("home/labels.png"));
    let yaml = fs::read_to_string(shipped("home/map.yaml")).unwrap();
    let resolution = yaml.lines().find_map(|line| line.strip_prefix("resolution: ")).unwrap().to_owned();
    let one = done(&[&"evaluate", &prediction, &labels, &"--resolution", &resolution, &"--json"]);
    let one: serde_json::Value = serde_json::from_str(&one).unwrap();
    assert_eq!(one["doors"], maps[0]["doors"]);
}

#[test]
fn a_map_without_a_result_fails_the_check_and_is_named() {
    let out = TempDir::new().unwrap();
    let home = out.path().join("home");
    fs::create_dir_all(&home).unwrap();
    fs::copy(shipped("home/labels.png"), home.join("labels.png")).unwrap();
    let output = placegraph(&[&"evaluate", &out.path(), &shipped(""), &"--json"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("office: no labels.png"), "{}", stderr(&output));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["missing"], serde_json::json!(["office"]));

    let empty = TempDir::new().unwrap();
    refused(&[&"evaluate", &empty.path(), &shipped("")], &["expected results", "found none"]);
    refused(&[&"evaluate", &out.path(), &empty.path()], &["expected folders with labels.png", "found none"]);
    let image = home.join("labels.png");
    refused(&[&"evaluate", &image, &shipped("")], &["expected a folder of results"]);
    refused(
        &[&"evaluate", &image, &image, &"--csv", &empty.path().join("t.csv")],
        &["--csv works for folders"],
    );
    refused(&[&"evaluate", &image, &image, &"--resolution", &"0"], &["resolution above 0"]);
}

/// A folder of results called `name` in which `change` was made to the labels of every shipped map.
fn results(folder: &TempDir, name: &str, change: impl Fn(usize, u8) -> u8) -> std::path::PathBuf {
    let out = folder.path().join(name);
    for map in ["home", "office"] {
        fs::create_dir_all(out.join(map)).unwrap();
        let mut image = image::open(shipped(map).join("labels.png")).unwrap().into_luma8();
        image.iter_mut().enumerate().for_each(|(n, pixel)| *pixel = change(n, *pixel));
        image.save(out.join(map).join("labels.png")).unwrap();
    }
    out
}

#[test]
fn two_methods_are_compared_map_by_map() {
    let folder = TempDir::new().unwrap();
    let good = results(&folder, "good", |_, label| label);
    let bad = results(&folder, "bad", |n, label| if n % 10 == 0 && label == 2 { 1 } else { label });
    let truth = shipped("");
    let report = done(&[&"evaluate", &good, &truth, &"--against", &bad, &"--json"]);
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    let comparison = &report["comparison"];
    assert_eq!(comparison["n_maps"], 2);
    let accuracy = &comparison["measures"][0];
    assert_eq!((accuracy["measure"].as_str(), accuracy["n_more"].as_u64()), (Some("accuracy"), Some(2)));
    // Two maps, both better: two of four choices of signs are as far out.
    assert!((accuracy["p_value"].as_f64().unwrap() - 0.5).abs() < 1e-9, "{accuracy}");
    assert!(accuracy["mean_difference"].as_f64().unwrap() > 0.05, "{accuracy}");
    let text = done(&[&"evaluate", &good, &truth, &"--against", &good]);
    assert!(text.contains("Wilcoxon") && text.contains("1.0000"), "{text}");
    refused(
        &[&"evaluate", &good, &truth, &"--against", &truth.join("home/labels.png")],
        &["folder of results"],
    );
}

#[test]
fn classes_come_from_the_files_next_to_the_prediction() {
    let folder = TempDir::new().unwrap();
    let file = |name: &str| folder.path().join(name);
    let (five, classes) = (shipped("home/labels-five.png"), shipped("home/five-classes.toml"));
    // Without a word about them, the colors are unknown; with the file of classes they are not.
    refused(&[&"evaluate", &five, &five], &["found", "expected one of"]);
    let told = done(&[&"evaluate", &five, &five, &"--classes", &classes]);
    assert!(told.contains("kitchen") && told.contains("stairs"), "{told}");
    // The YAML file of a label image names its classes, in order.
    let yaml = "image: \"labels.png\"\nmode: raw\nresolution: 0.05\norigin: [0.0, 0.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n\
        free_thresh: 0.196\nclasses: [{\"name\": \"hall\", \"role\": \"place\", \"color\": [1, 2, 3]}, \
        {\"name\": \"way\", \"role\": \"passage\", \"color\": [3, 2, 1]}]\n";
    fs::write(file("labels.yaml"), yaml).unwrap();
    fs::write(file("labels.png"), image_of(&[1, 2, 2, 0])).unwrap();
    let report = done(&[&"evaluate", &file("labels.png"), &file("labels.png"), &"--json"]);
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["cells"]["classes"][1]["name"], "way");
    assert_eq!(report["cells"]["n_cells"], 3);
    // The truth may be painted in colors that a file of classes tells; the result goes on telling its own values.
    let colors = "[classes]\nhall = { color = [9, 9, 200], role = \"place\" }\nway = { color = [200, 9, 9], role = \"passage\" }\n";
    fs::write(file("colors.toml"), colors).unwrap();
    let painted = [[9, 9, 200], [200, 9, 9], [9, 9, 200], [0, 0, 0]].concat();
    image::RgbImage::from_raw(4, 1, painted).unwrap().save(file("painted.png")).unwrap();
    let arguments: [&dyn AsRef<std::ffi::OsStr>; 5] =
        [&"evaluate", &file("labels.png"), &file("painted.png"), &"--classes", &file("colors.toml")];
    let told = done(&arguments);
    assert!(told.contains("66.67 %"), "two of three cells: {told}");
    // Each value that a class may have is told once.
    let known = stderr(&placegraph(&[&"evaluate", &five, &five, &"--classes", &file("colors.toml")]));
    assert_eq!(known.matches("color [9, 9, 200]").count(), 1, "{known}");
}

/// A gray image of one row.
fn image_of(values: &[u8]) -> Vec<u8> {
    let image = image::GrayImage::from_raw(values.len() as u32, 1, values.to_vec()).unwrap();
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}
