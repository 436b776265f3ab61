//! Obstacles: 8-connected groups of cells that are not free.

use super::{Cell, CellGraph};

/// Steps to the 8 cells around a cell. The last one is taken first, again and again: a search runs along a wall.
const AROUND: [(i32, i32); 8] = [(-1, -1), (1, -1), (-1, 1), (1, 1), (0, -1), (-1, 0), (0, 1), (1, 0)];

/// The obstacles of a map, found one at a time on request.
#[derive(Clone, Copy, Debug)]
pub struct Obstacles<'a> {
    graph: &'a CellGraph,
}

impl<'a> Obstacles<'a> {
    /// The obstacles between the nodes of `graph`.
    pub fn of(graph: &'a CellGraph) -> Self {
        Self { graph }
    }

    /// The cells of the obstacle that contains `cell`, if it is at most `max_length` cells long and wide and does not
    /// reach the border of the map, beyond which it may continue; else `None`. Cost: O(`max_length`) for a wall, at
    /// most its square.
    ///
    /// # Panics
    /// If `cell` is free or outside the map.
    pub fn small_at(&self, cell: Cell, max_length: u32) -> Option<Vec<Cell>> {
        assert!(!self.graph.is_free(cell), "an obstacle is not free");
        let mut window = Window::around(cell, max_length);
        let (mut low, mut high) = (cell, cell);
        let mut members = Vec::new();
        let mut open = vec![cell];
        window.enter(cell);
        while let Some(cell) = open.pop() {
            low = Cell::new(low.x.min(cell.x), low.y.min(cell.y));
            high = Cell::new(high.x.max(cell.x), high.y.max(cell.y));
            let is_long = (high.x - low.x).max(high.y - low.y) >= max_length;
            let is_cut = cell.x == 0
                || cell.y == 0
                || cell.x + 1 == self.graph.width()
                || cell.y + 1 == self.graph.height();
            if is_long || is_cut {
                return None;
            }
            members.push(cell);
            // No cell beyond the border: the obstacle would have reached it.
            let around = AROUND.iter().map(|&(x, y)| cell.moved(x, y));
            open.extend(around.filter(|&next| !self.graph.is_free(next) && window.enter(next)));
        }
        Some(members)
    }

    /// The cells of all obstacles that are at most `max_length` cells long and wide and do not reach the border of the map.
    /// Cost: one pass over the map, and [`Obstacles::small_at`] for every first cell of an obstacle.
    pub fn small(&self, max_length: u32) -> Vec<Cell> {
        let mut small = Vec::new();
        let is_free = |x, y| self.graph.is_free(Cell::new(x, y));
        for y in 1..self.graph.height().saturating_sub(1) {
            for x in 1..self.graph.width().saturating_sub(1) {
                // The first cell of an obstacle, row by row, has none of it to its left and below.
                let may_be_first =
                    !is_free(x, y) && is_free(x - 1, y) && (x - 1..=x + 1).all(|x| is_free(x, y - 1));
                if !may_be_first {
                    continue;
                }
                let cell = Cell::new(x, y);
                let is_first =
                    |members: &Vec<Cell>| members.iter().all(|other| (other.y, other.x) >= (cell.y, cell.x));
                small.extend(self.small_at(cell, max_length).filter(is_first).into_iter().flatten());
            }
        }
        small
    }

    /// The graph of the map without these obstacles: their cells are nodes too.
    pub fn cleared(&self, max_length: u32) -> CellGraph {
        self.graph.with_free(self.small(max_length))
    }
}

/// The cells that an obstacle of a limited length can have around one of its cells, and which were seen.
struct Window {
    corner: (i64, i64),
    side: i64,
    seen: Vec<bool>,
}

impl Window {
    fn around(cell: Cell, radius: u32) -> Self {
        let (radius, side) = (i64::from(radius), 2 * i64::from(radius) + 1);
        let corner = (i64::from(cell.x) - radius, i64::from(cell.y) - radius);
        Self { corner, side, seen: vec![false; (side * side) as usize] }
    }

    /// Whether `cell` is seen for the first time. It is at most a step out of an obstacle of the length that is looked for.
    fn enter(&mut self, cell: Cell) -> bool {
        let (x, y) = (i64::from(cell.x) - self.corner.0, i64::from(cell.y) - self.corner.1);
        !std::mem::replace(&mut self.seen[(y * self.side + x) as usize], true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Grid, Occupancy, OccupancyGrid};

    /// A leg of one cell, a table of 3 x 2 with a hole, a diagonal of three, a wall that reaches the border.
    fn map() -> CellGraph {
        let text = "
            ..............
            .#.......#....
            ..........#...
            .....##....#..
            .....?........
            .....###......
            ..............
            ##########....
            ..............
        ";
        CellGraph::new(&OccupancyGrid::from_ascii(1.0, text).cells)
    }

    #[test]
    fn obstacles_up_to_a_length_are_found_whole() {
        let map = map();
        let n_small = |max_length| Obstacles::of(&map).small(max_length).len();
        assert_eq!([1, 2, 3, 9, 100].map(n_small), [1, 1, 1 + 6 + 3, 10, 10]);
        assert!(Obstacles::of(&map).cleared(3).is_free(Cell::new(5, 4)));
        assert!(!Obstacles::of(&map).cleared(3).is_free(Cell::new(9, 1)), "cut by the border");
        assert_eq!(Obstacles::of(&map).cleared(3).n_nodes(), map.n_nodes() + 10);
    }

    #[test]
    fn the_length_is_that_of_the_longer_side() {
        let map = map();
        let at = |x, y, max_length| Obstacles::of(&map).small_at(Cell::new(x, y), max_length);
        assert_eq!(at(1, 7, 1).map(|cells| cells.len()), Some(1));
        assert_eq!(at(6, 3, 2), None);
        assert_eq!(at(6, 3, 3).map(|cells| cells.len()), Some(6));
        assert_eq!(at(3, 1, 50), None, "it goes on beyond the border");
    }

    /// Small obstacles by flooding the whole map, each obstacle from any of its cells.
    fn plainly(map: &Grid<Occupancy>, max_length: u32) -> Vec<Cell> {
        let mut seen = map.map(|&cell| cell == Occupancy::Free);
        let mut small = Vec::new();
        for start in map.cells() {
            let mut members: Vec<Cell> = Vec::new();
            let mut open = vec![start];
            while let Some(cell) = open.pop() {
                if std::mem::replace(&mut seen[cell], true) {
                    continue;
                }
                members.push(cell);
                open.extend(AROUND.iter().filter_map(|&step| map.offset(cell, step)));
            }
            let span = |of: fn(&Cell) -> u32| {
                let values = || members.iter().map(of);
                (values().min().unwrap_or(0), values().max().unwrap_or(0))
            };
            let (xs, ys) = (span(|cell| cell.x), span(|cell| cell.y));
            let is_cut = xs.0 == 0 || ys.0 == 0 || xs.1 + 1 == map.width() || ys.1 + 1 == map.height();
            if !is_cut && (xs.1 - xs.0).max(ys.1 - ys.0) < max_length {
                small.extend(members);
            }
        }
        small.sort_unstable();
        small
    }

    #[test]
    fn all_small_obstacles_are_found_as_by_flooding_the_map() {
        let mut state = 7u64;
        let mut random = || {
            // xorshift [Marsaglia 2003].
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            state
        };
        for percent in [5, 15, 30, 45] {
            let mut map = Grid::filled(60, 50, Occupancy::Free);
            for cell in map.values_mut() {
                if random() % 100 < percent {
                    *cell = if random() % 2 == 0 { Occupancy::Occupied } else { Occupancy::Unknown };
                }
            }
            for max_length in [1, 2, 5, 12] {
                let mut found = Obstacles::of(&CellGraph::new(&map)).small(max_length);
                found.sort_unstable();
                assert_eq!(found, plainly(&map, max_length), "{percent} % and {max_length} cells");
            }
        }
    }
}
