//! Tries a feature of one's own: how well does it part the classes, and what does it say that no other feature says?
//!
//! `cargo run --release --example 04_own_feature`. `CONTRIBUTING.md` says how such a feature enters the registry.
#![expect(clippy::print_stdout, reason = "an example shows what it found")]

use placegraph::features::select::{fisher_ratio, pearson};
use placegraph::features::{all, extract};
use placegraph::grid::{Cell, Grid, OccupancyGrid};
use placegraph::labels::{Label, LabelSet};
use placegraph::progress::Silent;
use placegraph::scan::{RangeScan, ScanConfig, cast};

/// Every letter is the class of a free cell of 25 cm.
const DRAWING: &str = include_str!("data/building.txt");

/// Share of the beams that are longer than twice the mean: high where there is a way out.
fn share_of_long_beams(scan: &RangeScan) -> f32 {
    let ranges = scan.ranges_m();
    let mean = ranges.iter().sum::<f64>() / ranges.len() as f64;
    let n_long = ranges.iter().filter(|&&range| range > 2.0 * mean).count();
    n_long as f32 / ranges.len() as f32
}

fn main() {
    let map = OccupancyGrid::from_ascii(0.25, &DRAWING.replace(['c', 'r', 'd'], "."));
    let labels = Grid::from_ascii(DRAWING, |letter| "crd".find(letter).map(|k| Label(k as u8)));
    let cells: Vec<Cell> = map.cells.cells().filter(|&cell| map.is_free(cell)).collect();
    let labels: Vec<Label> = cells.iter().filter_map(|&cell| labels[cell]).collect();

    let scan = ScanConfig::default();
    let own: Vec<f32> = cells.iter().map(|&cell| share_of_long_beams(&cast(&map, cell, &scan))).collect();
    let table = extract(&map, &cells, &all(), &scan, &Silent);

    println!("Fisher's ratio of the share of long beams: {:.2}", fisher_ratio(&own, &labels));
    let mut others: Vec<(f64, f64, &str)> = table
        .columns()
        .iter()
        .filter_map(|&id| Some((id, table.values_of(id)?)))
        .map(|(id, values)| {
            (pearson(&own, values).abs(), fisher_ratio(values, &labels), id.feature().name.as_str())
        })
        .collect();
    others.sort_by(|a, b| b.0.total_cmp(&a.0));
    println!("features of the registry that say nearly the same, for {} classes:", LabelSet::default().len());
    for (correlation, ratio, name) in others.iter().take(5) {
        println!("{name:<10} correlation {correlation:.2}, Fisher's ratio {ratio:.2}");
    }
}
