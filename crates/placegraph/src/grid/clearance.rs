//! Exact Euclidean distances to the nearest cell of another kind: first along the columns, then the lower envelope of
//! parabolas over the runs of the rows [Meijster, Roerdink, Hesselink 2000]. Cost: linear in nodes.

use super::{CellGraph, NO_NODE};

/// Calls `visit` with the first node of every run of nodes in a row that are of one kind, and the squared
/// distances, in cells, from the centers of its nodes to the nearest center of a cell of another kind, of a
/// cell that is not free, or beyond the map.
pub(crate) fn squared_clearances(
    graph: &CellGraph,
    same_kind: impl Fn(usize, usize) -> bool,
    mut visit: impl FnMut(usize, &[i64]),
) {
    let along_column = column_distances(graph, &same_kind);
    let mut pass = RowPass::default();
    for y in 0..graph.height() {
        let mut first = graph.nodes_in_rows(y..y + 1).start;
        let mut end = first;
        let mut right = None;
        for x in graph.columns(y, 0..graph.width()) {
            if end > first && (right != Some(x) || !same_kind(first, end)) {
                visit(first, pass.squared_distances(&along_column[first..end]));
                first = end;
            }
            end += 1;
            right = Some(x + 1);
        }
        if end > first {
            visit(first, pass.squared_distances(&along_column[first..end]));
        }
    }
}

/// Distance of every node to the nearest cell of its column that is not of its kind. Longer ones than 65 535 count as this:
/// a map so high is less wide, so that the end of a row is nearer.
fn column_distances(graph: &CellGraph, same_kind: impl Fn(usize, usize) -> bool) -> Vec<u16> {
    let mut distances = vec![u16::MAX; graph.n_nodes()];
    let mut sweep = |rows: &mut dyn Iterator<Item = u32>| {
        // The nodes of the row before.
        let mut beside = vec![NO_NODE; graph.width() as usize];
        let mut row = beside.clone();
        for y in rows {
            graph.fill_row(y, &mut row);
            for (&node, &beside) in row.iter().zip(&beside).filter(|(node, _)| **node != NO_NODE) {
                let node = node as usize;
                let same = beside != NO_NODE && same_kind(node, beside as usize);
                let distance = if same { distances[beside as usize].saturating_add(1) } else { 1 };
                distances[node] = distances[node].min(distance);
            }
            std::mem::swap(&mut row, &mut beside);
        }
    };
    sweep(&mut (0..graph.height()));
    sweep(&mut (0..graph.height()).rev());
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
    /// run and the two cells next to it, where g is 0. Cells farther along the row are never nearer.
    fn squared_distances(&mut self, along_column: &[u16]) -> &[i64] {
        // Positions 0 and `end` are the cells next to the run.
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
    use crate::grid::OccupancyGrid;

    #[test]
    fn distances_to_a_pillar_and_to_the_border() {
        let map = OccupancyGrid::from_ascii(
            1.0,
            "
            .....
            .....
            ..#..
            .....
            .....
            ",
        );
        let graph = CellGraph::new(&map.cells);
        let mut squared = Vec::new();
        squared_clearances(&graph, |_, _| true, |_, run| squared.extend_from_slice(run));
        let expected = [1, 1, 1, 1, 1, 1, 2, 1, 2, 1, 1, 1, 1, 1, 1, 2, 1, 2, 1, 1, 1, 1, 1, 1];
        assert_eq!(squared, expected);
    }
}
