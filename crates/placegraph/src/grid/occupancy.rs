//! The occupancy grid map: free, occupied and unknown cells with their georeference.

use super::{Cell, Grid, MapFrame};
use crate::geom::Pose2;

/// The state of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Occupancy {
    /// The robot can be here.
    Free,
    /// A wall or another obstacle.
    Occupied,
    /// Never observed.
    Unknown,
}

/// A map: one [`Occupancy`] per cell, and where the cells are.
#[derive(Clone, Debug, PartialEq)]
pub struct OccupancyGrid {
    /// Where the cells are.
    pub frame: MapFrame,
    /// The states of the cells.
    pub cells: Grid<Occupancy>,
}

impl OccupancyGrid {
    /// Reads a drawing: `#` occupied, `.` free, `?` unknown; the first line is the map's top.
    ///
    /// Lines are trimmed and empty lines skipped, so that drawings can be indented. The origin
    /// is (0, 0, 0).
    ///
    /// # Panics
    /// If lines differ in length, another character occurs, or the resolution is not above 0: this is for
    /// examples and tests.
    ///
    /// # Examples
    /// ```
    /// use placegraph::grid::{Cell, Occupancy, OccupancyGrid};
    ///
    /// let map = OccupancyGrid::from_ascii(0.05, "#####\n#..?#\n#####");
    /// assert_eq!(map.cells[Cell::new(3, 1)], Occupancy::Unknown);
    /// ```
    pub fn from_ascii(resolution_m: f64, drawing: &str) -> Self {
        let cells = Grid::from_ascii(drawing, |character| match character {
            '.' => Occupancy::Free,
            '#' => Occupancy::Occupied,
            '?' => Occupancy::Unknown,
            other => panic!("expected one of . # ? in a drawing, found {other:?}"),
        });
        #[expect(clippy::expect_used, reason = "documented panic of a helper for examples")]
        let frame = MapFrame::new(resolution_m, Pose2::default()).expect("a resolution above 0");
        Self { frame, cells }
    }

    /// Whether `cell` is free.
    pub fn is_free(&self, cell: Cell) -> bool {
        self.cells[cell] == Occupancy::Free
    }

    /// Number of free, occupied and unknown cells.
    pub fn count(&self, occupancy: Occupancy) -> usize {
        self.cells.values().iter().filter(|&&value| value == occupancy).count()
    }
}
