//! Widths of doorways drawn at any angle, with clean and with ragged walls.

use placegraph::geom::{Point2, Pose2, Vec2};
use placegraph::grid::{CellGraph, FreeSpace, Grid, MapFrame, Occupancy};
use placegraph::labels::{Label, LabelField, LabelSet};
use placegraph::regions::{DiagonalSteps, connected};
use placegraph::topology::{Place, build};

const RESOLUTION_M: f64 = 0.05;
const SIDE_CELLS: u32 = 161;

/// A corridor (label 0) and a room (label 1), the wall between them with an opening (label 2).
struct Drawn {
    angle_deg: f64,
    width_m: f64,
    wall_m: f64,
    /// How far the doorway label reaches beyond the wall, on either side.
    spill_m: f64,
    /// How far walls vary from cell to cell.
    ragged_m: f64,
}

impl Drawn {
    /// The one doorway of the drawing, in a frame that is turned and moved.
    fn doorway(&self) -> Place {
        let frame = MapFrame::new(RESOLUTION_M, Pose2::new(3.0, -2.0, 0.4)).unwrap();
        let mut cells = Grid::filled(SIDE_CELLS, SIDE_CELLS, Occupancy::Free);
        let mut label_of = Grid::filled(SIDE_CELLS, SIDE_CELLS, Label(0));
        for cell in cells.cells() {
            let noise = self.ragged_m * ((cell.x * 7919 + cell.y * 104_729) % 17) as f64 / 16.0;
            let Vec2 { x: across, y: through } = self.position(Point2::new(cell.x as f64, cell.y as f64));
            let in_wall = through.abs() < self.wall_m / 2.0 + noise;
            let in_opening = across.abs() < self.width_m / 2.0 - noise;
            if in_wall && !in_opening || across.hypot(through) > 3.8 {
                cells[cell] = Occupancy::Occupied;
            }
            label_of[cell] = match through {
                _ if in_opening && through.abs() < self.wall_m / 2.0 + self.spill_m => Label(2),
                t if t < 0.0 => Label(0),
                _ => Label(1),
            };
        }
        let graph = CellGraph::new(&cells);
        let labels: Vec<Label> = graph.cells().iter().map(|&cell| label_of[cell]).collect();
        let regions = connected(&graph, &labels, DiagonalSteps::ThroughFree);
        let field = LabelField::from_rows(3, vec![1.0 / 3.0; 3 * graph.n_nodes()]);
        let map = build(&FreeSpace { frame, graph }, &field, &regions, &LabelSet::default());
        let largest = map.places.iter().filter(|place| place.doorway.is_some()).max_by_key(|p| p.n_cells);
        largest.expect("a doorway").clone()
    }

    /// Position of a cell's center from the middle of the opening: along the wall and through it, in meters.
    fn position(&self, corner: Point2) -> Vec2 {
        let middle = Point2::new(SIDE_CELLS as f64 / 2.0 + 0.3, SIDE_CELLS as f64 / 2.0 - 0.2);
        ((corner + Vec2::new(0.5, 0.5) - middle) * RESOLUTION_M).rotated(-self.angle_deg.to_radians())
    }
}

#[test]
fn widths_at_any_angle_are_within_one_and_a_half_cells() {
    for angle_deg in [0.0, 17.0, 30.0, 45.0, 73.0, 90.0, 135.0, 160.0] {
        for width_m in [0.7, 0.9, 1.2, 2.0] {
            for (wall_m, spill_m) in [(0.1, 0.0), (0.1, 0.15), (0.25, 0.0), (0.4, 0.1)] {
                let drawn = Drawn { angle_deg, width_m, wall_m, spill_m, ragged_m: 0.0 };
                let doorway = drawn.doorway().doorway.unwrap();
                let error_cells = (doorway.width_m - width_m) / RESOLUTION_M;
                assert!(
                    error_cells.abs() <= 1.5,
                    "angle {angle_deg}, width {width_m}, wall {wall_m}, spill {spill_m}: {error_cells:.2} cells"
                );
                assert_eq!(doorway.sides.len(), 2);
            }
        }
    }
}

#[test]
fn ragged_walls_narrow_a_doorway_by_what_stands_out() {
    for angle_deg in [0.0, 17.0, 45.0] {
        let drawn = Drawn { angle_deg, width_m: 1.0, wall_m: 0.2, spill_m: 0.05, ragged_m: 0.06 };
        let width_m = drawn.doorway().doorway.unwrap().width_m;
        assert!((0.8..=1.05).contains(&width_m), "angle {angle_deg}: {width_m:.3} m");
    }
}

#[test]
fn jambs_stand_on_both_sides_of_the_opening() {
    let drawn = Drawn { angle_deg: 17.0, width_m: 0.9, wall_m: 0.2, spill_m: 0.0, ragged_m: 0.0 };
    let frame = MapFrame::new(RESOLUTION_M, Pose2::new(3.0, -2.0, 0.4)).unwrap();
    let place = drawn.doorway();
    let mut across = place.doorway.unwrap().jambs.map(|jamb| {
        let Point2 { x, y } = frame.cells_from_map(jamb);
        let Vec2 { x: across, y: through } = drawn.position(Point2::new(x - 0.5, y - 0.5));
        assert!(through.abs() < 0.15, "in the wall: {through:.3} m");
        across
    });
    across.sort_by(f64::total_cmp);
    assert!((across[0] + 0.45).abs() < 0.08 && (across[1] - 0.45).abs() < 0.08, "{across:?}");
}
