//! The cell of every region that is farthest from all cells that are not the region's.
//!
//! An exact Euclidean distance transform of all regions at once: down the columns, then along the runs of the
//! rows [Meijster, Roerdink, Hesselink 2000]. Cost: linear in nodes.

use crate::geom::Point2;
use crate::grid::CellGraph;
use crate::regions::{RegionMap, Runs};

/// The node of every region with the largest distance to the nearest center of a cell of another region, of
/// a cell that is not free, or beyond the map. Ties go to the node nearest the region's centroid, then to the
/// first. `centroids` are in cells.
pub(super) fn anchors(graph: &CellGraph, regions: &RegionMap, centroids: &[Point2]) -> Vec<usize> {
    let along_column = column_distances(graph, regions);
    let mut best = vec![(0, f64::INFINITY, 0); regions.regions.len()];
    let mut row = RowPass::default();
    for run in Runs::new(graph, |node| regions.region_of[node].0).all() {
        let region = run.value as usize;
        let squared = row.squared_distances(&along_column[run.nodes()]);
        for ((&squared, node), x) in squared.iter().zip(run.nodes()).zip(run.start..) {
            if squared < best[region].0 {
                continue;
            }
            let center = Point2::new(x as f64 + 0.5, run.y as f64 + 0.5);
            let from_centroid = center.distance(centroids[region]);
            if squared > best[region].0 || from_centroid < best[region].1 {
                best[region] = (squared, from_centroid, node);
            }
        }
    }
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
                    nearest = nearest.min(beside(step.0).hypot(beside(step.1)));
                }
            }
        }
        radius += 1;
    }
    nearest
}

/// Distance of every node to the nearest cell of its column that is not of its region.
fn column_distances(graph: &CellGraph, regions: &RegionMap) -> Vec<u32> {
    let same = |node: usize, step| {
        graph.node_at_step(node, step).filter(|&next| regions.region_of[next] == regions.region_of[node])
    };
    let mut distances = vec![1; graph.n_nodes()];
    for node in 0..graph.n_nodes() {
        if let Some(below) = same(node, (0, -1)) {
            distances[node] = distances[below] + 1;
        }
    }
    for node in (0..graph.n_nodes()).rev() {
        distances[node] = distances[node].min(same(node, (0, 1)).map_or(1, |above| distances[above] + 1));
    }
    distances
}

/// The second pass, with its memory.
#[derive(Default)]
struct RowPass {
    squared: Vec<i64>,
    /// Columns whose parabolas form the lower envelope, and where each begins to be the lowest.
    envelope: Vec<(i64, i64)>,
}

impl RowPass {
    /// For the cells of a run with column distances g, the least of (x − u)² + g(u)² over all cells u of the
    /// run and the two cells beside it, where g is 0. Cells farther along the row are never nearer.
    fn squared_distances(&mut self, along_column: &[u32]) -> &[i64] {
        // Positions 0 and `end` are the cells beside the run.
        let end = along_column.len() as u32 as i64 + 1;
        let squared_g = |u: i64| match u {
            0 => 0,
            u if u == end => 0,
            u => (along_column[u as usize - 1] as i64).pow(2),
        };
        let value = |x: i64, u: i64| (x - u).pow(2) + squared_g(u);
        self.envelope.clear();
        self.envelope.push((0, 0));
        for u in 1..=end {
            while self.envelope.last().is_some_and(|&(lower, begin)| value(begin, lower) > value(begin, u)) {
                self.envelope.pop();
            }
            let begin = self.envelope.last().map_or(0, |&(i, _)| {
                (u * u - i * i + squared_g(u) - squared_g(i)).div_euclid(2 * (u - i)) + 1
            });
            if begin <= end {
                self.envelope.push((u, begin));
            }
        }
        self.squared.clear();
        let mut current = 0;
        for x in 1..end {
            while self.envelope.get(current + 1).is_some_and(|&(_, begin)| begin <= x) {
                current += 1;
            }
            self.squared.push(value(x, self.envelope[current].0));
        }
        &self.squared
    }
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
        assert_eq!(graph.cells()[anchor], Cell::new(2, 1));
        assert!((clearance_cells(&graph, &regions, anchor) - 1.5).abs() < 1e-12);
    }
}
