//! Places that a line splits, and what falls apart.

use std::collections::{BTreeMap, BTreeSet};

use super::{Done, Editor};
use crate::geom::Point2;
use crate::grid::{Cell, Connectivity};
use crate::regions::RegionId;
use crate::topology::edits::gap::{gap, in_cells, in_map, reach_m};
use crate::topology::edits::{At, NotApplied};
use crate::topology::segments_cross;

/// What a line cuts off that is smaller is the ragged edge of a wall, in square meters.
const MIN_PART_M2: f64 = 0.1;

impl Editor<'_> {
    pub(super) fn split(&mut self, line: [At; 2]) -> Result<Done, NotApplied> {
        let drawn = in_cells(self.frame, line);
        self.undone_if_not(|editor| editor.split_along(drawn)).or_else(|reason| {
            let meant =
                gap(self.graph, drawn, self.cells(reach_m(line))).ok_or_else(|| parts_nothing(line))?;
            let done = self.undone_if_not(|editor| editor.split_along(meant)).map_err(|_| reason)?;
            Ok(Done { line: Some(in_map(self.frame, meant)), ..done })
        })
    }

    /// Cuts along the line from `a` to `b`, in cells.
    fn split_along(&mut self, [a, b]: [Point2; 2]) -> Result<Done, NotApplied> {
        let touched: BTreeSet<RegionId> = self
            .nodes_on(a, b)
            .into_iter()
            .map(|node| self.region_of[node])
            .filter(|&region| self.is_place(region))
            .collect();
        let crosses = |from: Cell, to: Cell| segments_cross(a, b, from.center(), to.center());
        let mut cut = Vec::new();
        let mut parts = Vec::new();
        for region in touched {
            let new = self.separate(region, crosses, None);
            if !new.is_empty() {
                cut.push(region);
                parts.extend(new);
            }
        }
        if parts.is_empty() {
            return Err(parts_nothing(in_map(self.frame, [a, b])));
        }
        let was = self.names(cut.iter().copied());
        Ok(Done { was, concerned: cut.into_iter().chain(parts).collect(), line: None })
    }

    /// Makes a region of every part of `region` that is not connected to its largest part by steps that do not
    /// cross what `is_cut` says, and returns these. The largest part stays; ties go to the part with the lower node. Parts
    /// below [`MIN_PART_M2`] go to `to_scraps`, or stay.
    pub(super) fn separate(
        &mut self,
        region: RegionId,
        is_cut: impl Fn(Cell, Cell) -> bool,
        to_scraps: Option<RegionId>,
    ) -> Vec<RegionId> {
        let mut part_of: BTreeMap<usize, usize> = BTreeMap::new();
        let mut parts: Vec<Vec<usize>> = Vec::new();
        for start in (0..self.region_of.len()).filter(|&node| self.region_of[node] == region) {
            if part_of.contains_key(&start) {
                continue;
            }
            part_of.insert(start, parts.len());
            let mut part = vec![start];
            let mut done = 0;
            while let Some(&node) = part.get(done) {
                done += 1;
                for next in self.graph.neighbors(node, Connectivity::Eight) {
                    let [from, to] = [node, next].map(|node| self.graph.cell(node));
                    if self.region_of[next] == region && !part_of.contains_key(&next) && !is_cut(from, to) {
                        part_of.insert(next, parts.len());
                        part.push(next);
                    }
                }
            }
            parts.push(part);
        }
        let largest = (0..parts.len()).max_by_key(|&part| (parts[part].len(), std::cmp::Reverse(part)));
        let label = self.label_of[region.index()];
        let mut new = Vec::new();
        for part in (0..parts.len()).filter(|&part| Some(part) != largest) {
            let is_scrap = (parts[part].len() as f64) * self.frame.cell_area_m2() < MIN_PART_M2;
            let id = match to_scraps {
                Some(id) if is_scrap => id,
                None if is_scrap => continue,
                _ => self.new_region(label),
            };
            if Some(id) != to_scraps {
                new.push(id);
            }
            for &node in &parts[part] {
                self.region_of[node] = id;
            }
        }
        new
    }
}

pub(super) fn parts_nothing(line: [At; 2]) -> NotApplied {
    let [[ax, ay], [bx, by]] = line;
    NotApplied::PartsNothing { ax, ay, bx, by, within_m: reach_m(line) }
}
