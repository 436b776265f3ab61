//! Sect. 4.7: the places of the regions, with their numbers, names and routes.

use std::borrow::Cow;
use std::collections::BTreeMap;

use super::{Config, Frames};
use crate::grid::{FreeSpace, GridShape};
use crate::labels::LabelField;
use crate::model::Model;
use crate::progress::{Progress, Stage};
use crate::regions::{RegionId, RegionMap};
use crate::topology::align::{Alignment, align};
use crate::topology::edits::{self, Edited, Numbering, Outcome};
use crate::topology::identity::{CarriedOver, Change, carry_over};
use crate::topology::reach::mark_cut_off;
use crate::topology::{self, PlaceId, TopologicalMap};

/// The regions as places.
pub(super) struct Places {
    pub(super) regions: RegionMap,
    pub(super) topology: TopologicalMap,
    /// Number of every region's place; `None` for a region that is none.
    pub(super) place_ids: Vec<Option<PlaceId>>,
    pub(super) edit_outcomes: Vec<Outcome>,
    pub(super) changes: Vec<Change>,
    pub(super) frames: Option<Frames>,
}

/// Edits `regions` and makes places of all but the `islands`.
pub(super) fn places(
    space: &FreeSpace,
    smoothed: &LabelField,
    regions: RegionMap,
    islands: &[RegionId],
    model: &Model,
    config: &Config,
    progress: &dyn Progress,
) -> Places {
    let shape = GridShape { frame: space.frame, width: space.graph.width(), height: space.graph.height() };
    let build = |regions: &RegionMap, numbers: &[Option<PlaceId>]| {
        let mut built = topology::build(space, smoothed, regions, &model.label_set);
        if config.robot.radius_m > 0.0 {
            topology::lay_routes(&mut built, space, regions, config.robot.radius_m);
        }
        built.without(|region| numbers[region.index()].is_none())
    };

    if !config.edits.is_empty() {
        progress.begin(Stage::Edits); // by hand
    }
    let numbers = numbers(regions.regions.len(), islands);
    let mut alignment = None;
    let mut previous = config.previous.as_ref().map(Cow::Borrowed);
    let mut numbering = Numbering { numbers, names: BTreeMap::new() };
    if let Some(earlier) = &mut previous
        && (config.align_previous || !config.edits.is_empty())
    {
        let automatic = build(&regions, &numbering.numbers);
        if config.align_previous {
            alignment = align(earlier, &automatic);
            if let Some(found) = alignment.filter(Alignment::is_certain) {
                *earlier = Cow::Owned(earlier.moved(found.new_from_old));
            }
        }
        let carried = carry_over(&automatic, shape, earlier, &BTreeMap::new());
        numbering = Numbering::of(&carried, numbering.numbers.len());
    }
    let Edited { regions, numbers, names, mut outcomes, concerned } =
        edits::apply(space, &model.label_set, regions, numbering, &config.edits);

    progress.begin(Stage::Topology); // places and how they connect
    let mut built = build(&regions, &numbers);
    mark_cut_off(&mut built, shape, config.robot.from);
    let names = names.into_iter().map(|(region, name)| (topology::place_id(region), name)).collect();
    let carried = if let Some(previous) = &previous {
        progress.begin(Stage::Identity); // numbers and names of an earlier result
        carry_over(&built, shape, previous, &names)
    } else {
        let numbers = (0..).map(RegionId).zip(numbers);
        let numbers = numbers.filter_map(|(region, id)| Some((topology::place_id(region), id?))).collect();
        CarriedOver::first(&built, &numbers, &names)
    };
    let frames = previous.map(|_| Frames { matched_share: carried.matched_share, alignment });
    let CarriedOver { map: topology, renumbered, changes, .. } = carried;
    let number = |region| renumbered.get(&topology::place_id(region)).copied();
    for (outcome, concerned) in outcomes.iter_mut().zip(&concerned) {
        if let Ok(applied) = outcome {
            let names = concerned.iter().filter_map(|&region| Some(&topology.place(number(region)?)?.name));
            applied.now = names.cloned().collect();
        }
    }
    let place_ids = (0..regions.regions.len() as u32).map(|region| number(RegionId(region))).collect();
    Places { regions, topology, place_ids, edit_outcomes: outcomes, changes, frames }
}

/// Numbers from 1 for all regions but `islands`.
fn numbers(n_regions: usize, islands: &[RegionId]) -> Vec<Option<PlaceId>> {
    let mut is_island = vec![false; n_regions];
    for island in islands {
        is_island[island.index()] = true;
    }
    let mut next = 0;
    let number = |is_island: bool| {
        (!is_island).then(|| {
            next += 1;
            PlaceId(next)
        })
    };
    is_island.into_iter().map(number).collect()
}
