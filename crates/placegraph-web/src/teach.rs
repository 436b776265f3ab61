//! Maps that somebody painted: the training file and label images that the program reads, and the model that comes of them.
//!
//! Training reads the very files that are handed out, so that the program learns the same from them.

use placegraph::import::{LabelCell, LoadedMap, TrainingFile, read_labels};
use placegraph::labels::{Class, Role};
use placegraph::learning::learn;
use placegraph::progress::Progress;
use placegraph::training::{LabeledMap, TrainConfig, Trained};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::session::{Answer, in_words, load};

const TRAINING_FILE: &str = "training.toml";
const LABELS: &str = "labels.png";

/// What somebody painted: maps, each with one class of `classes` per cell.
#[derive(Debug, Deserialize)]
pub(crate) struct Painted {
    maps: Vec<PaintedMap>,
    classes: Vec<Class>,
}

/// A painted map. Its byte strings are its files, then a byte per cell, first row on top: the number of the class from 1, or 0.
#[derive(Debug, Deserialize)]
struct PaintedMap {
    /// Names of its files, the main one first.
    names: Vec<String>,
    resolution_m: Option<f64>,
}

/// The training file with all that it names.
#[derive(Debug)]
pub(crate) struct TrainingSet<'a> {
    text: String,
    /// What the program reads in it.
    read: TrainingFile,
    maps: Vec<NamedMap<'a>>,
}

#[derive(Debug)]
struct NamedMap<'a> {
    map: LoadedMap,
    /// Where its files lie beside the training file: nothing, or a name and a slash.
    folder: String,
    files: Vec<(&'a str, &'a [u8])>,
    labels_png: Vec<u8>,
}

impl<'a> TrainingSet<'a> {
    /// Puts the set together; `has_folders` if every map shall lie in a folder of its own.
    pub(crate) fn new(painted: &'a Painted, blobs: &[&'a [u8]], has_folders: bool) -> Result<Self, String> {
        let mut blobs = blobs.iter().copied();
        let mut maps: Vec<NamedMap<'_>> = Vec::new();
        for PaintedMap { names, resolution_m } in &painted.maps {
            let files: Vec<(&str, &[u8])> = names.iter().map(String::as_str).zip(&mut blobs).collect();
            let map = load(&files, *resolution_m)?;
            let cells = blobs.next().ok_or("expected a painted map, found none")?;
            let labels_png = labels_png(cells, &map, &painted.classes)?;
            let is_taken = |folder: &String| maps.iter().any(|other| other.folder == *folder);
            let name = folder_name(&map.name);
            let numbered = (2..).map(|n| format!("{name}-{n}/"));
            let mut folders =
                std::iter::once(format!("{name}/")).chain(numbered).filter(|folder| !is_taken(folder));
            let folder = folders.next().filter(|_| has_folders).unwrap_or_default();
            maps.push(NamedMap { map, folder, files, labels_png });
        }
        let text = training_toml(&maps, &painted.classes);
        let read = TrainingFile::from_toml(&text).map_err(in_words)?;
        Ok(Self { text, read, maps })
    }

    /// All files: those of the maps too, where each has a folder.
    pub(crate) fn files(self) -> Vec<(String, Vec<u8>)> {
        let mut files = vec![(TRAINING_FILE.to_owned(), self.text.into_bytes())];
        for NamedMap { folder, files: own, labels_png, .. } in self.maps {
            files.push((format!("{folder}{LABELS}"), labels_png));
            if !folder.is_empty() {
                files.extend(own.iter().map(|(name, bytes)| (format!("{folder}{name}"), bytes.to_vec())));
            }
        }
        files
    }

    /// Trains; the answer is the report, and the model's file.
    pub(crate) fn train(self, max_cells_per_class: usize, progress: &dyn Progress) -> Result<Answer, String> {
        let TrainingFile { classes, coding, .. } = self.read;
        let labeled = self.maps.into_iter().map(|NamedMap { map, folder, labels_png, .. }| {
            let size = (map.grid.cells.width(), map.grid.cells.height());
            let labels = read_labels(&labels_png, size, &coding).map_err(in_words)?;
            // A file that is just called `map` is named by its folder.
            let name = if map.name == "map" && !folder.is_empty() {
                folder.trim_end_matches('/').to_owned()
            } else {
                map.name
            };
            Ok(LabeledMap {
                name,
                grid: map.grid,
                labels: labels.map(|cell| match cell {
                    LabelCell::Class(label) => Some(*label),
                    LabelCell::None | LabelCell::Ignore => None,
                }),
                window: None,
                building: None,
            })
        });
        let maps = labeled.collect::<Result<Vec<_>, String>>()?;
        let config = TrainConfig { max_cells_per_class: Some(max_cells_per_class), ..TrainConfig::default() };
        let trained = learn(&maps, &classes, &config, progress).map_err(in_words)?;
        Ok((report(&trained), vec![trained.model.to_json()]))
    }
}

/// What a person wants to know of a training.
fn report(trained: &Trained) -> Value {
    let report = &trained.report;
    let held_out = trained.model.record.validation.as_ref().and_then(|validation| {
        let best = validation.orders.first()?;
        Some(json!({
            "n_folds": validation.n_folds,
            "n_rounds": validation.n_rounds,
            "temperature": validation.temperature,
            "order": best.order,
            "accuracy": best.accuracy,
            "macro_f1": best.macro_f1,
        }))
    });
    json!({ "n_examples": report.n_examples, "training_error": report.training_error, "held_out": held_out })
}

/// The training file for `maps`, as [`TrainingFile`] reads it.
fn training_toml(maps: &[NamedMap<'_>], classes: &[Class]) -> String {
    let quoted = |text: &str| toml::Value::from(text).to_string();
    let mut text = String::new();
    for NamedMap { folder, files, .. } in maps {
        let main = files.first().map_or("", |(name, _)| name);
        let (map, labels) = (quoted(&format!("{folder}{main}")), quoted(&format!("{folder}{LABELS}")));
        text += &format!("[[map]]\nmap = {map}\nlabels = {labels}\n\n");
    }
    text += "[classes]\n";
    for Class { name, role, color: [red, green, blue] } in classes {
        let role = match role {
            Role::Place => "place",
            Role::Passage => "passage",
            Role::Doorway => "doorway",
        };
        text += &format!("{} = {{ color = [{red}, {green}, {blue}], role = \"{role}\" }}\n", quoted(name));
    }
    text
}

/// The label image: a palette with black for no label and every class's color.
fn labels_png(cells: &[u8], map: &LoadedMap, classes: &[Class]) -> Result<Vec<u8>, String> {
    let (width, height) = (map.grid.cells.width(), map.grid.cells.height());
    if cells.len() as u64 != u64::from(width) * u64::from(height) {
        return Err(format!("expected {width} x {height} painted cells, found {}", cells.len()));
    }
    if let Some(found) = cells.iter().find(|&&value| usize::from(value) > classes.len()) {
        return Err(format!("expected cells of {} classes, found {found}", classes.len()));
    }
    let palette: Vec<u8> =
        std::iter::once([0; 3]).chain(classes.iter().map(|class| class.color)).flatten().collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette(palette);
    let mut writer = encoder.write_header().map_err(in_words)?;
    writer.write_image_data(cells).map_err(in_words)?;
    writer.finish().map_err(in_words)?;
    Ok(bytes)
}

/// A name that any system takes for a folder.
fn folder_name(name: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_ ".contains(c);
    let name: String = name.chars().map(|c| if is_plain(c) { c } else { '_' }).collect();
    let name = name.trim();
    if name.is_empty() { "map".to_owned() } else { name.to_owned() }
}

#[cfg(test)]
mod tests {
    use placegraph::progress::Silent;

    use super::*;

    const YAML: &[u8] = include_bytes!("../page/example/map.yaml");
    const IMAGE: &[u8] = include_bytes!("../page/example/map.png");

    fn class(name: &str, role: Role, color: [u8; 3]) -> Class {
        Class { name: name.to_owned(), role, color }
    }

    /// The example, west of `x` one class, and east of it the other.
    fn halves(classes: Vec<Class>, n_maps: usize) -> (Painted, (u32, u32), Vec<u8>) {
        let map =
            load(&[("map.yaml", YAML), ("map.png", IMAGE)], None).unwrap_or_else(|error| panic!("{error}"));
        let (width, height) = (map.grid.cells.width(), map.grid.cells.height());
        let cells = (0..width * height).map(|cell| if cell % width < width / 2 { 1 } else { 2 }).collect();
        let names = || vec!["map.yaml".to_owned(), "map.png".to_owned()];
        let maps = (0..n_maps).map(|_| PaintedMap { names: names(), resolution_m: None }).collect();
        (Painted { maps, classes }, (width, height), cells)
    }

    #[test]
    fn what_is_handed_out_is_read_back_with_its_names_and_colors() {
        let classes = vec![
            class("café \"west\"", Role::Place, [1, 2, 3]),
            class("a.b = 'c'", Role::Passage, [200, 0, 9]),
            class("unused", Role::Doorway, [7, 7, 7]),
        ];
        let (painted, size, cells) = halves(classes, 2);
        let blobs = [YAML, IMAGE, &cells, YAML, IMAGE, &cells];
        let files = TrainingSet::new(&painted, &blobs, true).map(TrainingSet::files).unwrap_or_default();
        let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(
            names,
            [
                "training.toml",
                "map/labels.png",
                "map/map.yaml",
                "map/map.png",
                "map-2/labels.png",
                "map-2/map.yaml",
                "map-2/map.png"
            ]
        );
        let text = String::from_utf8_lossy(&files[0].1);
        let read = TrainingFile::from_toml(&text).unwrap_or_else(|error| panic!("{error}: {text}"));
        assert_eq!(read.classes.classes(), painted.classes);
        assert_eq!(read.maps[1].labels, "map-2/labels.png");
        let labels = read_labels(&files[1].1, size, &read.coding).unwrap_or_else(|error| panic!("{error}"));
        // Row 0 of the grid is the last of the picture.
        for (row, from_top) in (0..size.1).zip(cells.chunks(size.0 as usize).rev()) {
            for (found, &painted) in labels.row(row).iter().zip(from_top) {
                assert!(matches!(found, LabelCell::Class(label) if label.0 + 1 == painted));
            }
        }
    }

    #[test]
    fn what_cannot_be_learned_from_is_refused_in_words() {
        let pair = |a, b| vec![class("a", Role::Place, a), class("b", Role::Passage, b)];
        let train = |classes, cells: &[u8]| {
            let (painted, ..) = halves(classes, 1);
            let set = TrainingSet::new(&painted, &[YAML, IMAGE, cells], true);
            set.and_then(|set| set.train(100, &Silent)).err().unwrap_or_default()
        };
        let (.., cells) = halves(Vec::new(), 1);
        for (classes, cells, expected) in [
            (pair([1; 3], [1; 3]), cells.clone(), "same"),
            (pair([0; 3], [1; 3]), cells.clone(), "value"),
            (pair([2; 3], [1; 3]), cells[1..].to_vec(), "painted cells"),
            (pair([2; 3], [1; 3]), vec![3; cells.len()], "found 3"),
            (pair([2; 3], [1; 3]), vec![1; cells.len()], "\"b\""),
            (pair([2; 3], [1; 3]), vec![0; cells.len()], "labeled free cells"),
            (vec![class("a", Role::Place, [2; 3])], vec![1; cells.len()], "2 to 8 classes"),
        ] {
            let error = train(classes, &cells);
            assert!(error.contains(expected), "{expected}: {error}");
        }
    }

    #[test]
    fn names_of_folders_are_plain() {
        for (name, folder) in [
            ("office", "office"),
            ("../x", "___x"),
            ("a/b\\c:d", "a_b_c_d"),
            (" ", "map"),
            ("Büro 2", "Büro 2"),
        ] {
            assert_eq!(folder_name(name), folder);
        }
    }
}
