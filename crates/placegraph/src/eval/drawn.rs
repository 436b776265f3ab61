//! Labels drawn as text, for tests.

use crate::grid::Grid;
use crate::labels::Label;

/// c corridor, r room, d doorway, everything else unlabeled; the first line is the top row.
pub(super) fn grid(drawing: &str) -> Grid<Option<Label>> {
    let lines: Vec<&str> = drawing.split_whitespace().collect();
    let label = |letter| "crd".find(letter).map(|index| Label(index as u8));
    let values = lines.iter().rev().flat_map(|line| line.chars().map(label)).collect();
    Grid::from_rows(lines[0].len() as u32, lines.len() as u32, values)
}
