use super::{DoorwayConfig, mark};
use crate::grid::{Cell, CellGraph, Grid, Occupancy};
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

/// The cells marked as doorway where everything was labeled room.
fn doorways(graph: &CellGraph) -> Vec<Cell> {
    let field = LabelField::from_rows(3, [0.0, 1.0, 0.0].repeat(graph.n_nodes()));
    let labels = vec![ROOM; graph.n_nodes()];
    let marked = mark(graph, RESOLUTION_M, &field, &labels, &LabelSet::default(), &DoorwayConfig::default());
    let nodes = marked.iter().enumerate().filter(|(_, label)| **label == DOORWAY);
    nodes.map(|(node, _)| graph.cells()[node]).collect()
}

/// Two rooms of 4 m by 4 m, a wall of 0.2 m between them, open over `opening` rows from row 16.
fn two_rooms(opening: u32) -> CellGraph {
    map(82, 41, |x, y| (40..42).contains(&x) && !(16..16 + opening).contains(&y))
}

#[test]
fn a_door_is_marked_from_jamb_to_jamb_and_a_quarter_meter_to_both_sides() {
    let found = doorways(&two_rooms(9));
    let rows = (found.iter().map(|c| c.y).min(), found.iter().map(|c| c.y).max());
    assert_eq!(rows, (Some(16), Some(24)));
    let columns = (found.iter().map(|c| c.x).min().unwrap(), found.iter().map(|c| c.x).max().unwrap());
    assert!((37..=38).contains(&columns.0) && (43..=44).contains(&columns.1), "{columns:?}");
    assert_eq!(found.len() as u32, 9 * (columns.1 - columns.0 + 1), "a full rectangle");
}

#[test]
fn an_opening_wider_than_a_double_door_is_none() {
    assert_eq!(doorways(&two_rooms(24)), []);
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
    assert_eq!(mark(&graph, RESOLUTION_M, &field, &labels, &set, &DoorwayConfig::default()), labels);
}

#[test]
fn a_blob_around_a_doorway_joins_the_spaces_beside_it() {
    let graph = two_rooms(9);
    // The field would make a corridor of it.
    let field = LabelField::from_rows(3, [0.4, 0.0, 0.6].repeat(graph.n_nodes()));
    let labels: Vec<Label> =
        graph.cells().iter().map(|cell| if (30..52).contains(&cell.x) { DOORWAY } else { ROOM }).collect();
    let marked = mark(&graph, RESOLUTION_M, &field, &labels, &LabelSet::default(), &DoorwayConfig::default());
    assert_eq!(marked.iter().filter(|label| **label == DOORWAY).count(), doorways(&graph).len());
    assert!(marked.iter().all(|label| [ROOM, DOORWAY].contains(label)));
}

#[test]
fn what_lies_around_a_clean_doorway_takes_its_next_best_label() {
    let graph = two_rooms(9);
    let field = LabelField::from_rows(3, [0.1, 0.3, 0.6].repeat(graph.n_nodes()));
    let marked = mark(
        &graph,
        RESOLUTION_M,
        &field,
        &vec![DOORWAY; graph.n_nodes()],
        &LabelSet::default(),
        &DoorwayConfig::default(),
    );
    assert_eq!(marked.iter().filter(|label| **label == DOORWAY).count(), doorways(&graph).len());
    assert!(marked.iter().all(|label| [ROOM, DOORWAY].contains(label)));
}
