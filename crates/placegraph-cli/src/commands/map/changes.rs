//! What changed since an earlier result, in words.

use placegraph::labels::Role;
use placegraph::topology::identity::Change;
use placegraph::topology::{PlaceId, TopologicalMap};

/// A line per change from `earlier` to `map`; places by name and number.
pub(super) fn lines(
    changes: &[Change],
    map: &TopologicalMap,
    earlier: Option<&TopologicalMap>,
) -> Vec<String> {
    let named = |map: Option<&TopologicalMap>, id: PlaceId| match map.and_then(|map| map.place(id)) {
        Some(place) => format!("{} ({})", place.name, id.0),
        None => id.0.to_string(),
    };
    let new = |id: &PlaceId| named(Some(map), *id);
    let old = |id: &PlaceId| named(earlier, *id);
    let is_doorway = |id: &&PlaceId| {
        earlier.and_then(|map| map.place(**id)).is_some_and(|place| place.role == Role::Doorway)
    };
    let in_words = |change: &Change| match change {
        Change::Appeared { place } => format!("appeared: {}", new(place)),
        Change::Vanished { place, name } => format!("vanished: {name} ({})", place.0),
        Change::Split { from, into } => {
            format!("split: {} into {}", old(from), into.iter().map(new).collect::<Vec<_>>().join(", "))
        }
        Change::Merged { from, into } => {
            let (doorways, places): (Vec<&PlaceId>, Vec<&PlaceId>) = from.iter().partition(is_doorway);
            let join = |ids: &[&PlaceId]| ids.iter().map(|id| old(id)).collect::<Vec<_>>().join(", ");
            if places.len() == 1 && !doorways.is_empty() {
                // A door that is shut now, or was none.
                format!("gone: {}, now a part of {}", join(&doorways), new(into))
            } else {
                format!("merged: {} into {}", join(&from.iter().collect::<Vec<_>>()), new(into))
            }
        }
        other => format!("changed: {other:?}"),
    };
    changes.iter().map(in_words).collect()
}

#[cfg(test)]
mod tests {
    use placegraph::geom::{EllipseAxes, Point2};
    use placegraph::topology::Place;

    use super::*;

    fn place(id: u32, class: &str, role: Role) -> Place {
        Place {
            id: PlaceId(id),
            name: format!("{class} {id}"),
            class: class.to_owned(),
            role,
            probability: 1.0,
            n_cells: 1,
            area_m2: 1.0,
            centroid: Point2::new(0.0, 0.0),
            axes: EllipseAxes { major_m: 1.0, minor_m: 1.0, direction_rad: 0.0 },
            anchor: Point2::new(0.0, 0.0),
            clearance_m: 1.0,
            outline: Vec::new(),
            doorway: None,
            cut_off: false,
        }
    }

    #[test]
    fn a_doorway_that_became_part_of_a_room_is_no_merged_room() {
        let earlier = TopologicalMap {
            places: vec![
                place(5, "doorway", Role::Doorway),
                place(6, "room", Role::Place),
                place(7, "room", Role::Place),
            ],
            connections: Vec::new(),
            shortcuts: Vec::new(),
            last_id: PlaceId(0),
        };
        let map = TopologicalMap {
            places: vec![place(6, "room", Role::Place)],
            connections: Vec::new(),
            shortcuts: Vec::new(),
            last_id: PlaceId(0),
        };
        let line = |from: &[u32]| {
            let change =
                Change::Merged { from: from.iter().map(|&id| PlaceId(id)).collect(), into: PlaceId(6) };
            lines(&[change], &map, Some(&earlier)).remove(0)
        };
        assert_eq!(line(&[5, 6]), "gone: doorway 5 (5), now a part of room 6 (6)");
        assert_eq!(line(&[5, 6, 7]), "merged: doorway 5 (5), room 6 (6), room 7 (7) into room 6 (6)");
        assert_eq!(line(&[6, 7]), "merged: room 6 (6), room 7 (7) into room 6 (6)");
        let split = Change::Split { from: PlaceId(7), into: vec![PlaceId(6), PlaceId(9)] };
        assert_eq!(lines(&[split], &map, Some(&earlier)), ["split: room 7 (7) into room 6 (6), 9"]);
    }
}
