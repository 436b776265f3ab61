//! The map of the benches, at any size.
#![allow(dead_code, reason = "every bench uses a part of it")]

use placegraph::geom::Pose2;
use placegraph::grid::{Cell, Grid, MapFrame, Occupancy, OccupancyGrid};

/// Columns and rows from wall to wall.
const ROOM: (u32, u32) = (90, 70);

/// Rooms of 4.5 × 3.5 m with doors and a few obstacles, at 5 cm a cell, `width` columns and three quarters as many rows.
pub(crate) fn office(width: u32) -> OccupancyGrid {
    let height = width * 3 / 4;
    let mut cells = Grid::filled(width, height, Occupancy::Free);
    for cell in cells.clone().cells() {
        let border = cell.x == 0 || cell.y == 0 || cell.x == width - 1 || cell.y == height - 1;
        let obstacle = (cell.x * 7919 + cell.y * 104_729) % 997 == 0;
        if border || obstacle || is_on_wall_line(cell) && !is_door(cell) {
            cells[cell] = Occupancy::Occupied;
        }
    }
    OccupancyGrid { frame: MapFrame::new(0.05, Pose2::default()).unwrap(), cells }
}

fn is_on_wall_line(cell: Cell) -> bool {
    cell.x.is_multiple_of(ROOM.0) || cell.y.is_multiple_of(ROOM.1)
}

/// Whether a cell on the line of a wall lies in a door.
pub(crate) fn is_door(cell: Cell) -> bool {
    let (column, row) = (cell.x % ROOM.0, cell.y % ROOM.1);
    column == 0 && (20..38).contains(&row) || row == 0 && (40..58).contains(&column)
}

/// Writes labels for `peers/components.py` to the folder named by `PLACEGRAPH_DUMP`, a byte a cell: 0 is a wall.
pub(crate) fn dump(width: u32, height: u32, labels: &[u8]) {
    if let Ok(folder) = std::env::var("PLACEGRAPH_DUMP") {
        std::fs::write(format!("{folder}/{width}x{height}.cells"), labels).unwrap();
    }
}
