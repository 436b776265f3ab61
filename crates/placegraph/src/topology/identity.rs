//! Places keep their numbers and names when the map is updated: new places are matched to those of an earlier result
//! by their overlap in the map frame.
//!
//! Pairs are taken greedily by their overlap relative to their union, largest first. A doorway that moved off
//! its old cells is matched to the nearest one left.
//!
//! New places get the numbers after the one that was given last, and after [`PlaceId::MAX`] those from 1 on that no place has. So
//! the number of a place that vanished is given to another one only after all others were: with 20 new places a night, after
//! nine years.
//!
//! Cost: linear in the stretches of both maps on the new grid.

mod numbers;

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use self::numbers::new_ids;
use super::{Place, PlaceId, PlaceRaster, TopologicalMap};
use crate::grid::GridShape;
use crate::labels::Role;

/// Pairs that share less than this part of their union are not the same place.
pub const MIN_SHARED_FRAC: f64 = 0.1;

/// A place that overlaps another by more than this share is a piece of it.
pub const MIN_INSIDE_FRAC: f64 = 0.5;

/// Frames agree if at least this share of the smaller map's area belongs to places matched one to one.
pub const MIN_MATCHED_SHARE: f64 = 0.5;

/// Changes of places between two results, with the numbers of the new one unless stated otherwise.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case", tag = "change")]
#[non_exhaustive]
pub enum Change {
    /// A place that was not there.
    Appeared {
        /// Its number.
        place: PlaceId,
    },
    /// A place that is no longer there.
    Vanished {
        /// Its number in the earlier result.
        place: PlaceId,
        /// Its name.
        name: String,
    },
    /// A place that became several.
    Split {
        /// Its number in the earlier result.
        from: PlaceId,
        /// The places it became; the first that keeps the number, if one does.
        into: Vec<PlaceId>,
    },
    /// Places that became one.
    Merged {
        /// Their numbers in the earlier result.
        from: Vec<PlaceId>,
        /// The place they became.
        into: PlaceId,
    },
}

/// A map whose places have the numbers and names of an earlier one.
#[derive(Clone, Debug, PartialEq)]
pub struct CarriedOver {
    /// The map with its new numbers, places in their order.
    pub map: TopologicalMap,
    /// Old and new number of every place of the current map, for region images.
    pub renumbered: BTreeMap<PlaceId, PlaceId>,
    /// Other changes; empty if the frames disagree.
    pub changes: Vec<Change>,
    /// Area of the places that were matched one to one, divided by that of the smaller map. Below
    /// [`MIN_MATCHED_SHARE`] the frames of the two maps disagree, and no number or name is kept.
    pub matched_share: f64,
}

impl CarriedOver {
    /// A map without an earlier result: its places get the numbers in `numbers`, and those in `given` get the names
    /// in `given`.
    pub fn first(
        map: &TopologicalMap,
        numbers: &BTreeMap<PlaceId, PlaceId>,
        given: &BTreeMap<PlaceId, String>,
    ) -> Self {
        let renumbered: BTreeMap<PlaceId, PlaceId> = map
            .places
            .iter()
            .map(|place| (place.id, numbers.get(&place.id).copied().unwrap_or(place.id)))
            .collect();
        let mut map = renumber(map, &renumbered);
        map.last_id = map.places.last().map_or(PlaceId(0), |place| place.id);
        let given = given.iter().filter_map(|(id, name)| Some((*renumbered.get(id)?, name.as_str())));
        name_places(&mut map, &given.collect());
        Self { map, renumbered, changes: Vec::new(), matched_share: 1.0 }
    }
}

/// Gives the places of `current`, which lie on the grid `shape`, the numbers and names they have in `previous`.
///
/// The names in `given`, by number in `current`, win over earlier ones. Places without an earlier self get new numbers
/// and default names; so do all places where the frames of the maps disagree.
///
/// # Examples
/// ```
/// use std::collections::BTreeMap;
///
/// use placegraph::grid::{GridShape, OccupancyGrid};
/// use placegraph::model::Model;
/// use placegraph::pipeline::{Config, analyze};
/// use placegraph::progress::Silent;
/// use placegraph::topology::identity::carry_over;
///
/// let label = |map: &OccupancyGrid| analyze(map, &Model::builtin(), &Config::default(), &Silent).topology;
/// let mut yesterday = label(&OccupancyGrid::from_ascii(0.5, "########\n#......#\n#......#\n########"));
/// yesterday.places[0].name = "lobby".to_owned();
/// // Somebody left a box in the corner.
/// let map = OccupancyGrid::from_ascii(0.5, "########\n#.....##\n#......#\n########");
/// let today = carry_over(&label(&map), GridShape::of(&map), &yesterday, &BTreeMap::new());
/// assert_eq!(today.map.places[0].name, "lobby");
/// assert!(today.changes.is_empty());
/// ```
pub fn carry_over(
    current: &TopologicalMap,
    shape: GridShape,
    previous: &TopologicalMap,
    given: &BTreeMap<PlaceId, String>,
) -> CarriedOver {
    let overlaps = Overlaps::new(current, shape, previous);
    let mut earlier_self = overlaps.best_pairs();
    // Where one of the maps has no place, nothing speaks against the frames.
    let is_empty = current.places.is_empty() || previous.places.is_empty();
    let matched_share = if is_empty { 1.0 } else { overlaps.matched_share(&earlier_self) };
    let disagree = matched_share < MIN_MATCHED_SHARE;
    if disagree {
        earlier_self.clear();
    } else {
        pair_moved_doorways(current, previous, &mut earlier_self);
    }

    let kept: BTreeSet<PlaceId> = earlier_self.values().copied().collect();
    let earlier: BTreeSet<PlaceId> = previous.places.iter().map(|place| place.id).collect();
    let mut last_id = previous.last_id;
    let mut new_ids = new_ids(last_id, &earlier, &kept);
    let renumbered: BTreeMap<PlaceId, PlaceId> = current
        .places
        .iter()
        .map(|place| {
            let number = earlier_self.get(&place.id).copied().unwrap_or_else(|| {
                last_id = new_ids.next().unwrap_or(PlaceId::MAX);
                last_id
            });
            (place.id, number)
        })
        .collect();
    drop(new_ids);
    let mut map = renumber(current, &renumbered);
    map.last_id = last_id;
    let given: BTreeMap<PlaceId, &str> =
        given.iter().filter_map(|(id, name)| Some((*renumbered.get(id)?, name.as_str()))).collect();
    let mut names: BTreeMap<PlaceId, &str> = earlier_self
        .values()
        .filter_map(|&id| Some((id, previous.place(id)?.name.as_str())))
        .filter(|(_, name)| !given.values().any(|taken| taken == name))
        .collect();
    names.extend(given);
    name_places(&mut map, &names);
    let changes = if disagree { Vec::new() } else { overlaps.changes(previous, &earlier_self, &renumbered) };
    CarriedOver { map, renumbered, changes, matched_share }
}

/// Names the places in `names`; the others get the default name of their class and number, made unique.
pub fn name_places(map: &mut TopologicalMap, names: &BTreeMap<PlaceId, &str>) {
    let mut taken: BTreeSet<String> = names.values().map(|&name| name.to_owned()).collect();
    for place in &mut map.places {
        if let Some(&name) = names.get(&place.id) {
            name.clone_into(&mut place.name);
            continue;
        }
        let plain = format!("{} {}", place.class, place.id.0);
        let variants = (2..).map(|n| format!("{plain} ({n})"));
        let free = std::iter::once(plain.clone()).chain(variants).find(|name| !taken.contains(name));
        place.name = free.unwrap_or(plain);
        taken.insert(place.name.clone());
    }
}

/// The map with every number replaced; doorway sides, connections and routes follow.
pub fn renumber(map: &TopologicalMap, numbers: &BTreeMap<PlaceId, PlaceId>) -> TopologicalMap {
    let number = |id: PlaceId| numbers.get(&id).copied().unwrap_or(id);
    let mut result = map.clone();
    for place in &mut result.places {
        place.id = number(place.id);
        for side in place.doorway.iter_mut().flat_map(|doorway| &mut doorway.sides) {
            *side = number(*side);
        }
    }
    for connection in &mut result.connections {
        let [a, b] = [connection.a, connection.b].map(number);
        if a > b {
            connection.route = connection.route.as_ref().map(super::Route::reversed);
        }
        (connection.a, connection.b) = (a.min(b), a.max(b));
    }
    for way in &mut result.shortcuts {
        let [a, b] = [way.a, way.b].map(number);
        if a > b {
            way.route = way.route.reversed();
        }
        (way.within, way.a, way.b) = (number(way.within), a.min(b), a.max(b));
    }
    result.places.sort_by_key(|place| place.id);
    result.shortcuts.sort_by_key(|way| (way.within, way.a, way.b));
    result.connections.sort_by_key(|connection| (connection.a, connection.b));
    result
}

/// Cells that places share, and the cells of each, on one grid.
struct Overlaps {
    /// By (current, previous).
    shared: BTreeMap<(PlaceId, PlaceId), u64>,
    current: BTreeMap<PlaceId, u64>,
    previous: BTreeMap<PlaceId, u64>,
}

impl Overlaps {
    fn new(current: &TopologicalMap, shape: GridShape, previous: &TopologicalMap) -> Self {
        let [new, old] = [current, previous].map(|map| PlaceRaster::new(map, shape));
        let mut overlaps =
            Self { shared: BTreeMap::new(), current: cells_of(&new), previous: cells_of(&old) };
        for y in 0..shape.height {
            let old_row = old.row(y);
            for span in new.row(y) {
                let first = old_row.partition_point(|other| other.end <= span.start);
                for other in old_row[first..].iter().take_while(|other| other.start < span.end) {
                    let n_cells = other.end.min(span.end) - other.start.max(span.start);
                    *overlaps.shared.entry((span.place, other.place)).or_default() += n_cells as u64;
                }
            }
        }
        overlaps
    }

    /// Earlier self of each current place, largest shared part first; ties go to the lower numbers.
    fn best_pairs(&self) -> BTreeMap<PlaceId, PlaceId> {
        let mut pairs: Vec<_> = self
            .shared
            .iter()
            .map(|(&(new, old), &shared)| {
                let union = self.current[&new] + self.previous[&old] - shared;
                (shared as f64 / union as f64, new, old)
            })
            .filter(|pair| pair.0 >= MIN_SHARED_FRAC)
            .collect();
        pairs.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        let mut earlier_self = BTreeMap::new();
        let mut taken = BTreeSet::new();
        for (_, new, old) in pairs {
            if !earlier_self.contains_key(&new) && taken.insert(old) {
                earlier_self.insert(new, old);
            }
        }
        earlier_self
    }

    /// Cells that matched places share, by those of the smaller map; 0 where one of the maps has none on the grid.
    fn matched_share(&self, earlier_self: &BTreeMap<PlaceId, PlaceId>) -> f64 {
        let matched: u64 = earlier_self.iter().map(|(&new, &old)| self.shared[&(new, old)]).sum();
        let [all_new, all_old] = [&self.current, &self.previous].map(|cells| cells.values().sum::<u64>());
        let smaller = all_new.min(all_old);
        if smaller > 0 { matched as f64 / smaller as f64 } else { 0.0 }
    }

    fn changes(
        &self,
        previous: &TopologicalMap,
        earlier_self: &BTreeMap<PlaceId, PlaceId>,
        renumbered: &BTreeMap<PlaceId, PlaceId>,
    ) -> Vec<Change> {
        let later_self: BTreeMap<PlaceId, PlaceId> =
            earlier_self.iter().map(|(&new, &old)| (old, new)).collect();
        let mut pieces: BTreeMap<PlaceId, Vec<PlaceId>> = BTreeMap::new();
        let mut parts: BTreeMap<PlaceId, Vec<PlaceId>> = BTreeMap::new();
        for (&(new, old), &shared) in &self.shared {
            let inside = |n_cells: u64| shared as f64 > MIN_INSIDE_FRAC * n_cells as f64;
            if !earlier_self.contains_key(&new) && inside(self.current[&new]) {
                pieces.entry(old).or_default().push(new);
            }
            if !later_self.contains_key(&old) && inside(self.previous[&old]) {
                parts.entry(new).or_default().push(old);
            }
        }
        let explained_new: BTreeSet<PlaceId> = pieces.values().flatten().copied().collect();
        let explained_old: BTreeSet<PlaceId> = parts.values().flatten().copied().collect();

        let mut changes = Vec::new();
        for (&old, new) in &pieces {
            let into = later_self.get(&old).into_iter().chain(new).map(|id| renumbered[id]).collect();
            changes.push(Change::Split { from: old, into });
        }
        for (new, old) in &parts {
            let from = earlier_self.get(new).into_iter().chain(old).copied().collect();
            changes.push(Change::Merged { from, into: renumbered[new] });
        }
        for (new, &number) in renumbered {
            if !earlier_self.contains_key(new) && !explained_new.contains(new) {
                changes.push(Change::Appeared { place: number });
            }
        }
        for place in &previous.places {
            if !later_self.contains_key(&place.id) && !explained_old.contains(&place.id) {
                changes.push(Change::Vanished { place: place.id, name: place.name.clone() });
            }
        }
        changes
    }
}

fn cells_of(raster: &PlaceRaster) -> BTreeMap<PlaceId, u64> {
    let mut cells = BTreeMap::new();
    for span in (0..raster.shape().height).flat_map(|y| raster.row(y)) {
        *cells.entry(span.place).or_default() += (span.end - span.start) as u64;
    }
    cells
}

/// Matches doorways that share too few cells with their earlier selves: small as they are, a shift by a few
/// cells is enough. A doorway is the same if its center moved by less than its width.
fn pair_moved_doorways(
    current: &TopologicalMap,
    previous: &TopologicalMap,
    earlier_self: &mut BTreeMap<PlaceId, PlaceId>,
) {
    let taken: BTreeSet<PlaceId> = earlier_self.values().copied().collect();
    let doorways = |map: &TopologicalMap, known: &dyn Fn(PlaceId) -> bool| -> Vec<Place> {
        map.places.iter().filter(|place| place.role == Role::Doorway && !known(place.id)).cloned().collect()
    };
    let new = doorways(current, &|id| earlier_self.contains_key(&id));
    let old = doorways(previous, &|id| taken.contains(&id));
    let mut pairs: Vec<_> = new
        .iter()
        .flat_map(|new| old.iter().map(move |old| (new.centroid.distance(old.centroid), new, old)))
        .filter(|(distance, _, old)| old.doorway.as_ref().is_some_and(|doorway| *distance < doorway.width_m))
        .collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1.id, a.2.id).cmp(&(b.1.id, b.2.id))));
    let mut taken = taken;
    for (_, new, old) in pairs {
        if !earlier_self.contains_key(&new.id) && taken.insert(old.id) {
            earlier_self.insert(new.id, old.id);
        }
    }
}
