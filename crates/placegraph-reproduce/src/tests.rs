//! The whole reproduction on generated buildings that are laid out as the chapter's maps.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use placegraph_generate::{Mapping, Options, Style, files, generate};
use tempfile::TempDir;

use super::buildings::{Building, CHAPTER, Source};
use super::results::Results;
use super::settings::Settings;
use super::{REMARKS, load, page, reproduce, write};

/// Few rounds and few cells.
fn small() -> Settings {
    Settings {
        rounds: 6,
        best_rounds: vec![4, 8],
        rounds_curve: vec![2, 6, 8],
        iterations_curve: vec![0, 10, 50],
        scales: vec![1.0, 1.2],
        best_max_cells: Some(400),
        max_cells: 400,
        max_cells_scaled: 200,
        network_stride: 2,
    }
}

/// Draws a home in place of each of the chapter's buildings, split in the middle.
fn draw(data: &Path) -> [Source; 3] {
    let options = Options { mapping: Mapping::Clean, resolution_m: Some(0.1) };
    // Homes with corridors and doorways in both halves.
    let mut indices = [2, 1, 2].into_iter();
    CHAPTER.map(|source| {
        let building = generate(Style::Home, 5, indices.next().unwrap(), &options);
        let folder = data.join(source.folder);
        fs::create_dir_all(&folder).unwrap();
        for (name, bytes) in files(&building).unwrap() {
            fs::write(folder.join(name), bytes).unwrap();
        }
        let split = if source.split == 0 { 0 } else { building.labels.width() / 2 };
        // The drawing itself as the second drawing: both agree in every cell.
        let second = data.join(source.second_drawing);
        fs::create_dir_all(&second).unwrap();
        fs::copy(folder.join("map.yaml"), second.join("map.yaml")).unwrap();
        fs::copy(folder.join("map.png"), second.join("map.png")).unwrap();
        fs::copy(folder.join("labels.png"), second.join("labels_hand.png")).unwrap();
        Source { split, ..source }
    })
}

fn written(data: &Path, sources: &[Source; 3]) -> (Results, BTreeMap<String, Vec<u8>>) {
    let out = TempDir::new().unwrap();
    let (results, pictures) = reproduce(&load(data, sources).unwrap(), &small()).unwrap();
    write(&results, pictures, out.path()).unwrap();
    let mut found = BTreeMap::new();
    for folder in [out.path().to_owned(), out.path().join(super::PICTURES)] {
        for entry in fs::read_dir(folder).unwrap().map(Result::unwrap) {
            if entry.path().is_file() {
                let name = entry.file_name().into_string().unwrap();
                found.insert(name, fs::read(entry.path()).unwrap());
            }
        }
    }
    (results, found)
}

#[test]
fn experiments_agree_with_each_other_and_repeat_to_the_byte() {
    let data = TempDir::new().unwrap();
    let sources = draw(data.path());
    let (results, first) = written(data.path(), &sources);
    let (_, second) = written(data.path(), &sources);
    assert_eq!(first, second);

    let b79 = &results.experiments[0];
    let chosen = results.orders.iter().find(|row| row.order == b79.chapter.order).unwrap();
    assert_eq!(chosen.new, b79.chapter.list, "one training, two tables");
    let chosen = results.orders.iter().find(|row| row.order == b79.best.order).unwrap();
    assert_eq!(chosen.best, b79.best.list, "one training, two tables");
    let at_6 = results.rounds.iter().find(|point| point.at == 6).unwrap();
    assert_eq!(at_6.scores, b79.chapter.list, "boosting is nested");
    for (experiment, curve) in results.experiments.iter().zip(&results.iterations) {
        assert_eq!(curve.points[0].scores, experiment.chapter.list);
        assert_eq!(curve.points[2].scores, experiment.chapter.relaxed, "50 iterations, in two steps");
        assert_eq!(experiment.corrections[0].scores, experiment.chapter.relaxed);
        assert_eq!(experiment.corrections[3].scores, experiment.chapter.corrected);
        let errors = &experiment.errors;
        let counts = &experiment.chapter.corrected.confusion.matrix.counts;
        let n_right: u64 = (0..counts.len()).map(|k| counts[k][k]).sum();
        assert_eq!(errors.n_wrong, counts.iter().flatten().sum::<u64>() - n_right);
        assert_eq!(errors.n_disputed, Some(0), "no drawing but the one");
    }
    assert!(results.drawings.iter().all(|drawing| drawing.scores.accuracy == Some(1.0)));
    assert_eq!(results.pairs.len(), 6);

    let page = String::from_utf8(first["results.md"].clone()).unwrap();
    assert!(!page.contains(REMARKS), "there are none");
    assert!(page::page(&results, Some(REMARKS)).contains("[results-remarks.md](results-remarks.md)"));
    for link in page.split("](results/").skip(1).map(|rest| rest.split(')').next().unwrap()) {
        assert!(first.contains_key(link), "{link}");
    }
    for figure in ["97.27 %", "98.95", "98.66", "96.94", "97.60 %", "80.49 %", "Within one cell"] {
        assert!(page.contains(figure), "{figure}");
    }
}

#[test]
fn a_missing_file_is_named() {
    let data = TempDir::new().unwrap();
    let error = Building::load(data.path(), &CHAPTER[0]).unwrap_err().to_string();
    assert!(error.contains("fr79_slam") && error.contains("map.yaml"), "{error}");
}
