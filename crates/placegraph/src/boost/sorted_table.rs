//! Every column of a feature table sorted once, for the exact search of thresholds.

use rayon::prelude::*;

use crate::features::FeatureTable;

/// Marks a place in a sorted column whose value differs from the one before it: a threshold fits there.
pub(super) const NEW_VALUE: u32 = 1 << 31;

/// Examples: chosen rows of a feature table, with every column's rows in the order of their values.
///
/// Memory: 4 bytes per example and column beside the table itself.
#[derive(Debug)]
pub struct SortedTable<'a> {
    table: &'a FeatureTable,
    /// Row of the table of every example.
    rows: Vec<u32>,
    /// Per column, the examples by ascending value, equal values by ascending number; with [`NEW_VALUE`].
    order: Vec<u32>,
}

impl<'a> SortedTable<'a> {
    /// Sorts the columns of `table` over the examples in `rows`. Cost O(L n log n), columns in parallel.
    ///
    /// # Panics
    /// If there is no row, or 2³¹ rows or more.
    pub fn new(table: &'a FeatureTable, rows: Vec<u32>) -> Self {
        assert!(!rows.is_empty() && rows.len() < NEW_VALUE as usize, "1 to 2^31 - 1 examples");
        let mut order = vec![0; rows.len() * table.columns().len()];
        order.par_chunks_mut(rows.len()).enumerate().for_each(|(column, order)| {
            sort_column(table.column(column), &rows, order);
        });
        Self { table, rows, order }
    }

    /// The table whose rows the examples are.
    pub fn table(&self) -> &FeatureTable {
        self.table
    }

    /// Number of examples.
    pub fn n_examples(&self) -> usize {
        self.rows.len()
    }

    /// The sorted examples of `column`, with marks.
    pub(super) fn order(&self, column: usize) -> &[u32] {
        &self.order[column * self.rows.len()..(column + 1) * self.rows.len()]
    }

    /// The values of `column`, one an example, in the order of the examples.
    pub(super) fn values(&self, column: usize) -> impl Iterator<Item = f32> + '_ {
        let values = self.table.column(column);
        self.rows.iter().map(|&row| values[row as usize])
    }

    /// The value in `column` of the example at `place` of the sorted order.
    pub(super) fn sorted_value(&self, column: usize, place: usize) -> f32 {
        let example = self.order(column)[place] & !NEW_VALUE;
        self.table.column(column)[self.rows[example as usize] as usize]
    }
}

/// Writes the examples by ascending value, marked where the value is new.
fn sort_column(values: &[f32], rows: &[u32], order: &mut [u32]) {
    // Value and number in one word: one sort of integers, ties by number.
    let mut keys: Vec<u64> = rows
        .iter()
        .enumerate()
        .map(|(example, &row)| u64::from(ordered_bits(values[row as usize])) << 32 | example as u64)
        .collect();
    keys.sort_unstable();
    let mut last = keys[0] >> 32;
    for (place, key) in order.iter_mut().zip(keys) {
        *place = key as u32 | if key >> 32 == last { 0 } else { NEW_VALUE };
        last = key >> 32;
    }
}

/// Bits that compare like the values; both zeros have the same.
fn ordered_bits(value: f32) -> u32 {
    let bits = (value + 0.0).to_bits();
    if bits >> 31 == 0 { bits | 1 << 31 } else { !bits }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::FeatureId;

    #[test]
    fn marks_stand_where_values_change() {
        let table = FeatureTable::from_columns(vec![FeatureId(0)], 6, vec![9.0, 2.0, 0.0, -1.5, -0.0, 2.0]);
        let sorted = SortedTable::new(&table, vec![1, 2, 3, 4, 5]);
        // Examples 0 to 4 are 2, 0, -1.5, -0, 2.
        assert_eq!(sorted.order(0), [2, 1 | NEW_VALUE, 3, NEW_VALUE, 4]);
        assert_eq!(sorted.sorted_value(0, 4).to_bits(), 2.0f32.to_bits());
    }
}
