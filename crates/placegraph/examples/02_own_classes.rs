//! Trains a model with classes of one's own, and labels a map with it.
//!
//! `cargo run --release --example 02_own_classes`
#![expect(clippy::print_stdout, reason = "an example shows what it found")]

use std::error::Error;

use placegraph::grid::{Grid, OccupancyGrid};
use placegraph::labels::{Class, LabelSet, Role};
use placegraph::model::Model;
use placegraph::pipeline::{self, Config};
use placegraph::progress::Silent;
use placegraph::training::{Choice, LabeledMap, TrainConfig, train};

/// Every letter is the class of a free cell of 25 cm.
const DRAWING: &str = include_str!("data/building.txt");

fn main() -> Result<(), Box<dyn Error>> {
    // A class has a name, a color, and a role that says how the map is built from it.
    let class = |name: &str, role, color| Class { name: name.to_owned(), role, color };
    let classes = LabelSet::new(vec![
        class("hall", Role::Passage, [90, 160, 220]),
        class("ward", Role::Place, [240, 200, 120]),
        class("door", Role::Doorway, [200, 70, 90]),
    ])?;
    let label = |letter| match letter {
        'c' => classes.label("hall"),
        'r' => classes.label("ward"),
        'd' => classes.label("door"),
        _ => None,
    };
    let grid = OccupancyGrid::from_ascii(0.25, &DRAWING.replace(['c', 'r', 'd'], "."));
    let labels = Grid::from_ascii(DRAWING, label);
    let map = LabeledMap { name: "drawn".to_owned(), grid, labels, window: None, building: None };

    // Few rounds, for one small building; by default, rounds and temperature are chosen on held-out parts.
    let config = TrainConfig { rounds: Choice::Set(20), block_m: 2.5, ..TrainConfig::default() };
    let trained = train(std::slice::from_ref(&map), &classes, &config, &Silent)?;
    println!("{:.1} % of the training cells are wrong", 100.0 * trained.report.training_error);

    // A model is a file of JSON: the same bytes label the same way everywhere.
    let model = Model::from_json(&trained.model.to_json())?;
    let analysis = pipeline::analyze(&map.grid, &model, &Config::default(), &Silent);
    for place in &analysis.topology.places {
        println!("{:<10} {:>6.1} m²", place.name, place.area_m2);
    }
    Ok(())
}
