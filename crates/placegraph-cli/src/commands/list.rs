//! `placegraph list`: the places of a result.

use std::fmt::Write;

use anyhow::Result;
use placegraph::topology::{Place, TopologicalMap};
use serde_json::{Value, json};

use super::Outcome;
use crate::args::{ListArgs, MAX_CELLS};
use crate::document;
use crate::output::{print, print_json};

/// A line a place: number, name, class, area, a point inside of it; of a doorway width and sides.
pub(crate) fn run(args: &ListArgs) -> Result<Outcome> {
    let document = document::read(&document::path_in(&args.result), MAX_CELLS)?;
    let map = document.topology();
    let wanted = |place: &&Place| args.class.as_ref().is_none_or(|class| place.class == *class);
    let places = map.places.iter().filter(wanted);
    if args.json {
        let places: Vec<Value> = places.map(|place| about(&map, place)).collect();
        print_json(&json!(places))?;
        return Ok(Outcome::Done);
    }
    let names = |of: &dyn Fn(&Place) -> usize| map.places.iter().map(of).max().unwrap_or(0).max(5);
    let (name_width, class_width) =
        (names(&|place| place.name.chars().count()), names(&|place| place.class.chars().count()));
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "{:>6}  {:name_width$}  {:class_width$}  {:>9}  {:>8} {:>8}",
        "number", "name", "class", "area m²", "x m", "y m"
    );
    for place in places {
        let Place { id, name, class, area_m2, anchor, .. } = place;
        let _ = write!(
            text,
            "{:>6}  {name:name_width$}  {class:class_width$}  {area_m2:>9.2}  {:>8.2} {:>8.2}",
            id.0, anchor.x, anchor.y
        );
        if let Some(doorway) = &place.doorway {
            let _ =
                write!(text, "  {:.2} m wide, between {}", doorway.width_m, sides(&map, place).join(" and "));
        }
        text.push('\n');
    }
    print(&text)?;
    Ok(Outcome::Done)
}

fn sides(map: &TopologicalMap, place: &Place) -> Vec<String> {
    let sides = place.doorway.as_ref().map_or(&[][..], |doorway| &doorway.sides);
    let names: Vec<String> =
        sides.iter().take(2).filter_map(|&id| Some(map.place(id)?.name.clone())).collect();
    if names.is_empty() { vec!["no places".to_owned()] } else { names }
}

fn about(map: &TopologicalMap, place: &Place) -> Value {
    let mut about = json!({
        "id": place.id, "name": place.name, "class": place.class, "area_m2": place.area_m2,
        "at": [place.anchor.x, place.anchor.y],
    });
    if let Some(doorway) = &place.doorway {
        about["width_m"] = json!(doorway.width_m);
        about["sides"] = json!(sides(map, place));
    }
    about
}
