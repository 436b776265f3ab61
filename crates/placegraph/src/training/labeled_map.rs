//! A map with labels, and the part of it to train on.

use super::TrainError;
use crate::grid::{Cell, Grid, OccupancyGrid};
use crate::labels::{Label, LabelSet};
use crate::model::{MapRecord, sha256_hex};

/// A rectangle of cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// The cell at the lower left.
    pub min: Cell,
    /// Column and row behind the upper right cell.
    pub end: Cell,
}

impl Window {
    /// Whether `cell` lies inside.
    pub fn contains(&self, cell: Cell) -> bool {
        (self.min.x..self.end.x).contains(&cell.x) && (self.min.y..self.end.y).contains(&cell.y)
    }
}

/// A map whose free cells have labels.
#[derive(Clone, Debug)]
pub struct LabeledMap {
    /// Name for reports.
    pub name: String,
    /// The map; scans see all of it.
    pub grid: OccupancyGrid,
    /// Label of every cell; `None` for a cell that has none, or that must not be trained on. Labels of cells that are
    /// not free are ignored.
    pub labels: Grid<Option<Label>>,
    /// Learn only from cells in here; default: everywhere.
    pub window: Option<Window>,
    /// The building, where there are several maps of it: they are held out together. Default: one that no other map shows.
    pub building: Option<String>,
}

impl LabeledMap {
    /// # Errors
    /// If the labels do not fit the map or the label set, or the window the map.
    pub(super) fn check(&self, label_set: &LabelSet) -> Result<(), TrainError> {
        let map = || self.name.clone();
        let size = (self.grid.cells.width(), self.grid.cells.height());
        let found = (self.labels.width(), self.labels.height());
        if size != found {
            return Err(TrainError::Size { expected: size, found, map: map() });
        }
        let inside =
            |w: &Window| w.min.x < w.end.x && w.end.x <= size.0 && w.min.y < w.end.y && w.end.y <= size.1;
        if self.window.as_ref().is_some_and(|window| !inside(window)) {
            return Err(TrainError::Window { size, map: map() });
        }
        let n_labels = label_set.len();
        match self.labels.values().iter().flatten().find(|label| label.index() >= n_labels) {
            Some(label) => Err(TrainError::Label { n_labels, found: label.0.saturating_add(1), map: map() }),
            None => Ok(()),
        }
    }

    /// Free cells with a label to train on, in row-major order.
    pub fn labeled_cells(&self) -> impl Iterator<Item = (Cell, Label)> + '_ {
        let cells = self.labels.cells().zip(self.labels.values());
        cells.filter_map(|(cell, &label)| {
            let inside = self.window.as_ref().is_none_or(|window| window.contains(cell));
            label.filter(|_| inside && self.grid.is_free(cell)).map(|label| (cell, label))
        })
    }

    /// The labels with everything outside the window taken out, for counts of neighbors.
    pub(crate) fn inside_window(&self, mut labels: Grid<Option<Label>>) -> Grid<Option<Label>> {
        if let Some(window) = &self.window {
            let cells: Vec<Cell> = labels.cells().filter(|&cell| !window.contains(cell)).collect();
            for cell in cells {
                labels[cell] = None;
            }
        }
        labels
    }

    /// What the model remembers of the map.
    pub(super) fn record(&self, label_set: &LabelSet) -> MapRecord {
        let mut cells_per_class = vec![0; label_set.len()];
        self.labeled_cells().for_each(|(_, label)| cells_per_class[label.index()] += 1);
        let (name, resolution_m) = (self.name.clone(), self.grid.frame.resolution_m());
        MapRecord { name, sha256: sha256_hex(&self.bytes()), resolution_m, cells_per_class }
    }

    /// All that training sees of the map.
    fn bytes(&self) -> Vec<u8> {
        let (width, height) = (self.grid.cells.width(), self.grid.cells.height());
        let whole = Window { min: Cell::new(0, 0), end: Cell::new(width, height) };
        let window = self.window.unwrap_or(whole);
        let mut bytes = self.grid.frame.resolution_m().to_le_bytes().to_vec();
        for number in [width, height, window.min.x, window.min.y, window.end.x, window.end.y] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend(self.grid.cells.values().iter().map(|&occupancy| occupancy as u8));
        bytes.extend(self.labels.values().iter().map(|label| label.map_or(0, |label| label.0 + 1)));
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labeled() -> LabeledMap {
        let grid = OccupancyGrid::from_ascii(1.0, "..#");
        let labels = Grid::from_rows(3, 1, vec![Some(Label(0)), Some(Label(2)), Some(Label(1))]);
        LabeledMap { name: "three".into(), grid, labels, window: None, building: None }
    }

    #[test]
    fn only_free_cells_in_the_window_are_learned_from() {
        let cells = |map: &LabeledMap| map.labeled_cells().collect::<Vec<_>>();
        let mut map = labeled();
        assert_eq!(cells(&map), [(Cell::new(0, 0), Label(0)), (Cell::new(1, 0), Label(2))]);
        map.window = Some(Window { min: Cell::new(1, 0), end: Cell::new(3, 1) });
        assert_eq!(cells(&map), [(Cell::new(1, 0), Label(2))]);
        assert_ne!(map.bytes(), labeled().bytes());
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let set = LabelSet::default();
        assert_eq!(labeled().check(&set), Ok(()));
        let mut map = labeled();
        map.labels = Grid::filled(2, 1, None);
        assert!(matches!(map.check(&set), Err(TrainError::Size { expected: (3, 1), found: (2, 1), .. })));
        let mut map = labeled();
        map.labels.values_mut()[0] = Some(Label(3));
        assert!(matches!(map.check(&set), Err(TrainError::Label { n_labels: 3, found: 4, .. })));
        let mut map = labeled();
        map.window = Some(Window { min: Cell::new(0, 0), end: Cell::new(4, 1) });
        assert!(matches!(map.check(&set), Err(TrainError::Window { size: (3, 1), .. })));
    }
}
