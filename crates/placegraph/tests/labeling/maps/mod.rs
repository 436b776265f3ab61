//! Maps for the tests of scans and features: drawn, turned, and real ones.

#![allow(dead_code, unreachable_pub, reason = "every test file uses some of them")]
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests")]

pub mod bounds;

use std::path::PathBuf;

use placegraph::geom::Pose2;
use placegraph::grid::{Cell, Grid, MapFrame, Occupancy, OccupancyGrid};

/// The map called `name` in the folder of real maps, if the environment names that folder.
pub fn real(name: &str) -> Option<OccupancyGrid> {
    let Some(folder) = std::env::var_os("PLACEGRAPH_DATA") else {
        println!("skipped: PLACEGRAPH_DATA does not name the folder of real maps");
        return None;
    };
    let path = PathBuf::from(folder).join("eval").join(name).join("map.png");
    let image = image::open(path).unwrap().into_luma8();
    let rows = image.rows().rev().flat_map(|row| {
        row.map(|pixel| match pixel.0[0] {
            0 => Occupancy::Occupied,
            205 => Occupancy::Unknown,
            _ => Occupancy::Free,
        })
    });
    let cells = Grid::from_rows(image.width(), image.height(), rows.collect());
    Some(OccupancyGrid { frame: MapFrame::new(0.05, Pose2::default()).unwrap(), cells })
}

/// Two rooms, a corridor and a niche, at 30 cm a cell.
pub fn drawn() -> OccupancyGrid {
    OccupancyGrid::from_ascii(
        0.3,
        "
        ###########################################
        #.......#...................#.............#
        #.......#..#..............................#
        #...........................#.............#
        #.......#...................#.............#
        #.......############.########.....???.....#
        #.......................#.................#
        #.......................#.................#
        #..#....############.########.............#
        #.......#...................#.............#
        ###########################################
        ",
    )
}

/// The map turned counter-clockwise by 90°.
pub fn quarter_turn(grid: &OccupancyGrid) -> OccupancyGrid {
    let (width, height) = (grid.cells.width(), grid.cells.height());
    let mut cells = Grid::filled(height, width, Occupancy::Unknown);
    for cell in grid.cells.cells() {
        cells[quarter_turn_cell(grid, cell)] = grid.cells[cell];
    }
    OccupancyGrid { frame: grid.frame, cells }
}

/// Where `cell` goes when the map is turned.
pub fn quarter_turn_cell(grid: &OccupancyGrid, cell: Cell) -> Cell {
    Cell::new(grid.cells.height() - 1 - cell.y, cell.x)
}

/// The map mirrored left to right.
pub fn mirror(grid: &OccupancyGrid) -> OccupancyGrid {
    let mut cells = grid.cells.clone();
    for cell in grid.cells.cells() {
        cells[mirror_cell(grid, cell)] = grid.cells[cell];
    }
    OccupancyGrid { frame: grid.frame, cells }
}

/// Where `cell` goes when the map is mirrored.
pub fn mirror_cell(grid: &OccupancyGrid, cell: Cell) -> Cell {
    Cell::new(grid.cells.width() - 1 - cell.x, cell.y)
}
