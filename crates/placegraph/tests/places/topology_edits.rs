//! Corrections by hand: what they do, and what is said when they no longer apply.

use crate::building::{self, Building};
use placegraph::geom::Pose2;
use placegraph::labels::LabelSet;
use placegraph::topology::edits::{Edit, EditFile, Edited, NotApplied, apply};

fn edited(building: &Building, toml: &str) -> Edited {
    let file = EditFile::from_toml(toml).unwrap();
    apply(&building.space, &LabelSet::default(), building.regions.clone(), &file.edits)
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
    assert_eq!(result.outcomes, [Ok(())]);
    assert_eq!(result.regions.regions.len(), building.regions.regions.len() + 1);
    let merge = format!(
        "{split}\n[[edit]]\naction = \"merge\"\nat = [{}, {}]\n",
        at(&building, 5, 14),
        at(&building, 5, 10)
    );
    let result = edited(&building, &merge);
    assert_eq!(result.outcomes, [Ok(()), Ok(())]);
    assert_eq!(result.regions, building.regions);
}

#[test]
fn a_doorway_across_the_corridor_cuts_it_in_two() {
    let building = building::drawn(Pose2::default());
    let (below, above) = (at(&building, 24, 1), at(&building, 24, 7));
    let result =
        edited(&building, &format!("[[edit]]\naction = \"add_doorway\"\nline = [{below}, {above}]\n"));
    assert_eq!(result.outcomes, [Ok(())]);
    let classes: Vec<u8> = class_sizes(&result).iter().map(|&(class, _)| class).collect();
    assert_eq!(classes, [0, 0, 1, 1, 1, 2, 2, 2, 2]);
    // One column of cells, five letters high.
    assert!(class_sizes(&result).contains(&(2, 25)));
}

#[test]
fn a_removed_doorway_goes_to_its_longest_neighbor() {
    let building = building::drawn(Pose2::default());
    let doorway = at(&building, 6, 7);
    let result = edited(&building, &format!("[[edit]]\naction = \"remove_doorway\"\nat = {doorway}\n"));
    assert_eq!(result.outcomes, [Ok(())]);
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
    assert_eq!(result.outcomes[1], Err(NotApplied::NoClass { class: "garage".into() }));
    assert_eq!(result.outcomes[2], Err(NotApplied::CutsNothing));
    assert_eq!(result.outcomes[3], Err(NotApplied::NotTouching));
    assert_eq!(result.outcomes[4], Err(NotApplied::NoDoorway { class: "room".into() }));
    assert_eq!(result.outcomes[5], Ok(()));
    assert_eq!(result.outcomes[6], Err(NotApplied::NameTaken { name: "kitchen".into() }));
    assert_eq!(result.regions, building.regions);
}

#[test]
fn a_file_says_what_it_cannot_read() {
    let error =
        EditFile::from_toml("[[edit]]\naction = \"rename\"\nat = [1.0, 2.0]\nnam = \"x\"\n").unwrap_err();
    assert!(error.to_string().contains("nam"), "{error}");
    assert!(EditFile::from_toml("[[edit]]\naction = \"paint\"\n").is_err());
    let file = EditFile { edits: vec![Edit::RemoveDoorway { at: [1.0, 2.0] }] };
    assert_eq!(EditFile::from_toml(&toml::to_string(&file).unwrap()).unwrap(), file);
}
