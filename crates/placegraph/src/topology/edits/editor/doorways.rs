//! Doorways that are drawn, moved and removed.

use std::collections::BTreeSet;

use super::split::parts_nothing;
use super::{Done, Editor, sides_of};
use crate::geom::{Point2, Vec2};
use crate::grid::Connectivity;
use crate::labels::Role;
use crate::regions::RegionId;
use crate::topology::edits::gap::{gap, in_cells, in_map, reach_m};
use crate::topology::edits::{At, NotApplied, Target};

/// How far a drawn doorway reaches on both sides of its line, in meters.
const HALF_DEPTH_M: f64 = 0.1;

impl Editor<'_> {
    /// Makes the cells of the gap that `line` means the doorway's.
    pub(super) fn put_doorway(&mut self, doorway: RegionId, line: [At; 2]) -> Result<Done, NotApplied> {
        let drawn = in_cells(self.frame, line);
        let [a, b] = gap(self.graph, drawn, self.cells(reach_m(line))).ok_or_else(|| parts_nothing(line))?;
        let on_line = self.nodes_on(a, b);
        let is_doorway = |region: RegionId| self.labels.role(self.label_of[region.index()]) == Role::Doorway;
        let taken = on_line.iter().map(|&node| self.region_of[node]).find(|&region| is_doorway(region));
        if let Some(other) = taken {
            return Err(NotApplied::IsDoorway { name: self.name(other) });
        }
        let cut: BTreeSet<RegionId> = on_line.iter().map(|&node| self.region_of[node]).collect();
        let was = self.names(cut.iter().copied());
        for node in self.strip(&on_line, [a, b]) {
            if cut.contains(&self.region_of[node]) {
                self.region_of[node] = doorway;
            }
        }
        let mut concerned = vec![doorway];
        for region in cut {
            let new = self.separate(region, |_, _| false, Some(doorway));
            concerned.push(region);
            concerned.extend(new);
        }
        if self.n_sides(doorway) < 2 {
            return Err(parts_nothing(line));
        }
        Ok(Done { was, concerned, line: Some(in_map(self.frame, [a, b])) })
    }

    /// The nodes within the depth of a doorway from the line, as far as they are connected to those on it.
    fn strip(&self, on_line: &[usize], [a, b]: [Point2; 2]) -> BTreeSet<usize> {
        let along = (b - a) * (1.0 / a.distance(b));
        let across = Vec2::new(-along.y, along.x);
        let depth = self.cells(HALF_DEPTH_M);
        let is_near = |node: usize| (self.graph.cell(node).center() - a).dot(across).abs() <= depth;
        let is_between =
            |node: usize| (0.0..=a.distance(b)).contains(&(self.graph.cell(node).center() - a).dot(along));
        let mut strip: BTreeSet<usize> = on_line.iter().copied().collect();
        let mut open: Vec<usize> = on_line.to_vec();
        while let Some(node) = open.pop() {
            for next in self.graph.neighbors(node, Connectivity::Four) {
                if is_near(next) && is_between(next) && strip.insert(next) {
                    open.push(next);
                }
            }
        }
        strip
    }

    /// Number of stretches of the doorway's border that are not connected with each other next to it.
    fn n_sides(&self, doorway: RegionId) -> usize {
        let own = (0..self.region_of.len()).filter(|&node| self.region_of[node] == doorway);
        let beside: BTreeSet<usize> = own
            .flat_map(|node| self.graph.neighbors(node, Connectivity::Four).collect::<Vec<_>>())
            .filter(|&next| self.region_of[next] != doorway)
            .collect();
        let mut left = beside;
        let mut n = 0;
        while let Some(start) = left.pop_first() {
            n += 1;
            let mut open = vec![start];
            while let Some(node) = open.pop() {
                let next: Vec<usize> = self
                    .graph
                    .neighbors(node, Connectivity::Eight)
                    .filter(|next| left.contains(next))
                    .collect();
                for next in next {
                    left.remove(&next);
                    open.push(next);
                }
            }
        }
        n
    }

    pub(super) fn new_doorway(&mut self) -> Result<RegionId, NotApplied> {
        let doorway_class = self.labels.labels().find(|&label| self.labels.role(label) == Role::Doorway);
        Ok(self.new_region(doorway_class.ok_or(NotApplied::NoDoorwayClass)?))
    }

    pub(super) fn doorway(&self, at: &Target) -> Result<RegionId, NotApplied> {
        let region = self.region(at)?;
        let class = self.labels.class(self.label_of[region.index()]);
        if class.role == Role::Doorway {
            Ok(region)
        } else {
            Err(NotApplied::NoDoorway { name: self.name(region), class: class.name.clone() })
        }
    }

    /// Gives the cells of a doorway to the neighbor with the longest common border.
    pub(super) fn give_away(&mut self, doorway: RegionId) -> Result<RegionId, NotApplied> {
        let contact = self.contact();
        let sides = contact.get(&doorway).map(sides_of).unwrap_or_default();
        let neighbor = sides.into_iter().find(|&side| self.is_place(side));
        let neighbor = neighbor.ok_or_else(|| NotApplied::NothingBeside { name: self.name(doorway) })?;
        for region in self.region_of.iter_mut().filter(|region| **region == doorway) {
            *region = neighbor;
        }
        Ok(neighbor)
    }
}
