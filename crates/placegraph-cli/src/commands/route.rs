//! `placegraph route`: the way from one place to another.

use std::fmt::Write;
use std::path::Path;

use anyhow::{Context, Result};
use placegraph::topology::query::{find_route, place_called};
use placegraph::topology::{Place, PlaceRaster, TopologicalMap};
use serde_json::{Value, json};

use super::Outcome;
use crate::args::RouteArgs;
use crate::document;
use crate::output::{print, print_json};

/// Tells the places and doorways on the shortest way, and how long it is.
pub(crate) fn run(args: &RouteArgs) -> Result<Outcome> {
    let document = document::read(&args.topology, args.max_cells)?;
    let map = document.topology();
    let (from, to) =
        (named_place(&map, &args.from, &args.topology)?, named_place(&map, &args.to, &args.topology)?);
    let route = find_route(&map, from.id, to.id)
        .with_context(|| format!("there is no way from {} to {}", from.name, to.name))?
        .pulled_straight(&PlaceRaster::new(&map, document.map.shape()?));
    let places: Vec<&Place> = route.places.iter().filter_map(|&id| map.place(id)).collect();
    if args.json {
        let places: Vec<Value> = places.into_iter().map(named).collect();
        print_json(&json!({ "places": places, "length_m": route.length_m, "line": route.line }))?;
    } else {
        let mut text = String::new();
        for place in places {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{}", place.name);
        }
        // Rounding leaves lengths just below 0, and 0 may have a sign.
        print(&format!("{text}{:.2} m\n", route.length_m.max(0.0) + 0.0))?;
    }
    Ok(Outcome::Done)
}

fn named_place<'a>(map: &'a TopologicalMap, text: &str, path: &Path) -> Result<&'a Place> {
    place_called(map, text).with_context(|| format!("in {}", path.display()))
}

/// What tells a place from others.
pub(super) fn named(place: &Place) -> Value {
    json!({ "id": place.id, "name": place.name, "class": place.class })
}
