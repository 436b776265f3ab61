//! The nearest-neighbor transform τ of a feature vector: its smallest distances to the stored exemplars of every
//! class (Sect. 4.6.1, Eq. 4.10, 4.11).
//!
//! Exact search: every distance is computed, 64 exemplars at once, in the widest vectors that the processor has.
//! Sums over features run in the features' order, so the result has the same bits on every processor. Cost: queries ×
//! exemplars × features multiplications; no tree helps in 30 dimensions.

use pulp::{Simd, WithSimd};
use rayon::prelude::*;

/// Exemplars of a tile, stored feature by feature.
const LANES: usize = 64;
/// Vectors that are summed at once, so that additions need not wait for each other.
const ACCUMULATORS: usize = 4;
/// Queries that share one pass over the exemplars.
const BLOCK: usize = 64;

/// Feature vectors of training cells in groups (the classes, or the classes of every part of the training map).
#[derive(Clone, Debug, PartialEq)]
pub struct Exemplars {
    n_features: usize,
    n_groups: usize,
    tiles: Vec<Tile>,
}

#[derive(Clone, Debug, PartialEq)]
struct Tile {
    group: usize,
    /// Row that every lane came from; fewer than [`LANES`] in a group's last tile.
    rows: Vec<u32>,
    /// Feature-major; unused lanes are infinitely far.
    values: Vec<f32>,
}

impl Exemplars {
    /// Makes exemplars from `vectors`, `n_features` per row; the group of every row is in `groups`, each below
    /// `n_groups`.
    ///
    /// # Panics
    /// If the lengths do not fit.
    pub fn new(n_features: usize, vectors: &[f32], n_groups: usize, groups: &[usize]) -> Self {
        assert_eq!(vectors.len(), n_features * groups.len(), "n_features values per exemplar");
        let mut tiles = Vec::new();
        for group in 0..n_groups {
            let rows: Vec<u32> =
                (0..groups.len() as u32).filter(|&row| groups[row as usize] == group).collect();
            tiles.extend(rows.chunks(LANES).map(|rows| {
                let mut values = vec![f32::INFINITY; n_features * LANES];
                for (lane, &row) in rows.iter().enumerate() {
                    for f in 0..n_features {
                        values[f * LANES + lane] = vectors[row as usize * n_features + f];
                    }
                }
                Tile { group, rows: rows.to_vec(), values }
            }));
        }
        Self { n_features, n_groups, tiles }
    }

    /// Number of groups.
    pub fn n_groups(&self) -> usize {
        self.n_groups
    }

    /// The `n_neighbors` smallest squared distances from every query to the exemplars of every group, ascending.
    ///
    /// `queries` has one row of features per query; the result one row of `n_groups · n_neighbors` per query. Only
    /// exemplars with `counts(query, exemplar row)` count; where a group has fewer, the rest is infinite.
    /// Queries run in parallel.
    pub fn nearest(
        &self,
        queries: &[f32],
        n_neighbors: usize,
        counts: impl Fn(usize, u32) -> bool + Sync,
    ) -> Vec<f32> {
        let width = self.n_groups * n_neighbors;
        let mut nearest = vec![f32::INFINITY; queries.len() / self.n_features * width];
        #[cfg(not(target_arch = "wasm32"))]
        let arch = pulp::Arch::new();
        nearest
            .par_chunks_mut(BLOCK * width)
            .zip(queries.par_chunks(BLOCK * self.n_features))
            .enumerate()
            .for_each(|(block, (nearest, queries))| {
                for tile in &self.tiles {
                    let rows = queries.chunks_exact(self.n_features).zip(nearest.chunks_exact_mut(width));
                    for (i, (query, row)) in rows.enumerate() {
                        let smallest = &mut row[tile.group * n_neighbors..(tile.group + 1) * n_neighbors];
                        let mut distances = [0.0; LANES];
                        let tile_distances =
                            TileDistances { query, tile: &tile.values, distances: &mut distances };
                        // As in `Instructions::run`.
                        #[cfg(target_arch = "wasm32")]
                        let closest = pulp::Scalar::new().vectorize(tile_distances);
                        #[cfg(not(target_arch = "wasm32"))]
                        let closest = arch.dispatch(tile_distances);
                        if closest < smallest[n_neighbors - 1] {
                            insert(smallest, &distances, &tile.rows, |row| counts(block * BLOCK + i, row));
                        }
                    }
                }
            });
        nearest
    }
}

/// Merges the `distances` that count into the ascending list of the smallest.
fn insert(smallest: &mut [f32], distances: &[f32; LANES], rows: &[u32], counts: impl Fn(u32) -> bool) {
    for (&distance, &row) in distances.iter().zip(rows) {
        if distance < smallest[smallest.len() - 1] && counts(row) {
            let place = smallest.partition_point(|&other| other <= distance);
            smallest[place..].rotate_right(1);
            smallest[place] = distance;
        }
    }
}

/// Squared distances from a query to the exemplars of a tile, Eq. (4.10); returns the smallest.
struct TileDistances<'a> {
    query: &'a [f32],
    tile: &'a [f32],
    distances: &'a mut [f32; LANES],
}

impl WithSimd for TileDistances<'_> {
    type Output = f32;

    #[expect(
        clippy::inline_always,
        reason = "only inlined code is compiled for the vectors found at run time"
    )]
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f32 {
        let (distances, _) = S::as_mut_simd_f32s(self.distances);
        let mut closest = simd.splat_f32s(f32::INFINITY);
        for (part, sums) in distances.chunks_exact_mut(ACCUMULATORS).enumerate() {
            let mut accumulators = [simd.splat_f32s(0.0); ACCUMULATORS];
            for (&value, lanes) in self.query.iter().zip(self.tile.chunks_exact(LANES)) {
                let value = simd.splat_f32s(value);
                let (lanes, _) = S::as_simd_f32s(lanes);
                let lanes = &lanes[part * ACCUMULATORS..(part + 1) * ACCUMULATORS];
                for (sum, &lane) in accumulators.iter_mut().zip(lanes) {
                    let difference = simd.sub_f32s(value, lane);
                    // No fused multiplication: the bits shall not depend on the processor.
                    *sum = simd.add_f32s(*sum, simd.mul_f32s(difference, difference));
                }
            }
            for (out, sum) in sums.iter_mut().zip(accumulators) {
                *out = sum;
                closest = simd.min_f32s(closest, sum);
            }
        }
        simd.reduce_min_f32s(closest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eq_4_11_smallest_distances_per_class() {
        // Class 0 at 0, 3 and 10; class 1 at 4.
        let exemplars = Exemplars::new(1, &[0.0, 10.0, 4.0, 3.0], 2, &[0, 0, 1, 0]);
        let inf = f32::INFINITY;
        assert_eq!(exemplars.nearest(&[1.0], 2, |_, _| true), [1.0, 4.0, 9.0, inf]);
        // Without itself, exemplar row 0, the query at 0 has other neighbors.
        assert_eq!(exemplars.nearest(&[0.0], 2, |_, row| row != 0), [9.0, 100.0, 16.0, inf]);
    }

    #[test]
    fn equal_distances_are_counted_each() {
        let exemplars = Exemplars::new(2, &[1.0, 0.0, 0.0, 1.0, 3.0, 0.0], 1, &[0, 0, 0]);
        assert_eq!(exemplars.nearest(&[0.0, 0.0], 3, |_, _| true), [1.0, 1.0, 9.0]);
    }
}
