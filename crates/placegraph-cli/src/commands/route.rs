//! `placegraph route`: the way from one place to another.

use std::fmt::Write;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use placegraph::topology::query::{find_route, place_called};
use placegraph::topology::{Place, PlaceRaster, TopologicalMap};
use serde_json::{Value, json};

use super::Outcome;
use crate::args::RouteArgs;
use crate::document;
use crate::output::{print, print_json};

/// Prints the places and doorways on the shortest route, and its length.
pub(crate) fn run(args: &RouteArgs) -> Result<Outcome> {
    if let Some(site) = document::read_site(&args.topology)? {
        return super::site::route(&site, args);
    }
    ensure!(!args.stairs, "--stairs is for a site of several floors, found {}", args.topology.display());
    let document = document::read(&args.topology, args.max_cells)?;
    let map = document.topology();
    let (from, to) =
        (named_place(&map, &args.from, &args.topology)?, named_place(&map, &args.to, &args.topology)?);
    let route = find_route(&map, from.id, to.id)
        .with_context(|| format!("there is no route from {} to {}", from.name, to.name))?
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
        print(&format!("{text}{}\n", length(route.length_m)))?;
    }
    Ok(Outcome::Done)
}

fn named_place<'a>(map: &'a TopologicalMap, text: &str, path: &Path) -> Result<&'a Place> {
    place_called(map, text).with_context(|| format!("in {}", path.display()))
}

/// A length in meters. Rounding leaves lengths just below 0, and 0 may have a sign.
pub(super) fn length(length_m: f64) -> String {
    format!("{:.2} m", length_m.max(0.0) + 0.0)
}

/// What distinguishes a place from others.
pub(super) fn named(place: &Place) -> Value {
    json!({ "id": place.id, "name": place.name, "class": place.class })
}
