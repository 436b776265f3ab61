//! A table of feature values: a row per cell, a column per feature.

/// Position of a feature in the registry. Files name features and never store this number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FeatureId(pub u16);

/// `n × L` values, column-major, every value finite.
///
/// Values are `f32`: two million labeled cells by 240 features are 1.9 GB. Features whose values leave the
/// range of `f32` are stored on a logarithmic scale, which makes no difference to a decision stump (see the registry).
#[derive(Clone, Debug, PartialEq)]
pub struct FeatureTable {
    columns: Vec<FeatureId>,
    n_rows: usize,
    values: Vec<f32>,
}

impl FeatureTable {
    /// Makes a table from `values`, `n_rows` per column, with columns in the order of `columns`.
    ///
    /// # Panics
    /// If the length is not `n_rows · columns.len()`, or a column is named twice; in debug builds also if a
    /// value is not finite.
    pub fn from_columns(columns: Vec<FeatureId>, n_rows: usize, values: Vec<f32>) -> Self {
        assert_eq!(values.len(), n_rows * columns.len(), "n_rows values per column");
        let mut sorted = columns.clone();
        sorted.sort_unstable();
        assert!(sorted.windows(2).all(|pair| pair[0] != pair[1]), "a feature has one column");
        debug_assert!(values.iter().all(|value| value.is_finite()), "feature values are finite");
        Self { columns, n_rows, values }
    }

    /// Number of rows n.
    pub fn n_rows(&self) -> usize {
        self.n_rows
    }

    /// The features of the columns.
    pub fn columns(&self) -> &[FeatureId] {
        &self.columns
    }

    /// The values of column number `column`, one per row.
    pub fn column(&self, column: usize) -> &[f32] {
        &self.values[column * self.n_rows..(column + 1) * self.n_rows]
    }

    /// The same columns of some rows.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn of_rows(&self, rows: &[u32]) -> Self {
        let columns = (0..self.columns.len()).map(|c| self.column(c));
        let values = columns.flat_map(|column| rows.iter().map(|&row| column[row as usize])).collect();
        Self { columns: self.columns.clone(), n_rows: rows.len(), values }
    }

    /// The values of `feature`, if it is in the table.
    pub fn values_of(&self, feature: FeatureId) -> Option<&[f32]> {
        self.columns.iter().position(|&id| id == feature).map(|column| self.column(column))
    }
}
