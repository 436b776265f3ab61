//! Scans of many cells: an exact walk along the grid for 512 start cells at once.
//!
//! The result is that of [`cast`](super::cast), bit for bit; only ranges are rounded to `f32`. Seen from cell
//! centers, beams of one direction enter the same sequence of cells, so a block of 64 × 8 start cells walks
//! together: the map is one bit per cell, a beam is one bit of a mask, and a step is a shift and an AND.
//! Cost: about a nanosecond per beam with 512-bit instructions.

use super::cast::range_m;
use super::obstacles::Obstacles;
use super::path::{N_OCTANT, Octant, octant_path};
use super::walk::{LANES, MAX_STEPS, Path, count_steps};
use super::{Block, Instructions, N_BEAMS, ScanConfig};
use crate::grid::OccupancyGrid;

/// Ranges from beam to beam in a [`BlockRanges`]: no power of 2, which would put the beams of a cell in the same few
/// places of a cache.
const STRIDE: usize = LANES + 16;

/// Casts the beams of whole blocks of cells. Holds the map as bits and the paths of all directions.
#[derive(Clone, Debug)]
pub struct RayCaster {
    obstacles: Obstacles,
    paths: Vec<Path>,
    /// For the beams of the first octant: the range in meters after so many steps.
    ranges_m: Vec<Vec<f32>>,
}

/// The ranges of a block's cells, beam by beam.
#[derive(Clone, Debug)]
pub struct BlockRanges {
    ranges_m: Vec<f32>,
    lanes: Vec<u16>,
}

impl BlockRanges {
    /// Room for the ranges of any block.
    #[expect(clippy::new_without_default, reason = "a buffer of 0.7 MB is made on purpose")]
    pub fn new() -> Self {
        Self { ranges_m: vec![0.0; N_BEAMS * STRIDE], lanes: Vec::with_capacity(LANES) }
    }

    /// Number of cells of the block.
    pub fn n_cells(&self) -> usize {
        self.lanes.len()
    }

    /// The ranges of `beam` in meters, one per cell of the block, row-major.
    pub fn beam(&self, beam: usize) -> &[f32] {
        &self.padded_beam(beam)[..self.lanes.len()]
    }

    /// The same, followed by the ranges of an earlier block, up to [`Block::MAX_CELLS`] ranges.
    #[inline(always)]
    pub(crate) fn padded_beam(&self, beam: usize) -> &[f32] {
        &self.ranges_m[beam * STRIDE..][..LANES]
    }
}

impl RayCaster {
    /// Prepares casting in `grid`. A beam enters at most 65 535 cells, more than any range worth the name.
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
            all.map(|range| (range * config.range_scale) as f32).collect()
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
        ranges.lanes.clear();
        ranges.lanes.extend(block.lanes());
        let position = self.obstacles.position(block.corner);
        let wanted = block.rows.map(|run| run.columns);
        for (beam, path) in self.paths.iter().enumerate() {
            let steps = count_steps(&self.obstacles, position, &wanted, path);
            let table = self.ranges_m[Octant::of(beam).beam].as_slice();
            let lanes = ranges.lanes.as_slice();
            let out = &mut ranges.ranges_m[beam * STRIDE..][..lanes.len()];
            for (range, &lane) in out.iter_mut().zip(lanes) {
                *range = table[usize::from(steps[usize::from(lane) % LANES])];
            }
        }
    }
}
