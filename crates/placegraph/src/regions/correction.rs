//! The two heuristics of Sect. 4.7: regions too small for their class take the class of a neighbor.
//!
//! (1) A region with role place or passage and less than 1 m² is wrong; (2) a doorway region with less than
//! 0.1 m² or fewer than two neighboring regions is wrong. The chapter says neither which neighbor gives the
//! new label nor in which order regions are handled; here the smallest wrong region goes first (ties: lower
//! id) and takes the label of the neighbor with the longest contact (ties: larger area, then lower id). It
//! merges with every neighbor of that label, and so on until nothing is wrong: every step leaves a region
//! less. A place without neighbors stays; a doorway without neighbors becomes a place.
//!
//! Cost: one pass over the nodes, then O(log n) per touching pair of regions: contact lengths add up when
//! regions merge, so nothing is counted again.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use serde::{Deserialize, Serialize};

use super::{Region, RegionId, RegionMap, contacts};
use crate::grid::{CellGraph, DisjointSets, FreeSpace};
use crate::labels::{Label, LabelSet, Role};

/// When a region is too small for its class. The defaults are the chapter's.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Thresholds {
    /// Smallest area of a region with role place or passage, in m². Default 1.
    pub min_place_m2: f64,
    /// Smallest area of a doorway, in m². Default 0.1.
    pub min_doorway_m2: f64,
    /// Smallest number of different regions that a doorway touches. Default 2.
    pub min_doorway_neighbors: usize,
    /// Smallest area of a region that no step leads to, in m²; a smaller one is an [island](super::islands()).
    /// Default 0.25; 0 in the chapter's setting.
    pub min_island_m2: f64,
}

impl Default for Thresholds {
    fn default() -> Self {
        Self { min_place_m2: 1.0, min_doorway_m2: 0.1, min_doorway_neighbors: 2, min_island_m2: 0.25 }
    }
}

/// Number of regions and cells that one of the two rules changed. A cell that changed its label twice counts twice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Relabeled {
    /// Number of regions that got another label.
    pub n_regions: usize,
    /// Number of their cells.
    pub n_cells: usize,
}

/// What [`correct`] returns.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Corrected {
    /// The regions after the correction.
    pub regions: RegionMap,
    /// Changes by rule (1): small places and passages.
    pub places: Relabeled,
    /// Changes by rule (2): small doorways, and doorways that join nothing.
    pub doorways: Relabeled,
}

/// Relabels every region that breaks a rule of Sect. 4.7, until none is left.
///
/// Correcting the result again changes nothing.
///
/// # Examples
/// ```
/// use placegraph::grid::{FreeSpace, OccupancyGrid};
/// use placegraph::labels::{Label, LabelSet};
/// use placegraph::regions::{DiagonalSteps, Thresholds, connected, correct};
///
/// // A room of one cell, 0.25 m², in the middle of a corridor.
/// let space = FreeSpace::of(&OccupancyGrid::from_ascii(0.5, "......\n......\n......"));
/// let labels: Vec<Label> = (0..18).map(|node| Label(u8::from(node == 8))).collect();
/// let found = connected(&space.graph, &labels, DiagonalSteps::default());
/// let corrected = correct(&space, &found, &LabelSet::default(), &Thresholds::default());
/// let draw = |labels: Vec<Label>| space.graph.to_ascii(|node| ['c', 'r', 'd'][labels[node].index()]);
/// assert_eq!(draw(labels), "cccccc\nccrccc\ncccccc\n");
/// assert_eq!(draw(corrected.regions.labeling()), "cccccc\ncccccc\ncccccc\n");
/// ```
///
/// # Panics
/// If `regions` do not belong to `space`, or a label is not of `label_set`.
pub fn correct(
    space: &FreeSpace,
    regions: &RegionMap,
    label_set: &LabelSet,
    thresholds: &Thresholds,
) -> Corrected {
    let mut partition = Partition::new(&space.graph, regions);
    let is_wrong = |part: &Merged| is_wrong(part, space.resolution_m(), label_set, thresholds);
    let mut queue: BinaryHeap<_> =
        partition.parts.iter().filter(|part| is_wrong(part)).map(|part| Reverse(part.key())).collect();
    let (mut places, mut doorways) = (Relabeled::default(), Relabeled::default());

    while let Some(Reverse(key)) = queue.pop() {
        let smallest = key.2;
        let part = &partition.parts[smallest];
        // Entries of regions that grew, merged or were corrected meanwhile are out of date.
        if part.key() != key || !is_wrong(part) {
            continue;
        }
        let Some(label) = partition.new_label(smallest, label_set) else { continue };
        let rule = if label_set.role(part.label) == Role::Doorway { &mut doorways } else { &mut places };
        rule.n_regions += 1;
        rule.n_cells += part.n_cells as usize;
        for changed in partition.relabel(smallest, label) {
            let part = &partition.parts[changed];
            if is_wrong(part) {
                queue.push(Reverse(part.key()));
            }
        }
    }
    Corrected { regions: partition.into_regions(regions), places, doorways }
}

/// Whether `part` breaks the rule for its role.
fn is_wrong(part: &Merged, resolution_m: f64, label_set: &LabelSet, thresholds: &Thresholds) -> bool {
    let area_m2 = part.n_cells as f64 * resolution_m * resolution_m;
    match label_set.role(part.label) {
        Role::Doorway => {
            area_m2 < thresholds.min_doorway_m2 || part.neighbors.len() < thresholds.min_doorway_neighbors
        }
        Role::Place | Role::Passage => area_m2 < thresholds.min_place_m2 && !part.neighbors.is_empty(),
    }
}

/// A region while regions merge.
struct Merged {
    label: Label,
    /// 0 once it is merged into another part.
    n_cells: u32,
    /// Its own position.
    index: usize,
    /// Lowest original id among what merged into it.
    first: u32,
    /// Neighboring parts and the number of common cell sides.
    neighbors: BTreeMap<usize, u32>,
}

impl Merged {
    /// What the queue sorts by: size, then id.
    fn key(&self) -> (u32, u32, usize) {
        (self.n_cells, self.first, self.index)
    }
}

/// All regions while they merge.
struct Partition {
    parts: Vec<Merged>,
    merged: DisjointSets,
}

impl Partition {
    fn new(graph: &CellGraph, regions: &RegionMap) -> Self {
        let mut parts: Vec<Merged> = regions
            .regions
            .iter()
            .enumerate()
            .map(|(index, &Region { label, n_cells })| Merged {
                label,
                n_cells,
                index,
                first: index as u32,
                neighbors: BTreeMap::new(),
            })
            .collect();
        for contact in contacts(graph, regions) {
            parts[contact.a.index()].neighbors.insert(contact.b.index(), contact.n_sides);
            parts[contact.b.index()].neighbors.insert(contact.a.index(), contact.n_sides);
        }
        let merged = DisjointSets::new(parts.len());
        Self { parts, merged }
    }

    /// The label of the neighbor with the longest contact; without neighbors, the first place of the set.
    fn new_label(&self, part: usize, label_set: &LabelSet) -> Option<Label> {
        self.parts[part]
            .neighbors
            .iter()
            .max_by_key(|&(&neighbor, &n_sides)| {
                let Merged { n_cells, first, .. } = self.parts[neighbor];
                (n_sides, n_cells, Reverse(first))
            })
            .map(|(&neighbor, _)| self.parts[neighbor].label)
            .or_else(|| label_set.labels().find(|&label| label_set.role(label) == Role::Place))
    }

    /// Gives `part` the label and merges it with all its neighbors of that label. Returns the parts of which
    /// size or number of neighbors changed.
    fn relabel(&mut self, part: usize, label: Label) -> Vec<usize> {
        self.parts[part].label = label;
        let same: Vec<usize> =
            self.parts[part].neighbors.keys().copied().filter(|&n| self.parts[n].label == label).collect();
        let mut merged = part;
        let mut changed = Vec::new();
        for neighbor in same {
            merged = self.merge(merged, neighbor, &mut changed);
        }
        changed.push(merged);
        changed
    }

    /// Merges two touching parts: the one with fewer neighbors goes into the other, which is returned. Adds
    /// the parts that touched both to `changed`: they have a neighbor less.
    fn merge(&mut self, a: usize, b: usize, changed: &mut Vec<usize>) -> usize {
        let a_is_larger = self.parts[a].neighbors.len() >= self.parts[b].neighbors.len();
        let (into, from) = if a_is_larger { (a, b) } else { (b, a) };
        let neighbors = std::mem::take(&mut self.parts[from].neighbors);
        self.parts[into].neighbors.remove(&from);
        for (neighbor, n_sides) in neighbors.into_iter().filter(|&(neighbor, _)| neighbor != into) {
            self.parts[neighbor].neighbors.remove(&from);
            *self.parts[neighbor].neighbors.entry(into).or_insert(0) += n_sides;
            let both = self.parts[into].neighbors.entry(neighbor);
            if matches!(both, std::collections::btree_map::Entry::Occupied(_)) {
                changed.push(neighbor);
            }
            *both.or_insert(0) += n_sides;
        }
        self.parts[into].n_cells += std::mem::take(&mut self.parts[from].n_cells);
        self.parts[into].first = self.parts[into].first.min(self.parts[from].first);
        self.parts[into].label = self.parts[a].label;
        self.merged.unite(a, b);
        into
    }

    /// The merged regions, renumbered. Of a set of merged regions the first one has its first node.
    fn into_regions(mut self, original: &RegionMap) -> RegionMap {
        let mut new_id = vec![RegionId(0); self.parts.len()];
        let mut regions = Vec::new();
        for old in 0..self.parts.len() {
            let first = self.merged.find(old);
            if first == old {
                new_id[old] = RegionId(regions.len() as u32);
                regions.push(Region { label: self.parts[old].label, n_cells: 0 });
            } else {
                new_id[old] = new_id[first];
            }
            let region = &mut regions[new_id[old].index()];
            region.n_cells += original.regions[old].n_cells;
            // Only the part that is left of a set knows its label.
            if self.parts[old].n_cells > 0 {
                region.label = self.parts[old].label;
            }
        }
        let region_of = original.region_of.iter().map(|id| new_id[id.index()]).collect();
        RegionMap { region_of, regions, diagonal: original.diagonal }
    }
}
