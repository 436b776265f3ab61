//! `placegraph where`: the place that a point lies in.

use anyhow::{Context, Result, ensure};
use placegraph::geom::Point2;
use placegraph::topology::query::{PlaceIndex, Whereabouts};
use placegraph::topology::{Place, TopologicalMap};
use serde_json::{Value, json};

use super::Outcome;
use crate::args::WhereArgs;
use crate::document;
use crate::output::{print, print_json};

/// Prints place, class and probability, and for a doorway its sides.
pub(crate) fn run(args: &WhereArgs) -> Result<Outcome> {
    let document = document::read(&args.topology, args.max_cells)?;
    let expected = &document.map.frame_id;
    if let Some(found) = &args.at.frame_id {
        ensure!(found == expected, "expected a point in the frame {expected:?}, found {found:?}");
    }
    let map = document.topology();
    let point = Point2::new(args.at.point.x, args.at.point.y);
    let index = PlaceIndex::new(&map, document.map.shape()?);
    let whereabouts =
        index.locate(point).with_context(|| format!("{} has no places", args.topology.display()))?;
    let (id, distance_m) = match whereabouts {
        Whereabouts::Inside { place, border_m } => (place, border_m),
        Whereabouts::Outside { nearest, distance_m } => (nearest, distance_m),
    };
    let place = map.place(id).context("expected the index to know places of the map only")?;
    let is_inside = matches!(whereabouts, Whereabouts::Inside { .. });
    if args.json {
        let key = if is_inside { "border_m" } else { "distance_m" };
        print_json(&json!({ "inside": is_inside, "place": about(&map, place), key: distance_m }))?;
    } else if is_inside {
        let percent = 100.0 * place.probability;
        print(&format!(
            "{} ({}, number {}, probability {percent:.0} %), {distance_m:.2} m from its border\n",
            place.name, place.class, place.id.0
        ))?;
        if place.doorway.is_some() {
            let names: Vec<&str> = sides(&map, place).map(|side| side.name.as_str()).collect();
            print(&format!(
                "between {}\n",
                if names.is_empty() { "no places".into() } else { names.join(" and ") }
            ))?;
        }
    } else {
        print(&format!("outside of all places; {distance_m:.2} m from {}\n", place.name))?;
    }
    Ok(Outcome::Done)
}

/// The places on the two sides of a doorway, fewer at the edge of the explored area.
fn sides<'a>(map: &'a TopologicalMap, place: &'a Place) -> impl Iterator<Item = &'a Place> {
    let sides = place.doorway.as_ref().map_or(&[][..], |doorway| &doorway.sides);
    sides.iter().take(2).filter_map(|&id| map.place(id))
}

fn about(map: &TopologicalMap, place: &Place) -> Value {
    let mut about = super::route::named(place);
    about["probability"] = json!(place.probability);
    if place.doorway.is_some() {
        about["sides"] = sides(map, place).map(super::route::named).collect();
    }
    about
}
