use super::flood::{Flood, Window};
use super::gate::Narrow;
use super::{DoorwayConfig, Gate, GateModel, figure_table, gates, mark};
use crate::geom::{Point2, Pose2, Vec2};
use crate::grid::{Cell, CellGraph, FreeSpace, Grid, MapFrame, Occupancy};
use crate::labels::{Class, Label, LabelField, LabelSet, Role};

const RESOLUTION_M: f64 = 0.1;
const ROOM: Label = Label(1);
const DOORWAY: Label = Label(2);

/// A map of `width` by `height` cells of 0.1 m: walls where `is_wall` says so and along the border.
fn map(width: u32, height: u32, is_wall: impl Fn(u32, u32) -> bool) -> CellGraph {
    let border = |cell: Cell| cell.x == 0 || cell.y == 0 || cell.x + 1 == width || cell.y + 1 == height;
    let mut cells = Grid::filled(width, height, Occupancy::Free);
    for cell in cells.cells().collect::<Vec<_>>() {
        if border(cell) || is_wall(cell.x, cell.y) {
            cells[cell] = Occupancy::Occupied;
        }
    }
    CellGraph::new(&cells)
}

fn space(graph: &CellGraph) -> FreeSpace {
    FreeSpace { frame: MapFrame::new(RESOLUTION_M, Pose2::default()).unwrap(), graph: graph.clone() }
}

/// The cells marked as doorway where everything was labeled room.
fn doorways(graph: &CellGraph) -> Vec<Cell> {
    let field = LabelField::from_rows(3, [0.0, 1.0, 0.0].repeat(graph.n_nodes()));
    let labels = vec![ROOM; graph.n_nodes()];
    let marked =
        mark(&space(graph), [&field; 2], &labels, &LabelSet::default(), &DoorwayConfig::default(), None)
            .labeling;
    let nodes = marked.iter().enumerate().filter(|(_, label)| **label == DOORWAY);
    nodes.map(|(node, _)| graph.cells()[node]).collect()
}

/// Two rooms of 4 m by 4 m, a wall of 0.2 m between them, open over `opening` rows from row 16.
fn two_rooms(opening: u32) -> CellGraph {
    map(82, 41, |x, y| (40..42).contains(&x) && !(16..16 + opening).contains(&y))
}

#[test]
fn a_door_is_marked_from_jamb_to_jamb_and_beside_the_wall() {
    let found = doorways(&two_rooms(9));
    let rows = (found.iter().map(|c| c.y).min(), found.iter().map(|c| c.y).max());
    assert_eq!(rows, (Some(15), Some(25)), "a cell more at both jambs, in front of the wall");
    let columns = (found.iter().map(|c| c.x).min().unwrap(), found.iter().map(|c| c.x).max().unwrap());
    assert!((37..=38).contains(&columns.0) && (43..=44).contains(&columns.1), "{columns:?}");
    let n_columns = columns.1 - columns.0 + 1;
    assert_eq!(found.len() as u32, 9 * 2 + 11 * (n_columns - 2), "full rectangles in the wall and beside it");
}

#[test]
fn an_opening_wider_than_a_double_door_is_none() {
    assert_eq!(doorways(&two_rooms(27)), []);
}

#[test]
fn a_gap_narrower_than_a_robot_is_none() {
    assert_eq!(doorways(&two_rooms(3)), []);
}

#[test]
fn a_gap_beside_furniture_is_none_where_one_can_walk_around_it() {
    let shelf = map(62, 62, |x, y| (28..34).contains(&x) && (10..24).contains(&y));
    assert_eq!(doorways(&shelf), []);
}

#[test]
fn a_narrow_corridor_is_none() {
    let corridor = map(122, 41, |x, y| (40..82).contains(&x) && !(16..25).contains(&y));
    assert_eq!(doorways(&corridor), []);
}

#[test]
fn a_door_in_a_slanted_wall_is_found() {
    // The wall along x + y = 80, three cells thick; the opening around its middle.
    let graph = map(80, 80, |x, y| {
        let (along, across) = (i64::from(x) - i64::from(y), i64::from(x) + i64::from(y) - 79);
        across.abs() <= 2 && along.abs() > 6
    });
    let found = doorways(&graph);
    assert!(!found.is_empty());
    assert!(found.iter().all(|c| c.x.abs_diff(c.y) <= 8 && (c.x + c.y).abs_diff(79) <= 12), "{found:?}");
}

#[test]
fn without_a_doorway_class_nothing_changes() {
    let graph = two_rooms(9);
    let class = |name: &str| Class { name: name.into(), role: Role::Place, color: [0; 3] };
    let set = LabelSet::new(vec![class("a"), class("b")]).unwrap();
    let field = LabelField::from_rows(2, [0.5, 0.5].repeat(graph.n_nodes()));
    let labels = vec![Label(1); graph.n_nodes()];
    assert_eq!(
        mark(&space(&graph), [&field; 2], &labels, &set, &DoorwayConfig::default(), None).labeling,
        labels
    );
}

#[test]
fn what_is_no_doorway_takes_its_next_best_label() {
    let graph = two_rooms(9);
    let field = LabelField::from_rows(3, [0.1, 0.3, 0.6].repeat(graph.n_nodes()));
    let everything = vec![DOORWAY; graph.n_nodes()];
    let config = DoorwayConfig::default();
    let marked = mark(&space(&graph), [&field; 2], &everything, &LabelSet::default(), &config, None).labeling;
    assert_eq!(marked.iter().filter(|label| **label == DOORWAY).count(), doorways(&graph).len());
    assert!(marked.iter().all(|label| [ROOM, DOORWAY].contains(label)));
}

#[test]
fn a_chair_in_a_door_does_not_hide_it() {
    let blocked = map(82, 41, |x, y| {
        (40..42).contains(&x) && !(16..26).contains(&y) || (40..43).contains(&x) && (19..22).contains(&y)
    });
    let found = doorways(&blocked);
    assert!(found.iter().any(|c| c.y < 19) && found.iter().any(|c| c.y > 21), "{found:?}");
}

/// The gate of two rooms of 4 m by 6 m, 0.9 m wide in a wall of 0.2 m, where the left side is corridor.
fn gate_of_two_rooms() -> Gate {
    let graph = two_rooms(9);
    let rows =
        graph.cells().iter().flat_map(|cell| if cell.x < 41 { [0.9, 0.1, 0.0] } else { [0.1, 0.8, 0.1] });
    let field = LabelField::from_rows(3, rows.collect());
    let mut gates = gates(&space(&graph), [&field; 2], &LabelSet::default(), &DoorwayConfig::default());
    assert_eq!(gates.len(), 1, "{gates:?}");
    gates.remove(0)
}

#[test]
fn figures_of_a_gate_by_hand() {
    let gate = gate_of_two_rooms();
    assert!((gate.width_cells() - 9.0).abs() < 1e-9 && (gate.depth_cells() - 2.0).abs() < 1.0, "{gate:?}");
    let value = |name: &str| {
        let at = figure_table().iter().position(|figure| figure.0 == name).unwrap();
        gate.figures[at] as f64
    };
    let is = |name: &str, expected: f64, within: f64| {
        assert!((value(name) - expected).abs() <= within, "{name}: {} instead of {expected}", value(name));
    };
    is("width", 0.9, 1e-6);
    is("difference_scans", 0.8, 1e-6);
    is("passage_low_scans", 0.1, 1e-6);
    is("passage_high_smoothed", 0.9, 1e-6);
    is("beside_high_scans", 0.1, 1e-6);
    is("bypass", 6.0, 1e-6);
    is("jamb", 3.0, 1e-6);
    is("inline_low", 1.0, 1e-6);
    is("thickness", 0.2, 0.11);
    is("clutter", 0.0, 1e-6);
    is("turn", 0.0, 0.05);
    // 3.9 m to the border from the wall, and half of the wall.
    is("sight_low", 4.0, 0.15);
    // Both ends of the room's wall, 1.6 m and 1.5 m from the jambs.
    is("span02_near_low", 2.0 / 0.5, 0.3);
}

#[test]
fn every_figure_is_finite_and_named_once() {
    let table = figure_table();
    let mut names: Vec<&str> = table.iter().map(|figure| figure.0).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), table.len());
    assert!(gate_of_two_rooms().figures.iter().all(|value| value.is_finite()));
}

#[test]
fn the_page_lists_every_figure() {
    let row = |(name, about): &(&str, &str)| format!("| `{name}` | {about} |");
    let rows = figure_table().iter().map(row).collect::<Vec<_>>().join("\n") + "\n";
    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/gates.md")).unwrap();
    assert!(page.ends_with(&rows), "docs/gates.md should end with\n{rows}");
}

#[test]
fn a_model_of_gates_is_read_as_it_was_written() {
    let model = GateModel::builtin();
    assert_eq!(GateModel::from_json(&model.to_json()).unwrap(), model);
    let text = String::from_utf8(model.to_json()).unwrap();
    for (from, to) in [
        ("placegraph-gates", "placegraph-model"),
        ("\"version\":1", "\"version\":2"),
        ("\"line_scans\"", "\"lines\""),
        ("\"slope\":", "\"slope\":1e999,\"x\":"),
    ] {
        assert!(text.contains(from), "{from}");
        assert!(GateModel::from_json(text.replacen(from, to, 1).as_bytes()).is_err(), "{from}");
    }
}

#[test]
fn walks_measure_both_sides_of_a_gate_and_the_way_around() {
    // A wall with a door of 5 cells in rows 8 to 12, its upper end 4 cells on, in a hall of 40 x 38 free cells.
    let graph = map(42, 40, |x, y| x == 20 && y < 17 && !(8..13).contains(&y));
    let gate =
        Narrow { center: Point2::new(20.5, 10.5), across: Vec2::new(0.0, 1.0), width: 6.0, depth: 1.0 };
    let window = Window::around(&graph, &gate, 30);
    let mut floods = [1.0, -1.0].map(|direction| Flood::from(&graph, &gate, direction, &window));
    for flood in &mut floods {
        flood.advance(&window, 30);
    }
    // From row 12 up to row 16, with a diagonal step onto the end of the wall and one down from it: 6 steps up to
    // the end, 6 down.
    assert_eq!(Flood::meeting(&floods), Some(10));
    // Five cells beside the line; with the first step, to 8-neighbors, two above and below them and seven in the next
    // column; with the second, to 4-neighbors, two at both ends and seven in the column after that.
    let n_at = |steps: u32| floods[0].visited(&window).filter(|visit| visit.1 == steps).count();
    assert_eq!([n_at(0), n_at(1), n_at(2)], [5, 9, 11]);
}

#[test]
fn the_widest_door_is_that_of_the_configuration() {
    // An opening of 0.9 m.
    let graph = two_rooms(9);
    let field = LabelField::from_rows(3, [0.0, 1.0, 0.0].repeat(graph.n_nodes()));
    let labels = vec![ROOM; graph.n_nodes()];
    let n_marked = |max_width_m| {
        let config = DoorwayConfig { max_width_m, ..DoorwayConfig::default() };
        let marked = mark(&space(&graph), [&field; 2], &labels, &LabelSet::default(), &config, None).labeling;
        marked.into_iter().filter(|&label| label == DOORWAY).count()
    };
    assert_eq!(n_marked(0.8), 0);
    assert!(n_marked(1.0) > 0);
}

#[test]
fn a_doorway_that_was_there_needs_less_evidence_and_a_new_one_more() {
    let graph = two_rooms(9);
    let (space, set) = (space(&graph), LabelSet::default());
    let field = LabelField::from_rows(3, [0.0, 1.0, 0.0].repeat(graph.n_nodes()));
    let labels = vec![ROOM; graph.n_nodes()];
    // No gate is one by its form, and the most probable one has this probability.
    let learned = DoorwayConfig { min_well_formed: 2.0, min_learned_cells: 0.0, ..DoorwayConfig::default() };
    let found = gates(&space, [&field; 2], &set, &learned);
    let most = found.iter().map(|gate| learned.model.doorway.probability(&gate.figures)).fold(0.0, f64::max);
    let is_marked = |more: f64, held: Option<Label>| {
        let config = DoorwayConfig { min_doorway: most + more, ..learned.clone() };
        let held = held.map(|label| vec![Some(label); graph.n_nodes()]);
        let marked = mark(&space, [&field; 2], &labels, &set, &config, held.as_deref());
        marked.labeling.contains(&DOORWAY)
    };
    let DoorwayConfig { held_lead, new_lag, .. } = learned;
    assert_eq!([is_marked(0.01, None), is_marked(-0.01, None)], [false, true]);
    let doorway = [held_lead - 0.01, held_lead + 0.01].map(|more| is_marked(more, Some(DOORWAY)));
    assert_eq!(doorway, [true, false], "it was a doorway");
    let room = [-new_lag - 0.01, -new_lag + 0.01].map(|more| is_marked(more, Some(ROOM)));
    assert_eq!(room, [true, false], "it was none");
    let nothing = vec![None; graph.n_nodes()];
    let config = DoorwayConfig { min_doorway: most - 0.01, ..learned.clone() };
    let marked = mark(&space, [&field; 2], &labels, &set, &config, Some(&nothing));
    assert!(marked.labeling.contains(&DOORWAY), "cells that are new");
}
