//! Corrections by hand: what they do, and what is said when they no longer apply.

use crate::building::{self, Building};
use placegraph::geom::Pose2;
use placegraph::grid::{Cell, Grid};
use placegraph::labels::LabelSet;
use placegraph::topology::PlaceId;
use placegraph::topology::edits::{Edit, EditFile, Edited, NotApplied, Numbering, apply};
use placegraph::topology::query::UnknownPlace;

/// Places are numbered as the regions are, from 1.
fn edited(building: &Building, toml: &str) -> Edited {
    let file = EditFile::from_toml(toml).unwrap();
    let numbers = (1..=building.regions.regions.len() as u32).map(|id| Some(PlaceId(id))).collect();
    let numbering = Numbering { numbers, ..Numbering::default() };
    let labels = LabelSet::default();
    apply(&building.space, &labels, building.regions.clone(), numbering, &file.edits)
}

fn all_applied(result: &Edited) -> bool {
    result.outcomes.iter().all(Result::is_ok)
}

/// The numbers of the places, in order.
fn numbers(result: &Edited) -> Vec<u32> {
    let mut numbers: Vec<u32> = result.numbers.iter().flatten().map(|id| id.0).collect();
    numbers.sort_unstable();
    numbers
}

/// The number of the place at the letter in column `x` and row `y`.
fn number_at(building: &Building, result: &Edited, x: u32, y: u32) -> Option<u32> {
    let cell = building.grid.frame.cell_at(building.at(x, y)).unwrap();
    let region = result.regions.region_of[building.space.graph.node_at(cell).unwrap()];
    result.numbers[region.index()].map(|id| id.0)
}

fn edit(action: &str, rest: &str) -> String {
    format!("[[edit]]\naction = \"{action}\"\n{rest}\n")
}

/// `[x, y]` in the map of the letter in column `x` and row `y`.
fn at(building: &Building, x: u32, y: u32) -> String {
    let point = building.at(x, y);
    format!("[{}, {}]", point.x, point.y)
}

fn class_sizes(edited: &Edited) -> Vec<(u8, u32)> {
    let mut sizes: Vec<(u8, u32)> = edited.regions.regions.iter().map(|r| (r.label.0, r.n_cells)).collect();
    sizes.sort_unstable();
    sizes
}

#[test]
fn rename_and_relabel() {
    let building = building::drawn(Pose2::new(2.0, -1.0, 0.3));
    let here = at(&building, 5, 12);
    let result = edited(
        &building,
        &format!(
            "[[edit]]\naction = \"rename\"\nat = {here}\nname = \"kitchen\"\n\n[[edit]]\naction = \"relabel\"\nat = {here}\nclass = \"corridor\"\n"
        ),
    );
    assert!(result.outcomes.iter().all(Result::is_ok), "{:?}", result.outcomes);
    let (region, name) = result.names.first_key_value().unwrap();
    assert_eq!(name, "kitchen");
    assert_eq!(result.regions.regions[region.index()].label.0, 0);
    assert_eq!(result.regions.region_of, building.regions.region_of);
}

#[test]
fn a_line_splits_a_room_and_merging_undoes_it() {
    let building = building::drawn(Pose2::new(2.0, -1.0, 0.3));
    // Between the 12th and the 13th row, from wall to wall.
    let (left, right) = (at(&building, 1, 12), at(&building, 14, 12));
    let split = format!("[[edit]]\naction = \"split\"\nline = [{left}, {right}]\n");
    let result = edited(&building, &split);
    assert!(all_applied(&result), "{:?}", result.outcomes);
    assert_eq!(result.regions.regions.len(), building.regions.regions.len() + 1);
    let merge = format!(
        "{split}\n[[edit]]\naction = \"merge\"\nat = [{}, {}]\n",
        at(&building, 5, 14),
        at(&building, 5, 10)
    );
    let result = edited(&building, &merge);
    assert!(all_applied(&result), "{:?}", result.outcomes);
    assert_eq!(result.regions, building.regions);
}

#[test]
fn a_doorway_across_the_corridor_cuts_it_in_two() {
    let building = building::drawn(Pose2::default());
    let (below, above) = (at(&building, 24, 1), at(&building, 24, 7));
    let result =
        edited(&building, &format!("[[edit]]\naction = \"add_doorway\"\nline = [{below}, {above}]\n"));
    assert!(all_applied(&result), "{:?}", result.outcomes);
    let classes: Vec<u8> = class_sizes(&result).iter().map(|&(class, _)| class).collect();
    assert_eq!(classes, [0, 0, 1, 1, 1, 2, 2, 2, 2]);
    // Five columns of cells, 0.1 m to both sides of the line, five letters high.
    assert!(class_sizes(&result).contains(&(2, 125)), "{:?}", class_sizes(&result));
}

#[test]
fn a_removed_doorway_goes_to_its_longest_neighbor() {
    let building = building::drawn(Pose2::default());
    let doorway = at(&building, 6, 7);
    let result = edited(&building, &format!("[[edit]]\naction = \"remove_doorway\"\nat = {doorway}\n"));
    assert!(all_applied(&result), "{:?}", result.outcomes);
    assert_eq!(result.regions.regions.len(), building.regions.regions.len() - 1);
    assert_eq!(class_sizes(&result).iter().filter(|(class, _)| *class == 2).count(), 2);
}

#[test]
fn what_does_not_apply_is_reported_and_the_rest_is_done() {
    let building = building::drawn(Pose2::default());
    let (room, wall) = (at(&building, 5, 12), at(&building, 14, 12));
    let other = at(&building, 40, 15);
    let result = edited(
        &building,
        &format!(
            "
            [[edit]]
            action = \"rename\"
            at = {wall}
            name = \"x\"

            [[edit]]
            action = \"relabel\"
            at = {room}
            class = \"garage\"

            [[edit]]
            action = \"split\"
            line = [{room}, {wall}]

            [[edit]]
            action = \"merge\"
            at = [{room}, {other}]

            [[edit]]
            action = \"remove_doorway\"
            at = {room}

            [[edit]]
            action = \"rename\"
            at = {room}
            name = \"kitchen\"

            [[edit]]
            action = \"rename\"
            at = {other}
            name = \"kitchen\"
            "
        ),
    );
    assert!(matches!(result.outcomes[0], Err(NotApplied::NoPlace { .. })));
    let known = ["corridor", "room", "doorway"].map(str::to_owned).into();
    assert_eq!(result.outcomes[1], Err(NotApplied::NoClass { class: "garage".into(), known }));
    assert!(matches!(result.outcomes[2], Err(NotApplied::PartsNothing { .. })));
    let [room, other] = [(5, 12), (40, 15)].map(|(x, y)| building.place_at(x, y).name.clone());
    assert_eq!(result.outcomes[3], Err(NotApplied::NotTouching { found: vec![room.clone(), other] }));
    assert_eq!(result.outcomes[4], Err(NotApplied::NoDoorway { name: room, class: "room".into() }));
    assert!(result.outcomes[5].is_ok());
    assert_eq!(result.outcomes[6], Err(NotApplied::NameTaken { name: "kitchen".into() }));
    assert_eq!(result.regions, building.regions);
}

#[test]
fn a_file_says_what_it_cannot_read() {
    let error =
        EditFile::from_toml("[[edit]]\naction = \"rename\"\nat = [1.0, 2.0]\nnam = \"x\"\n").unwrap_err();
    assert!(error.to_string().contains("nam"), "{error}");
    assert!(EditFile::from_toml("[[edit]]\naction = \"paint\"\n").is_err());
    let file = EditFile { edits: vec![Edit::RemoveDoorway { at: [1.0, 2.0].into() }] };
    assert_eq!(EditFile::from_toml(&toml::to_string(&file).unwrap()).unwrap(), file);
}

#[test]
fn a_file_refuses_names_that_no_place_can_have() {
    for name in ["", "7", "a/b", "a\\u001bb", "a\\nb", &"x".repeat(201)] {
        let text = edit("rename", &format!("at = [1.0, 2.0]\nname = \"{name}\""));
        let error = EditFile::from_toml(&format!("{}{text}", edit("exclude", "at = 3"))).unwrap_err();
        assert!(error.to_string().contains("in edit 2: expected a name"), "{error}");
    }
    assert!(EditFile::from_toml(&edit("open", "line = [[0, 0], [1, 0]]\nwidth_m = nan")).is_err());
    assert!(EditFile::from_toml(&edit("exclude", "at = [inf, 0.0]")).is_err());
}

#[test]
fn places_are_meant_by_name_or_number_too() {
    let building = building::drawn(Pose2::default());
    let place = building.place_at(5, 12);
    for at in [format!("\"{}\"", place.name), format!("\"{}\"", place.id.0), place.id.0.to_string()] {
        let result = edited(&building, &edit("rename", &format!("at = {at}\nname = \"kitchen\"")));
        assert!(all_applied(&result), "{:?}", result.outcomes);
        let (region, name) = result.names.first_key_value().unwrap();
        assert_eq!((result.numbers[region.index()], name.as_str()), (Some(place.id), "kitchen"));
        let applied = result.outcomes[0].as_ref().unwrap();
        assert_eq!(applied.was, [place.name.as_str()]);
    }
    // A name that an earlier edit gave, and the one that the place had before it.
    let twice = [
        edit("rename", &format!("at = \"{}\"\nname = \"kitchen\"", place.name)),
        edit("relabel", "at = \"kitchen\"\nclass = \"corridor\""),
        edit("rename", &format!("at = \"{}\"\nname = \"canteen\"", place.name)),
    ];
    let result = edited(&building, &twice.join("\n"));
    assert!(all_applied(&result), "{:?}", result.outcomes);
    assert_eq!(result.names.values().collect::<Vec<_>>(), ["canteen"]);
}

#[test]
fn an_unknown_name_tells_those_that_are_known() {
    let building = building::drawn(Pose2::default());
    let result = edited(&building, &edit("exclude", "at = \"Room 77\""));
    let Err(NotApplied::NoPlaceCalled(UnknownPlace { found, known })) = &result.outcomes[0] else {
        panic!("{:?}", result.outcomes)
    };
    assert_eq!((found.as_str(), known.len()), ("Room 77", building.map.places.len()));
    assert!(known[0].starts_with("room"), "{known:?}");
}

#[test]
fn numbers_stay_whatever_is_edited() {
    let building = building::drawn(Pose2::default());
    let n = building.regions.regions.len() as u32;
    let everywhere = [(5, 12), (20, 16), (40, 15), (24, 4)];
    let before = everywhere.map(|(x, y)| building.place_at(x, y).id.0);
    let result = edited(
        &building,
        &[
            edit("split", &format!("line = [{}, {}]", at(&building, 1, 12), at(&building, 14, 12))),
            edit("add_doorway", &format!("line = [{}, {}]", at(&building, 35, 1), at(&building, 35, 7))),
            edit("remove_doorway", &format!("at = {}", at(&building, 6, 7))),
        ]
        .join("\n"),
    );
    assert!(all_applied(&result), "{:?}", result.outcomes);
    // One room in two, a doorway more with a corridor beyond, a doorway less.
    let gone = building.place_at(6, 7).id.0;
    let expected: Vec<u32> = (1..=n + 3).filter(|&id| id != gone).collect();
    assert_eq!(numbers(&result), expected);
    let after = everywhere.map(|(x, y)| number_at(&building, &result, x, y).unwrap());
    assert_eq!(after[1..], before[1..], "the larger part keeps the number");
}

#[test]
fn a_doorway_drawn_beside_the_gap_is_moved_into_it() {
    // The doorway between the second and the third room is removed and drawn again, 0.3 m beside, slanted, too short.
    let building = building::drawn(Pose2::new(2.0, -1.0, 0.3));
    let doorway = building.place_at(32, 10);
    let [top, bottom] = doorway.doorway.as_ref().unwrap().jambs;
    let frame = building.grid.frame;
    for [(ax, ay), (bx, by)] in
        [[(0.0, 0.0), (0.0, 0.0)], [(6.0, 0.0), (5.0, 1.0)], [(-4.0, -3.0), (4.0, 3.0)]]
    {
        let moved = |point, x, y| {
            let cells = frame.cells_from_map(point);
            let point = frame.map_from_cells(placegraph::geom::Point2::new(cells.x + x, cells.y + y));
            format!("[{}, {}]", point.x, point.y)
        };
        let line = format!("line = [{}, {}]", moved(top, ax, ay), moved(bottom, bx, by));
        let remove = edit("remove_doorway", &format!("at = \"{}\"", doorway.name));
        let result = edited(&building, &(remove + &edit("add_doorway", &line)));
        assert!(all_applied(&result), "{:?}", result.outcomes);
        let drawn = result.outcomes[1].as_ref().unwrap().line.unwrap();
        let length = (drawn[0][0] - drawn[1][0]).hypot(drawn[0][1] - drawn[1][1]);
        assert!((length - doorway.doorway.as_ref().unwrap().width_m).abs() < 0.06, "{drawn:?}");
        // One doorway of the gap's width, not five slivers.
        assert_eq!(class_sizes(&result).iter().filter(|(class, _)| *class == 2).count(), 3);
        assert_eq!(result.regions.regions.len(), building.regions.regions.len());
    }
}

#[test]
fn a_doorway_that_parts_nothing_is_refused_and_leaves_no_trace() {
    let building = building::drawn(Pose2::default());
    for line in [((20, 14), (22, 14)), ((3, 13), (4, 13))] {
        let line =
            format!("line = [{}, {}]", at(&building, line.0.0, line.0.1), at(&building, line.1.0, line.1.1));
        for action in ["add_doorway", "split"] {
            let result = edited(&building, &edit(action, &line));
            assert!(
                matches!(result.outcomes[0], Err(NotApplied::PartsNothing { .. })),
                "{:?}",
                result.outcomes
            );
            assert_eq!(result.regions, building.regions);
        }
    }
    // Where a doorway is there is none to add.
    let jambs = building.place_at(6, 7).doorway.as_ref().unwrap().jambs;
    let line = format!("line = [[{}, {}], [{}, {}]]", jambs[0].x, jambs[0].y, jambs[1].x, jambs[1].y);
    let result = edited(&building, &edit("add_doorway", &line));
    assert_eq!(result.outcomes[0], Err(NotApplied::IsDoorway { name: building.place_at(6, 7).name.clone() }));
}

#[test]
fn a_merge_takes_the_doorway_between_along() {
    let building = building::drawn(Pose2::default());
    let [second, third] = [(20, 16), (40, 15)].map(|(x, y)| building.place_at(x, y));
    let doorway = building.place_at(32, 10);
    let merge = edit("merge", &format!("at = [\"{}\", \"{}\"]", third.name, second.name));
    let result = edited(&building, &merge);
    assert!(all_applied(&result), "{:?}", result.outcomes);
    let applied = result.outcomes[0].as_ref().unwrap();
    assert_eq!(applied.was, [third.name.clone(), second.name.clone(), doorway.name.clone()]);
    let merged = [(20, 16), (40, 15), (32, 10)].map(|(x, y)| number_at(&building, &result, x, y));
    assert_eq!(merged, [Some(third.id.0); 3]);
    // The doorway to the corridor stays.
    assert_eq!(class_sizes(&result).iter().filter(|(class, _)| *class == 2).count(), 2);

    // The name of the first of them stays, and those of other places.
    let rename = |x, y, name| edit("rename", &format!("at = {}\nname = \"{name}\"", at(&building, x, y)));
    let renamed = rename(40, 15, "den") + &rename(20, 16, "kitchen") + &rename(6, 7, "entrance");
    let result = edited(&building, &(renamed + &merge));
    assert!(all_applied(&result), "{:?}", result.outcomes);
    let names: Vec<&String> = result.names.values().collect();
    assert_eq!(names.len(), 2, "{names:?}");
    assert!(names.iter().all(|name| ["den", "entrance"].contains(&name.as_str())), "{names:?}");

    let alone = edited(&building, &edit("merge", "at = [1, 1]"));
    assert!(matches!(alone.outcomes[0], Err(NotApplied::OnePlace { .. })), "{:?}", alone.outcomes);
}

#[test]
fn a_moved_doorway_keeps_its_number() {
    let building = building::drawn(Pose2::default());
    let doorway = building.place_at(32, 10);
    let line = format!("line = [{}, {}]", at(&building, 24, 1), at(&building, 24, 7));
    let result = edited(&building, &edit("move_doorway", &format!("at = \"{}\"\n{line}", doorway.name)));
    assert!(all_applied(&result), "{:?}", result.outcomes);
    assert_eq!(number_at(&building, &result, 24, 4), Some(doorway.id.0));
    assert_ne!(number_at(&building, &result, 32, 10), Some(doorway.id.0));
    // Where it cannot be it stays where it was.
    let nowhere = format!("line = [{}, {}]", at(&building, 20, 14), at(&building, 22, 14));
    let result = edited(&building, &edit("move_doorway", &format!("at = \"{}\"\n{nowhere}", doorway.name)));
    assert!(matches!(result.outcomes[0], Err(NotApplied::PartsNothing { .. })));
    assert_eq!(result.regions, building.regions);
}

#[test]
fn what_is_excluded_is_no_place() {
    let building = building::drawn(Pose2::default());
    let room = building.place_at(40, 15);
    let again = edit("rename", &format!("at = {}\nname = \"x\"", at(&building, 40, 15)));
    let result = edited(&building, &(edit("exclude", &format!("at = \"{}\"", room.name)) + &again));
    assert!(result.outcomes[0].is_ok());
    assert!(matches!(result.outcomes[1], Err(NotApplied::NoPlace { .. })), "{:?}", result.outcomes);
    assert_eq!(number_at(&building, &result, 40, 15), None);
    assert_eq!(numbers(&result).len(), building.map.places.len() - 1);
}

/// Two rooms with two gaps in the wall between them.
const LOOP: &str = "
    ?????????????????
    ?###############?
    ?#rrrrrr#rrrrrr#?
    ?#rrrrrr#rrrrrr#?
    ?#rrrrrrrrrrrrr#?
    ?#rrrrrrrrrrrrr#?
    ?#rrrrrrrrrrrrr#?
    ?#rrrrrr#rrrrrr#?
    ?#rrrrrr#rrrrrr#?
    ?#rrrrrrrrrrrrr#?
    ?#rrrrrrrrrrrrr#?
    ?#rrrrrrrrrrrrr#?
    ?#rrrrrr#rrrrrr#?
    ?#rrrrrr#rrrrrr#?
    ?###############?
    ?????????????????
";

#[test]
fn a_doorway_parts_its_sides_though_there_is_another_way_around() {
    let building = building::from_drawing(LOOP, Pose2::default());
    let line = |low: u32, high: u32| {
        edit("add_doorway", &format!("line = [{}, {}]", at(&building, 8, low), at(&building, 8, high)))
    };
    let one = edited(&building, &line(9, 11));
    assert!(all_applied(&one), "{:?}", one.outcomes);
    assert_eq!(class_sizes(&one).len(), 2, "a doorway, and the rooms around it are still one");
    let both = edited(&building, &[line(9, 11), line(4, 6)].concat());
    assert!(all_applied(&both), "{:?}", both.outcomes);
    assert_eq!(class_sizes(&both).iter().filter(|size| size.0 == 1).count(), 2, "two rooms");
}

/// A wall from corner to corner with a gap, 0.7 m wide.
#[test]
fn a_slanted_doorway_is_as_deep_as_a_straight_one() {
    let size = 60;
    let letters = Grid::filled(size, size, ()).cells().map(|Cell { x, y }| {
        let on_wall = x == y || x == y + 1;
        let in_gap = (25..35).contains(&x);
        if x == 0 || y == 0 || x == size - 1 || y == size - 1 || (on_wall && !in_gap) { b'#' } else { b'r' }
    });
    let building = building::from_letters(&Grid::from_rows(size, size, letters.collect()), Pose2::default());
    let line = "line = [[1.225, 1.225], [1.775, 1.775]]";
    let result = edited(&building, &edit("add_doorway", line));
    assert!(all_applied(&result), "{:?}", result.outcomes);
    let [a, b] = result.outcomes[0].as_ref().unwrap().line.unwrap();
    let [along_x, along_y] = [b[0] - a[0], b[1] - a[1]];
    let width_m = along_x.hypot(along_y);
    assert!((0.6..0.8).contains(&width_m), "{a:?} {b:?}");
    let doorway = result.regions.regions.iter().position(|region| region.label.0 == 2).unwrap();
    for (&cell, region) in building.space.graph.cells().iter().zip(&result.regions.region_of) {
        let center = building.grid.frame.map_from_cells(cell.center());
        let (x, y) = (center.x - a[0], center.y - a[1]);
        let beside_m = (x * along_y - y * along_x).abs() / width_m;
        let share = (x * along_x + y * along_y) / (width_m * width_m);
        // What is within 0.1 m of the line, and cells that it touches.
        if region.index() == doorway {
            assert!(beside_m <= 0.1 + 1e-9, "{cell:?}: {beside_m} m");
        } else if (0.1..0.9).contains(&share) {
            assert!(beside_m > 0.1 - 1e-9, "{cell:?}: {beside_m} m");
        }
    }
}
