//! The hand-labeled maps of the chapter's buildings, split into a half to learn from and one to be judged on.

use std::path::PathBuf;

use placegraph::geom::Pose2;
use placegraph::grid::{Cell, Grid, MapFrame, Occupancy, OccupancyGrid};
use placegraph::labels::Label;
use placegraph::training::{LabeledMap, Window};

fn data(name: &str) -> Option<PathBuf> {
    let Some(folder) = std::env::var_os("PLACEGRAPH_DATA") else {
        println!("skipped: PLACEGRAPH_DATA does not name the folder of maps");
        return None;
    };
    Some(PathBuf::from(folder).join("eval").join(name))
}

/// An 8-bit image with the bottom row first.
fn gray(path: &PathBuf) -> Grid<u8> {
    let image = image::open(path).unwrap().into_luma8();
    let rows = image.rows().rev().flatten().map(|pixel| pixel.0[0]).collect();
    Grid::from_rows(image.width(), image.height(), rows)
}

/// The map called `name`, to learn from its first `split` columns; all of these maps have cells of 5 cm.
pub(crate) fn labeled_map(name: &str, split: Option<u32>) -> Option<LabeledMap> {
    let folder = data(name)?;
    let cells = gray(&folder.join("map.png")).map(|&value| match value {
        0 => Occupancy::Occupied,
        254 => Occupancy::Free,
        _ => Occupancy::Unknown,
    });
    let labels = gray(&folder.join("labels.png"))
        .map(|&value| if (1..=3).contains(&value) { Some(Label(value - 1)) } else { None });
    let frame = MapFrame::new(0.05, Pose2::default()).unwrap();
    let window = split.map(|x| Window { min: Cell::new(0, 0), end: Cell::new(x, cells.height()) });
    Some(LabeledMap {
        name: name.to_owned(),
        grid: OccupancyGrid { frame, cells },
        labels,
        window,
        building: None,
    })
}

/// Judges the labels `found` of those `cells` that have one, from column `split` on: shares of right cells and of right
/// doorway cells. Prints more measures.
pub(crate) fn evaluate(
    map: &LabeledMap,
    cells: &[Cell],
    found: &[Label],
    split: u32,
    stage: &str,
) -> (f64, f64) {
    let mut confusion = [[0.0f64; 3]; 3];
    for (&cell, label) in cells.iter().zip(found).filter(|(cell, _)| cell.x >= split) {
        if let Some(truth) = map.labels[cell] {
            confusion[truth.index()][label.index()] += 1.0;
        }
    }
    let called = |k: usize| confusion.iter().map(|row| row[k]).sum::<f64>();
    let total = |k: usize| confusion[k].iter().sum::<f64>();
    let right: f64 = (0..3).map(|k| confusion[k][k]).sum();
    let accuracy = right / (0..3).map(total).sum::<f64>();
    let (precision, recall) = (confusion[2][2] / called(2), confusion[2][2] / total(2));
    let f1 = (0..3).map(|k| 2.0 * confusion[k][k] / (called(k) + total(k))).sum::<f64>() / 3.0;
    println!(
        "{} {stage}: accuracy {:.2} %, doorway precision {precision:.3} recall {recall:.3}, macro F1 {f1:.3}",
        map.name,
        100.0 * accuracy
    );
    (accuracy, recall)
}
