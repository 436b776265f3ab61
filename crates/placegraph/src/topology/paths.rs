//! Short paths between the anchors of places that touch, inside the two places.
//!
//! From the anchor, distances grow over a region in steps of 2 along sides and 3 across corners; a path
//! leads back from the middle of the common border to both anchors, and is then pulled tight: a corner stays
//! only where the straight line would leave the two places. Cost: linear in nodes, plus the paths.

use crate::geom::Point2;
use crate::grid::{Cell, CellGraph, Connectivity};
use crate::regions::{Contact, DiagonalSteps, RegionId, RegionMap};

/// Marks an anchor, and a node that was not reached.
const NONE: u32 = u32::MAX;

/// For every contact, the cells at which the path from the anchor of `a` to the anchor of `b` turns, ends
/// included. `anchors` are nodes.
pub(super) fn paths(
    graph: &CellGraph,
    regions: &RegionMap,
    anchors: &[usize],
    contacts: &[Contact],
) -> Vec<Vec<Cell>> {
    let toward_anchor = toward_anchors(graph, regions, anchors);
    let to_anchor = |node: usize| {
        std::iter::successors(Some(node), |&node| {
            let next = toward_anchor[node];
            (next != NONE).then_some(next as usize)
        })
    };
    contacts
        .iter()
        .map(|contact| {
            let Some((in_a, in_b)) = crossing(graph, regions, contact) else { return Vec::new() };
            let mut nodes: Vec<usize> = to_anchor(in_a).collect();
            nodes.reverse();
            nodes.extend(to_anchor(in_b));
            let inside = |cell| {
                graph.node_at(cell).is_some_and(|node| {
                    let region = regions.region_of[node];
                    region == contact.a || region == contact.b
                })
            };
            let cells: Vec<Cell> = nodes.into_iter().map(|node| graph.cells()[node]).collect();
            pulled_tight(&cells, inside)
        })
        .collect()
}

/// For every node, the next one on the way to the anchor of its region.
fn toward_anchors(graph: &CellGraph, regions: &RegionMap, anchors: &[usize]) -> Vec<u32> {
    let mut next = vec![NONE; graph.n_nodes()];
    let mut distances = vec![u32::MAX; graph.n_nodes()];
    // Nodes by distance modulo 4: no step is longer than 3.
    let mut waiting: [Vec<u32>; 4] = Default::default();
    for &anchor in anchors {
        distances[anchor] = 0;
        waiting[0].push(anchor as u32);
        let mut distance = 0u32;
        while waiting.iter().any(|nodes| !nodes.is_empty()) {
            let mut nodes = std::mem::take(&mut waiting[distance as usize % 4]);
            for node in nodes.drain(..).map(|node| node as usize) {
                if distances[node] != distance {
                    continue;
                }
                for &(dx, dy) in Connectivity::Eight.steps() {
                    let Some(other) = graph.node_at_step(node, (dx, dy)) else { continue };
                    let is_diagonal = dx != 0 && dy != 0;
                    let farther = distance + if is_diagonal { 3 } else { 2 };
                    if distances[other] <= farther
                        || regions.region_of[other] != regions.region_of[node]
                        || is_diagonal && !may_step(graph, regions.diagonal, node, (dx, dy))
                    {
                        continue;
                    }
                    distances[other] = farther;
                    next[other] = node as u32;
                    waiting[farther as usize % 4].push(other as u32);
                }
            }
            waiting[distance as usize % 4] = nodes;
            distance += 1;
        }
    }
    next
}

/// Whether a diagonal step from `node` connects cells.
fn may_step(graph: &CellGraph, diagonal: DiagonalSteps, node: usize, (dx, dy): (i32, i32)) -> bool {
    match diagonal {
        DiagonalSteps::Never => false,
        DiagonalSteps::Any => true,
        DiagonalSteps::ThroughFree => {
            graph.node_at_step(node, (dx, 0)).is_some() || graph.node_at_step(node, (0, dy)).is_some()
        }
    }
}

/// The pair of neighboring nodes, one of each region, that is nearest to the middle of the contact.
fn crossing(graph: &CellGraph, regions: &RegionMap, contact: &Contact) -> Option<(usize, usize)> {
    let (x, y) = (contact.middle.x.floor() as i64, contact.middle.y.floor() as i64);
    let around = (y - 2..=y + 1).flat_map(|y| (x - 2..=x + 1).map(move |x| (x, y)));
    let of = |region: RegionId| {
        around
            .clone()
            .filter(|&(x, y)| {
                (0..graph.width() as i64).contains(&x) && (0..graph.height() as i64).contains(&y)
            })
            .filter_map(|(x, y)| graph.node_at(Cell::new(x as u32, y as u32)))
            .filter(move |&node| regions.region_of[node] == region)
    };
    let center = |node: usize| {
        let Cell { x, y } = graph.cells()[node];
        Point2::new(x as f64 + 0.5, y as f64 + 0.5)
    };
    // Pairs across a side first: their centers are one cell apart, others farther.
    let length = |(a, b): (usize, usize)| {
        let (a, b) = (center(a), center(b));
        a.distance(b) + a.midpoint(b).distance(contact.middle)
    };
    of(contact.a)
        .flat_map(|a| of(contact.b).map(move |b| (a, b)))
        .min_by(|&first, &second| length(first).total_cmp(&length(second)))
}

/// The corners that remain when `path` is pulled tight, where `inside` says which cells it may use.
fn pulled_tight(path: &[Cell], inside: impl Fn(Cell) -> bool) -> Vec<Cell> {
    let mut corners: Vec<Cell> = path.first().copied().into_iter().collect();
    let mut here = 0;
    while here + 1 < path.len() {
        // As far as one sees, in growing steps, then in shrinking ones.
        let mut seen = here + 1;
        let mut step = 1;
        while step > 0 {
            let ahead = (seen + step).min(path.len() - 1);
            if ahead > seen && is_visible(path[here], path[ahead], &inside) {
                seen = ahead;
                step *= 2;
            } else {
                step /= 2;
            }
        }
        corners.push(path[seen]);
        here = seen;
    }
    corners
}

/// Whether every cell that the line between two cells' centers enters is `inside`. Through a corner, one of
/// the two cells beside it is enough.
fn is_visible(from: Cell, to: Cell, inside: &impl Fn(Cell) -> bool) -> bool {
    let (n_x, n_y) = (from.x.abs_diff(to.x) as i64, from.y.abs_diff(to.y) as i64);
    let along = |from: u32, to: u32, steps: i64| {
        if to > from { from + steps as u32 } else { from - steps as u32 }
    };
    let is_inside = |x: i64, y: i64| inside(Cell::new(along(from.x, to.x, x), along(from.y, to.y, y)));
    let (mut x, mut y) = (0, 0);
    while x < n_x || y < n_y {
        // Which side comes first: the upright one at (x + ½) / n_x or the level one at (y + ½) / n_y.
        match ((2 * x + 1) * n_y).cmp(&((2 * y + 1) * n_x)) {
            std::cmp::Ordering::Less => x += 1,
            std::cmp::Ordering::Greater => y += 1,
            std::cmp::Ordering::Equal => {
                if !is_inside(x + 1, y) && !is_inside(x, y + 1) {
                    return false;
                }
                x += 1;
                y += 1;
            }
        }
        if !is_inside(x, y) {
            return false;
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::OccupancyGrid;

    #[test]
    fn lines_of_sight() {
        let map = OccupancyGrid::from_ascii(
            1.0,
            "
            .....
            ..#..
            .....
            ",
        );
        let free = |cell: Cell| map.is_free(cell);
        let sees = |x0, y0, x1, y1| is_visible(Cell::new(x0, y0), Cell::new(x1, y1), &free);
        assert!(sees(0, 0, 4, 0) && sees(4, 0, 0, 0) && sees(0, 0, 0, 2));
        assert!(!sees(0, 1, 4, 1) && !sees(0, 0, 4, 2));
        // Past the corner of the wall: one cell beside it is free.
        assert!(sees(1, 1, 2, 2) && sees(2, 2, 1, 1));
    }

    #[test]
    fn a_path_around_a_wall_keeps_two_corners() {
        let map = OccupancyGrid::from_ascii(
            1.0,
            "
            .......
            .#####.
            .#####.
            ",
        );
        let path: Vec<Cell> =
            [(0, 0), (0, 1), (0, 2), (1, 2), (2, 2), (3, 2), (4, 2), (5, 2), (6, 2), (6, 1)]
                .map(|(x, y)| Cell::new(x, y))
                .to_vec();
        let corners = pulled_tight(&path, |cell| map.is_free(cell));
        assert_eq!(corners, [(0, 0), (0, 2), (6, 2), (6, 1)].map(|(x, y)| Cell::new(x, y)));
    }
}
