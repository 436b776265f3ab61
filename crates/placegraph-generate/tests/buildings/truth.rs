//! The generated truth holds together: labels, rooms, doorways and the plan tell the same story.

use placegraph::grid::{Cell, Grid, Occupancy};
use placegraph_generate::{
    AMBIGUOUS, Building, CORRIDOR, DOORWAY, Mapping, OpeningKind, Options, ROOM, Style, generate,
};

const STYLES: [Style; 9] = [
    Style::Office,
    Style::Home,
    Style::Hospital,
    Style::Hotel,
    Style::School,
    Style::Warehouse,
    Style::Campus,
    Style::OpenOffice,
    Style::Flat,
];

fn series(mapping: Mapping, resolution_m: f64, count: u64) -> Vec<Building> {
    let options = Options { mapping, resolution_m: Some(resolution_m) };
    STYLES
        .iter()
        .flat_map(|&style| (0..count).map(move |index| generate(style, 20, index, &options)))
        .collect()
}

/// Connected sets (over sides) of cells with the label.
fn patches(labels: &Grid<u8>, label: u8) -> Vec<Vec<Cell>> {
    let mut seen = labels.map(|&value| value != label);
    let mut patches = Vec::new();
    for start in labels.cells() {
        if seen[start] {
            continue;
        }
        seen[start] = true;
        let mut patch = vec![start];
        let mut next = 0;
        while next < patch.len() {
            for step in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
                if let Some(cell) = labels.offset(patch[next], step).filter(|&cell| !seen[cell]) {
                    seen[cell] = true;
                    patch.push(cell);
                }
            }
            next += 1;
        }
        patches.push(patch);
    }
    patches
}

#[test]
fn labels_and_rooms_lie_on_free_cells_only_and_on_all_of_them() {
    for building in series(Mapping::Slam, 0.1, 2).iter().chain(&series(Mapping::Furnished, 0.1, 2)) {
        for cell in building.labels.cells() {
            let (label, room) = (building.labels[cell], building.rooms[cell]);
            let is_free = building.map.cells[cell] == Occupancy::Free;
            assert_eq!(is_free, label != 0);
            assert!(is_free || room == 0);
            if label == CORRIDOR || label == ROOM {
                let space = &building.plan.spaces[usize::from(room) - 1];
                assert_eq!(space.is_corridor(), label == CORRIDOR);
            }
        }
    }
}

#[test]
fn every_doorway_of_a_clean_map_touches_both_of_its_spaces() {
    for building in series(Mapping::Clean, 0.05, 4) {
        let doorways = building.plan.openings.iter().filter(|o| o.kind == OpeningKind::Doorway).count();
        let patches = patches(&building.labels, DOORWAY);
        assert_eq!(patches.len(), doorways, "{:?}", building.style);
        for patch in patches {
            let mut sides: Vec<u16> = patch
                .iter()
                .flat_map(|&cell| [(1, 0), (-1, 0), (0, 1), (0, -1)].map(|step| (cell, step)))
                .filter_map(|(cell, step)| building.labels.offset(cell, step))
                .filter(|&cell| matches!(building.labels[cell], CORRIDOR | ROOM))
                .map(|cell| building.rooms[cell])
                .collect();
            sides.sort_unstable();
            sides.dedup();
            assert!(sides.len() >= 2, "{:?} {:?}: {sides:?}", building.style, patch[0]);
        }
    }
}

#[test]
fn all_rooms_of_a_clean_map_can_be_reached() {
    for building in series(Mapping::Clean, 0.05, 4) {
        let free = building.map.cells.map(|&value| u8::from(value == Occupancy::Free));
        let patches = patches(&free, 1);
        let largest = patches.iter().max_by_key(|patch| patch.len()).unwrap();
        for (space, _) in building.plan.spaces.iter().enumerate() {
            let reached = largest.iter().any(|&cell| usize::from(building.rooms[cell]) == space + 1);
            assert!(reached, "{:?}: space {space} {:?}", building.style, building.plan.spaces[space]);
        }
    }
}

#[test]
fn doorways_in_the_raster_are_as_wide_and_deep_as_in_the_plan() {
    let cell_m = 0.025;
    let options = Options { mapping: Mapping::Clean, resolution_m: Some(cell_m) };
    for index in 0..4 {
        let building = generate(Style::Office, 4, index, &options);
        let expected: f64 = building
            .plan
            .openings
            .iter()
            .filter(|opening| opening.kind == OpeningKind::Doorway)
            .map(|opening| opening.strip().area())
            .sum();
        let cells = building.labels.map(|&label| u32::from(label == DOORWAY)).values().iter().sum::<u32>();
        let found = f64::from(cells) * cell_m * cell_m;
        // Jambs that are drawn over and rounding take a little.
        assert!((found / expected - 1.0).abs() < 0.1, "{found} m2 in the raster, {expected} m2 in the plan");
        for opening in building.plan.openings.iter().filter(|o| o.kind == OpeningKind::Doorway) {
            assert!((0.68..=2.0).contains(&opening.width_m()), "{}", opening.width_m());
        }
    }
}

#[test]
fn shares_of_the_classes_are_those_of_real_buildings() {
    // The real maps: doorways 0.5 to 4 %, corridors 7 to 39 %, means near 2.3 and 22 %.
    let options = Options { mapping: Mapping::Slam, resolution_m: Some(0.1) };
    let mut counts = [0.0; 256];
    for index in 0..24 {
        let style = [Style::Office, Style::Hospital, Style::School][index as usize % 3];
        let labels = generate(style, 7, index, &options).labels;
        let free = labels.values().iter().filter(|&&label| label != 0).count() as f64;
        for &label in labels.values().iter().filter(|&&label| label != 0) {
            counts[usize::from(label)] += 100.0 / free / 24.0;
        }
    }
    let share = |label: u8| counts[usize::from(label)];
    assert!((15.0..40.0).contains(&share(CORRIDOR)), "corridors {} %", share(CORRIDOR));
    assert!((1.0..3.5).contains(&share(DOORWAY)), "doorways {} %", share(DOORWAY));
    assert!(share(AMBIGUOUS) < 10.0, "ambiguous {} %", share(AMBIGUOUS));
}

#[test]
fn corridors_and_rooms_have_the_sizes_of_their_style() {
    let ranges = [
        (Style::Office, (1.2, 3.5), (6.0, 45.0)),
        (Style::Hospital, (1.9, 3.6), (4.0, 40.0)),
        (Style::Hotel, (1.2, 2.6), (3.0, 40.0)),
        (Style::School, (1.8, 5.0), (15.0, 80.0)),
    ];
    for (style, corridor_m, room_m2) in ranges {
        let (mut widths, mut areas) = (Vec::new(), Vec::new());
        for index in 0..12 {
            let plan =
                generate(style, 30, index, &Options { mapping: Mapping::Clean, resolution_m: Some(0.2) })
                    .plan;
            for (number, space) in plan.spaces.iter().enumerate() {
                let tiles = plan.tiles.iter().filter(|tile| tile.space == number);
                if space.is_corridor() {
                    widths.extend(tiles.map(|tile| tile.inner.width().min(tile.inner.height())));
                } else {
                    areas.push(tiles.map(|tile| tile.inner.area()).sum());
                }
            }
        }
        for (values, (low, high)) in [(&mut widths, corridor_m), (&mut areas, room_m2)] {
            values.sort_by(f64::total_cmp);
            let median = values[values.len() / 2];
            assert!((low..high).contains(&median), "{style:?}: median {median}");
            assert!(values[values.len() / 10] < values[values.len() * 9 / 10] * 0.8, "{style:?} varies");
        }
    }
}
