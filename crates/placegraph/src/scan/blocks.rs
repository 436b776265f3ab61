//! Cells in blocks of 64 columns and 8 rows.

use std::ops::Range;

use super::obstacles::{ROWS, WORD};
use crate::grid::Cell;

/// Cells of one row of a block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Run {
    /// Position of the first one in the list of all cells; the others follow it there.
    pub first: usize,
    /// Their columns: bit c is column c of the block.
    pub columns: u64,
}

impl Run {
    /// Positions in the list of all cells.
    pub fn positions(&self) -> Range<usize> {
        self.first..self.first + self.columns.count_ones() as usize
    }
}

/// The cells, of a list in row-major order, that lie in one block of the map.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Block {
    /// The block's lower left cell.
    pub corner: Cell,
    /// Its cells, by row from below.
    pub rows: [Run; ROWS],
}

impl Block {
    /// Cells of a full block.
    pub const MAX_CELLS: usize = ROWS * WORD;

    /// Number of cells.
    pub fn n_cells(&self) -> usize {
        self.rows.iter().map(|run| run.columns.count_ones() as usize).sum()
    }

    /// The blocks of `cells`, rows of blocks from below, left to right.
    ///
    /// # Panics
    /// If the cells are not in row-major order, each once.
    pub fn of_cells(cells: &[Cell]) -> Vec<Self> {
        Self::bands(cells).into_iter().flat_map(|band| Self::of_band(cells, band)).collect()
    }

    /// The parts of `cells` that lie in the same [`ROWS`] rows of blocks, as ranges of positions.
    ///
    /// # Panics
    /// If the cells are not in row-major order, each once.
    pub(crate) fn bands(cells: &[Cell]) -> Vec<Range<usize>> {
        let in_order = cells.windows(2).all(|pair| (pair[0].y, pair[0].x) < (pair[1].y, pair[1].x));
        assert!(in_order, "cells come in row-major order, each once");
        let mut end = 0;
        let bands = cells.chunk_by(|one, next| one.y / ROWS as u32 == next.y / ROWS as u32);
        let positions = |band: &[Cell]| {
            end += band.len();
            end - band.len()..end
        };
        bands.map(positions).collect()
    }

    /// The blocks of one band: the cells at `positions`, left to right.
    pub(crate) fn of_band(cells: &[Cell], positions: Range<usize>) -> Vec<Self> {
        let mut blocks: Vec<Self> = Vec::new();
        let band = &cells[positions.clone()];
        let Some(first) = band.first() else { return blocks };
        let bottom = first.y - first.y % ROWS as u32;
        let n_words = band.iter().map(|cell| cell.x as usize / WORD + 1).max().unwrap_or(0);
        blocks.extend((0..n_words).map(|word| Self {
            corner: Cell::new((word * WORD) as u32, bottom),
            rows: [Run::default(); ROWS],
        }));
        for (position, cell) in positions.zip(band) {
            let run = &mut blocks[cell.x as usize / WORD].rows[(cell.y - bottom) as usize];
            if run.columns == 0 {
                run.first = position;
            }
            run.columns |= 1 << (cell.x as usize % WORD);
        }
        blocks.retain(|block| block.n_cells() > 0);
        blocks
    }

    /// The cells' numbers in the block, row-major.
    pub(super) fn lanes(&self) -> impl Iterator<Item = u16> + '_ {
        self.rows.iter().enumerate().flat_map(|(row, run)| {
            let columns = (0..WORD).filter(move |column| run.columns >> column & 1 == 1);
            columns.map(move |column| (row * WORD + column) as u16)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_partition_the_cells() {
        let cells: Vec<Cell> = (0..20)
            .flat_map(|y| (0..150).filter(move |x| (x * 7 + y * 3) % 5 == 0).map(move |x| Cell::new(x, y)))
            .collect();
        let mut seen = vec![0; cells.len()];
        for block in Block::of_cells(&cells) {
            for (run, y) in block.rows.iter().zip(block.corner.y..) {
                for position in run.positions() {
                    seen[position] += 1;
                    let column = cells[position].x - block.corner.x;
                    assert!(cells[position].y == y && run.columns >> column & 1 == 1);
                }
            }
        }
        assert!(seen.iter().all(|&times| times == 1));
    }
}
