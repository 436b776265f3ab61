//! Regions by flood fill, and their correction by starting over after every change.

use std::collections::{BTreeMap, BTreeSet};

use placegraph::grid::{CellGraph, Connectivity};
use placegraph::labels::{Label, LabelSet, Role};
use placegraph::regions::{DiagonalSteps, Region, RegionId, RegionMap, Thresholds};

/// The nodes next to `node`, under the rule for diagonal steps.
pub fn neighbors(graph: &CellGraph, node: usize, diagonal: DiagonalSteps) -> Vec<usize> {
    let is_free = |step| graph.node_at_step(node, step).is_some();
    Connectivity::Eight
        .steps()
        .iter()
        .filter(|&&(dx, dy)| {
            dx == 0
                || dy == 0
                || match diagonal {
                    DiagonalSteps::Never => false,
                    DiagonalSteps::Any => true,
                    DiagonalSteps::ThroughFree => is_free((dx, 0)) || is_free((0, dy)),
                }
        })
        .filter_map(|&step| graph.node_at_step(node, step))
        .collect()
}

/// Connected regions of equal label, one flood at a time.
pub fn flood_fill(graph: &CellGraph, labeling: &[Label], diagonal: DiagonalSteps) -> RegionMap {
    let mut region_of = vec![None; graph.n_nodes()];
    let mut regions = Vec::new();
    for start in 0..graph.n_nodes() {
        if region_of[start].is_some() {
            continue;
        }
        let id = RegionId(regions.len() as u32);
        let mut n_cells = 0;
        let mut open = vec![start];
        region_of[start] = Some(id);
        while let Some(node) = open.pop() {
            n_cells += 1;
            for next in neighbors(graph, node, diagonal) {
                if region_of[next].is_none() && labeling[next] == labeling[start] {
                    region_of[next] = Some(id);
                    open.push(next);
                }
            }
        }
        regions.push(Region { label: labeling[start], n_cells });
    }
    RegionMap { region_of: region_of.into_iter().flatten().collect(), regions, diagonal }
}

/// For every pair of regions with neighboring cells, the number of pairs of cells that share a side.
pub fn contact_sides(graph: &CellGraph, regions: &RegionMap) -> BTreeMap<(RegionId, RegionId), u32> {
    let mut sides = BTreeMap::new();
    for node in 0..graph.n_nodes() {
        let a = regions.region_of[node];
        let beside: BTreeSet<usize> = graph.neighbors(node, Connectivity::Four).collect();
        for next in neighbors(graph, node, regions.diagonal) {
            let b = regions.region_of[next];
            if a < b {
                *sides.entry((a, b)).or_insert(0) += u32::from(beside.contains(&next));
            }
        }
    }
    sides
}

/// The two corrections of Sect. 4.7: mend the smallest wrong region, rebuild all regions, repeat. Returns the
/// regions and the number of regions relabeled by the rule for places and by the rule for doorways.
pub fn correct(
    graph: &CellGraph,
    resolution_m: f64,
    regions: &RegionMap,
    label_set: &LabelSet,
    thresholds: &Thresholds,
) -> (RegionMap, usize, usize) {
    let mut regions = regions.clone();
    let (mut n_places, mut n_doorways) = (0, 0);
    while let Some((wrong, label)) = smallest_wrong(graph, resolution_m, &regions, label_set, thresholds) {
        if label_set.role(regions.regions[wrong].label) == Role::Doorway {
            n_doorways += 1;
        } else {
            n_places += 1;
        }
        let mut labeling = regions.labeling();
        for (node, _) in regions.region_of.iter().enumerate().filter(|(_, id)| id.index() == wrong) {
            labeling[node] = label;
        }
        regions = flood_fill(graph, &labeling, regions.diagonal);
    }
    (regions, n_places, n_doorways)
}

/// The smallest region that breaks a rule and can be mended, and its new label.
fn smallest_wrong(
    graph: &CellGraph,
    resolution_m: f64,
    regions: &RegionMap,
    label_set: &LabelSet,
    thresholds: &Thresholds,
) -> Option<(usize, Label)> {
    let sides = contact_sides(graph, regions);
    let mut best: Option<(u32, usize, Label)> = None;
    for (index, region) in regions.regions.iter().enumerate() {
        let neighbors: Vec<(u32, RegionId)> = sides
            .iter()
            .filter_map(|(&(a, b), &n)| match index {
                i if i == a.index() => Some((n, b)),
                i if i == b.index() => Some((n, a)),
                _ => None,
            })
            .collect();
        let area_m2 = region.n_cells as f64 * resolution_m * resolution_m;
        let is_doorway = label_set.role(region.label) == Role::Doorway;
        let is_wrong = if is_doorway {
            area_m2 < thresholds.min_doorway_m2 || neighbors.len() < thresholds.min_doorway_neighbors
        } else {
            area_m2 < thresholds.min_place_m2
        };
        if !is_wrong || best.is_some_and(|(n_cells, ..)| n_cells <= region.n_cells) {
            continue;
        }
        let first_place = label_set.labels().find(|&label| label_set.role(label) == Role::Place);
        let mut label = if is_doorway { first_place } else { None };
        let mut longest: Option<(u32, u32)> = None;
        for (n_sides, neighbor) in neighbors {
            let candidate = (n_sides, regions.regions[neighbor.index()].n_cells);
            if longest.is_none_or(|longest| candidate > longest) {
                longest = Some(candidate);
                label = Some(regions.regions[neighbor.index()].label);
            }
        }
        if let Some(label) = label {
            best = Some((region.n_cells, index, label));
        }
    }
    best.map(|(_, index, label)| (index, label))
}

/// The label of every region after every one of `islands` took that of the nearest nodes of the others, by the larger
/// coordinate: of several labels that which most pairs of nodes have, then the lower one.
pub fn labels_of_islands(graph: &CellGraph, regions: &RegionMap, islands: &[RegionId]) -> Vec<Label> {
    let is_island = |id: RegionId| islands.contains(&id);
    let cells = || graph.cells().iter().zip(&regions.region_of);
    let label = |id: RegionId| regions.regions[id.index()].label;
    let label_of_island = |island: RegionId| {
        let mut pairs: Vec<(u32, Label)> = Vec::new();
        for (here, _) in cells().filter(|(_, id)| **id == island) {
            for (there, id) in cells().filter(|(_, id)| !is_island(**id)) {
                pairs.push((here.x.abs_diff(there.x).max(here.y.abs_diff(there.y)), label(*id)));
            }
        }
        let nearest = pairs.iter().map(|pair| pair.0).min()?;
        let count = |label: Label| pairs.iter().filter(|pair| **pair == (nearest, label)).count();
        (0..8).map(Label).rev().max_by_key(|&label| count(label))
    };
    let ids = (0..regions.regions.len() as u32).map(RegionId);
    ids.map(|id| if is_island(id) { label_of_island(id).unwrap_or(label(id)) } else { label(id) }).collect()
}
