//! Distances to the nearest cell that is not of a region, by looking at every cell.

use placegraph::grid::CellGraph;
use placegraph::regions::RegionMap;

/// Squared distance in cells from the center of `node` to the nearest center of a cell that is not of its
/// region; the map is surrounded by such cells.
pub fn squared_clearance(graph: &CellGraph, regions: &RegionMap, node: usize) -> i64 {
    let cell = graph.cells()[node];
    let (width, height) = (graph.width() as i32, graph.height() as i32);
    let mut nearest = i64::MAX;
    for y in -1..=height {
        for x in -1..=width {
            let step = (x - cell.x as i32, y - cell.y as i32);
            let other = graph.node_at_step(node, step);
            if other.is_none_or(|other| regions.region_of[other] != regions.region_of[node]) {
                nearest = nearest.min((step.0 as i64).pow(2) + (step.1 as i64).pow(2));
            }
        }
    }
    nearest
}
