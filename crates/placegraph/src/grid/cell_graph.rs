//! The graph G = (V, E) of Sect. 4.5: a node per free cell, edges between neighboring free cells.

use std::ops::Range;
use std::sync::OnceLock;

use super::{Cell, Connectivity, Grid, Occupancy};

/// Cells in a word.
const WORD: usize = u64::BITS as usize;

/// Marks a cell that is no node, in rows of nodes.
pub(crate) const NO_NODE: u32 = u32::MAX;

/// The free cells of a map, numbered in row-major order from the bottom left, so that node ids are deterministic and
/// neighbors are near in memory. Edges are implicit: [`CellGraph::neighbors`].
///
/// A bit per cell, the number of nodes before every 64 cells, and where every 64th node is: at most 0.3 bytes per cell.
/// A node is found from its cell by counting bits, and a cell from its node by looking for one.
#[derive(Clone, Debug)]
pub struct CellGraph {
    width: u32,
    height: u32,
    /// 1 where a cell is free, row-major.
    free: Vec<u64>,
    /// Number of nodes before each word, and of all.
    before: Vec<u32>,
    /// The word of every 64th node, and the last word.
    word_of: Vec<u32>,
    /// [`CellGraph::cells`], once it was asked for.
    cells: OnceLock<Vec<Cell>>,
}

impl CellGraph {
    /// The graph over the free cells of a map. Cost: one pass over the map.
    ///
    /// # Panics
    /// If the map has 2³² − 1 cells or more; readers refuse such maps.
    pub fn new(map: &Grid<Occupancy>) -> Self {
        Self::from_free(map.width(), map.height(), |index| map.values()[index] == Occupancy::Free)
    }

    /// The graph over the cells for which `is_free` holds, asked once for every position in row-major order.
    pub(crate) fn from_free(width: u32, height: u32, mut is_free: impl FnMut(usize) -> bool) -> Self {
        let n_cells = width as usize * height as usize;
        assert!(n_cells < u32::MAX as usize, "node ids fit in 32 bits");
        let mut graph = Self {
            width,
            height,
            free: Vec::with_capacity(n_cells.div_ceil(WORD)),
            before: Vec::with_capacity(n_cells.div_ceil(WORD) + 1),
            word_of: Vec::new(),
            cells: OnceLock::new(),
        };
        let mut n_nodes = 0;
        for start in (0..n_cells).step_by(WORD) {
            let bits = (start..n_cells.min(start + WORD)).map(|index| u64::from(is_free(index)));
            let word = bits.enumerate().fold(0, |word, (bit, free)| word | free << bit);
            graph.before.push(n_nodes);
            n_nodes += word.count_ones();
            graph.word_of.resize((n_nodes as usize).div_ceil(WORD), graph.free.len() as u32);
            graph.free.push(word);
        }
        graph.before.push(n_nodes);
        graph.word_of.push(graph.free.len().saturating_sub(1) as u32);
        graph
    }

    /// Number of nodes.
    pub fn n_nodes(&self) -> usize {
        self.before.last().map_or(0, |&n| n as usize)
    }

    /// Number of columns of the map.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Number of rows of the map.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The cell of `node`. Cost: a few dozen operations; for consecutive nodes, [`CellGraph::cells_in_rows`] costs a
    /// few.
    ///
    /// # Panics
    /// If there is no such node.
    pub fn cell(&self, node: usize) -> Cell {
        let (first, last) = (self.word_of[node / WORD] as usize, self.word_of[node / WORD + 1] as usize);
        // The last word with no more nodes before it.
        let word = first + self.before[first + 1..=last].partition_point(|&before| before as usize <= node);
        let index = word * WORD + nth_bit(self.free[word], node as u32 - self.before[word]);
        Cell::new(index as u32 % self.width, index as u32 / self.width)
    }

    /// The cell of every node, in the order of the nodes. Makes a list of 8 bytes per node at the first call and
    /// keeps it.
    pub fn cells(&self) -> &[Cell] {
        self.cells.get_or_init(|| self.cells_in_rows(0..self.height).collect())
    }

    /// The cells of the nodes in `rows`, in the order of the nodes.
    pub fn cells_in_rows(&self, rows: Range<u32>) -> impl Iterator<Item = Cell> + '_ {
        rows.flat_map(move |y| self.columns(y, 0..self.width).map(move |x| Cell::new(x, y)))
    }

    /// `values` of the nodes at their positions in the map, and `fill` in all other cells.
    ///
    /// # Panics
    /// If there is not one value per node.
    ///
    /// # Examples
    /// ```
    /// use placegraph::grid::{CellGraph, OccupancyGrid};
    ///
    /// let graph = CellGraph::new(&OccupancyGrid::from_ascii(0.05, "..#.").cells);
    /// assert_eq!(graph.to_grid(&[7, 8, 9], 0).values(), [7, 8, 0, 9]);
    /// ```
    pub fn to_grid<T: Clone>(&self, values: &[T], fill: T) -> Grid<T> {
        assert_eq!(values.len(), self.n_nodes(), "one value per node");
        let mut grid = Grid::filled(self.width, self.height, fill);
        for (cell, value) in self.cells_in_rows(0..self.height).zip(values) {
            grid[cell] = value.clone();
        }
        grid
    }

    /// Draws the map with a letter for every node and `#` for all other cells, the top row first: the reverse of
    /// [`OccupancyGrid::from_ascii`](super::OccupancyGrid::from_ascii), for examples and tests.
    pub fn to_ascii(&self, letter_of: impl Fn(usize) -> char) -> String {
        let letters: Vec<char> = (0..self.n_nodes()).map(letter_of).collect();
        let rows = self.to_grid(&letters, '#');
        rows.rows_from_top().map(|row| row.iter().collect::<String>() + "\n").collect()
    }

    /// The free ones of `columns` in row `y`, from the left.
    pub(crate) fn columns(&self, y: u32, columns: Range<u32>) -> impl Iterator<Item = u32> + '_ {
        let start = y as usize * self.width as usize;
        let range = start + columns.start as usize..start + columns.end as usize;
        self.free_in(range).map(move |index| (index - start) as u32)
    }

    /// The nodes of the 3 × 3 cells around `cell`, rows from below, and [`NO_NODE`] where a cell is not free.
    pub(crate) fn around(&self, cell: Cell) -> [[u32; 3]; 3] {
        let mut around = [[NO_NODE; 3]; 3];
        let columns = cell.x.saturating_sub(1)..self.width.min(cell.x + 2);
        for (dy, row) in around.iter_mut().enumerate() {
            let Some(y) = (cell.y + dy as u32).checked_sub(1).filter(|&y| y < self.height) else { continue };
            let start = y as usize * self.width as usize;
            let mut node = self.n_before(start + columns.start as usize) as u32;
            for x in columns.clone() {
                let index = start + x as usize;
                if self.free[index / WORD] >> (index % WORD) & 1 == 1 {
                    row[(x + 1 - cell.x) as usize] = node;
                    node += 1;
                }
            }
        }
        around
    }

    /// Puts the nodes of row `y` into `row`, one entry a column, and [`NO_NODE`] where a cell is not free.
    pub(crate) fn fill_row(&self, y: u32, row: &mut [u32]) {
        row.fill(NO_NODE);
        for (x, node) in self.columns(y, 0..self.width).zip(self.n_nodes_before(y, 0) as u32..) {
            row[x as usize] = node;
        }
    }

    /// Number of nodes before the cell in column `x` of row `y`.
    pub(crate) fn n_nodes_before(&self, y: u32, x: u32) -> usize {
        self.n_before(y as usize * self.width as usize + x as usize)
    }

    /// The nodes of `rows`, which are consecutive.
    pub fn nodes_in_rows(&self, rows: Range<u32>) -> Range<usize> {
        self.n_nodes_before(rows.start, 0)..self.n_nodes_before(rows.end, 0)
    }

    /// The node in `cell`, or `None` if the cell is not free.
    ///
    /// # Panics
    /// If the cell is not of the map.
    pub fn node_at(&self, cell: Cell) -> Option<usize> {
        self.is_free(cell).then(|| self.n_before(self.index(cell)))
    }

    /// Whether `cell` is free.
    ///
    /// # Panics
    /// If the cell is not of the map.
    pub fn is_free(&self, cell: Cell) -> bool {
        assert!(cell.x < self.width, "a column of the map");
        let index = self.index(cell);
        self.free[index / WORD] >> (index % WORD) & 1 == 1
    }

    /// The graph in which `cells` are free too.
    pub(crate) fn with_free(&self, mut cells: Vec<Cell>) -> Self {
        cells.sort_unstable_by_key(|&cell| self.index(cell));
        let mut more = cells.into_iter().map(|cell| self.index(cell)).peekable();
        Self::from_free(self.width, self.height, |index| {
            let is_more = more.next_if_eq(&index).is_some();
            is_more || self.free[index / WORD] >> (index % WORD) & 1 == 1
        })
    }

    /// Position of `cell` in the map.
    fn index(&self, cell: Cell) -> usize {
        cell.y as usize * self.width as usize + cell.x as usize
    }

    /// The node `step` away from `cell`, or `None` if no free cell is there.
    pub fn node_beside(&self, cell: Cell, step: (i32, i32)) -> Option<usize> {
        let x = cell.x.checked_add_signed(step.0).filter(|&x| x < self.width)?;
        let y = cell.y.checked_add_signed(step.1).filter(|&y| y < self.height)?;
        self.node_at(Cell::new(x, y))
    }

    /// The node `step` away from `node`, or `None` if no free cell is there.
    pub fn node_at_step(&self, node: usize, step: (i32, i32)) -> Option<usize> {
        self.node_beside(self.cell(node), step)
    }

    /// The nodes next to `node`, in the order of [`Connectivity::steps`].
    pub fn neighbors(&self, node: usize, connectivity: Connectivity) -> impl Iterator<Item = usize> + '_ {
        let cell = self.cell(node);
        connectivity.steps().iter().filter_map(move |&step| self.node_beside(cell, step))
    }

    /// Number of nodes before position `index` of the map.
    fn n_before(&self, index: usize) -> usize {
        let (word, bit) = (index / WORD, index % WORD);
        let in_word = if bit == 0 { 0 } else { (self.free[word] & ((1 << bit) - 1)).count_ones() };
        (self.before[word] + in_word) as usize
    }

    /// The positions of free cells in `range`.
    fn free_in(&self, range: Range<usize>) -> impl Iterator<Item = usize> + '_ {
        (range.start / WORD..range.end.div_ceil(WORD)).flat_map(move |word| {
            let mut bits = self.free[word];
            let start = word * WORD;
            if start < range.start {
                bits &= u64::MAX << (range.start - start);
            }
            if range.end < start + WORD {
                bits &= (1 << (range.end - start)) - 1;
            }
            std::iter::from_fn(move || {
                let bit = bits.trailing_zeros() as usize;
                let rest = bits & bits.wrapping_sub(1);
                (std::mem::replace(&mut bits, rest) != 0).then_some(start + bit)
            })
        })
    }
}

impl PartialEq for CellGraph {
    fn eq(&self, other: &Self) -> bool {
        (self.width, self.height, &self.free) == (other.width, other.height, &other.free)
    }
}

impl Eq for CellGraph {}

/// Position of the bit of `word` that is set and has `n` set ones below it.
fn nth_bit(word: u64, n: u32) -> usize {
    // The same byte eight times.
    const fn each(byte: u64) -> u64 {
        byte * (u64::MAX / 255)
    }
    // Set bits in pairs, in groups of four, in bytes; then in all bytes up to each.
    let pairs = word - ((word >> 1) & each(0x55));
    let fours = (pairs & each(0x33)) + ((pairs >> 2) & each(0x33));
    let up_to = ((fours + (fours >> 4)) & each(0x0f)).wrapping_mul(each(1));
    // The first byte with more than n bits up to it.
    let has_more = ((up_to | each(0x80)) - each(u64::from(n + 1))) & each(0x80);
    let shift = has_more.trailing_zeros() & !7;
    let before = ((up_to << 8) >> shift) as u32 & 0xff;
    let mut byte = word >> shift;
    for _ in before..n {
        byte &= byte - 1;
    }
    (shift + byte.trailing_zeros()) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::OccupancyGrid;

    #[test]
    fn nodes_are_free_cells_in_row_major_order() {
        let map = OccupancyGrid::from_ascii(
            1.0,
            "
            .#.
            ..?
            ",
        );
        let graph = CellGraph::new(&map.cells);
        assert_eq!(graph.cells(), [Cell::new(0, 0), Cell::new(1, 0), Cell::new(0, 1), Cell::new(2, 1)]);
        assert_eq!(graph.neighbors(1, Connectivity::Eight).collect::<Vec<_>>(), [0, 2, 3]);
        assert_eq!(graph.neighbors(1, Connectivity::Four).collect::<Vec<_>>(), [0]);
        assert_eq!(graph.node_at(Cell::new(1, 1)), None);
    }

    /// Against a plain list of the free cells: dense, ragged and nearly empty maps, rows of any length.
    #[test]
    fn nodes_and_cells_find_each_other() {
        for (width, height) in [(1, 1), (1, 300), (300, 1), (63, 9), (64, 9), (65, 9), (200, 150)] {
            for one_in in [1, 2, 3, 700] {
                let is_free = |index: usize| (index * 7919 + index / 13).is_multiple_of(one_in);
                let graph = CellGraph::from_free(width, height, is_free);
                let all = Grid::filled(width, height, ());
                let free: Vec<Cell> = all.cells().filter(|&cell| is_free(all.index(cell))).collect();
                assert_eq!(graph.cells(), free);
                assert_eq!(graph.n_nodes(), free.len());
                for (node, &cell) in free.iter().enumerate() {
                    assert_eq!((graph.cell(node), graph.node_at(cell)), (cell, Some(node)));
                }
                assert_eq!(all.cells().filter(|&cell| graph.node_at(cell).is_some()).count(), free.len());
                let rows = height / 3..height - height / 3;
                let nodes = graph.nodes_in_rows(rows.clone());
                assert!(graph.cells_in_rows(rows).eq(free[nodes].iter().copied()));
            }
        }
    }
}
