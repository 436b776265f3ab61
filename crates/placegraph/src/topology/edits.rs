//! Corrections by hand that are replayed on every run: rename, relabel, split, merge, add or remove a doorway.
//!
//! Edits point at places by a point inside of them, in meters of the map frame: numbers and names may change
//! from run to run, the ground does not. They are applied in the order of the file to the regions, before the
//! topological map is built. An edit that no longer applies changes nothing and is reported.
//!
//! ```toml
//! [[edit]]
//! action = "rename"
//! at = [12.5, 3.0]
//! name = "kitchen"
//!
//! [[edit]]
//! action = "split"
//! line = [[4.0, 0.0], [4.0, 2.5]]
//! ```
//!
//! Cost: `O(n)` for every edit, n cells.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use super::segment::for_each_touched_in;
use super::segments_cross;
use crate::geom::Point2;
use crate::grid::{Cell, CellGraph, Connectivity, FreeSpace, MapFrame};
use crate::labels::{Label, LabelSet, Role};
use crate::regions::{DiagonalSteps, Region, RegionId, RegionMap};
use crate::syntax::SyntaxError;

/// An edit file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EditFile {
    /// The edits, in the order they are applied.
    #[serde(default, rename = "edit")]
    pub edits: Vec<Edit>,
}

/// Why an edit file cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EditFileError {
    /// No TOML, or an unknown action or key.
    #[error("expected an edit file: {source}")]
    Toml {
        /// What the TOML reader found, and where.
        source: SyntaxError,
    },
    /// A coordinate is no number.
    #[error("expected finite numbers in edit {edit}, found {found}")]
    Number {
        /// Number of the edit, from 1.
        edit: usize,
        /// The number found.
        found: f64,
    },
}

impl EditFile {
    /// Reads a file's text.
    ///
    /// # Errors
    /// If it is no TOML, has an unknown action or key, or a number that is not finite.
    #[cfg(feature = "import")]
    pub fn from_toml(text: &str) -> Result<Self, EditFileError> {
        let file: Self =
            toml::from_str(text).map_err(|error| EditFileError::Toml { source: SyntaxError::of(&error) })?;
        for (edit, number) in file.edits.iter().zip(1..) {
            if let Some(&found) = edit.points().as_flattened().iter().find(|v| !v.is_finite()) {
                return Err(EditFileError::Number { edit: number, found });
            }
        }
        Ok(file)
    }
}

/// A point of the map frame, in meters: `[x, y]`.
pub type At = [f64; 2];

/// One correction. Every `at` is a point inside of the place that is meant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "action", rename_all = "snake_case", deny_unknown_fields)]
#[non_exhaustive]
pub enum Edit {
    /// Gives a place a name.
    Rename {
        /// The place.
        at: At,
        /// Its name.
        name: String,
    },
    /// Gives a place another class.
    Relabel {
        /// The place.
        at: At,
        /// Name of the class.
        class: String,
    },
    /// Cuts every place that the line cuts through into its parts; the largest part keeps the name.
    Split {
        /// The two ends of the line.
        line: [At; 2],
    },
    /// Joins places that touch; the first gives class and name.
    Merge {
        /// A point in each of them.
        at: Vec<At>,
    },
    /// Makes the free cells on the line a doorway. What the line cuts apart becomes several places.
    AddDoorway {
        /// From jamb to jamb.
        line: [At; 2],
    },
    /// Gives the cells of a doorway to the neighbor it shares the longest border with.
    RemoveDoorway {
        /// The doorway.
        at: At,
    },
}

impl Edit {
    /// The points that it names.
    fn points(&self) -> Vec<At> {
        match self {
            Self::Rename { at, .. } | Self::Relabel { at, .. } | Self::RemoveDoorway { at } => vec![*at],
            Self::Split { line } | Self::AddDoorway { line } => line.to_vec(),
            Self::Merge { at } => at.clone(),
        }
    }
}

/// Why an edit does not apply to this map.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NotApplied {
    /// No place is there.
    #[error("expected a place at ({x}, {y}), found no free cell")]
    NoPlace {
        /// The point's first coordinate, in meters.
        x: f64,
        /// Its second coordinate, in meters.
        y: f64,
    },
    /// The model knows no such class.
    #[error("expected one of the model's classes, found {class:?}")]
    NoClass {
        /// The name found.
        class: String,
    },
    /// The model has no class with the role doorway.
    #[error("expected a class with the role doorway, found none")]
    NoDoorwayClass,
    /// Another place has this name.
    #[error("expected a name that no other place has, found {name:?} twice")]
    NameTaken {
        /// The name.
        name: String,
    },
    /// The line cuts nothing in two.
    #[error("expected a line across a place, found none that it cuts apart")]
    CutsNothing,
    /// The places do not touch one another.
    #[error("expected two or more places that touch one another")]
    NotTouching,
    /// The place is no doorway.
    #[error("expected a doorway, found a {class}")]
    NoDoorway {
        /// Class of what is there.
        class: String,
    },
}

/// The corrected regions.
#[derive(Clone, Debug, PartialEq)]
pub struct Edited {
    /// The regions, numbered by their first node again.
    pub regions: RegionMap,
    /// Names that edits gave, by region.
    pub names: BTreeMap<RegionId, String>,
    /// What became of every edit, in the order of the file.
    pub outcomes: Vec<Result<(), NotApplied>>,
}

/// Applies `edits` to `regions`.
pub fn apply(space: &FreeSpace, labels: &LabelSet, regions: RegionMap, edits: &[Edit]) -> Edited {
    if edits.is_empty() {
        return Edited { regions, names: BTreeMap::new(), outcomes: Vec::new() };
    }
    let diagonal = regions.diagonal;
    let mut editor = Editor {
        frame: &space.frame,
        graph: &space.graph,
        labels,
        label_of: regions.regions.iter().map(|region| region.label).collect(),
        region_of: regions.region_of,
        names: BTreeMap::new(),
    };
    let outcomes = edits.iter().map(|edit| editor.apply(edit)).collect();
    let (regions, names) = editor.finish(diagonal);
    Edited { regions, names, outcomes }
}

/// The regions while they change: numbers are only ever added, emptied ones disappear at the end.
struct Editor<'a> {
    frame: &'a MapFrame,
    graph: &'a CellGraph,
    labels: &'a LabelSet,
    region_of: Vec<RegionId>,
    label_of: Vec<Label>,
    names: BTreeMap<RegionId, String>,
}

impl Editor<'_> {
    fn apply(&mut self, edit: &Edit) -> Result<(), NotApplied> {
        if let Some(&[x, y]) = edit.points().iter().find(|at| !at.iter().all(|v| v.is_finite())) {
            return Err(NotApplied::NoPlace { x, y });
        }
        match edit {
            Edit::Rename { at, name } => self.rename(*at, name),
            Edit::Relabel { at, class } => {
                let region = self.region_at(*at)?;
                let label =
                    self.labels.label(class).ok_or_else(|| NotApplied::NoClass { class: class.clone() })?;
                self.label_of[region.index()] = label;
                Ok(())
            }
            Edit::Split { line } => self.split(*line),
            Edit::Merge { at } => self.merge(at),
            Edit::AddDoorway { line } => self.add_doorway(*line),
            Edit::RemoveDoorway { at } => self.remove_doorway(*at),
        }
    }

    fn region_at(&self, [x, y]: At) -> Result<RegionId, NotApplied> {
        let cell = self.frame.cell_at(Point2::new(x, y));
        let inside = cell.filter(|cell| cell.x < self.graph.width() && cell.y < self.graph.height());
        let node = inside.and_then(|cell| self.graph.node_at(cell)).ok_or(NotApplied::NoPlace { x, y })?;
        Ok(self.region_of[node])
    }

    fn rename(&mut self, at: At, name: &str) -> Result<(), NotApplied> {
        let region = self.region_at(at)?;
        if self.names.iter().any(|(&other, taken)| other != region && taken == name) {
            return Err(NotApplied::NameTaken { name: name.to_owned() });
        }
        self.names.insert(region, name.to_owned());
        Ok(())
    }

    fn split(&mut self, line: [At; 2]) -> Result<(), NotApplied> {
        let [a, b] = self.in_cells(line);
        let mut touched = BTreeSet::new();
        self.for_each_node_on(a, b, |editor, node| {
            touched.insert(editor.region_of[node]);
        });
        let crosses = |from: Cell, to: Cell| segments_cross(a, b, from.center(), to.center());
        let n_before = self.label_of.len();
        for region in touched {
            self.separate(region, crosses);
        }
        if self.label_of.len() == n_before { Err(NotApplied::CutsNothing) } else { Ok(()) }
    }

    fn merge(&mut self, at: &[At]) -> Result<(), NotApplied> {
        let regions = at.iter().map(|&at| self.region_at(at)).collect::<Result<Vec<_>, _>>()?;
        let Some(&first) = regions.first() else { return Err(NotApplied::NotTouching) };
        let members: BTreeSet<RegionId> = regions.iter().copied().collect();
        let mut joined = BTreeSet::from([first]);
        loop {
            let n_joined = joined.len();
            for (node, &region) in
                self.region_of.iter().enumerate().filter(|(_, region)| members.contains(region))
            {
                for next in self.graph.neighbors(node, Connectivity::Four) {
                    if joined.contains(&self.region_of[next]) {
                        joined.insert(region);
                    }
                }
            }
            if joined.len() == n_joined {
                break;
            }
        }
        if members.len() < 2 || joined != members {
            return Err(NotApplied::NotTouching);
        }
        for region in self.region_of.iter_mut().filter(|region| members.contains(region)) {
            *region = first;
        }
        self.names.retain(|region, _| *region == first || !members.contains(region));
        Ok(())
    }

    fn add_doorway(&mut self, line: [At; 2]) -> Result<(), NotApplied> {
        let doorway_class = self.labels.labels().find(|&label| self.labels.role(label) == Role::Doorway);
        let label = doorway_class.ok_or(NotApplied::NoDoorwayClass)?;
        let [a, b] = self.in_cells(line);
        let mut nodes = BTreeSet::new();
        self.for_each_node_on(a, b, |_, node| {
            nodes.insert(node);
        });
        if nodes.is_empty() {
            return Err(NotApplied::NoPlace { x: line[0][0], y: line[0][1] });
        }
        let doorway = self.new_region(label);
        let cut: BTreeSet<RegionId> = nodes.iter().map(|&node| self.region_of[node]).collect();
        for &node in &nodes {
            self.region_of[node] = doorway;
        }
        self.separate(doorway, |_, _| false);
        for region in cut {
            self.separate(region, |_, _| false);
        }
        Ok(())
    }

    fn remove_doorway(&mut self, at: At) -> Result<(), NotApplied> {
        let doorway = self.region_at(at)?;
        let class = self.labels.class(self.label_of[doorway.index()]);
        if class.role != Role::Doorway {
            return Err(NotApplied::NoDoorway { class: class.name.clone() });
        }
        let mut contact: BTreeMap<RegionId, u32> = BTreeMap::new();
        for node in (0..self.region_of.len()).filter(|&node| self.region_of[node] == doorway) {
            for next in self.graph.neighbors(node, Connectivity::Four) {
                if self.region_of[next] != doorway {
                    *contact.entry(self.region_of[next]).or_default() += 1;
                }
            }
        }
        let longest = contact.iter().max_by_key(|&(&region, &sides)| (sides, std::cmp::Reverse(region)));
        let (&neighbor, _) = longest.ok_or(NotApplied::NotTouching)?;
        for region in self.region_of.iter_mut().filter(|region| **region == doorway) {
            *region = neighbor;
        }
        self.names.remove(&doorway);
        Ok(())
    }

    fn new_region(&mut self, label: Label) -> RegionId {
        self.label_of.push(label);
        RegionId(self.label_of.len() as u32 - 1)
    }

    fn in_cells(&self, line: [At; 2]) -> [Point2; 2] {
        line.map(|[x, y]| self.frame.cells_from_map(Point2::new(x, y)))
    }

    /// Calls `visit` for the node of every free cell that the segment from `a` to `b` touches, in cells.
    fn for_each_node_on(&self, a: Point2, b: Point2, mut visit: impl FnMut(&Self, usize)) {
        for_each_touched_in((self.graph.width(), self.graph.height()), a, b, |x, y| {
            if let Some(node) = self.graph.node_at(Cell::new(x, y)) {
                visit(self, node);
            }
        });
    }

    /// Makes a region of every part of `region` that is not connected to its largest part by steps that do not
    /// cross what `is_cut` says. The largest part stays; ties go to the part with the lower node.
    fn separate(&mut self, region: RegionId, is_cut: impl Fn(Cell, Cell) -> bool) {
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
        for part in (0..parts.len()).filter(|&part| Some(part) != largest) {
            let id = self.new_region(label);
            for &node in &parts[part] {
                self.region_of[node] = id;
            }
        }
    }

    /// Numbers the regions by their first node again.
    fn finish(self, diagonal: DiagonalSteps) -> (RegionMap, BTreeMap<RegionId, String>) {
        let mut number = vec![None; self.label_of.len()];
        let mut regions: Vec<Region> = Vec::new();
        let mut names = BTreeMap::new();
        let region_of = self
            .region_of
            .iter()
            .map(|&old| {
                let id = *number[old.index()].get_or_insert_with(|| {
                    let id = RegionId(regions.len() as u32);
                    regions.push(Region { label: self.label_of[old.index()], n_cells: 0 });
                    names.extend(self.names.get(&old).map(|name| (id, name.clone())));
                    id
                });
                regions[id.index()].n_cells += 1;
                id
            })
            .collect();
        (RegionMap { region_of, regions, diagonal }, names)
    }
}
