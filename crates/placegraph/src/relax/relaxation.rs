//! The relaxation iteration (Sect. 4.5, Eqs. 4.6 and 4.7): the probabilities of every cell move toward those that its
//! eight neighbors support, in all cells at once.
//!
//! Cost O(K² n) an iteration. The iterations are made in passes over the map, several in each, in bands of rows and tiles
//! that stay in cache (`tile.rs`); every value is computed by the same operations however the map is cut. In place:
//! memory is an eighth of the field and a band a thread.
//!
//! Influence weights are o = 1/8 for each of the eight neighbors, also where some of them are walls or outside the
//! map. Cells that are not free are wall with probability 1 and stay so: the update is multiplicative. They need no
//! plane of their own either, because a neighbor is wall exactly where the K class probabilities are 0. With
//! B(k') = Σ_j p_j(k') over the eight neighbors, Σ_j p_j(wall) = 8 − Σ B(k'), so Eq. (4.7) reads
//!
//! ```text
//! q(k) = r(k, wall) + ⅛ Σ_k' (r(k, k') − r(k, wall)) B(k')
//! ```
//!
//! **Deviation**: `f32`, under a test that bounds the difference from the formula in `f64` (`tests/labeling/relax_oracle.rs`);
//! probabilities below 10⁻³⁰ become 0. A cell for which the neighbors rule out every label keeps its probabilities,
//! which Eq. (4.6) leaves open.

use std::ops::Range;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::compatibility::Compatibility;
use super::planes::{LANES, Planes};
use super::tile::{MAX_STEPS, Support, TILE_BLOCKS, Tile};
use crate::grid::CellGraph;
use crate::labels::{Label, LabelField};
use crate::scan::Instructions;

/// Iterations of a pass.
const STEPS: u32 = 10;
const _: () = assert!(STEPS <= MAX_STEPS);
/// Fewest and most rows of a band, which one thread steps through at a time.
const BAND: Range<u32> = 64..256;

/// How long to iterate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RelaxConfig {
    /// Number of iterations. Default 50, as in the chapter.
    pub iterations: u32,
    /// Stop when no node's most probable label has changed for this many iterations. Default: never.
    pub patience: Option<u32>,
}

impl Default for RelaxConfig {
    fn default() -> Self {
        Self { iterations: 50, patience: None }
    }
}

/// The result of the relaxation.
#[derive(Clone, Debug, PartialEq)]
pub struct Relaxed {
    /// The probabilities after the last iteration.
    pub field: LabelField,
    /// Number of iterations made.
    pub iterations: u32,
    /// Largest change of a probability in the last iteration.
    pub last_change: f32,
}

/// Relaxes `initial` over the 8-neighborhoods of `graph`.
///
/// # Examples
/// ```
/// use placegraph::grid::{CellGraph, OccupancyGrid};
/// use placegraph::labels::LabelField;
/// use placegraph::relax::{Compatibility, RelaxConfig, relax};
///
/// let graph = CellGraph::new(&OccupancyGrid::from_ascii(0.05, "...\n...\n...").cells);
/// // Eight cells of a room; the one in the middle looks a little more like a corridor.
/// let row = |node: usize| if node == 4 { [0.6, 0.4] } else { [0.1, 0.9] };
/// let field = LabelField::from_rows(2, (0..9).flat_map(row).collect());
/// // Equal labels support each other, others do not; the wall, last, says nothing.
/// let r = vec![vec![0.5, -0.5, 0.0], vec![-0.5, 0.5, 0.0], vec![0.0, 0.0, 0.0]];
/// let relaxed = relax(&graph, &field, &Compatibility::from_rows(r)?, &RelaxConfig::default());
/// let draw = |field: &LabelField| {
///     let labels = field.most_likely();
///     graph.to_ascii(|node| ['c', 'r'][labels[node].index()])
/// };
/// assert_eq!(draw(&field), "rrr\nrcr\nrrr\n");
/// assert_eq!(draw(&relaxed.field), "rrr\nrrr\nrrr\n");
/// # Ok::<(), placegraph::relax::CompatibilityError>(())
/// ```
///
/// # Panics
/// If the field is not over the graph's nodes or the compatibilities not over the field's labels.
pub fn relax(
    graph: &CellGraph,
    initial: &LabelField,
    compatibility: &Compatibility,
    config: &RelaxConfig,
) -> Relaxed {
    let mut field = initial.clone();
    let (iterations, last_change) = relax_in_place(graph, &mut field, compatibility, config);
    Relaxed { field, iterations, last_change }
}

/// Relaxes the field in place, without a copy. Returns the other members of [`Relaxed`]: the number of iterations and
/// the largest change in the last one.
///
/// # Panics
/// As [`relax`].
pub fn relax_in_place(
    graph: &CellGraph,
    field: &mut LabelField,
    compatibility: &Compatibility,
    config: &RelaxConfig,
) -> (u32, f32) {
    assert_eq!(field.n_nodes(), graph.n_nodes(), "a distribution per node");
    assert_eq!(field.n_labels(), compatibility.n_labels(), "compatibilities of the same labels");
    match field.n_labels() {
        2 => relax_labels::<2>(graph, field, compatibility, config),
        3 => relax_labels::<3>(graph, field, compatibility, config),
        4 => relax_labels::<4>(graph, field, compatibility, config),
        5 => relax_labels::<5>(graph, field, compatibility, config),
        6 => relax_labels::<6>(graph, field, compatibility, config),
        7 => relax_labels::<7>(graph, field, compatibility, config),
        8 => relax_labels::<8>(graph, field, compatibility, config),
        other => unreachable!("a label set has 2 to 8 classes, not {other}"),
    }
}

fn relax_labels<const K: usize>(
    graph: &CellGraph,
    field: &mut LabelField,
    compatibility: &Compatibility,
    config: &RelaxConfig,
) -> (u32, f32) {
    let support = Support::<K>::new(compatibility);
    let mut stability = config.patience.map(|patience| Stability::new(patience, field));
    let (mut iterations, mut last_change) = (0, 0.0);
    while iterations < config.iterations && graph.n_nodes() > 0 {
        // Labels are looked at after every iteration.
        let steps = if stability.is_some() { 1 } else { STEPS.min(config.iterations - iterations) };
        last_change = pass(graph, field.values_mut(), &support, steps);
        iterations += steps;
        if stability.as_mut().is_some_and(|stability| stability.reached(field)) {
            break;
        }
    }
    (iterations, last_change)
}

/// Watches for labels that no longer change.
struct Stability {
    patience: u32,
    labels: Vec<Label>,
    unchanged: u32,
}

impl Stability {
    fn new(patience: u32, field: &LabelField) -> Self {
        Self { patience, labels: field.most_likely(), unchanged: 0 }
    }

    fn reached(&mut self, field: &LabelField) -> bool {
        let labels = field.most_likely();
        self.unchanged = if labels == self.labels { self.unchanged + 1 } else { 0 };
        self.labels = labels;
        self.unchanged >= self.patience
    }
}

/// `steps` iterations over all cells; the largest change of a probability in the last of them.
fn pass<const K: usize>(graph: &CellGraph, field: &mut [f32], support: &Support<K>, steps: u32) -> f32 {
    let height = graph.height();
    let n_rows = height.div_ceil(4 * rayon::current_num_threads() as u32).clamp(BAND.start, BAND.end);
    let bands = (0..height).step_by(n_rows as usize).map(|y| y..height.min(y + n_rows));
    let nodes_of = |rows: Range<u32>| {
        let nodes = graph.nodes_in_rows(rows);
        nodes.start * K..nodes.end * K
    };
    // What a band sees of the bands below and above it, before any of them changes.
    let halos: Vec<_> = bands
        .map(|rows| {
            let below = rows.start.saturating_sub(steps)..rows.start;
            let above = rows.end..height.min(rows.end + steps);
            let [below, above] = [below, above].map(|rows| (rows.clone(), field[nodes_of(rows)].to_vec()));
            (below, rows, above)
        })
        .collect();
    let mut rest = field;
    let mut own = Vec::with_capacity(halos.len());
    for (_, rows, _) in &halos {
        let (values, after) = rest.split_at_mut(nodes_of(rows.clone()).len());
        own.push(values);
        rest = after;
    }
    let bands = own.into_par_iter().zip(halos);
    bands
        .map(|(values, (below, rows, above))| {
            let mut planes = Planes::new(graph, below.0.start..above.0.end, K);
            for (rows, values) in [(below.0, &*below.1), (rows.clone(), &*values), (above.0, &*above.1)] {
                planes.fill(graph, rows, values);
            }
            relax_band(graph, rows, &planes, support, steps, values)
        })
        .reduce(|| 0.0, f32::max)
}

/// The band of `rows`, tile by tile, from `planes` into `field`.
fn relax_band<const K: usize>(
    graph: &CellGraph,
    rows: Range<u32>,
    planes: &Planes,
    support: &Support<K>,
    steps: u32,
    field: &mut [f32],
) -> f32 {
    let first_node = graph.nodes_in_rows(rows.clone()).start;
    let tiles = (0..planes.n_blocks).step_by(TILE_BLOCKS);
    let mut relax_tile = |start: usize| {
        let blocks = start..planes.n_blocks.min(start + TILE_BLOCKS);
        let columns = (blocks.start * LANES) as u32..graph.width().min((blocks.end * LANES) as u32);
        let tile = Tile { rows: rows.clone(), blocks, height: graph.height(), steps };
        let stride = tile.stride();
        let store = |y: u32, row: &[f32]| {
            let node = graph.n_nodes_before(y, columns.start) - first_node;
            let out = field[node * K..].chunks_exact_mut(K);
            for (x, out) in graph.columns(y, columns.clone()).zip(out) {
                let at = (x - columns.start) as usize + LANES + 1;
                for (k, p) in out.iter_mut().enumerate() {
                    *p = row[k * stride + at];
                }
            }
        };
        Instructions::default().run(
            #[inline(always)]
            || tile.relax(planes, support, store),
        )
    };
    tiles.fold(0.0, |largest, start| relax_tile(start).max(largest))
}
