//! Openings and spaces of a map as objects.

use placegraph::geom::Point2;
use placegraph::grid::{Grid, Occupancy, OccupancyGrid};
use serde::Serialize;

use crate::plan::{Opening, OpeningKind, Plan};
use crate::shape::{Rect, across};
use crate::warp::Warp;

/// A door, or an opening without one, between two spaces of the plan.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OpeningRecord {
    /// `doorway`, or `opening` where two spaces meet without a doorway.
    pub kind: &'static str,
    /// From jamb to jamb in the middle of the wall: x and y of both ends, in pixels, y down; the center of the
    /// top left pixel is at (0, 0).
    pub line: [[f64; 2]; 2],
    /// Clear width.
    pub width_m: f64,
    /// Thickness of the wall.
    pub depth_m: f64,
    /// Numbers of the two spaces, as in the room image.
    pub spaces: [usize; 2],
    /// Their classes: `corridor`, `room` or `ambiguous`.
    pub classes: [&'static str; 2],
    /// Whether its leaves are shut, so that nobody passes.
    pub is_closed: bool,
    /// Number of leaves that stand at it.
    pub n_leaves: usize,
    /// Share of the gap that is free in the map, 0 where nobody looked.
    pub free_frac: f64,
}

/// A space of the plan.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SpaceRecord {
    /// Its value in the room image.
    pub id: usize,
    /// `corridor`, `room` or `ambiguous`.
    pub class: &'static str,
    /// What it is used for, in words of the plan.
    pub usage: String,
    /// Area of its free cells in the map, 0 if it was not mapped.
    pub area_m2: f64,
}

/// Openings and spaces of one map.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Record {
    /// All spaces of the plan.
    pub spaces: Vec<SpaceRecord>,
    /// All openings of the plan, closed ones and those that nobody mapped among them.
    pub openings: Vec<OpeningRecord>,
}

/// The objects of `plan` in `map`.
pub(crate) fn of(plan: &Plan, warp: &Warp, map: &OccupancyGrid, rooms: &Grid<u16>) -> Record {
    let mut n_cells = vec![0_u64; plan.spaces.len() + 1];
    rooms.values().iter().for_each(|&room| n_cells[usize::from(room)] += 1);
    let spaces = plan.spaces.iter().zip(1..).map(|(space, id)| SpaceRecord {
        id,
        class: space.class().name(),
        usage: format!("{:?}", space.usage).to_lowercase(),
        area_m2: rounded(n_cells[id] as f64 * map.frame.cell_area_m2(), 100.0),
    });
    let openings = plan.openings.iter().map(|opening| OpeningRecord {
        kind: if opening.kind == OpeningKind::Doorway { "doorway" } else { "opening" },
        line: opening.line().map(|end| in_pixels(warp.world_from_plan(end), map)),
        width_m: rounded(opening.width_m(), 1000.0),
        depth_m: rounded(opening.depth_m(), 1000.0),
        spaces: opening.spaces.map(|space| space + 1),
        classes: opening.spaces.map(|space| plan.spaces[space].class().name()),
        is_closed: opening.closed,
        n_leaves: opening.leaves.len(),
        free_frac: rounded(free_frac(opening, warp, map), 1000.0),
    });
    Record { spaces: spaces.collect(), openings: openings.collect() }
}

fn in_pixels(point: Point2, map: &OccupancyGrid) -> [f64; 2] {
    let cells = map.frame.cells_from_map(point);
    [rounded(cells.x - 0.5, 100.0), rounded(f64::from(map.cells.height()) - cells.y - 0.5, 100.0)]
}

/// The share of an even raster of points in the gap that lie on free cells.
fn free_frac(opening: &Opening, warp: &Warp, map: &OccupancyGrid) -> f64 {
    const ALONG: usize = 16;
    const ACROSS: usize = 3;
    let gap = opening.gap;
    let ((lo, hi), (from, to)) = (gap.span(opening.wall), gap.span(across(opening.wall)));
    let at = |low: f64, high: f64, k: usize, n: usize| low + (high - low) * (k as f64 + 0.5) / n as f64;
    let points = (0..ALONG * ACROSS).map(|k| {
        let (u, v) = (at(lo, hi, k % ALONG, ALONG), at(from, to, k / ALONG, ACROSS));
        warp.world_from_plan(opening.in_plan(Rect::along(opening.wall, (u, u), (v, v)).min))
    });
    let is_free = |point: &Point2| {
        let on_grid =
            |cell: &placegraph::grid::Cell| cell.x < map.cells.width() && cell.y < map.cells.height();
        map.frame.cell_at(*point).filter(on_grid).is_some_and(|cell| map.cells[cell] == Occupancy::Free)
    };
    points.filter(is_free).count() as f64 / (ALONG * ACROSS) as f64
}

fn rounded(value: f64, digits: f64) -> f64 {
    (value * digits).round() / digits
}
