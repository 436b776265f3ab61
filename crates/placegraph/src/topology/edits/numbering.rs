//! What regions are called before edits, and what edits leave.

use std::collections::BTreeMap;

use super::Outcome;
use crate::regions::{RegionId, RegionMap};
use crate::topology::identity::CarriedOver;
use crate::topology::{PlaceId, place_id};

/// Names and numbers of regions as places.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Numbering {
    /// The number of each region's place; `None` for a region that is not a place.
    pub numbers: Vec<Option<PlaceId>>,
    /// Names other than class and number.
    pub names: BTreeMap<RegionId, String>,
}

impl Numbering {
    /// What a map built from `n_regions` regions was called by its earlier self.
    pub(crate) fn of(carried: &CarriedOver, n_regions: usize) -> Self {
        let mut numbering = Self { numbers: vec![None; n_regions], names: BTreeMap::new() };
        for (index, number) in numbering.numbers.iter_mut().enumerate() {
            let region = RegionId(index as u32);
            let Some(&id) = carried.renumbered.get(&place_id(region)) else { continue };
            *number = Some(id);
            let place = carried.map.place(id);
            let named = place.filter(|place| place.name != format!("{} {}", place.class, id.0));
            numbering.names.extend(named.map(|place| (region, place.name.clone())));
        }
        numbering
    }
}

/// The corrected regions.
#[derive(Clone, Debug, PartialEq)]
pub struct Edited {
    /// The regions, numbered by their first node again.
    pub regions: RegionMap,
    /// Number of every region's place, kept from before the edits; new places have numbers above all others.
    pub numbers: Vec<Option<PlaceId>>,
    /// Names that edits gave, by region.
    pub names: BTreeMap<RegionId, String>,
    /// The outcome of every edit, in the order of the file; edits of the map have none.
    pub outcomes: Vec<Outcome>,
    /// The regions that each edit concerned, as far as they still exist.
    pub concerned: Vec<Vec<RegionId>>,
}
