//! A rectangular array of cells, row-major, row 0 at the map's bottom.

use crate::geom::Point2;

/// A cell's column `x` and row `y`, counted from the lower left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Cell {
    /// Column, from the left.
    pub x: u32,
    /// Row, from the bottom.
    pub y: u32,
}

impl Cell {
    /// The cell in column `x` and row `y`.
    pub const fn new(x: u32, y: u32) -> Self {
        Self { x, y }
    }

    /// Its center, in cells from the lower left corner of the grid.
    pub fn center(self) -> Point2 {
        Point2::new(self.x as f64 + 0.5, self.y as f64 + 0.5)
    }

    /// The cell at this offset in columns and rows, which must exist.
    pub(crate) fn moved(self, columns: i32, rows: i32) -> Self {
        Self::new(self.x.wrapping_add_signed(columns), self.y.wrapping_add_signed(rows))
    }
}

/// `width · height` values, row-major, row 0 at the bottom. Both sides are at least 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Grid<T> {
    width: u32,
    height: u32,
    values: Vec<T>,
}

impl<T> Grid<T> {
    /// Makes a grid from `values`, rows from the bottom up.
    ///
    /// # Panics
    /// If a side is 0 or `values.len()` is not `width · height`; readers check both before they call this.
    pub fn from_rows(width: u32, height: u32, values: Vec<T>) -> Self {
        assert!(width > 0 && height > 0, "a grid has at least one cell");
        assert_eq!(values.len(), width as usize * height as usize, "one value per cell");
        Self { width, height, values }
    }

    /// Reads a drawing with the meaning of every character; the first line is the top of the map.
    ///
    /// Lines are trimmed and empty lines skipped, so that drawings can be indented.
    ///
    /// # Panics
    /// If lines differ in length or there are none: this is for examples and tests.
    ///
    /// # Examples
    /// ```
    /// use placegraph::grid::{Cell, Grid};
    ///
    /// let is_wall = Grid::from_ascii("##.\n#..", |character| character == '#');
    /// assert!(is_wall[Cell::new(1, 1)] && !is_wall[Cell::new(1, 0)]);
    /// ```
    pub fn from_ascii(drawing: &str, value_of: impl Fn(char) -> T) -> Self {
        let lines: Vec<&str> = drawing.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
        let width = lines.first().map_or(0, |line| line.chars().count());
        let is_wide = |line: &&str| line.chars().count() == width;
        assert!(lines.iter().all(is_wide), "all lines of a drawing are equally long");
        let values = lines.iter().rev().flat_map(|line| line.chars().map(&value_of)).collect();
        Self::from_rows(width as u32, lines.len() as u32, values)
    }

    /// Number of columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Number of rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All values, row-major from the bottom left.
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// All values, mutable.
    pub fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }

    /// The values of row `y`, from left to right.
    pub fn row(&self, y: u32) -> &[T] {
        let start = y as usize * self.width as usize;
        &self.values[start..start + self.width as usize]
    }

    /// The rows from the top down, as images have them.
    ///
    /// # Examples
    /// ```
    /// use placegraph::grid::Grid;
    ///
    /// let grid = Grid::from_rows(2, 2, vec!["bottom left", "bottom right", "top left", "top right"]);
    /// assert_eq!(grid.rows_from_top().next().unwrap(), ["top left", "top right"]);
    /// ```
    pub fn rows_from_top(&self) -> impl DoubleEndedIterator<Item = &[T]> + ExactSizeIterator {
        self.values.chunks_exact(self.width as usize).rev()
    }

    /// Position of `cell` in [`Grid::values`].
    pub fn index(&self, cell: Cell) -> usize {
        cell.y as usize * self.width as usize + cell.x as usize
    }

    /// The cell at position `index` of [`Grid::values`].
    pub fn cell(&self, index: usize) -> Cell {
        Cell::new((index % self.width as usize) as u32, (index / self.width as usize) as u32)
    }

    /// All cells, in the order of [`Grid::values`].
    pub fn cells(&self) -> impl Iterator<Item = Cell> + use<T> {
        let width = self.width;
        (0..self.height).flat_map(move |y| (0..width).map(move |x| Cell::new(x, y)))
    }

    /// The cell `step` away from `cell`, or `None` outside the grid.
    pub fn offset(&self, cell: Cell, step: (i32, i32)) -> Option<Cell> {
        let x = cell.x.checked_add_signed(step.0).filter(|&x| x < self.width)?;
        let y = cell.y.checked_add_signed(step.1).filter(|&y| y < self.height)?;
        Some(Cell::new(x, y))
    }

    /// A grid of the same shape with `f` applied to every value.
    pub fn map<U>(&self, f: impl FnMut(&T) -> U) -> Grid<U> {
        Grid { width: self.width, height: self.height, values: self.values.iter().map(f).collect() }
    }
}

impl<T: Clone> Grid<T> {
    /// A grid with the same `value` everywhere.
    ///
    /// # Panics
    /// If a side is 0.
    pub fn filled(width: u32, height: u32, value: T) -> Self {
        Self::from_rows(width, height, vec![value; width as usize * height as usize])
    }
}

impl<T> std::ops::Index<Cell> for Grid<T> {
    type Output = T;
    fn index(&self, cell: Cell) -> &T {
        &self.values[Grid::index(self, cell)]
    }
}

impl<T> std::ops::IndexMut<Cell> for Grid<T> {
    fn index_mut(&mut self, cell: Cell) -> &mut T {
        let index = Grid::index(self, cell);
        &mut self.values[index]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn index_and_cell_are_inverse() {
        let grid = Grid::filled(3, 2, 0u8);
        assert!(grid.cells().enumerate().all(|(i, c)| grid.index(c) == i && grid.cell(i) == c));
        assert_eq!(grid.offset(Cell::new(2, 1), (1, 0)), None);
        assert_eq!(grid.offset(Cell::new(0, 0), (0, -1)), None);
        assert_eq!(grid.offset(Cell::new(0, 0), (1, 1)), Some(Cell::new(1, 1)));
    }
}
