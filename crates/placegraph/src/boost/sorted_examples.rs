//! Examples sorted once by every feature, and divided into bins of neighboring values, for the exact search of
//! thresholds.

use std::ops::Range;

use rayon::prelude::*;

use crate::features::FeatureTable;
use crate::labels::Label;

/// Most bins of a column: their numbers are bytes.
pub(super) const MAX_BINS: usize = 256;
/// Marks a place in a sorted column whose value differs from the one before it: a threshold fits there.
pub(super) const NEW_VALUE: u32 = 1 << 31;
/// Parts of a class from which examples are taken in turn.
const STREAMS: usize = 16;

/// Chosen rows of a feature table, numbered class after class.
///
/// Memory: 5 bytes per example and column in addition to the table.
#[derive(Debug)]
pub(super) struct SortedExamples<'a> {
    table: &'a FeatureTable,
    /// Row of the table of every example.
    rows: Vec<u32>,
    /// The examples of every class.
    of_class: Vec<Range<usize>>,
    /// Per column, the examples by ascending value, with [`NEW_VALUE`].
    order: Vec<u32>,
    /// Per column and bin, the places of its examples in that order. Equal values share a bin, and none is empty.
    bins: Vec<Vec<Range<usize>>>,
    /// Per column, the bin of every example.
    codes: Vec<u8>,
}

impl<'a> SortedExamples<'a> {
    /// Sorts the columns of `table` over `rows`, whose classes are `labels`. Cost O(L n log n), columns in parallel.
    ///
    /// # Panics
    /// If there is no row, or 2³¹ rows or more.
    pub(super) fn new(table: &'a FeatureTable, rows: &[u32], labels: &[Label], n_labels: usize) -> Self {
        assert!(!rows.is_empty() && rows.len() < NEW_VALUE as usize, "1 to 2^31 - 1 examples");
        let mut classes = vec![Vec::new(); n_labels];
        rows.iter().zip(labels).for_each(|(&row, label)| classes[label.index()].push(row));
        let mut end = 0;
        let range = |class: &Vec<u32>| {
            end += class.len();
            end - class.len()..end
        };
        let of_class = classes.iter().map(range).collect();
        let rows: Vec<u32> = classes.iter().flat_map(|rows| in_turn(rows)).collect();
        let n_values = rows.len() * table.columns().len();
        let (mut order, mut codes) = (vec![0; n_values], vec![0; n_values]);
        let columns = order.par_chunks_mut(rows.len()).zip(codes.par_chunks_mut(rows.len())).enumerate();
        let bins = columns.map(|(column, (order, codes))| {
            sort_column(table.column(column), &rows, order);
            let bins = bins(order);
            for (code, places) in bins.iter().enumerate() {
                for &marked in &order[places.clone()] {
                    codes[(marked & !NEW_VALUE) as usize] = code as u8;
                }
            }
            bins
        });
        let bins = bins.collect();
        Self { table, rows, of_class, order, bins, codes }
    }

    /// The table whose rows the examples are.
    pub(super) fn table(&self) -> &FeatureTable {
        self.table
    }

    /// Row of the table of every example.
    pub(super) fn rows(&self) -> &[u32] {
        &self.rows
    }

    /// Number of examples.
    pub(super) fn n_examples(&self) -> usize {
        self.rows.len()
    }

    /// The examples of every class.
    pub(super) fn of_class(&self) -> &[Range<usize>] {
        &self.of_class
    }

    /// The sorted examples of `column`, with marks.
    pub(super) fn order(&self, column: usize) -> &[u32] {
        &self.order[column * self.rows.len()..(column + 1) * self.rows.len()]
    }

    /// The places of the bins of `column`, in ascending order.
    pub(super) fn bins(&self, column: usize) -> &[Range<usize>] {
        &self.bins[column]
    }

    /// The bin of every example in `column`.
    pub(super) fn codes(&self, column: usize) -> &[u8] {
        &self.codes[column * self.rows.len()..(column + 1) * self.rows.len()]
    }

    /// The value of every example in `column`.
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

/// Rows from distant places in turn: neighbors have like values, and sums over examples that fall into one bin after
/// the other would wait for each other.
fn in_turn(rows: &[u32]) -> impl Iterator<Item = u32> + '_ {
    let step = rows.len().div_ceil(STREAMS).max(1);
    (0..step.min(rows.len())).flat_map(move |first| rows[first..].iter().step_by(step).copied())
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

/// Deals a sorted column into bins of equal size, as far as equal values allow.
fn bins(order: &[u32]) -> Vec<Range<usize>> {
    let n = order.len();
    let mut bins = Vec::with_capacity(MAX_BINS);
    let mut start = 0;
    for bin in 1..=MAX_BINS {
        let wanted = (bin * n / MAX_BINS).max(start + 1).min(n);
        let end = (wanted..n).find(|&place| order[place] & NEW_VALUE != 0).unwrap_or(n);
        if start < n {
            bins.push(start..end);
        }
        start = end;
    }
    bins
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::FeatureId;

    #[test]
    fn marks_stand_where_values_change() {
        let table = FeatureTable::from_columns(vec![FeatureId(0)], 6, vec![9.0, 2.0, 0.0, -1.5, -0.0, 2.0]);
        let labels = [0, 0, 1, 0, 1].map(Label);
        let examples = SortedExamples::new(&table, &[1, 2, 3, 4, 5], &labels, 2);
        // Examples 0 to 4 are the rows 1, 2, 4 of class 0, then 3 and 5 of class 1.
        assert_eq!(examples.values(0).collect::<Vec<_>>(), [2.0, 0.0, -0.0, -1.5, 2.0]);
        assert_eq!(examples.of_class(), [0..3, 3..5]);
        assert_eq!(examples.order(0), [3, 1 | NEW_VALUE, 2, NEW_VALUE, 4]);
        assert_eq!(examples.bins(0), [0..1, 1..3, 3..5]);
        assert_eq!(examples.codes(0), [2, 1, 1, 0, 2]);
        assert_eq!(examples.sorted_value(0, 4).to_bits(), 2.0f32.to_bits());
    }

    /// Half of the values are 0, the others different.
    #[test]
    fn bins_of_many_values_are_filled_and_split_no_value() {
        let n = 10_000;
        let value = |i: usize| if i.is_multiple_of(2) { 0.0 } else { ((i * 7919) % n) as f32 };
        let table = FeatureTable::from_columns(vec![FeatureId(0)], n, (0..n).map(value).collect());
        let rows: Vec<u32> = (0..n as u32).collect();
        let examples = SortedExamples::new(&table, &rows, &vec![Label(0); n], 1);
        let bins = examples.bins(0);
        assert_eq!((bins[0].clone(), bins[bins.len() - 1].end), (0..n / 2, n));
        assert!(bins.len() > MAX_BINS / 2 && bins[1..].iter().all(|bin| (1..=80).contains(&bin.len())));
        for pair in bins.windows(2) {
            assert_eq!(pair[0].end, pair[1].start);
            assert!(examples.sorted_value(0, pair[0].end - 1) < examples.sorted_value(0, pair[1].start));
        }
    }
}
