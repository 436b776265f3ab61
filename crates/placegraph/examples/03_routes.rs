//! Asks a topological map: which place is here, and how do I get from one place to another?
//!
//! `cargo run --example 03_routes`
#![expect(clippy::print_stdout, reason = "an example shows what it found")]

use std::error::Error;

use placegraph::geom::Point2;
use placegraph::grid::{GridShape, OccupancyGrid};
use placegraph::model::Model;
use placegraph::pipeline::{self, Config};
use placegraph::progress::Silent;
use placegraph::topology::query::{PlaceIndex, Whereabouts, find_place, find_route};

/// c, r and d are free, 25 cm a letter.
const DRAWING: &str = include_str!("data/building.txt");

fn main() -> Result<(), Box<dyn Error>> {
    let grid = OccupancyGrid::from_ascii(0.25, &DRAWING.replace(['c', 'r', 'd'], "."));
    let analysis = pipeline::analyze(&grid, &Model::builtin(), &Config::default(), &Silent);
    let map = &analysis.topology;

    // Which place is here? Points are in meters of the map frame.
    let index = PlaceIndex::new(map, GridShape::of(&grid));
    let place_at = |x, y| match index.locate(Point2::new(x, y)) {
        Some(Whereabouts::Inside { place, .. }) => map.place(place),
        _ => None,
    };
    let from = place_at(1.0, 0.5).ok_or("no place at (1, 0.5)")?;
    let to = place_at(9.5, 4.0).ok_or("no place at (9.5, 4)")?;
    println!("from {} to {}", from.name, to.name);

    // Names are found too, and numbers.
    assert_eq!(find_place(map, &from.name), Some(from));

    let way = find_route(map, from.id, to.id).ok_or("no way")?;
    println!("{:.1} m through {} places", way.length_m, way.places.len());
    for point in &way.line {
        println!("({:.2}, {:.2})", point.x, point.y);
    }
    Ok(())
}
