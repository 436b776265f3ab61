//! Edits of places: the regions while they change.

mod doorways;
mod split;

use std::collections::{BTreeMap, BTreeSet};

use super::{Applied, At, Edit, Edited, NotApplied, Numbering, Outcome, Target};
use crate::geom::Point2;
use crate::grid::{Cell, CellGraph, Connectivity, FreeSpace, MapFrame};
use crate::labels::{Label, LabelSet, Role};
use crate::regions::{DiagonalSteps, Region, RegionId, RegionMap};
use crate::topology::PlaceId;
use crate::topology::names::check_name;
use crate::topology::query::UnknownPlace;
use crate::topology::segment::for_each_touched_in;

/// Applies `edits` to `regions`, with the names of places in `numbering`. Edits of the map itself are skipped.
///
/// # Panics
/// If `numbering` has not one number for every region.
pub fn apply(
    space: &FreeSpace,
    labels: &LabelSet,
    regions: RegionMap,
    numbering: Numbering,
    edits: &[Edit],
) -> Edited {
    assert_eq!(numbering.numbers.len(), regions.regions.len(), "one number per region");
    let FreeSpace { frame, graph } = space;
    let Numbering { numbers, names: called } = numbering;
    let diagonal = regions.diagonal;
    let label_of: Vec<Label> = regions.regions.iter().map(|region| region.label).collect();
    let class = |index: usize| labels.class(label_of[index]).name.as_str();
    let automatic =
        numbers.iter().enumerate().map(|(index, id)| Some(format!("{} {}", class(index), (*id)?.0)));
    let automatic = automatic.collect();
    let next = numbers.iter().flatten().map(|id| id.0).max().unwrap_or(0);
    let region_of = regions.region_of;
    let mut editor = Editor {
        frame,
        graph,
        labels,
        region_of,
        label_of,
        numbers,
        next,
        called,
        automatic,
        given: BTreeMap::new(),
    };
    let mut outcomes = Vec::new();
    let mut concerned = Vec::new();
    for edit in edits {
        let (outcome, regions) = editor.outcome(edit);
        outcomes.push(outcome);
        concerned.push(regions);
    }
    editor.finish(diagonal, outcomes, concerned)
}

/// What an edit did to the regions.
struct Done {
    was: Vec<String>,
    concerned: Vec<RegionId>,
    line: Option<[At; 2]>,
}

/// The regions while they change: ids are only ever added, emptied ones disappear at the end.
struct Editor<'a> {
    frame: &'a MapFrame,
    graph: &'a CellGraph,
    labels: &'a LabelSet,
    region_of: Vec<RegionId>,
    label_of: Vec<Label>,
    numbers: Vec<Option<PlaceId>>,
    /// The highest number so far.
    next: u32,
    /// Names before the edits that are not made of class and number.
    called: BTreeMap<RegionId, String>,
    /// Names made of class and number, before the edits.
    automatic: Vec<Option<String>>,
    /// Names that edits gave.
    given: BTreeMap<RegionId, String>,
}

impl Editor<'_> {
    fn outcome(&mut self, edit: &Edit) -> (Outcome, Vec<RegionId>) {
        let action = edit.action().to_owned();
        match self.apply(edit) {
            Ok(Done { was, concerned, line }) => {
                (Ok(Applied { action, was, now: Vec::new(), line }), concerned)
            }
            Err(reason) => (Err(reason), Vec::new()),
        }
    }

    fn apply(&mut self, edit: &Edit) -> Result<Done, NotApplied> {
        let points = edit.points();
        if let Some(&[x, y]) = points.iter().find(|at| !at.iter().all(|v| v.is_finite())) {
            return Err(NotApplied::NoPlace { x, y, found: "no number" });
        }
        match edit {
            Edit::Rename { at, name } => self.on_one(at, |editor, region| editor.rename(region, name)),
            Edit::Relabel { at, class } => self.on_one(at, |editor, region| {
                let label = editor.labels.label(class).ok_or_else(|| NotApplied::NoClass {
                    class: class.clone(),
                    known: editor.labels.classes().iter().map(|class| class.name.clone()).collect(),
                })?;
                editor.label_of[region.index()] = label;
                Ok(())
            }),
            Edit::Exclude { at } => self.on_one(at, |editor, region| {
                editor.numbers[region.index()] = None;
                editor.given.remove(&region);
                Ok(())
            }),
            Edit::Split { line } => self.split(*line),
            Edit::Merge { at } => self.merge(at),
            Edit::AddDoorway { line } => {
                let doorway = self.new_doorway()?;
                self.undone_if_not(|editor| editor.put_doorway(doorway, *line))
            }
            Edit::MoveDoorway { at, line } => self.undone_if_not(|editor| {
                let doorway = editor.doorway(at)?;
                editor.give_away(doorway)?;
                editor.put_doorway(doorway, *line)
            }),
            Edit::RemoveDoorway { at } => {
                let doorway = self.doorway(at)?;
                let was = vec![self.name(doorway)];
                let neighbor = self.give_away(doorway)?;
                Ok(Done { was, concerned: vec![neighbor], line: None })
            }
            Edit::Close { .. } | Edit::Open { .. } => {
                Ok(Done { was: Vec::new(), concerned: Vec::new(), line: None })
            }
        }
    }

    /// Does `change` to the region that is meant.
    fn on_one(
        &mut self,
        at: &Target,
        change: impl FnOnce(&mut Self, RegionId) -> Result<(), NotApplied>,
    ) -> Result<Done, NotApplied> {
        let region = self.region(at)?;
        let was = vec![self.name(region)];
        change(self, region)?;
        Ok(Done { was, concerned: vec![region], line: None })
    }

    /// Does `change`; if it fails, the cells are as they were.
    fn undone_if_not(
        &mut self,
        change: impl FnOnce(&mut Self) -> Result<Done, NotApplied>,
    ) -> Result<Done, NotApplied> {
        let before = self.region_of.clone();
        let (n_regions, next) = (self.label_of.len(), self.next);
        let done = change(self);
        if done.is_err() {
            self.region_of = before;
            self.label_of.truncate(n_regions);
            self.numbers.truncate(n_regions);
            self.next = next;
        }
        done
    }

    fn region(&self, at: &Target) -> Result<RegionId, NotApplied> {
        match at {
            Target::Point(at) => self.region_at(*at),
            Target::Named(name) => self.region_called(name),
        }
    }

    fn region_at(&self, [x, y]: At) -> Result<RegionId, NotApplied> {
        let cell = self.frame.cell_at(Point2::new(x, y));
        let inside = cell.filter(|cell| cell.x < self.graph.width() && cell.y < self.graph.height());
        let nowhere = NotApplied::NoPlace { x, y, found: "no free cell" };
        let node = inside.and_then(|cell| self.graph.node_at(cell)).ok_or(nowhere)?;
        let region = self.region_of[node];
        if self.is_place(region) {
            Ok(region)
        } else {
            Err(NotApplied::NoPlace { x, y, found: "free cells that are no place" })
        }
    }

    /// The place called `text` now, else before the edits, else the one with that number.
    fn region_called(&self, text: &str) -> Result<RegionId, NotApplied> {
        let is_left: BTreeSet<RegionId> = self.region_of.iter().copied().collect();
        let places = || is_left.iter().copied().filter(|&region| self.is_place(region));
        let before = |region: RegionId| self.called.get(&region).map(String::as_str);
        let automatic = |region: RegionId| self.automatic.get(region.index())?.as_deref();
        let number = text.trim().parse().ok().map(PlaceId);
        let found = places()
            .find(|&region| self.name(region) == text)
            .or_else(|| places().find(|&region| before(region) == Some(text)))
            .or_else(|| places().find(|&region| automatic(region) == Some(text)))
            .or_else(|| number.and_then(|_| places().find(|region| self.numbers[region.index()] == number)));
        found.ok_or_else(|| {
            let known = places().map(|region| self.name(region)).collect();
            UnknownPlace::new(text, known).into()
        })
    }

    fn is_place(&self, region: RegionId) -> bool {
        self.numbers[region.index()].is_some()
    }

    /// What the place is called now.
    fn name(&self, region: RegionId) -> String {
        let named = self.given.get(&region).or_else(|| self.called.get(&region));
        named.cloned().unwrap_or_else(|| {
            let class = &self.labels.class(self.label_of[region.index()]).name;
            self.numbers[region.index()].map_or_else(|| class.clone(), |id| format!("{class} {}", id.0))
        })
    }

    fn names(&self, regions: impl IntoIterator<Item = RegionId>) -> Vec<String> {
        regions.into_iter().map(|region| self.name(region)).collect()
    }

    fn rename(&mut self, region: RegionId, name: &str) -> Result<(), NotApplied> {
        check_name(name)?;
        let is_left: BTreeSet<RegionId> = self.region_of.iter().copied().collect();
        let is_other = |&&other: &&RegionId| other != region && self.is_place(other);
        if is_left.iter().filter(is_other).any(|&other| self.name(other) == name) {
            return Err(NotApplied::NameTaken { name: name.to_owned() });
        }
        self.given.insert(region, name.to_owned());
        Ok(())
    }

    fn merge(&mut self, at: &[Target]) -> Result<Done, NotApplied> {
        let regions = at.iter().map(|at| self.region(at)).collect::<Result<Vec<_>, _>>()?;
        let members: BTreeSet<RegionId> = regions.iter().copied().collect();
        let named = || regions.iter().copied();
        let Some(&first) = regions.first().filter(|_| members.len() > 1) else {
            return Err(NotApplied::OnePlace { found: self.names(members) });
        };
        let contact = self.contact();
        // Doorways whose two sides are joined join with them.
        let inner: Vec<RegionId> =
            contact.keys().copied().filter(|&region| !members.contains(&region)).collect();
        let inner = inner.into_iter().filter(|region| {
            let sides = sides_of(&contact[region]);
            let is_doorway = self.labels.role(self.label_of[region.index()]) == Role::Doorway;
            is_doorway && sides.len() >= 2 && sides[..2].iter().all(|side| members.contains(side))
        });
        let all: BTreeSet<RegionId> = inner.chain(members.iter().copied()).collect();
        let mut joined = BTreeSet::from([first]);
        let mut open = vec![first];
        while let Some(region) = open.pop() {
            for &next in contact.get(&region).into_iter().flat_map(BTreeMap::keys) {
                if all.contains(&next) && joined.insert(next) {
                    open.push(next);
                }
            }
        }
        if joined != all {
            return Err(NotApplied::NotTouching { found: self.names(named()) });
        }
        let others = all.iter().copied().filter(|region| !members.contains(region));
        let was = self.names(named().chain(others));
        for region in self.region_of.iter_mut().filter(|region| all.contains(region)) {
            *region = first;
        }
        self.given.retain(|region, _| *region == first || !all.contains(region));
        Ok(Done { was, concerned: vec![first], line: None })
    }

    /// Number of common sides of cells, by region and neighbor.
    fn contact(&self) -> BTreeMap<RegionId, BTreeMap<RegionId, u32>> {
        let mut contact: BTreeMap<RegionId, BTreeMap<RegionId, u32>> = BTreeMap::new();
        for (node, &region) in self.region_of.iter().enumerate() {
            for next in self.graph.neighbors(node, Connectivity::Four) {
                if self.region_of[next] != region {
                    *contact.entry(region).or_default().entry(self.region_of[next]).or_default() += 1;
                }
            }
        }
        contact
    }

    fn new_region(&mut self, label: Label) -> RegionId {
        self.label_of.push(label);
        self.next += 1;
        self.numbers.push(Some(PlaceId(self.next)));
        RegionId(self.label_of.len() as u32 - 1)
    }

    fn cells(&self, meters: f64) -> f64 {
        meters / self.frame.resolution_m()
    }

    /// The nodes of the free cells that the segment from `a` to `b` touches, in cells.
    fn nodes_on(&self, a: Point2, b: Point2) -> Vec<usize> {
        let mut nodes = Vec::new();
        for_each_touched_in((self.graph.width(), self.graph.height()), a, b, |x, y| {
            nodes.extend(self.graph.node_at(Cell::new(x, y)));
        });
        nodes
    }

    /// Numbers the regions by their first node again.
    fn finish(
        self,
        diagonal: DiagonalSteps,
        outcomes: Vec<Outcome>,
        concerned: Vec<Vec<RegionId>>,
    ) -> Edited {
        let mut number = vec![None; self.label_of.len()];
        let mut regions: Vec<Region> = Vec::new();
        let mut numbers = Vec::new();
        let mut names = BTreeMap::new();
        let region_of = self
            .region_of
            .iter()
            .map(|&old| {
                let id = *number[old.index()].get_or_insert_with(|| {
                    let id = RegionId(regions.len() as u32);
                    regions.push(Region { label: self.label_of[old.index()], n_cells: 0 });
                    numbers.push(self.numbers[old.index()]);
                    names.extend(self.given.get(&old).map(|name| (id, name.clone())));
                    id
                });
                regions[id.index()].n_cells += 1;
                id
            })
            .collect();
        let left = |old: Vec<RegionId>| old.into_iter().filter_map(|old| number[old.index()]).collect();
        let concerned = concerned.into_iter().map(left).collect();
        Edited { regions: RegionMap { region_of, regions, diagonal }, numbers, names, outcomes, concerned }
    }
}

/// Neighbors, the longest common border first; ties go to the lower region.
fn sides_of(contact: &BTreeMap<RegionId, u32>) -> Vec<RegionId> {
    let mut sides: Vec<(RegionId, u32)> = contact.iter().map(|(&region, &n)| (region, n)).collect();
    sides.sort_by_key(|&(region, n)| (std::cmp::Reverse(n), region));
    sides.into_iter().map(|(region, _)| region).collect()
}
