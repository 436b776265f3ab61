//! Labels a map with the model that comes with the library, and prints its places.
//!
//! `cargo run --example 01_label_map [MAP.yaml]`; without a map, a drawn building.
#![expect(clippy::print_stdout, reason = "an example shows what it found")]

use std::error::Error;
use std::path::Path;

use placegraph::grid::OccupancyGrid;
use placegraph::import::{ReadOptions, load_map};
use placegraph::model::Model;
use placegraph::pipeline::{self, Config};
use placegraph::progress::Silent;

/// c, r and d are free, 25 cm a letter.
const DRAWING: &str = include_str!("data/building.txt");

fn main() -> Result<(), Box<dyn Error>> {
    let map = match std::env::args().nth(1) {
        Some(path) => load_map(Path::new(&path), &ReadOptions::default())?.grid,
        None => OccupancyGrid::from_ascii(0.25, &DRAWING.replace(['c', 'r', 'd'], ".")),
    };
    let analysis = pipeline::analyze(&map, &Model::builtin(), &Config::default(), &Silent);

    // Results are lists over the free cells; a grid has them where they are.
    let letter = |node: usize| ['c', 'r', 'd'][analysis.labeling[node].index()];
    if map.cells.width() < 200 {
        println!("{}", analysis.space.graph.to_ascii(letter));
    }
    for place in &analysis.topology.places {
        println!(
            "{:<14} {:>6.1} m² at ({:.2}, {:.2})",
            place.name, place.area_m2, place.anchor.x, place.anchor.y
        );
    }
    for connection in &analysis.topology.connections {
        println!("{} touches {} over {:.2} m", connection.a.0, connection.b.0, connection.contact_m);
    }
    Ok(())
}
