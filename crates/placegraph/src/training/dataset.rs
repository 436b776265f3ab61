//! Labeled maps as a table of examples. Cost: that of the features; memory 4 bytes per example and feature.

use std::collections::BTreeMap;

use super::{HoldOut, LabeledMap, TrainConfig, TrainError, assign_folds};
use crate::features::{FeatureTable, extract};
use crate::grid::Cell;
use crate::labels::{Label, LabelSet};
use crate::progress::{Part, Progress, Stage};
use crate::scan::ScanConfig;

/// Examples are numbered in 31 bits.
const MAX_EXAMPLES: usize = (1 << 31) - 1;

/// A row of a data set without its features.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Example {
    /// The true class.
    pub label: Label,
    /// The fold in which the example is held out.
    pub fold: u8,
}

/// Where an example was seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seen {
    /// Number of the map, from 0.
    pub map: u32,
    /// The cell.
    pub cell: Cell,
    /// Number of the scale, from 0.
    pub scale: u8,
}

/// Examples: features of scans, their classes and folds.
///
/// Rows are ordered by map, then by scale, then by cell in row-major order.
#[derive(Clone, Debug)]
pub struct Dataset {
    /// The features.
    pub table: FeatureTable,
    /// The rest of every row.
    pub examples: Vec<Example>,
    /// Where every row was seen.
    pub seen: Vec<Seen>,
    /// The number of labeled cells that an example of each class stands for: more than 1 if cells were skipped.
    pub cells_per_example: Vec<u32>,
    /// What the folds are made of.
    pub held_out: HoldOut,
}

/// The cells of one map to learn from.
struct Chosen {
    cells: Vec<Cell>,
    examples: Vec<Example>,
}

impl Dataset {
    /// Computes the features of the labeled cells of `maps`, once for every scale.
    ///
    /// # Errors
    /// If labels do not fit their map or the label set, or a class has no cell.
    pub fn build(
        maps: &[LabeledMap],
        label_set: &LabelSet,
        config: &TrainConfig,
        progress: &dyn Progress,
    ) -> Result<Self, TrainError> {
        maps.iter().try_for_each(|map| map.check(label_set))?;
        let cells_per_example = thinning(maps, label_set, config)?;
        let (chosen, held_out) = choose(maps, label_set, config, &cells_per_example);
        let n_rows = chosen.iter().map(|chosen| chosen.cells.len()).sum::<usize>() * config.scales.len();
        if n_rows > MAX_EXAMPLES {
            return Err(TrainError::TooManyExamples { limit: MAX_EXAMPLES, found: n_rows });
        }
        progress.begin(Stage::Features);
        let mut columns = config.features.clone();
        columns.sort_unstable();
        let mut values = vec![0.0; n_rows * columns.len()];
        let mut examples = Vec::with_capacity(n_rows);
        let n_parts = maps.len() * config.scales.len();
        let mut seen = Vec::with_capacity(n_rows);
        for ((map, chosen), number) in maps.iter().zip(&chosen).zip(0..) {
            for (&scale, scale_number) in config.scales.iter().zip(0..=u8::MAX) {
                let done = number as usize * config.scales.len() + usize::from(scale_number);
                let part = Part { of: progress, number: done, n_parts };
                let range_scale = config.scan.range_scale * scale;
                // Learned from all that a robot sees: classifiers that know clutter stand more of it.
                let scan = ScanConfig { range_scale, max_speck_m: 0.0, ..config.scan };
                let found = extract(&map.grid, &chosen.cells, &columns, &scan, &part);
                for (column, all) in values.chunks_exact_mut(n_rows).enumerate() {
                    all[examples.len()..][..found.n_rows()].copy_from_slice(found.column(column));
                }
                examples.extend(&chosen.examples);
                seen.extend(chosen.cells.iter().map(|&cell| Seen { map: number, cell, scale: scale_number }));
            }
        }
        let table = FeatureTable::from_columns(columns, n_rows, values);
        Ok(Self { table, examples, seen, cells_per_example, held_out })
    }

    /// Every n-th example of a class with more than `most`, so that at most that many remain.
    pub fn thinned(&self, most: usize) -> Self {
        let n_labels = self.cells_per_example.len();
        let mut n_examples = vec![0; n_labels];
        self.examples.iter().for_each(|example| n_examples[example.label.index()] += 1);
        let every: Vec<usize> = n_examples.iter().map(|n: &usize| n.div_ceil(most).max(1)).collect();
        let mut seen = vec![0usize; n_labels];
        let mut is_taken = |example: &Example| {
            let k = example.label.index();
            seen[k] += 1;
            (seen[k] - 1).is_multiple_of(every[k])
        };
        let rows: Vec<u32> =
            (0..self.examples.len() as u32).filter(|&row| is_taken(&self.examples[row as usize])).collect();
        let cells_per_example = self.cells_per_example.iter().zip(&every);
        Self {
            table: self.table.of_rows(&rows),
            examples: rows.iter().map(|&row| self.examples[row as usize]).collect(),
            seen: rows.iter().map(|&row| self.seen[row as usize]).collect(),
            cells_per_example: cells_per_example.map(|(&n, &every)| n * every as u32).collect(),
            held_out: self.held_out,
        }
    }

    /// The number of the block of its map in which every example lies.
    pub(super) fn blocks(&self, maps: &[LabeledMap], block_m: f64) -> Vec<u32> {
        let mut numbers = BTreeMap::new();
        let block = |seen: &Seen| {
            let (number, x, y) = block_at(seen.map as usize, &maps[seen.map as usize], seen.cell, block_m);
            let next = numbers.len() as u32;
            *numbers.entry((number, x, y)).or_insert(next)
        };
        self.seen.iter().map(block).collect()
    }

    /// The true classes of all examples.
    pub fn labels(&self) -> Vec<Label> {
        self.examples.iter().map(|example| example.label).collect()
    }
}

/// For each class, the n of "every n-th cell".
fn thinning(maps: &[LabeledMap], label_set: &LabelSet, config: &TrainConfig) -> Result<Vec<u32>, TrainError> {
    let mut n_cells = vec![0; label_set.len()];
    maps.iter().flat_map(LabeledMap::labeled_cells).for_each(|(_, label)| n_cells[label.index()] += 1);
    if n_cells.iter().all(|&n| n == 0) {
        return Err(TrainError::NoLabels);
    }
    if let Some(absent) = label_set.labels().find(|label| n_cells[label.index()] == 0) {
        return Err(TrainError::ClassAbsent { class: label_set.class(absent).name.clone() });
    }
    let step = |n: usize| config.max_cells_per_class.map_or(1, |most| n.div_ceil(most));
    Ok(n_cells.into_iter().map(|n| step(n) as u32).collect())
}

/// The square block of a map in which `cell` lies.
fn block_at(number: usize, map: &LabeledMap, cell: Cell, block_m: f64) -> (usize, u64, u64) {
    let at = |v: u32| ((v as f64 + 0.5) * map.grid.frame.resolution_m() / block_m) as u64;
    (number, at(cell.y), at(cell.x))
}

/// The cells to learn from, their folds, and what these are made of.
fn choose(
    maps: &[LabeledMap],
    label_set: &LabelSet,
    config: &TrainConfig,
    every: &[u32],
) -> (Vec<Chosen>, HoldOut) {
    let mut seen = vec![0u32; label_set.len()];
    let mut block_numbers = BTreeMap::new();
    let mut blocks: Vec<Vec<usize>> = Vec::new();
    let mut block_of: Vec<usize> = Vec::new();
    let mut chosen = Vec::new();
    for (number, map) in maps.iter().enumerate() {
        let (mut cells, mut examples) = (Vec::new(), Vec::new());
        for (cell, label) in map.labeled_cells() {
            let taken = seen[label.index()].is_multiple_of(every[label.index()]);
            seen[label.index()] += 1;
            if !taken {
                continue;
            }
            let at = block_at(number, map, cell, config.block_m);
            let block = *block_numbers.entry(at).or_insert(blocks.len());
            if block == blocks.len() {
                blocks.push(vec![0; label_set.len()]);
            }
            blocks[block][label.index()] += 1;
            block_of.push(block);
            cells.push(cell);
            examples.push(Example { label, fold: 0 });
        }
        chosen.push(Chosen { cells, examples });
    }
    let folds = assign_folds(&blocks, config.n_folds);
    let examples = chosen.iter_mut().flat_map(|chosen| &mut chosen.examples);
    examples.zip(block_of).for_each(|(example, block)| example.fold = folds[block] as u8);
    if config.hold_out == HoldOut::Buildings
        && let Some(folds) = building_folds(maps, &chosen, label_set, config)
    {
        for (chosen, fold) in chosen.iter_mut().zip(folds) {
            chosen.examples.iter_mut().for_each(|example| example.fold = fold as u8);
        }
        return (chosen, HoldOut::Buildings);
    }
    (chosen, HoldOut::Blocks)
}

/// The fold of every map, so that the maps of a building are in one; `None` with a single building, or where holding out a fold
/// would leave a class without an example.
fn building_folds(
    maps: &[LabeledMap],
    chosen: &[Chosen],
    label_set: &LabelSet,
    config: &TrainConfig,
) -> Option<Vec<usize>> {
    let mut buildings: Vec<Option<&str>> = Vec::new();
    let mut building_of = Vec::with_capacity(maps.len());
    for map in maps {
        let name = map.building.as_deref();
        let known = buildings.iter().position(|other| name.is_some() && *other == name);
        building_of.push(known.unwrap_or(buildings.len()));
        if known.is_none() {
            buildings.push(name);
        }
    }
    let mut counts = vec![vec![0; label_set.len()]; buildings.len()];
    for (chosen, &building) in chosen.iter().zip(&building_of) {
        chosen.examples.iter().for_each(|example| counts[building][example.label.index()] += 1);
    }
    let n_folds = config.n_folds.min(buildings.len());
    let folds = assign_folds(&counts, n_folds);
    let rest = |fold: usize, class: usize| -> usize {
        counts.iter().zip(&folds).filter(|&(_, &other)| other != fold).map(|(counts, _)| counts[class]).sum()
    };
    let is_whole = |fold: usize| (0..label_set.len()).all(|class| rest(fold, class) > 0);
    let can_learn = n_folds > 1 && (0..n_folds).all(is_whole);
    can_learn.then(|| building_of.into_iter().map(|building| folds[building]).collect())
}
