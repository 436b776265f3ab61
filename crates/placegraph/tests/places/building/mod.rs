//! A small building for the tests of routes, exports and questions: three rooms along a corridor with an alcove.

#![allow(dead_code, reason = "every test file uses a part of it")]

use placegraph::geom::{Point2, Pose2};
use placegraph::grid::{Cell, CellGraph, FreeSpace, Grid, GridShape, MapFrame, Occupancy, OccupancyGrid};
use placegraph::labels::{Label, LabelField, LabelSet};
use placegraph::regions::{DiagonalSteps, RegionMap, connected};
use placegraph::topology::{Place, PlaceId, TopologicalMap, build, lay_routes};

/// A quarter of a meter a letter: c corridor, r room, d doorway, # wall, ? unknown. The second room is bent
/// around a closet, the third has a pillar.
pub(crate) const DRAWING: &str = "
    ????????????????????????????????????????????????
    ?##############################################?
    ?#rrrrrrrrrrrr#rrrrrrrrrrrrrrrrr#rrrrrrrrrrrrr#?
    ?#rrrrrrrrrrrr#rrrrrrrrrrrrrrrrr#rrrrrrrrrrrrr#?
    ?#rrrrrrrrrrrr#rrrrrrrrrrrrrrrrr#rrrrrrrrrrrrr#?
    ?#rrrrrrrrrrrr#rrrrrrrrrrrrrrrrr#rrrrr##rrrrrr#?
    ?#rrrrrrrrrrrr#rrrrrr######rrrrr#rrrrr##rrrrrr#?
    ?#rrrrrrrrrrrr#rrrrrr######rrrrrdrrrrrrrrrrrrr#?
    ?#rrrrrrrrrrrr#rrrrrr######rrrrrdrrrrrrrrrrrrr#?
    ?#rrrrrrrrrrrr#rrrrrr######rrrrrdrrrrrrrrrrrrr#?
    ?#rrrrrrrrrrrr#rrrrrr######rrrrr#rrrrrrrrrrrrr#?
    ?####ddd#########ddd###########################?
    ?#cccccccccccccccccccccccccccccccccccccccccccc#?
    ?#cccccccccccccccccccccccccccccccccccccccccccc#?
    ?#cccccccccccccccccccccccccccccccccccccccccccc#?
    ?#cccccccccccccccccccccccccccccccccccccccccccc#?
    ?#cccccccccccccccccccccccccccccccccccccccccccc#?
    ?##############################################?
    ????????????????????????????????????????????????
";

/// Cells a letter.
pub(crate) const SCALE: u32 = 5;

/// A map, its parts by class, and what was made of them.
pub(crate) struct Building {
    pub(crate) grid: OccupancyGrid,
    pub(crate) space: FreeSpace,
    pub(crate) labels: LabelSet,
    pub(crate) regions: RegionMap,
    pub(crate) map: TopologicalMap,
}

/// The drawn building with cells of 5 cm, its lower left corner at `map_from_grid`.
pub(crate) fn drawn(map_from_grid: Pose2) -> Building {
    from_drawing(DRAWING, map_from_grid)
}

/// Any drawing, every letter `SCALE` by `SCALE` cells of 5 cm.
pub(crate) fn from_drawing(drawing: &str, map_from_grid: Pose2) -> Building {
    let rows: Vec<&[u8]> =
        drawing.lines().map(|line| line.trim().as_bytes()).filter(|line| !line.is_empty()).collect();
    let (width, height) = (rows[0].len() as u32 * SCALE, rows.len() as u32 * SCALE);
    let letter = |cell: Cell| rows[rows.len() - 1 - (cell.y / SCALE) as usize][(cell.x / SCALE) as usize];
    let empty = Grid::filled(width, height, ());
    let letters = Grid::from_rows(width, height, empty.cells().map(letter).collect());
    from_letters(&letters, map_from_grid)
}

/// A letter per cell.
pub(crate) fn from_letters(letters: &Grid<u8>, map_from_grid: Pose2) -> Building {
    let cells = letters.map(|letter| match letter {
        b'#' => Occupancy::Occupied,
        b'?' => Occupancy::Unknown,
        _ => Occupancy::Free,
    });
    let grid = OccupancyGrid { frame: MapFrame::new(0.05, map_from_grid).unwrap(), cells };
    let labels = LabelSet::default();
    let graph = CellGraph::new(&grid.cells);
    let labeling: Vec<Label> = graph
        .cells()
        .iter()
        .map(|&cell| match letters[cell] {
            b'c' => Label(0),
            b'r' => Label(1),
            _ => Label(2),
        })
        .collect();
    let regions = connected(&graph, &labeling, DiagonalSteps::default());
    finish(grid, graph, labels, regions)
}

/// Builds the topological map of `regions`.
pub(crate) fn finish(
    grid: OccupancyGrid,
    graph: CellGraph,
    labels: LabelSet,
    regions: RegionMap,
) -> Building {
    let third = vec![1.0 / labels.len() as f32; labels.len() * graph.n_nodes()];
    let field = LabelField::from_rows(labels.len(), third);
    let space = FreeSpace { frame: grid.frame, graph };
    let mut map = build(&space, &field, &regions, &labels);
    lay_routes(&mut map, &space, &regions, 0.0);
    Building { grid, space, labels, regions, map }
}

impl Building {
    pub(crate) fn shape(&self) -> GridShape {
        GridShape::of(&self.grid)
    }

    /// The middle of the letter in column `x` and row `y` from below.
    pub(crate) fn at(&self, x: u32, y: u32) -> Point2 {
        let middle = |v: u32| (v as f64 + 0.5) * SCALE as f64;
        self.grid.frame.map_from_cells(Point2::new(middle(x), middle(y)))
    }

    /// The place there.
    pub(crate) fn place_at(&self, x: u32, y: u32) -> &Place {
        let cell = self.grid.frame.cell_at(self.at(x, y)).unwrap();
        let node = self.space.graph.node_at(cell).unwrap();
        self.map.place(PlaceId(self.regions.region_of[node].0 + 1)).unwrap()
    }
}
