use super::gate::Gate;
use super::saddles::squared_clearance;
use super::sides::{Sides, Walks};
use super::{DoorwayConfig, mark};
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
    let marked = mark(&space(graph), &field, &labels, &LabelSet::default(), &DoorwayConfig::default());
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
    assert_eq!(mark(&space(&graph), &field, &labels, &set, &DoorwayConfig::default()), labels);
}

#[test]
fn what_is_no_doorway_takes_its_next_best_label() {
    let graph = two_rooms(9);
    let field = LabelField::from_rows(3, [0.1, 0.3, 0.6].repeat(graph.n_nodes()));
    let everything = vec![DOORWAY; graph.n_nodes()];
    let config = DoorwayConfig::default();
    let marked = mark(&space(&graph), &field, &everything, &LabelSet::default(), &config);
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

/// Two rooms joined by a door in a wall that one can walk around: 2.5 m from the middle of the door to the end of the
/// wall, where an opening too wide for a door begins.
fn screen() -> CellGraph {
    map(82, 62, |x, y| (40..42).contains(&x) && y < 32 && !(4..13).contains(&y))
}

#[test]
fn a_plausible_gate_is_a_doorway_where_the_labels_support_it() {
    let graph = screen();
    assert_eq!(doorways(&graph), [], "both sides are one room");
    let rows =
        graph.cells().iter().flat_map(|cell| if cell.x < 41 { [0.9, 0.1, 0.0] } else { [0.1, 0.9, 0.0] });
    let field = LabelField::from_rows(3, rows.collect());
    let labels = field.most_likely();
    let config = DoorwayConfig::default();
    let marked = mark(&space(&graph), &field, &labels, &LabelSet::default(), &config);
    let n_doorway = marked.iter().filter(|label| **label == DOORWAY).count();
    assert!(n_doorway >= 9 * 5, "a corridor on one side, a room on the other: {n_doorway}");
    let undecided = LabelField::from_rows(3, [0.5, 0.5, 0.0].repeat(graph.n_nodes()));
    let marked = mark(&space(&graph), &undecided, &labels, &LabelSet::default(), &config);
    assert!(marked.iter().all(|label| *label != DOORWAY));
}

#[test]
fn walks_measure_both_sides_of_a_gate_and_the_way_around() {
    // A wall with a door of 5 cells in rows 8 to 12, its upper end 4 cells on, in a hall of 40 x 38 free cells.
    let graph = map(42, 40, |x, y| x == 20 && y < 17 && !(8..13).contains(&y));
    let clearance = squared_clearance(&graph);
    let gate = Gate { center: Point2::new(20.5, 10.5), across: Vec2::new(0.0, 1.0), width: 6.0, depth: 1.0 };
    let walks = Walks { near: 1.0, far: 2.0, labels: (0.5, 1.5), bypass: 60.0 };
    let mut sides = Sides::of(&graph, &clearance, &gate, &walks);
    let [left, right] = sides.near();
    let bypass = sides.bypass();
    // From row 12 up to row 16, with a diagonal step onto the end of the wall and one down from it: 6 steps up to
    // the end, 6 down.
    assert!((bypass - 10.0).abs() < 1e-12, "{bypass}");
    assert_eq!(left.near_clearance, right.near_clearance);
    assert!(left.far_clearance > left.near_clearance);
    // Five cells beside the line; with the first step, to 8-neighbors, two above and below them and seven in the next
    // column; with the second, to 4-neighbors, two at both ends and seven in the column after that.
    assert_eq!(left.label_nodes.len(), 9);
    assert_eq!(left.n_cells, 5 + 9 + 11);
}

#[test]
fn the_widest_door_is_that_of_the_configuration() {
    // An opening of 1.5 m.
    let graph = two_rooms(15);
    let field = LabelField::from_rows(3, [0.0, 1.0, 0.0].repeat(graph.n_nodes()));
    let labels = vec![ROOM; graph.n_nodes()];
    let n_marked = |max_width_m| {
        let config = DoorwayConfig { max_width_m, ..DoorwayConfig::default() };
        let marked = mark(&space(&graph), &field, &labels, &LabelSet::default(), &config);
        marked.into_iter().filter(|&label| label == DOORWAY).count()
    };
    assert_eq!(n_marked(1.4), 0);
    assert!(n_marked(1.6) > 0);
}
