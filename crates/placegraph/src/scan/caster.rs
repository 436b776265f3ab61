//! Scans of many cells: an exact walk along the grid for 512 start cells at once.
//!
//! The result is that of [`cast`](super::cast), bit for bit; only ranges are rounded to `f32`. Seen from cell
//! centers, beams of one direction enter the same sequence of cells, so a block of 64 × 8 start cells walks
//! together: the map is one bit per cell, a beam is one bit of a mask, and a step is a shift and an AND.
//! Cost: about a nanosecond per beam with 512-bit instructions.

use super::cast::range_m;
use super::lanes::{Singles, WIDTH, ZERO};
use super::obstacles::Obstacles;
use super::path::{N_OCTANT, Octant, octant_path};
use super::walk::{LANES, MAX_STEPS, Path, Plane, Steps, count_steps, meets, slot};
use super::{Block, Instructions, N_BEAMS, ScanConfig};
use crate::grid::{Cell, OccupancyGrid};

/// Ranges of [`WIDTH`] cells in meters, by beam; the first beam again at the end.
pub(crate) type Ranges = [Singles; N_BEAMS + 1];

/// Steps that are counted in a byte.
const SHORT: usize = 256;

/// Casts the beams of whole blocks of cells. Holds the map as bits, and the paths of all directions.
#[derive(Clone, Debug)]
pub struct RayCaster {
    obstacles: Obstacles,
    paths: Vec<Path>,
    /// For the beams of the first octant: the range in meters after each number of steps; at least [`SHORT`] of them.
    ranges_m: Vec<Vec<f32>>,
}

/// The ranges of a block's cells.
#[derive(Clone, Debug)]
pub struct BlockRanges {
    /// The cells of the block in row-major order, a few at a time, as features are computed of them.
    groups: Vec<Ranges>,
    n_cells: usize,
    /// Where [`Steps`] has every cell's count; the last one again until the last group is full.
    slots: Vec<u16>,
}

impl BlockRanges {
    /// Buffers for the ranges of any block.
    #[expect(clippy::new_without_default, reason = "a buffer of 0.7 MB is made on purpose")]
    pub fn new() -> Self {
        Self { groups: vec![[ZERO; N_BEAMS + 1]; LANES / WIDTH], n_cells: 0, slots: Vec::new() }
    }

    /// Number of cells of the block.
    pub fn n_cells(&self) -> usize {
        self.n_cells
    }

    /// The range in meters of a beam of the block's cell number `cell`, row-major.
    ///
    /// # Panics
    /// If the block has no such cell, or there is no such beam.
    pub fn range_m(&self, cell: usize, beam: usize) -> f32 {
        assert!(cell < self.n_cells && beam < N_BEAMS, "cell {cell} of {}, beam {beam}", self.n_cells);
        self.groups[cell / WIDTH][beam].0[cell % WIDTH]
    }

    /// All ranges; beyond the last cell its ranges are repeated.
    #[inline(always)]
    pub(crate) fn groups(&self) -> &[Ranges] {
        &self.groups[..self.slots.len() / WIDTH]
    }

    /// Takes the cells of `block` in place of the last one's.
    fn take(&mut self, block: &Block) {
        self.n_cells = block.n_cells();
        self.slots.clear();
        self.slots.extend(block.lanes().map(slot));
        if let Some(&last) = self.slots.last() {
            self.slots.resize(self.n_cells.next_multiple_of(WIDTH), last);
        }
    }
}

impl RayCaster {
    /// Prepares casting in `grid`. A beam enters at most 65 535 cells, more than any sensible range.
    ///
    /// Cost: O(width · height) bits and O(360 · longest path) offsets.
    pub fn new(grid: &OccupancyGrid, config: &ScanConfig) -> Self {
        let obstacles = Obstacles::new(grid, config);
        let n_max = (grid.cells.width() as usize + grid.cells.height() as usize).min(MAX_STEPS);
        let range_max_cells = config.range_max_m / grid.frame.resolution_m();
        let octant: Vec<_> = (0..N_OCTANT).map(|beam| octant_path(beam, range_max_cells, n_max)).collect();
        let ranges_m = octant.iter().map(|path| {
            let entries = path.iter().map(|step| range_m(step.entry_cells, grid, config));
            let all = entries.chain([config.range_max_m]);
            let mut ranges: Vec<f32> = all.map(|range| (range * config.range_scale) as f32).collect();
            // Not looked up, but so no look-up has to be checked.
            ranges.resize(ranges.len().max(SHORT), 0.0);
            ranges
        });
        let paths = (0..N_BEAMS).map(|beam| {
            let turn = Octant::of(beam);
            let cells = octant[turn.beam].iter().map(|step| turn.back(step.x, step.y));
            let (right, up) = turn.back(1, 1);
            let beside = cells.clone().filter(|_| turn.is_diagonal());
            Path {
                cells: cells.map(|(x, y)| obstacles.offset(x, y)).collect(),
                beside: beside
                    .map(|(x, y)| [obstacles.offset(x - right, y), obstacles.offset(x, y - up)])
                    .collect(),
            }
        });
        Self { paths: paths.collect(), ranges_m: ranges_m.collect(), obstacles }
    }

    /// The cells of `wanted`, of the block at `corner`, whose `beam` meets one of `changed`.
    pub(super) fn meets(
        &self,
        corner: Cell,
        wanted: &Plane,
        beam: usize,
        changed: &Obstacles,
        instructions: Instructions,
    ) -> Plane {
        let position = self.obstacles.position(corner);
        instructions.run(
            #[inline(always)]
            || meets(&self.obstacles, changed, position, wanted, &self.paths[beam]),
        )
    }

    /// Casts all beams of the cells of `block`.
    ///
    /// # Panics
    /// If the block does not lie in the map.
    pub fn cast_block(&self, block: &Block, instructions: Instructions, ranges: &mut BlockRanges) {
        instructions.run(
            #[inline(always)]
            || self.cast_block_inlined(block, ranges),
        );
    }

    #[inline(always)]
    fn cast_block_inlined(&self, block: &Block, ranges: &mut BlockRanges) {
        ranges.take(block);
        let position = self.obstacles.position(block.corner);
        let wanted = block.rows.map(|run| run.columns);
        for (beam, path) in self.paths.iter().enumerate() {
            let steps = count_steps(&self.obstacles, position, &wanted, path);
            let table = self.ranges_m[Octant::of(beam).beam].as_slice();
            let groups = ranges.groups.iter_mut().zip(ranges.slots.as_chunks::<WIDTH>().0);
            match (&steps, table.first_chunk::<SHORT>()) {
                (Steps { low, high: None }, Some(table)) => {
                    for (group, slots) in groups {
                        for (range, &slot) in group[beam].0.iter_mut().zip(slots) {
                            *range = table[usize::from(low[usize::from(slot) % LANES])];
                        }
                    }
                }
                (Steps { low, high }, _) => {
                    let high = high.unwrap_or([0; LANES]);
                    for (group, slots) in groups {
                        for (range, &slot) in group[beam].0.iter_mut().zip(slots) {
                            let slot = usize::from(slot) % LANES;
                            *range = table[usize::from(u16::from_le_bytes([low[slot], high[slot]]))];
                        }
                    }
                }
            }
        }
        for group in &mut ranges.groups[..ranges.slots.len() / WIDTH] {
            group[N_BEAMS] = group[0];
        }
    }
}
