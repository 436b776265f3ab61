//! The regions that touch, the length of their contact in cell sides, and its position (Sect. 4.7).
//!
//! Cost: linear in runs, plus a sort of the touching pairs.

use super::{RegionId, RegionMap};
use crate::geom::Point2;
use crate::grid::{CellGraph, Runs};

/// Two regions that touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The region with the lower id.
    pub a: RegionId,
    /// The region with the higher id.
    pub b: RegionId,
    /// Number of pairs of cells that share a side; 0 if the regions touch only at corners.
    pub n_sides: u32,
    /// Mean of the common border, in cells from the lower left corner of the grid.
    pub mean: Point2,
    /// The point of the common border nearest to its mean, in cells.
    pub middle: Point2,
}

/// A stretch of the border between two regions, in cells.
#[derive(Clone, Copy)]
struct Stretch {
    pair: [RegionId; 2],
    n_sides: u32,
    from: Point2,
    to: Point2,
}

/// The pairs of regions with neighboring cells, by ids. Cells are neighbors as in the regions themselves, see
/// [`RegionMap::diagonal`].
pub fn contacts(graph: &CellGraph, regions: &RegionMap) -> Vec<Contact> {
    let runs = Runs::new(graph, |node| regions.region_of[node].0);
    let mut stretches = Vec::new();
    runs.for_each_touch(regions.diagonal, |touch| {
        let [a, b] = touch.runs.map(|run| RegionId(runs.all()[run].value));
        if a != b {
            let [from, to] = [touch.from, touch.to].map(|(x, y)| Point2::new(x as f64, y as f64));
            stretches.push(Stretch { pair: [a.min(b), a.max(b)], n_sides: touch.n_sides(), from, to });
        }
    });
    stretches.sort_by_key(|stretch| stretch.pair);
    stretches.chunk_by(|first, second| first.pair == second.pair).map(contact).collect()
}

/// The contact that consists of `stretches`.
fn contact(stretches: &[Stretch]) -> Contact {
    let [a, b] = stretches[0].pair;
    let n_sides = stretches.iter().map(|stretch| stretch.n_sides).sum();
    // Corners count only where there is nothing else.
    let weight = |stretch: &Stretch| if n_sides == 0 { 1.0 } else { stretch.n_sides as f64 };
    let (mut x, mut y, mut total) = (0.0, 0.0, 0.0);
    for stretch in stretches {
        let center = stretch.from.midpoint(stretch.to);
        x += weight(stretch) * center.x;
        y += weight(stretch) * center.y;
        total += weight(stretch);
    }
    let mean = Point2::new(x / total, y / total);
    let middle = stretches
        .iter()
        .filter(|stretch| weight(stretch) > 0.0)
        .map(|stretch| {
            let Stretch { from, to, .. } = stretch;
            Point2::new(mean.x.clamp(from.x, to.x), mean.y.clamp(from.y, to.y))
        })
        .min_by(|first, second| first.distance(mean).total_cmp(&second.distance(mean)))
        .unwrap_or(mean);
    Contact { a, b, n_sides, mean, middle }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::OccupancyGrid;
    use crate::labels::Label;
    use crate::regions::{DiagonalSteps, connected};

    #[test]
    fn a_bent_border_by_hand() {
        let map = OccupancyGrid::from_ascii(1.0, "...\n...\n");
        let graph = CellGraph::new(&map.cells);
        // Upper row: 1 1 1, lower row: 0 0 1.
        let labels = [0, 0, 1, 1, 1, 1].map(Label);
        let regions = connected(&graph, &labels, DiagonalSteps::ThroughFree);
        let contact = contacts(&graph, &regions)[0];
        assert_eq!((contact.a, contact.b, contact.n_sides), (RegionId(0), RegionId(1), 3));
        // Sides centered at (2, 0.5), (0.5, 1) and (1.5, 1).
        assert!(contact.mean.distance(Point2::new(4.0 / 3.0, 2.5 / 3.0)) < 1e-12);
        assert!(contact.middle.distance(Point2::new(4.0 / 3.0, 1.0)) < 1e-12);
    }

    #[test]
    fn regions_may_touch_at_a_corner_only() {
        let map = OccupancyGrid::from_ascii(1.0, ".#\n..\n");
        let graph = CellGraph::new(&map.cells);
        let regions = connected(&graph, &[0, 1, 2].map(Label), DiagonalSteps::ThroughFree);
        let pairs: Vec<_> =
            contacts(&graph, &regions).iter().map(|c| (c.a.0, c.b.0, c.n_sides, c.mean)).collect();
        let at = Point2::new;
        assert_eq!(pairs, [(0, 1, 1, at(1.0, 0.5)), (0, 2, 1, at(0.5, 1.0)), (1, 2, 0, at(1.0, 1.0))]);
    }
}
