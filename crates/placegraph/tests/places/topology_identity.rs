//! Names stay when a map is updated.

use std::collections::BTreeMap;

use crate::building::{self, Building, SCALE};
use placegraph::geom::Pose2;
use placegraph::grid::Grid;
use placegraph::topology::identity::{CarriedOver, Change, carry_over, name_places};
use placegraph::topology::{PlaceId, TopologicalMap};

/// The drawing as cells, with `change` applied to its rows of letters.
fn letters(change: impl Fn(&mut Vec<Vec<u8>>)) -> Grid<u8> {
    let mut rows: Vec<Vec<u8>> =
        building::DRAWING.lines().map(|l| l.trim().as_bytes().to_vec()).filter(|l| !l.is_empty()).collect();
    change(&mut rows);
    rows.reverse();
    let (width, height) = (rows[0].len() as u32 * SCALE, rows.len() as u32 * SCALE);
    let shape = Grid::filled(width, height, ());
    let cells = shape.cells().map(|cell| rows[(cell.y / SCALE) as usize][(cell.x / SCALE) as usize]);
    Grid::from_rows(width, height, cells.collect())
}

/// The building with names of its own.
fn named() -> TopologicalMap {
    let mut map = building::drawn(Pose2::default()).map;
    for place in &mut map.places {
        place.name = format!("named {}", place.id.0);
    }
    map
}

fn carried(building: &Building) -> (TopologicalMap, Vec<Change>) {
    let result = carry_over(&building.map, building.shape(), &named(), &BTreeMap::new());
    (result.map, result.changes)
}

#[test]
fn the_same_map_keeps_everything() {
    let building = building::drawn(Pose2::default());
    let (map, changes) = carried(&building);
    assert_eq!(map, named());
    assert_eq!(changes, []);
}

#[test]
fn the_number_of_a_vanished_place_is_given_to_no_other() {
    let building = building::drawn(Pose2::default());
    let mut before = named();
    assert_eq!(before.last_id, before.places.last().unwrap().id);
    // Two nights ago the last place was another one, which vanished: nothing but `last_id` knows of its number.
    let gone = before.places.pop().unwrap().id;
    before.connections.retain(|connection| connection.a != gone && connection.b != gone);
    let found = carry_over(&building.map, building.shape(), &before, &BTreeMap::new()).map;
    let new = PlaceId(gone.0 + 1);
    assert!(found.place(gone).is_none() && found.place(new).is_some());
    assert_eq!(found.last_id, new);
    // Nor while it is still in the document, in the night in which it vanishes.
    let mut moved = named();
    moved.places.last_mut().unwrap().outline.clear();
    moved.places.last_mut().unwrap().doorway = None;
    let found = carry_over(&building.map, building.shape(), &moved, &BTreeMap::new()).map;
    assert!(found.place(gone).is_none() && found.place(new).is_some());
    // Documents with numbers that no region image holds are refused; of a map made otherwise nothing wraps.
    let mut huge = named();
    huge.last_id = PlaceId(u32::MAX);
    huge.places.pop();
    let found = carry_over(&building.map, building.shape(), &huge, &BTreeMap::new()).map;
    assert!(found.places.iter().all(|place| (PlaceId(1)..=PlaceId::MAX).contains(&place.id)));
}

#[test]
fn names_given_by_hand_win_over_earlier_ones() {
    let building = building::drawn(Pose2::default());
    // The second place takes the name that the first has had.
    let given = BTreeMap::from([(PlaceId(2), "named 1".to_owned())]);
    let map = carry_over(&building.map, building.shape(), &named(), &given).map;
    let name = |id| map.place(PlaceId(id)).unwrap().name.as_str();
    assert_eq!((name(2), name(3)), ("named 1", "named 3"));
    assert_eq!(name(1), format!("{} 1", map.places[0].class));

    let first = CarriedOver::first(&building.map, &BTreeMap::new(), &given).map;
    assert_eq!(first.place(PlaceId(2)).unwrap().name, "named 1");
    assert_eq!(first.place(PlaceId(1)), building.map.place(PlaceId(1)));
}

#[test]
fn noise_and_a_shifted_origin_keep_all_names() {
    // Every 29th free cell became occupied, three columns and two rows of unknown cells appeared before the
    // first, and the origin moved back by as much.
    let clean = letters(|_| {});
    let noisy = {
        let mut noisy = Grid::filled(clean.width() + 3, clean.height() + 2, b'?');
        for (index, cell) in clean.cells().enumerate() {
            let letter = if index % 29 == 0 && clean[cell] != b'd' { b'#' } else { clean[cell] };
            noisy[placegraph::grid::Cell::new(cell.x + 3, cell.y + 2)] = letter;
        }
        noisy
    };
    let building = building::from_letters(&noisy, Pose2::new(-0.15, -0.1, 0.0));
    let (map, changes) = carried(&building);
    let names = |map: &TopologicalMap| -> BTreeMap<PlaceId, String> {
        map.places.iter().map(|place| (place.id, place.name.clone())).collect()
    };
    assert_eq!(names(&map), names(&named()));
    assert_eq!(changes, []);
}

#[test]
fn a_new_room_appears_and_the_others_stay() {
    let with_room = letters(|rows| {
        for row in rows.iter_mut() {
            row.extend_from_slice(b"??????????");
        }
        let first = rows[0].len() - 11;
        for (y, row) in rows.iter_mut().enumerate().take(9).skip(3) {
            for x in first..first + 10 {
                row[x] = if x == first || y == 3 || y == 8 || x == first + 9 { b'#' } else { b'r' };
            }
        }
    });
    let building = building::from_letters(&with_room, Pose2::default());
    let (map, changes) = carried(&building);
    let new = PlaceId(map.places.len() as u32);
    assert_eq!(changes, [Change::Appeared { place: new }]);
    assert_eq!(map.place(new).unwrap().name, format!("room {}", new.0));
    assert!(map.places.iter().filter(|place| place.id != new).all(|place| place.name.starts_with("named")));
}

#[test]
fn split_merged_and_vanished_are_told_apart() {
    // The first room gets a wall across; the doorway between the second and the third becomes part of a room
    // that reaches over both; the second doorway to the corridor is walled up.
    let changed = letters(|rows| {
        for letter in rows[5][2..14].iter_mut().filter(|letter| **letter == b'r') {
            *letter = b'#';
        }
        for row in rows.iter_mut() {
            for letter in row[30..34].iter_mut().filter(|letter| **letter == b'd') {
                *letter = b'r';
            }
        }
        for letter in &mut rows[11][16..22] {
            *letter = b'#';
        }
    });
    let before = named();
    let original = building::drawn(Pose2::default());
    let building = building::from_letters(&changed, Pose2::default());
    let (map, changes) = carried(&building);
    let id = |x, y| original.place_at(x, y).id;
    let (room, second, third) = (id(5, 12), id(16, 15), id(40, 15));
    let (door, walled) = (id(32, 10), id(18, 7));
    let split = changes.iter().find_map(|change| match change {
        Change::Split { from, into } => Some((*from, into.clone())),
        _ => None,
    });
    let (from, into) = split.unwrap();
    assert_eq!((from, into.len()), (room, 2));
    assert_eq!(into[0], room, "the larger piece keeps the number");
    let merged = changes.iter().find_map(|change| match change {
        Change::Merged { from, .. } => Some(from.clone()),
        _ => None,
    });
    let mut merged = merged.unwrap();
    merged.sort_unstable();
    let mut expected = vec![second, third, door];
    expected.sort_unstable();
    assert_eq!(merged, expected);
    let vanished = Change::Vanished { place: walled, name: before.place(walled).unwrap().name.clone() };
    assert!(changes.contains(&vanished), "{changes:?}");
    assert!(map.connections.iter().all(|connection| connection.a < connection.b));
}

#[test]
fn a_doorway_that_moved_by_its_depth_is_the_same() {
    let moved = building::from_letters(&letters(|_| {}), Pose2::new(0.0, 0.3, 0.0));
    let (map, changes) = carried(&moved);
    assert_eq!(
        map.places.iter().map(|place| &place.name).collect::<Vec<_>>(),
        named().places.iter().map(|place| &place.name).collect::<Vec<_>>()
    );
    assert_eq!(changes, []);
}

#[test]
fn a_default_name_makes_way_for_a_given_one() {
    let mut map = building::drawn(Pose2::default()).map;
    let (first, last) = (map.places[0].id, map.places.last().unwrap().id);
    let taken = format!("{} {}", map.places.last().unwrap().class, last.0);
    name_places(&mut map, &BTreeMap::from([(first, taken.as_str())]));
    assert_eq!(map.place(first).unwrap().name, taken);
    assert_eq!(map.place(last).unwrap().name, format!("{taken} (2)"));
}

#[test]
fn a_number_that_vanished_is_not_given_again() {
    // The highest number of the earlier result belongs to a place that is no longer there.
    let mut previous = named();
    let mut gone = previous.places[0].clone();
    (gone.id, gone.name) = (PlaceId(99), "gone".to_owned());
    gone.outline.clear();
    previous.places.push(gone);
    previous.last_id = PlaceId(99);
    let mut current = building::drawn(Pose2::default());
    current.map.places[0].outline.clear();
    let carried = carry_over(&current.map, current.shape(), &previous, &BTreeMap::new());
    let new = carried.map.places.last().unwrap();
    assert_eq!(new.id, PlaceId(100), "{:?}", carried.changes);
    assert!(carried.changes.contains(&Change::Vanished { place: PlaceId(99), name: "gone".to_owned() }));
}
