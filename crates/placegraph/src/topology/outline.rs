//! Outlines of regions along the sides of their cells.
//!
//! Every boundary side is walked once with the region on its left. Regions are connected over corners too, so
//! an outline has a polygon for every part that is connected over sides; then no ring touches itself, and
//! rings touch each other at single points only. Cost: linear in nodes and boundary sides.

use super::PolygonWithHoles;
use crate::geom::Point2;
use crate::grid::{Cell, CellGraph, DiagonalSteps, FreeSpace, Runs, components};
use crate::regions::RegionMap;

/// The outline of every region, in the map frame: a polygon for every part that is connected over sides.
///
/// # Panics
/// If `regions` do not belong to `space`.
pub fn outlines(space: &FreeSpace, regions: &RegionMap) -> Vec<Vec<PolygonWithHoles>> {
    let FreeSpace { frame, graph } = space;
    let parts = Parts::new(graph, regions);
    let mut polygons: Vec<Option<PolygonWithHoles>> = vec![None; parts.region_of.len()];
    let mut is_walked = vec![false; graph.n_nodes()];
    for (node, cell) in graph.cells_in_rows(0..graph.height()).enumerate() {
        let part = parts.part_of[node];
        // Every ring has a side at the bottom of a cell.
        if is_walked[node] || parts.at(graph, cell.x as i64, cell.y as i64 - 1) == Some(part) {
            continue;
        }
        let ring = parts.ring(graph, cell, &mut is_walked).into_iter().map(|p| frame.map_from_cells(p));
        match &mut polygons[part as usize] {
            // The lowest side of a part is on its exterior.
            none @ None => *none = Some(PolygonWithHoles { exterior: ring.collect(), holes: Vec::new() }),
            Some(polygon) => polygon.holes.push(ring.collect()),
        }
    }
    let mut outlines = vec![Vec::new(); regions.regions.len()];
    for (polygon, &region) in polygons.into_iter().zip(&parts.region_of) {
        outlines[region as usize].extend(polygon);
    }
    outlines
}

/// The parts of regions that are connected over sides.
struct Parts {
    part_of: Vec<u32>,
    region_of: Vec<u32>,
}

impl Parts {
    fn new(graph: &CellGraph, regions: &RegionMap) -> Self {
        let runs = Runs::new(graph, |node| regions.region_of[node].0);
        let (part_of_run, n_parts) = components(&runs, DiagonalSteps::Never);
        let mut part_of = Vec::with_capacity(graph.n_nodes());
        let mut region_of = vec![0; n_parts];
        for (run, part) in runs.all().iter().zip(part_of_run) {
            part_of.resize(run.nodes().end, part);
            region_of[part as usize] = run.value;
        }
        Self { part_of, region_of }
    }

    /// The part in column `x` and row `y`, if that is a free cell.
    fn at(&self, graph: &CellGraph, x: i64, y: i64) -> Option<u32> {
        let inside = (0..graph.width() as i64).contains(&x) && (0..graph.height() as i64).contains(&y);
        let cell = inside.then(|| Cell::new(x as u32, y as u32))?;
        graph.node_at(cell).map(|node| self.part_of[node])
    }

    /// Walks around the part of `start` from the lower left corner of `start` along its lower side, and marks
    /// the cells of which it walks the lower side. Corners in cells: where the ring turns, and where another part begins or
    /// ends next to it, so that outlines that share a side share its ends, also after their points were turned and rounded.
    fn ring(&self, graph: &CellGraph, start: Cell, is_walked: &mut [bool]) -> Vec<Point2> {
        let first = (start.x as i64, start.y as i64);
        let part = self.at(graph, first.0, first.1);
        let mut corners = Vec::new();
        let (mut corner, mut ahead) = (first, (1, 0));
        loop {
            if ahead == (1, 0)
                && let Some(node) = graph.node_at(Cell::new(corner.0 as u32, corner.1 as u32))
            {
                is_walked[node] = true;
            }
            corner = (corner.0 + ahead.0, corner.1 + ahead.1);
            let (left, right) = ((-ahead.1, ahead.0), (ahead.1, -ahead.0));
            // The part in the cell ahead or behind on one side of the way: its lower left corner, seen from here.
            let at = |way: (i64, i64), side: (i64, i64)| {
                let x = corner.0 + (way.0 + side.0 - 1) / 2;
                let y = corner.1 + (way.1 + side.1 - 1) / 2;
                self.at(graph, x, y)
            };
            let (behind, beside) = ((-ahead.0, -ahead.1), at(ahead, right));
            let turned = match (at(ahead, left) == part, beside == part) {
                // Also where only the cell across the corner is of the part: it is reached, not cut off.
                (_, true) => right,
                (true, false) => ahead,
                (false, false) => left,
            };
            if turned != ahead || beside != at(behind, right) {
                corners.push(Point2::new(corner.0 as f64, corner.1 as f64));
            }
            ahead = turned;
            if corner == first && ahead == (1, 0) {
                corners.rotate_right(1);
                return corners;
            }
        }
    }
}
