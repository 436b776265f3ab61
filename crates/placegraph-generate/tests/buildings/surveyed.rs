//! Surveyed buildings: what the plan says is what the map's truth says.

use placegraph::grid::Occupancy;
use placegraph_generate::{
    AMBIGUOUS, Building, CORRIDOR, DOORWAY, Mapping, Options, Survey, SurveyError, files, generate_surveyed,
    read_flat, read_plan_xml,
};

fn plan() -> Survey {
    read_plan_xml(include_str!("../plans/sample.xml")).unwrap()
}

fn flat() -> Survey {
    read_flat(include_str!("../plans/sample.jsonl")).unwrap()
}

fn building(survey: &Survey, mapping: Mapping, seed: u64) -> Building {
    let options = Options { mapping, resolution_m: Some(0.05) };
    generate_surveyed(survey, "sample", seed, 0, &options).unwrap()
}

/// Classes on both sides and kinds of all openings, in a fixed order.
fn openings(building: &Building) -> Vec<(String, &'static str)> {
    let sides = |classes: [&str; 2]| {
        let mut classes = classes;
        classes.sort_unstable();
        classes.join(" / ")
    };
    let mut found: Vec<_> =
        building.record.openings.iter().map(|opening| (sides(opening.classes), opening.kind)).collect();
    found.sort_unstable();
    found
}

#[test]
fn a_floor_plan_has_its_spaces_doors_and_openings() {
    for seed in 0..8 {
        let found = building(&plan(), Mapping::Clean, seed);
        let expected = [
            ("ambiguous / corridor", "opening"),
            ("corridor / room", "doorway"),
            ("corridor / room", "doorway"),
            ("corridor / room", "doorway"),
            ("corridor / room", "doorway"),
            ("room / room", "doorway"),
        ];
        assert_eq!(openings(&found), expected.map(|(sides, kind)| (sides.to_owned(), kind)), "seed {seed}");
        let spaces = &found.record.spaces;
        let area_m2 = |usage: &str| spaces.iter().find(|space| space.usage == usage).unwrap().area_m2;
        // 20 m by 2 m, and a classroom of 6 m by 5 m; walls and mapping take some.
        assert!((28.0..42.0).contains(&area_m2("corridor")), "{}", area_m2("corridor"));
        assert!((23.0..31.0).contains(&area_m2("classroom")), "{}", area_m2("classroom"));
    }
}

#[test]
fn a_slanted_wall_has_a_slanted_door() {
    let found = building(&plan(), Mapping::Clean, 1);
    let slanted = found.plan.openings.iter().find(|opening| {
        let [a, b] = opening.line();
        (a.x - b.x).abs() > 0.1 && (a.y - b.y).abs() > 0.1
    });
    let [a, b] = slanted.unwrap().line();
    // The wall falls by 5 m over 2 m.
    assert!(((a.y - b.y) / (a.x - b.x) + 2.5).abs() < 0.05, "{a:?} {b:?}");
}

#[test]
fn a_flat_has_rooms_up_to_its_walls_and_no_balcony() {
    for seed in 0..8 {
        let found = building(&flat(), Mapping::Clean, seed);
        let expected = [("corridor / room", "doorway"); 4].map(|(sides, kind)| (sides.to_owned(), kind));
        assert_eq!(openings(&found), expected, "seed {seed}");
        let mut usages: Vec<&str> = found.record.spaces.iter().map(|space| space.usage.as_str()).collect();
        usages.sort_unstable();
        assert_eq!(usages, ["bath", "bedroom", "corridor", "kitchen", "living"]);
        for opening in &found.record.openings {
            // Drawn 28 and 32 pixels wide, the median 0.8 m.
            assert!((0.69..0.81).contains(&opening.width_m), "{}", opening.width_m);
        }
    }
}

#[test]
fn doors_as_objects_lie_on_doorway_cells_unless_they_are_closed() {
    for survey in [plan(), flat()] {
        for (mapping, seed) in [(Mapping::Clean, 2), (Mapping::Furnished, 3), (Mapping::Slam, 4)] {
            let found = building(&survey, mapping, seed);
            let labels = &found.labels;
            for opening in found.record.openings.iter().filter(|opening| opening.free_frac > 0.5) {
                let [a, b] = opening.line;
                let (x, y) = (0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]));
                let row = labels.height() - 1 - y.round() as u32;
                let label = labels[placegraph::grid::Cell::new(x.round() as u32, row)];
                let expected = if opening.kind == "doorway" { DOORWAY } else { AMBIGUOUS };
                assert!(opening.is_closed || label == expected || label == 0, "{mapping:?}: {opening:?}");
            }
            assert!(labels.values().contains(&DOORWAY) && labels.values().contains(&CORRIDOR));
            for (&label, &value) in labels.values().iter().zip(found.map.cells.values()) {
                assert_eq!(label != 0, value == Occupancy::Free);
            }
        }
    }
}

#[test]
fn name_seed_and_options_decide_the_bytes() {
    let bytes = |seed| files(&building(&plan(), Mapping::Slam, seed)).unwrap();
    assert_eq!(bytes(5), bytes(5));
    assert_ne!(bytes(5), bytes(6));
}

#[test]
fn what_is_no_plan_is_refused() {
    let text = include_str!("../plans/sample.xml");
    assert!(matches!(read_plan_xml("<building>"), Err(SurveyError::Text { .. })));
    assert!(matches!(read_plan_xml(&text.replace("real_distance", "length")), Err(SurveyError::Text { .. })));
    assert!(matches!(read_plan_xml(&text.replace(">90<", ">90000<")), Err(SurveyError::Scale { .. })));
    assert!(matches!(read_plan_xml(&text.replace(">90<", ">nan<")), Err(SurveyError::Scale { .. })));
    assert!(matches!(read_flat("{}"), Err(SurveyError::Text { .. })));
    let no_doors = r#"{"walls":[[0,0,9,0]],"doors":[],"rooms":[],"fixtures":[]}"#;
    assert!(matches!(read_flat(no_doors), Err(SurveyError::Scale { .. })));
    let no_portals = read_plan_xml(&text.replace("PORTAL", "WALL")).unwrap();
    let options = Options::default();
    assert!(matches!(generate_surveyed(&no_portals, "sample", 1, 0, &options), Err(SurveyError::Empty)));
}

/// Reads damaged text as a plan and as a flat, and draws what can be read.
fn read_and_draw(text: &str) {
    for survey in [read_plan_xml(text), read_flat(text)].into_iter().flatten() {
        let options = Options { mapping: Mapping::Clean, resolution_m: Some(0.2) };
        let _ = generate_surveyed(&survey, "damaged", 1, 0, &options);
    }
}

#[test]
fn damaged_plans_are_refused_or_drawn() {
    for text in [include_str!("../plans/sample.xml"), include_str!("../plans/sample.jsonl")] {
        for at in (0..text.len()).step_by(23) {
            read_and_draw(&text[..at]);
        }
        // Some digits are other ones: spaces overlap, doors stand nowhere.
        let digits: Vec<usize> = text.match_indices(|c: char| c.is_ascii_digit()).map(|(at, _)| at).collect();
        for at in digits.into_iter().step_by(101) {
            for digit in ["0", "9", "-1", "1e9"] {
                read_and_draw(&[&text[..at], digit, &text[at + 1..]].concat());
            }
        }
    }
    let many = format!("[{}]", vec!["[0,0,9,9]"; 20_001].join(","));
    let flat = format!(r#"{{"walls":{many},"doors":[[0,0,1,0]],"rooms":[],"fixtures":[]}}"#);
    assert!(matches!(read_flat(&flat), Err(SurveyError::TooMany { .. })));
}
