//! Scans and features of many cells, block by block, so that ranges and values stay in cache.
//!
//! A block of at most 512 cells is cast (`scan`), its cells are measured 16 at a time, and the values are
//! handed to the caller before the next block starts; only what the caller keeps is stored. Blocks of
//! different rows run in parallel.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::plan::{Buffers, Plan};
use super::values::Values;
use super::{FeatureId, FeatureTable};
use crate::grid::{Cell, OccupancyGrid};
use crate::progress::Progress;
use crate::scan::lanes::{Lanes, WIDTH};
use crate::scan::{Block, BlockRanges, Instructions, N_BEAMS, RangeScan, RayCaster, ScanConfig};

/// The cells to measure, and the settings.
#[derive(Clone, Copy)]
pub struct Job<'a> {
    /// The map.
    pub grid: &'a OccupancyGrid,
    /// Free cells of the map, in row-major order, each once: all of them, or any part.
    pub cells: &'a [Cell],
    /// The features to compute.
    pub columns: &'a [FeatureId],
    /// How scans are simulated.
    pub config: &'a ScanConfig,
    /// Receives the number of finished cells.
    pub progress: &'a dyn Progress,
    /// Which vector instructions to use.
    pub instructions: Instructions,
}

impl std::fmt::Debug for Job<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Job").field("n_cells", &self.cells.len()).field("columns", &self.columns).finish()
    }
}

/// The feature values of a block's cells.
#[derive(Clone, Debug)]
pub struct BlockValues {
    values: Vec<f32>,
    n_cells: usize,
}

impl BlockValues {
    /// Number of cells.
    pub fn n_cells(&self) -> usize {
        self.n_cells
    }

    /// The values of column number `column`, one per cell.
    #[inline(always)]
    pub fn column(&self, column: usize) -> &[f32] {
        let stride = Block::MAX_CELLS;
        &self.values[column * stride..][..self.n_cells]
    }
}

/// The features `columns` of `cells`: free cells of the map in row-major order, each once.
///
/// Cost: about 1 ns per beam and at most a few microseconds for all features, per cell and core. Values are
/// the same bits on any number of threads.
///
/// # Panics
/// If the cells are not in row-major order or lie outside the map, or a column is named twice.
///
/// # Examples
/// ```
/// use placegraph::features::{self, FeatureId};
/// use placegraph::grid::{CellGraph, OccupancyGrid};
/// use placegraph::{progress::Silent, scan::ScanConfig};
///
/// let map = OccupancyGrid::from_ascii(1.0, "#####\n#...#\n#####");
/// let graph = CellGraph::new(&map.cells);
/// let area = FeatureId::from_name("B1").unwrap();
/// let table = features::extract(&map, graph.cells(), &[area], &ScanConfig::default(), &Silent);
/// assert!(table.column(0).iter().all(|&m2| (m2 - 3.0).abs() < 0.05));
/// ```
pub fn extract(
    grid: &OccupancyGrid,
    cells: &[Cell],
    columns: &[FeatureId],
    config: &ScanConfig,
    progress: &dyn Progress,
) -> FeatureTable {
    let job = Job { grid, cells, columns, config, progress, instructions: Instructions::default() };
    let mut values = vec![0.0; cells.len() * columns.len()];
    for_each_block(&job, table_slots(cells, &mut values), |block, measured, (start, slot)| {
        for (column, out) in slot.iter_mut().enumerate() {
            scatter(block, *start, 1, measured.column(column), out);
        }
    });
    FeatureTable::from_columns(columns.to_vec(), cells.len(), values)
}

/// For each band of cells: the position of its first cell, and its part of every column of `values`.
fn table_slots<'v>(cells: &[Cell], values: &'v mut [f32]) -> Vec<(usize, Vec<&'v mut [f32]>)> {
    let bands = Block::bands(cells);
    let mut slots: Vec<_> = bands.iter().map(|band| (band.start, Vec::new())).collect();
    for mut column in values.chunks_exact_mut(cells.len().max(1)) {
        for (band, (_, slot)) in bands.iter().zip(&mut slots) {
            let (part, rest) = column.split_at_mut(band.len());
            slot.push(part);
            column = rest;
        }
    }
    slots
}

/// Puts `per_cell` values for each of a block's cells where they belong in the values of a band.
fn scatter<T: Copy>(block: &Block, start: usize, per_cell: usize, values: &[T], band: &mut [T]) {
    let mut rest = values;
    for run in &block.rows {
        let positions = run.positions();
        let (here, after) = rest.split_at(positions.len() * per_cell);
        if !here.is_empty() {
            let first = (positions.start - start) * per_cell;
            band[first..first + here.len()].copy_from_slice(here);
        }
        rest = after;
    }
}

/// Measures all cells of the job and keeps a few numbers for each. `evaluate(values, out)` computes them from the
/// values of a block while these are in cache: it fills `out`, with equally many numbers for each cell, cell by cell.
///
/// `numbers` takes those of all cells, in the order of `job.cells`. No table of features is ever stored.
///
/// # Panics
/// If there are not as many numbers for every cell, or the cells are not in row-major order or lie outside the map.
pub fn evaluate<T: Copy + Default + Send>(
    job: &Job<'_>,
    numbers: &mut [T],
    evaluate: impl Fn(&BlockValues, &mut [T]) + Sync,
) {
    let per_cell = numbers.len() / job.cells.len().max(1);
    assert_eq!(numbers.len(), job.cells.len() * per_cell, "as many numbers for every cell");
    let mut rest = numbers;
    let mut slots = Vec::new();
    for band in Block::bands(job.cells) {
        let (part, after) = rest.split_at_mut(band.len() * per_cell);
        slots.push((band.start, part));
        rest = after;
    }
    for_each_block(job, slots, |block, values, (start, band)| {
        let mut out = vec![T::default(); values.n_cells() * per_cell];
        evaluate(values, &mut out);
        scatter(block, *start, per_cell, &out, band);
    });
}

/// Calls `visit` with every block, its values, and the slot of its band.
fn for_each_block<S: Send>(
    job: &Job<'_>,
    slots: Vec<S>,
    visit: impl Fn(&Block, &BlockValues, &mut S) + Sync,
) {
    let caster = RayCaster::new(job.grid, job.config);
    let plan = Plan::new(job.columns);
    let done = AtomicUsize::new(0);
    let bands = Block::bands(job.cells).into_par_iter().zip(slots).with_max_len(1);
    // One for each thread that works, not for each band: a megabyte is not made and cleared so often.
    let idle = Mutex::new(Vec::new());
    let lock = || idle.lock().unwrap_or_else(PoisonError::into_inner);
    bands.for_each(|(band, mut slot)| {
        let n = band.len();
        let taken = lock().pop();
        let mut workspace = taken.unwrap_or_else(|| Workspace::new(job.columns.len()));
        for block in Block::of_band(job.cells, band) {
            caster.cast_block(&block, job.instructions, &mut workspace.ranges);
            workspace.measure(&plan, job);
            visit(&block, &workspace.values, &mut slot);
        }
        lock().push(workspace);
        job.progress.advance(done.fetch_add(n, Ordering::Relaxed) + n, job.cells.len());
    });
}

/// Buffers of one thread, used for band after band.
struct Workspace {
    ranges: BlockRanges,
    buffers: Box<Buffers>,
    group: Values,
    values: BlockValues,
}

impl Workspace {
    fn new(n_columns: usize) -> Self {
        Self {
            ranges: BlockRanges::new(),
            buffers: Buffers::new(),
            group: Values::new(),
            values: BlockValues { values: vec![0.0; n_columns * Block::MAX_CELLS], n_cells: 0 },
        }
    }

    /// Measures the cells of the block that was cast last.
    fn measure(&mut self, plan: &Plan, job: &Job<'_>) {
        self.values.n_cells = self.ranges.n_cells();
        for (number, ranges) in self.ranges.groups().iter().enumerate() {
            plan.measure(ranges, job.instructions, &mut self.buffers, &mut self.group);
            for (column, id) in job.columns.iter().enumerate() {
                let at = column * Block::MAX_CELLS + number * WIDTH;
                self.values.values[at..at + WIDTH].copy_from_slice(&self.group.at(usize::from(id.0)).0);
            }
        }
    }
}

/// The features `columns` of one scan. Its ranges are rounded to `f32`, as the engine's are.
pub fn of_scan(scan: &RangeScan, columns: &[FeatureId]) -> Vec<f32> {
    let plan = Plan::new(columns);
    let mut ranges = Box::new([Lanes::all(0.0); N_BEAMS + 1]);
    for (beam, lanes) in ranges.iter_mut().enumerate() {
        *lanes = Lanes::all(scan.ranges_m()[beam % N_BEAMS] as f32);
    }
    let mut values = Values::new();
    plan.measure(&ranges, Instructions::default(), &mut Buffers::new(), &mut values);
    columns.iter().map(|id| values.at(usize::from(id.0)).0[0]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::all;
    use crate::grid::CellGraph;
    use crate::progress::Silent;

    fn map() -> OccupancyGrid {
        OccupancyGrid::from_ascii(
            0.3,
            "
            ####################################################################################
            #.......#..........................................................#...............#
            #.......#..#.......................................................................#
            #..................................................................#...............#
            #.......#..........................................................#...............#
            #.......############.###############################################.......???.....#
            #.......................................#..........................................#
            #.......................................#..........................................#
            #..#....############.###############################################...............#
            #.......#..........................................................#...............#
            ####################################################################################
            ",
        )
    }

    fn table(instructions: Instructions, n_threads: usize) -> Vec<f32> {
        let (map, columns, config) = (map(), all(), ScanConfig::default());
        let graph = CellGraph::new(&map.cells);
        let (grid, cells, progress) = (&map, graph.cells(), &Silent);
        let job = Job { grid, cells, columns: &columns, config: &config, progress, instructions };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
        pool.install(|| {
            let mut table = vec![0.0; cells.len() * columns.len()];
            evaluate(&job, &mut table, |values, out| {
                for column in 0..columns.len() {
                    for (cell, &value) in values.column(column).iter().enumerate() {
                        out[cell * columns.len() + column] = value;
                    }
                }
            });
            table
        })
    }

    #[test]
    fn any_instructions_and_any_number_of_threads_give_the_same_bits() {
        let bits = |values: Vec<f32>| values.into_iter().map(f32::to_bits).collect::<Vec<_>>();
        let expected = bits(table(Instructions::Baseline, 1));
        for instructions in Instructions::ALL {
            assert_eq!(bits(table(instructions, 1)), expected, "{instructions:?}");
        }
        assert_eq!(bits(table(Instructions::Widest, 4)), expected);
    }

    #[test]
    fn a_table_holds_what_is_evaluated() {
        let map = map();
        let graph = CellGraph::new(&map.cells);
        let some: Vec<_> = graph.cells().iter().copied().filter(|cell| (cell.x + cell.y) % 3 == 0).collect();
        let columns = all();
        let dense = extract(&map, graph.cells(), &columns, &ScanConfig::default(), &Silent);
        let sparse = extract(&map, &some, &columns, &ScanConfig::default(), &Silent);
        for column in 0..columns.len() {
            for (row, &cell) in some.iter().enumerate() {
                let node = graph.node_at(cell).unwrap();
                assert_eq!(sparse.column(column)[row].to_bits(), dense.column(column)[node].to_bits());
            }
        }
    }
}
