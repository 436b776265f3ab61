use super::*;
use crate::geom::Pose2;
use crate::grid::{Cell, Grid, MapFrame, Occupancy};
use crate::labels::Role;
use crate::progress::Silent;

/// A map of free cells of 0.1 m where `is_free` says so, inside a wall.
fn map(width: u32, height: u32, is_free: impl Fn(Cell) -> bool) -> OccupancyGrid {
    let mut cells = Grid::filled(width, height, Occupancy::Occupied);
    for cell in cells.cells().collect::<Vec<_>>() {
        let is_inside = cell.x > 0 && cell.y > 0 && cell.x + 1 < width && cell.y + 1 < height;
        if is_inside && is_free(cell) {
            cells[cell] = Occupancy::Free;
        }
    }
    OccupancyGrid { frame: MapFrame::new(0.1, Pose2::default()).unwrap(), cells }
}

fn places(map: &OccupancyGrid) -> Vec<Role> {
    let analysis = analyze(map, &Model::builtin(), &Config::default(), &Silent);
    analysis.topology.places.iter().map(|place| place.role).collect()
}

#[test]
fn an_empty_hall_is_one_place() {
    for (width, height) in [(80, 80), (200, 100), (400, 150), (300, 200), (150, 400)] {
        let hall = map(width + 2, height + 2, |_| true);
        assert_eq!(places(&hall).len(), 1, "{width} x {height}");
    }
}

#[test]
fn rows_of_desks_do_not_make_a_hall_several_places() {
    // 20 m by 12 m, desks of 1.6 m by 0.8 m with lanes of 1 m between the rows.
    let is_desk = |cell: Cell| {
        (20..180).contains(&cell.x) && (15..105).contains(&cell.y) && cell.x % 20 < 16 && cell.y % 18 < 8
    };
    let hall = map(202, 122, |cell| !is_desk(cell));
    assert_eq!(places(&hall).len(), 1);
}
