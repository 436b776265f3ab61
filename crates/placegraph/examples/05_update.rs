//! Labels a map again after it changed: places keep their numbers and names, corrections by hand are replayed.
//!
//! `cargo run --example 05_update`
#![expect(clippy::print_stdout, reason = "an example shows what it found")]

use std::error::Error;

use placegraph::document::{MapInfo, TopologyDocument};
use placegraph::grid::{Cell, Occupancy, OccupancyGrid};
use placegraph::model::Model;
use placegraph::pipeline::{self, Config};
use placegraph::progress::Silent;
use placegraph::topology::edits::EditFile;

/// c, r and d are free, 25 cm a letter.
const DRAWING: &str = include_str!("data/building.txt");

const EDITS: &str = r#"
[[edit]]
action = "rename"
at = [1.0, 0.5]
name = "kitchen"
"#;

fn main() -> Result<(), Box<dyn Error>> {
    let model = Model::builtin();
    let mut map = OccupancyGrid::from_ascii(0.25, &DRAWING.replace(['c', 'r', 'd'], "."));
    let edits = EditFile::from_toml(EDITS)?.edits;
    let config = Config { edits, ..Config::default() };
    let first = pipeline::analyze(&map, &model, &config, &Silent);

    // A result is kept as a document, and read back when the next map comes.
    let info = MapInfo::of(&map, "drawn", "no hash");
    let kept = TopologyDocument::new(info, None, &model.label_set, &first.topology).to_json()?;
    let previous = TopologyDocument::from_json(kept.as_bytes())?.topology();

    // Next month, the robot finds a pillar in a room.
    map.cells[Cell::new(24, 14)] = Occupancy::Occupied;
    let config = Config { previous: Some(previous), ..Config::default() };
    let second = pipeline::analyze(&map, &model, &config, &Silent);
    for place in &second.topology.places {
        let same = first.topology.place(place.id).is_some_and(|earlier| earlier.name == place.name);
        println!("{:>3} {:<14} {}", place.id.0, place.name, if same { "as before" } else { "new" });
    }
    println!("{} changes", second.changes.len());
    Ok(())
}
