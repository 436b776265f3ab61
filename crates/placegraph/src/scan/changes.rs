//! Scans that are what they were, found without casting all of their beams: a scan changes only if a beam enters a cell that did.
//!
//! Beams walk through the new map as for their ranges ([`super::walk`]), but only until they meet a cell that stops beams in one of the
//! two maps alone. Up to there both maps are the same. Beams that cannot reach such a cell are not cast, nor those of a cell that
//! met one.

use rayon::prelude::*;

use super::obstacles::{Obstacles, ROWS, WORD};
use super::walk::Plane;
use super::{Block, Instructions, N_BEAMS, RayCaster, Run, ScanConfig, beam_direction};
use crate::geom::Vec2;
use crate::grid::{Cell, OccupancyGrid};

/// What stops beams in a map, to be compared with a later one. Memory: a bit a cell.
#[derive(Clone, Debug)]
pub(crate) struct Stops {
    obstacles: Obstacles,
    width: u32,
    height: u32,
    resolution_m: f64,
}

impl Stops {
    /// What stops beams in `grid`.
    pub(crate) fn of(grid: &OccupancyGrid, config: &ScanConfig) -> Self {
        Self {
            obstacles: Obstacles::new(grid, config),
            width: grid.cells.width(),
            height: grid.cells.height(),
            resolution_m: grid.frame.resolution_m(),
        }
    }

    /// Whether a cell stops beams; all outside of the map do.
    fn stops(&self, x: i64, y: i64) -> bool {
        let inside = |v: i64, end: u32| u32::try_from(v).ok().filter(|&v| v < end);
        let cell = inside(x, self.width).zip(inside(y, self.height));
        cell.is_none_or(|(x, y)| self.obstacles.is_set(Cell::new(x, y)))
    }
}

/// Whether the scan of each of `cells` of the map that `now` is of may be another one than it was in that of `before`. A cell of `now` stands
/// at the place of the cell `shift` columns and rows away in `before`. What is not marked has the same ranges, to the bit.
///
/// Cost: a comparison of the maps if they are equal; at most that of casting, and half as much again.
///
/// # Panics
/// If the cells are not in row-major order, each once, or lie outside of the map.
pub(crate) fn may_differ(
    grid: &OccupancyGrid,
    now: &Stops,
    before: &Stops,
    shift: (i64, i64),
    cells: &[Cell],
    config: &ScanConfig,
) -> Vec<bool> {
    let mut found = vec![false; cells.len()];
    let changes = Changes::between(now, before, shift);
    // Ranges are in meters. What lies outside of the new map, but not of the old one, is not looked at.
    #[expect(clippy::float_cmp, reason = "the same map has the same resolution, to the last bit")]
    if now.resolution_m != before.resolution_m || changes.leaves_out {
        found.fill(true);
        return found;
    }
    if changes.areas.is_empty() {
        return found;
    }
    let caster = RayCaster::new(grid, config);
    let range_cells = config.range_max_m / now.resolution_m;
    let (mut rest, mut bands) = (found.as_mut_slice(), Vec::new());
    for band in Block::bands(cells) {
        let (slot, after) = rest.split_at_mut(band.len());
        bands.push((band, slot));
        rest = after;
    }
    bands.into_par_iter().for_each(|(band, slot)| {
        let start = band.start;
        for block in Block::of_band(cells, band) {
            let met = changes.met_by(&block, &caster, range_cells);
            for (run, met) in block.rows.iter().zip(met) {
                let columns = (0..WORD).filter(|column| run.columns >> column & 1 == 1);
                for (position, column) in Run::positions(run).zip(columns) {
                    slot[position - start] = met >> column & 1 == 1;
                }
            }
        }
    });
    found
}

/// Side of the squares that changes are told by, in cells.
const AREA: u32 = 128;
/// Most areas that beams are compared with: then one around all of them.
const MAX_AREAS: usize = 48;

/// The cells that stop beams in one of two maps alone.
struct Changes {
    cells: Obstacles,
    /// Rectangles around all of them: first and last column and row.
    areas: Vec<[u32; 4]>,
    /// Whether a cell that beams passed lies outside of the new map.
    leaves_out: bool,
}

impl Changes {
    fn between(now: &Stops, before: &Stops, shift: (i64, i64)) -> Self {
        let mut cells = now.obstacles.emptied();
        let mut areas: Vec<[u32; 4]> = Vec::new();
        let n_across = now.width.div_ceil(AREA) as usize;
        let mut area_of = vec![None; n_across * now.height.div_ceil(AREA) as usize];
        for y in 0..now.height {
            for x in 0..now.width {
                let (old_x, old_y) = (i64::from(x) + shift.0, i64::from(y) + shift.1);
                if now.obstacles.is_set(Cell::new(x, y)) == before.stops(old_x, old_y) {
                    continue;
                }
                cells.set(Cell::new(x, y));
                let index = *area_of[(y / AREA) as usize * n_across + (x / AREA) as usize]
                    .get_or_insert_with(|| {
                        areas.push([x, x, y, y]);
                        areas.len() - 1
                    });
                let [left, right, low, high] = &mut areas[index];
                (*left, *right) = ((*left).min(x), (*right).max(x));
                (*low, *high) = ((*low).min(y), (*high).max(y));
            }
        }
        if areas.len() > MAX_AREAS {
            let around =
                |a: [u32; 4], b: &[u32; 4]| [a[0].min(b[0]), a[1].max(b[1]), a[2].min(b[2]), a[3].max(b[3])];
            areas = vec![areas.iter().fold(areas[0], around)];
        }
        let is_inside = |v: i64, shift: i64, end: u32| (0..i64::from(end)).contains(&(v - shift));
        let leaves_out = (0..before.height).any(|y| {
            let row_stays = is_inside(i64::from(y), shift.1, now.height);
            (0..before.width).any(|x| {
                let stays = row_stays && is_inside(i64::from(x), shift.0, now.width);
                !stays && !before.obstacles.is_set(Cell::new(x, y))
            })
        });
        Self { cells, areas, leaves_out }
    }

    /// The cells of `block` of which a beam meets a change.
    fn met_by(&self, block: &Block, caster: &RayCaster, range_cells: f64) -> Plane {
        let mut met: Plane = [0; ROWS];
        let wanted: Plane = block.rows.map(|run| run.columns);
        // In an order in which neighbors come late: most cells that see a change are found soon.
        for beam in (0..N_BEAMS).map(|number| number * STRIDE_OF_BEAMS % N_BEAMS) {
            let mut open = wanted;
            (0..ROWS).for_each(|row| open[row] &= !met[row]);
            if open == [0; ROWS] {
                break;
            }
            if !self.areas.iter().any(|area| may_reach(block.corner, beam_direction(beam), area, range_cells))
            {
                continue;
            }
            let new = caster.meets(block.corner, &open, beam, &self.cells, Instructions::default());
            (0..ROWS).for_each(|row| met[row] |= new[row]);
        }
        met
    }
}

/// Has no factor in common with the number of beams.
const STRIDE_OF_BEAMS: usize = 97;

/// Whether a beam from any cell of the block at `corner` may enter a cell of `area`: whether a line from the origin meets the
/// rectangle of all displacements, with two cells around it.
fn may_reach(corner: Cell, direction: Vec2, area: &[u32; 4], range_cells: f64) -> bool {
    let [left, right, low, high] = area.map(f64::from);
    let (x, y) = (f64::from(corner.x), f64::from(corner.y));
    let (block_width, block_height) = (WORD as f64 - 1.0, ROWS as f64 - 1.0);
    let spans = [
        (direction.x, left - x - block_width - 2.0, right - x + 2.0),
        (direction.y, low - y - block_height - 2.0, high - y + 2.0),
    ];
    let (mut from, mut to) = (0.0, range_cells + 2.0);
    for (speed, first, last) in spans {
        if speed.abs() < 1e-12 {
            if !(first..=last).contains(&0.0) {
                return false;
            }
        } else {
            let ends = [first / speed, last / speed];
            from = ends[0].min(ends[1]).max(from);
            to = ends[0].max(ends[1]).min(to);
        }
    }
    from <= to
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{CellGraph, Grid, MapFrame, Occupancy};
    use crate::scan::cast;

    /// Rooms and pillars, with `n` cells changed by a fixed rule of `seed`.
    fn map(width: u32, height: u32, seed: u64, n: u32) -> OccupancyGrid {
        let mut cells = Grid::filled(width, height, Occupancy::Free);
        for cell in cells.cells().collect::<Vec<_>>() {
            let is_wall = cell.x % 40 == 0 && cell.y % 23 > 3 || cell.y % 31 == 0 && cell.x % 17 > 2;
            if is_wall || cell.x + 1 == width || cell.y + 1 == height {
                cells[cell] = Occupancy::Occupied;
            }
        }
        let mut state = seed;
        for _ in 0..n {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let cell = Cell::new((state >> 33) as u32 % width, (state >> 13) as u32 % height);
            cells[cell] = match cells[cell] {
                Occupancy::Free => Occupancy::Occupied,
                _ => Occupancy::Free,
            };
        }
        OccupancyGrid { frame: MapFrame::new(0.1, crate::geom::Pose2::default()).unwrap(), cells }
    }

    /// The map with `left` and `below` unknown columns and rows more.
    fn padded(map: &OccupancyGrid, left: u32, below: u32) -> OccupancyGrid {
        let (width, height) = (map.cells.width() + left, map.cells.height() + below);
        let mut cells = Grid::filled(width, height, Occupancy::Unknown);
        for cell in map.cells.cells() {
            cells[Cell::new(cell.x + left, cell.y + below)] = map.cells[cell];
        }
        OccupancyGrid { cells, frame: map.frame }
    }

    #[test]
    fn what_is_not_marked_has_the_same_ranges() {
        for (range_max_m, max_speck_m) in [(50.0, 0.0), (4.0, 0.0), (50.0, 0.2)] {
            let config = ScanConfig { range_max_m, max_speck_m, ..ScanConfig::default() };
            for (seed, n, left, below) in [(1, 0, 0, 0), (2, 1, 0, 0), (3, 3, 5, 2), (4, 40, 70, 9)] {
                let old = map(150, 90, 7, 20);
                let mut changed = old.clone();
                let (other, plain) = (map(150, 90, seed, n), map(150, 90, seed, 0));
                for cell in old.cells.cells().filter(|&cell| other.cells[cell] != plain.cells[cell]) {
                    changed.cells[cell] = match old.cells[cell] {
                        Occupancy::Free => Occupancy::Occupied,
                        _ => Occupancy::Free,
                    };
                }
                let new = padded(&changed, left, below);
                let [before, now] = [&old, &new].map(|map| Stops::of(map, &config));
                let graph = CellGraph::new(&new.cells);
                let shift = (-i64::from(left), -i64::from(below));
                let marked = may_differ(&new, &now, &before, shift, graph.cells(), &config);
                let mut n_marked = 0;
                for (&cell, &marked) in graph.cells().iter().zip(&marked) {
                    let Some((x, y)) = cell.x.checked_sub(left).zip(cell.y.checked_sub(below)) else {
                        continue;
                    };
                    n_marked += usize::from(marked);
                    let was = Cell::new(x, y);
                    if !marked && cell.x % 5 == cell.y % 5 && old.cells[was] == Occupancy::Free {
                        assert_eq!(
                            cast(&new, cell, &config),
                            cast(&old, was, &config),
                            "{cell:?}, seed {seed}"
                        );
                    }
                }
                // A change may be a speck, which stops no beam.
                let is_seen = n > 0 && max_speck_m == 0.0;
                assert!(
                    if is_seen { n_marked > 0 } else { n > 0 || n_marked == 0 },
                    "seed {seed}: {n_marked}"
                );
                assert!(n > 3 || n_marked < marked.len() / 2, "{n_marked} of {}", marked.len());
            }
        }
    }

    #[test]
    fn another_resolution_or_a_map_that_was_cut_has_no_scan_in_common() {
        let config = ScanConfig::default();
        let old = map(60, 40, 1, 0);
        let mut finer = old.clone();
        finer.frame = MapFrame::new(0.05, crate::geom::Pose2::default()).unwrap();
        let cut = OccupancyGrid { cells: Grid::filled(20, 20, Occupancy::Free), frame: old.frame };
        for new in [finer, cut] {
            let [before, now] = [&old, &new].map(|map| Stops::of(map, &config));
            let graph = CellGraph::new(&new.cells);
            assert!(
                may_differ(&new, &now, &before, (0, 0), graph.cells(), &config).iter().all(|&marked| marked)
            );
        }
    }
}
