//! The map as one bit per cell; 1 stops a beam.

use super::{ScanConfig, UnknownCells};
use crate::grid::{self, Cell, CellGraph, Occupancy, OccupancyGrid};

/// Cells in a word, along a row.
pub(super) const WORD: usize = u64::BITS as usize;
/// Rows of start cells that are walked together.
pub(super) const ROWS: usize = 8;
/// Steps between two looks at whether any beam is alive.
pub(super) const STRIDE: usize = 8;

/// Rows of obstacles below and above the map: a block may leave the map by its own height, and by the steps
/// that it walks before the end of its last beam is noticed.
const MARGIN_ROWS: usize = ROWS + STRIDE;
/// Words of obstacles left and right of the map, for the same reason, and one more for the unaligned word.
const MARGIN_WORDS: usize = 3;

/// Obstacles, a word for 64 cells of a row. Words of the same columns are neighbors in memory from row to row,
/// so that one load fetches the obstacles of [`ROWS`] rows.
#[derive(Clone, Debug)]
pub(super) struct Obstacles {
    words: Vec<u64>,
    rows: usize,
}

impl Obstacles {
    /// The cells of `grid` that stop a beam; everything outside stops it.
    pub(super) fn new(grid: &OccupancyGrid, config: &ScanConfig) -> Self {
        let (width, height) = (grid.cells.width() as usize, grid.cells.height() as usize);
        let rows = height + 2 * MARGIN_ROWS;
        let mut words = vec![u64::MAX; (width.div_ceil(WORD) + 2 * MARGIN_WORDS) * rows];
        for y in 0..height {
            for (word, cells) in grid.cells.row(y as u32).chunks(WORD).enumerate() {
                let passes = |value: &Occupancy| match value {
                    Occupancy::Free => true,
                    Occupancy::Unknown => config.unknown == UnknownCells::Pass,
                    Occupancy::Occupied => false,
                };
                let free = cells.iter().enumerate().map(|(bit, value)| u64::from(passes(value)) << bit);
                words[(word + MARGIN_WORDS) * rows + y + MARGIN_ROWS] &= !free.sum::<u64>();
            }
        }
        let mut obstacles = Self { words, rows };
        for cell in specks(grid, config) {
            let position = obstacles.position(cell);
            obstacles.words[position] &= !(1 << (cell.x as usize % WORD));
        }
        obstacles
    }

    /// No obstacles, on as many words.
    pub(super) fn emptied(&self) -> Self {
        Self { words: vec![0; self.words.len()], rows: self.rows }
    }

    /// Whether `cell` is an obstacle.
    pub(super) fn is_set(&self, cell: Cell) -> bool {
        self.words[self.position(cell)] >> (cell.x as usize % WORD) & 1 == 1
    }

    /// Makes `cell` an obstacle.
    pub(super) fn set(&mut self, cell: Cell) {
        let position = self.position(cell);
        self.words[position] |= 1 << (cell.x as usize % WORD);
    }

    /// Position of the word that holds `cell`.
    pub(super) fn position(&self, cell: Cell) -> usize {
        (cell.x as usize / WORD + MARGIN_WORDS) * self.rows + cell.y as usize + MARGIN_ROWS
    }

    #[expect(clippy::cast_possible_wrap, reason = "small constants, and sizes that fit in memory")]
    /// The displacement by `x` columns and `y` rows, for [`Obstacles::around`].
    pub(super) fn offset(&self, x: i32, y: i32) -> Offset {
        let words = i64::from(x.div_euclid(WORD as i32)) * self.rows as i64 + i64::from(y);
        Offset { words: words as i32, bits: x.rem_euclid(WORD as i32) as u32 }
    }

    /// The obstacles `offset` away from the cells of the words at `position` and in the rows above.
    #[inline(always)]
    pub(super) fn around(&self, position: usize, offset: Offset) -> [u64; ROWS] {
        let start = position.wrapping_add_signed(offset.words as isize);
        let left = self.load(start);
        let right = self.load(start + self.rows);
        let mut obstacles = [0; ROWS];
        for row in 0..ROWS {
            let spill = (right[row] << 1) << (WORD as u32 - 1 - offset.bits);
            obstacles[row] = left[row] >> offset.bits | spill;
        }
        obstacles
    }

    #[inline(always)]
    fn load(&self, start: usize) -> [u64; ROWS] {
        let Some(&rows) = self.words[start..].first_chunk() else { outside() };
        rows
    }
}

#[cold]
fn outside() -> ! {
    panic!("a block lies in the map");
}

/// The cells of the obstacles that beams pass through ([`ScanConfig::max_speck_m`]).
pub(super) fn specks(grid: &OccupancyGrid, config: &ScanConfig) -> Vec<Cell> {
    let max_length = (config.max_speck_m / grid.frame.resolution_m()).round() as u32;
    if max_length == 0 {
        return Vec::new();
    }
    grid::Obstacles::of(&CellGraph::new(&grid.cells)).small(max_length)
}

/// A displacement as words and bits. A bitmap below 2³¹ words (137 G cells) keeps it in 32 bits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Offset {
    words: i32,
    bits: u32,
}
