//! Compatibility coefficients r(k, k') from labeled maps (Sect. 4.5, Eq. 4.8; Yamamoto 1979).
//!
//! Cost: one pass over the maps.
//!
//! The chapter takes p(k) and p(k|k') from "statistics in the labeled training map". Here p(k) is the share of cells
//! with label k, and p(k|k') the share of label k among the 8-neighbors of cells with label k', in one table for all
//! directions. Every cell that is not free carries the label wall, and so does everything outside the map. The counts
//! of several maps add up. The table depends on the size of a cell: it belongs to maps of one resolution.
//!
//! **Deviation**: coefficients may be kept above −1 by a small margin ([`LEAST_COMPATIBLE`]), so that two labels
//! which no training map showed side by side can still meet.

use serde::{Deserialize, Serialize};

use crate::grid::{Connectivity, Grid, Occupancy};
use crate::labels::{Label, LabelSet};

/// Least coefficient; in the chapter's own setting it is −1.
pub const LEAST_COMPATIBLE: f64 = -0.999;

/// r(k, k') for K classes and wall, which is the last label, K.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<Vec<f64>>", into = "Vec<Vec<f64>>")]
pub struct Compatibility {
    rows: Vec<Vec<f64>>,
}

/// Why numbers are not a valid table of compatibilities.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CompatibilityError {
    /// Not one row and column for each of 2 to 8 classes and for wall.
    #[error("expected 3 to 9 rows of as many coefficients, found {rows} rows, one of {columns}")]
    Shape {
        /// Number of rows.
        rows: usize,
        /// Length of the first row at fault.
        columns: usize,
    },
    /// A coefficient is not between −1 and 1.
    #[error("expected a coefficient from -1 to 1 in row {row}, column {column}, found {found}")]
    Value {
        /// Row k.
        row: usize,
        /// Column k'.
        column: usize,
        /// The value found.
        found: f64,
    },
}

impl Compatibility {
    /// Makes the table from r(k, k') in rows k, wall last.
    ///
    /// # Errors
    /// If the table is not square, not of 2 to 8 classes and wall, or a coefficient is outside −1..=1.
    pub fn from_rows(rows: Vec<Vec<f64>>) -> Result<Self, CompatibilityError> {
        let n = rows.len();
        let bad_size = !(LabelSet::MIN + 1..=LabelSet::MAX + 1).contains(&n);
        if let Some(row) = rows.iter().find(|row| bad_size || row.len() != n) {
            return Err(CompatibilityError::Shape { rows: n, columns: row.len() });
        }
        if rows.is_empty() {
            return Err(CompatibilityError::Shape { rows: 0, columns: 0 });
        }
        for (k, row) in rows.iter().enumerate() {
            if let Some(column) = row.iter().position(|r| !(-1.0..=1.0).contains(r)) {
                return Err(CompatibilityError::Value { row: k, column, found: row[column] });
            }
        }
        Ok(Self { rows })
    }

    /// Number of classes K, wall not counted.
    pub fn n_labels(&self) -> usize {
        self.rows.len() - 1
    }

    /// The label wall.
    pub fn wall(&self) -> Label {
        Label(self.n_labels() as u8)
    }

    /// r(k, k').
    pub fn r(&self, k: Label, k_other: Label) -> f64 {
        self.rows[k.index()][k_other.index()]
    }
}

impl TryFrom<Vec<Vec<f64>>> for Compatibility {
    type Error = CompatibilityError;
    fn try_from(rows: Vec<Vec<f64>>) -> Result<Self, CompatibilityError> {
        Self::from_rows(rows)
    }
}

impl From<Compatibility> for Vec<Vec<f64>> {
    fn from(table: Compatibility) -> Self {
        table.rows
    }
}

/// Labels with walls: label K if a cell is not free, `None` if a free cell has no label.
pub fn with_walls(
    map: &Grid<Occupancy>,
    labels: &Grid<Option<Label>>,
    n_labels: usize,
) -> Grid<Option<Label>> {
    let wall = Label(n_labels as u8);
    let cells = map.values().iter().zip(labels.values());
    let values =
        cells.map(|(&map, &label)| if map == Occupancy::Free { label } else { Some(wall) }).collect();
    Grid::from_rows(map.width(), map.height(), values)
}

/// Counts of labels, and of labels in neighboring cells.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PairCounts {
    n_labels: usize,
    /// Cells of each label, wall last.
    cells: Vec<u64>,
    /// N(k, k') at `k · (K + 1) + k'`: cells of label k next to a cell of label k'.
    pairs: Vec<u64>,
}

impl PairCounts {
    /// Empty counts for `n_labels` classes and wall.
    pub fn new(n_labels: usize) -> Self {
        let n = n_labels + 1;
        Self { n_labels, cells: vec![0; n], pairs: vec![0; n * n] }
    }

    /// Counts the cells of a map, labeled as [`with_walls`] does; cells without a label are skipped.
    pub fn add(&mut self, labels: &Grid<Option<Label>>) {
        let n = self.n_labels + 1;
        let wall = Label(self.n_labels as u8);
        for (index, label) in labels.values().iter().enumerate() {
            let Some(label) = label else { continue };
            self.cells[label.index()] += 1;
            for &step in Connectivity::Eight.steps() {
                let neighbor = match labels.offset(labels.cell(index), step) {
                    Some(cell) => labels[cell],
                    None => Some(wall),
                };
                if let Some(neighbor) = neighbor {
                    self.pairs[label.index() * n + neighbor.index()] += 1;
                }
            }
        }
    }

    /// The coefficients, none below `least`.
    pub fn compatibility(&self, least: f64) -> Compatibility {
        let n = self.n_labels + 1;
        let n_cells: u64 = self.cells.iter().sum();
        let share = |part: u64, whole: u64| part as f64 / whole as f64;
        let r = |k: usize, k_other: usize| {
            let next_to_other: u64 = (0..n).map(|k| self.pairs[k * n + k_other]).sum();
            if n_cells == 0 || next_to_other == 0 {
                return 0.0;
            }
            let p = share(self.cells[k], n_cells);
            let p_given = share(self.pairs[k * n + k_other], next_to_other);
            coefficient(p, p_given).max(least)
        };
        Compatibility { rows: (0..n).map(|k| (0..n).map(|k_other| r(k, k_other)).collect()).collect() }
    }
}

/// r(k, k') from p(k) and p(k|k') (Eq. 4.8); 0, neither for nor against, for a label that never or always occurs.
fn coefficient(p: f64, p_given: f64) -> f64 {
    if p <= 0.0 || p >= 1.0 {
        return 0.0;
    }
    // Eq. (4.8)
    if p < p_given { (1.0 - p / p_given) / (1.0 - p) } else { p_given / p - 1.0 }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "poles of the formula are exact")]
mod tests {
    use super::*;
    use crate::grid::{Cell, OccupancyGrid};

    #[test]
    fn eq_4_8_by_hand_and_at_its_poles() {
        assert!((coefficient(0.25, 0.5) - 2.0 / 3.0).abs() < 1e-15);
        assert!((coefficient(0.5, 0.25) + 0.5).abs() < 1e-15);
        assert_eq!(coefficient(0.5, 0.5), 0.0);
        assert_eq!(coefficient(0.5, 1.0), 1.0);
        assert_eq!(coefficient(0.5, 0.0), -1.0);
        assert_eq!((coefficient(0.0, 0.0), coefficient(1.0, 1.0)), (0.0, 0.0));
    }

    /// Two free cells side by side, class 0 left and class 1 right, nothing else: each sees the other once and
    /// the outside seven times.
    #[test]
    fn pairs_are_counted_over_eight_neighbors_and_the_outside() {
        let map = OccupancyGrid::from_ascii(1.0, "..");
        let labels = Grid::from_rows(2, 1, vec![Some(Label(0)), Some(Label(1))]);
        let mut counts = PairCounts::new(2);
        counts.add(&with_walls(&map.cells, &labels, 2));
        assert_eq!(counts.cells, [1, 1, 0]);
        assert_eq!(counts.pairs, [0, 1, 7, 1, 0, 7, 0, 0, 0]);
        let r = counts.compatibility(-1.0);
        // p(0) = 1/2, p(0|1) = 1, p(0|0) = 0, p(0|wall) = 1/2; wall itself never occurs in the map.
        assert_eq!(r.rows, [vec![-1.0, 1.0, 0.0], vec![1.0, -1.0, 0.0], vec![0.0; 3]]);
        assert_eq!(counts.compatibility(-0.5).r(Label(0), Label(0)), -0.5);
    }

    #[test]
    fn cells_without_a_label_are_passed_over_and_maps_add_up() {
        let map = OccupancyGrid::from_ascii(1.0, "..#");
        let mut labels = Grid::filled(3, 1, None);
        labels[Cell::new(1, 0)] = Some(Label(1));
        let mut counts = PairCounts::new(2);
        counts.add(&with_walls(&map.cells, &labels, 2));
        counts.add(&with_walls(&map.cells, &labels, 2));
        assert_eq!(counts.cells, [0, 2, 2]);
        assert_eq!(counts.pairs, [0, 0, 0, 0, 0, 14, 0, 2, 14]);
    }

    #[test]
    fn tables_of_another_shape_or_range_are_refused() {
        let shape = |rows: Vec<Vec<f64>>| Compatibility::from_rows(rows);
        assert!(matches!(shape(vec![]), Err(CompatibilityError::Shape { rows: 0, .. })));
        assert!(matches!(shape(vec![vec![0.0; 2]; 2]), Err(CompatibilityError::Shape { rows: 2, .. })));
        assert!(matches!(shape(vec![vec![0.0; 4]; 3]), Err(CompatibilityError::Shape { columns: 4, .. })));
        for bad in [f64::NAN, -1.5, f64::INFINITY] {
            let mut rows = vec![vec![0.0; 3]; 3];
            rows[1][2] = bad;
            assert!(matches!(shape(rows), Err(CompatibilityError::Value { row: 1, column: 2, .. })));
        }
    }
}
