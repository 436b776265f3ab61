//! The cell of every region that is farthest from all cells outside of the region.
//!
//! An exact Euclidean distance transform of all regions at once: down the columns, then along the runs of the
//! rows [Meijster, Roerdink, Hesselink 2000]. Cost: linear in nodes.

use crate::geom::{Point2, Vec2};
use crate::grid::{CellGraph, squared_clearances};
use crate::regions::RegionMap;

/// The node of every region with the largest distance to the nearest center of a cell of another region, of
/// a cell that is not free, or beyond the map. Ties go to the node nearest the region's centroid, then to the
/// first. `centroids` are in cells.
pub(super) fn anchors(graph: &CellGraph, regions: &RegionMap, centroids: &[Point2]) -> Vec<usize> {
    let mut best = vec![(0, f64::INFINITY, 0); regions.regions.len()];
    let same_region = |a: usize, b: usize| regions.region_of[a] == regions.region_of[b];
    squared_clearances(graph, same_region, |first, run| {
        let region = regions.region_of[first].index();
        for (node, &squared) in (first..).zip(run) {
            if squared < best[region].0 {
                continue;
            }
            let from_centroid = graph.cell(node).center().distance(centroids[region]);
            if squared > best[region].0 || from_centroid < best[region].1 {
                best[region] = (squared, from_centroid, node);
            }
        }
    });
    best.into_iter().map(|(_, _, node)| node).collect()
}

/// Distance from the center of `node` to the nearest side of a cell that is not of its region, in cells.
/// Cost: the square of the answer.
pub(super) fn clearance_cells(graph: &CellGraph, regions: &RegionMap, node: usize) -> f64 {
    let own = regions.region_of[node];
    let is_own = |step| graph.node_at_step(node, step).is_some_and(|other| regions.region_of[other] == own);
    let mut nearest = f64::INFINITY;
    let mut radius = 1;
    // Cells on the square ring of this radius are at least radius − ½ away.
    while radius as f64 - 0.5 < nearest {
        for along in -radius..=radius {
            for step in [(along, -radius), (along, radius), (-radius, along), (radius, along)] {
                if !is_own(step) {
                    let beside = |d: i32| (d.abs() as f64 - 0.5).max(0.0);
                    nearest = nearest.min(Vec2::new(beside(step.0), beside(step.1)).length());
                }
            }
        }
        radius += 1;
    }
    nearest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Cell, OccupancyGrid};
    use crate::labels::Label;
    use crate::regions::{DiagonalSteps, connected};

    #[test]
    fn the_anchor_of_a_bent_room() {
        let map = OccupancyGrid::from_ascii(
            1.0,
            "
            ..###
            .....
            .....
            .....
            ",
        );
        let graph = CellGraph::new(&map.cells);
        let regions = connected(&graph, &[Label(0); 17], DiagonalSteps::ThroughFree);
        // Distance 2 in the middle row; (2, 1) is nearest to the centroid.
        let anchor = anchors(&graph, &regions, &[Point2::new(2.2, 1.7)])[0];
        assert_eq!(graph.cell(anchor), Cell::new(2, 1));
        assert!((clearance_cells(&graph, &regions, anchor) - 1.5).abs() < 1e-12);
    }
}
