//! Alcoves: the lane between a bed and a wall looks like a corridor, and is a part of the room that it opens to.

use super::SpaceConfig;
use crate::grid::FreeSpace;
use crate::labels::{Label, LabelSet, Role};
use crate::regions::{RegionId, RegionMap, connected, contacts, properties};

/// A passage while its neighbors are counted.
#[derive(Clone, Copy, Default)]
struct Ways {
    n_doorways: usize,
    /// Regions that it touches without a doorway, and the last of them with the length of the contact in cell sides.
    n_open: usize,
    open: Option<(RegionId, u32)>,
}

/// `regions` with every alcove as a part of the place that it opens to, or `None` if there is no alcove.
///
/// A corridor joins what it leads to. A passage is an alcove if it touches, besides at most [`SpaceConfig::max_alcove_doors`] doorways,
/// one region only, which is a larger place, over more than [`SpaceConfig::min_alcove_mouth`] of its own length: the major axis of its
/// ellipse. A corridor whose doors are shut is longer than that.
///
/// Cost: linear in runs.
///
/// # Examples
/// ```
/// use placegraph::grid::{FreeSpace, OccupancyGrid};
/// use placegraph::labels::{Label, LabelSet};
/// use placegraph::regions::{DiagonalSteps, connected};
/// use placegraph::spaces::{SpaceConfig, join_alcoves};
///
/// // c: what looks like a corridor beside a wall (#) in a room (r).
/// let drawing = "rrrrrrr\nrr#####\nrrcccc#";
/// let free = drawing.replace(['r', 'c'], ".");
/// let space = FreeSpace::of(&OccupancyGrid::from_ascii(0.5, &free));
/// let letters: Vec<char> = drawing.lines().rev().flat_map(str::chars).filter(|&c| c != '#').collect();
/// let labels: Vec<Label> = letters.iter().map(|&c| Label(u8::from(c == 'r'))).collect();
/// let regions = connected(&space.graph, &labels, DiagonalSteps::default());
/// let join = |min_alcove_mouth| {
///     let config = SpaceConfig { min_alcove_mouth, ..SpaceConfig::default() };
///     join_alcoves(&space, &regions, &LabelSet::default(), &config)
/// };
/// // Its ellipse is 2.31 m long, its mouth one cell wide: 0.22 of this.
/// assert!(join(0.25).is_none());
/// assert!(join(0.2).unwrap().labeling().iter().all(|&label| label == Label(1)));
/// ```
///
/// # Panics
/// If `regions` do not belong to `space`, or a label is not of `label_set`.
pub fn join_alcoves(
    space: &FreeSpace,
    regions: &RegionMap,
    label_set: &LabelSet,
    config: &SpaceConfig,
) -> Option<RegionMap> {
    let role = |id: RegionId| label_set.role(regions.regions[id.index()].label);
    let mut ways = vec![Ways::default(); regions.regions.len()];
    for contact in contacts(&space.graph, regions) {
        for (id, other) in [(contact.a, contact.b), (contact.b, contact.a)] {
            let ways = &mut ways[id.index()];
            if role(other) == Role::Doorway {
                ways.n_doorways += 1;
            } else {
                ways.n_open += 1;
                ways.open = Some((other, contact.n_sides));
            }
        }
    }
    let joins = |(id, ways): (usize, &Ways)| {
        let (other, n_sides) =
            ways.open.filter(|_| ways.n_open == 1 && ways.n_doorways <= config.max_alcove_doors)?;
        let (own, around) = (regions.regions[id], regions.regions[other.index()]);
        let is_part = label_set.role(own.label) == Role::Passage
            && role(other) == Role::Place
            && own.n_cells < around.n_cells;
        is_part.then_some((id, around.label, f64::from(n_sides) * space.resolution_m()))
    };
    let mut found: Vec<(usize, Label, f64)> = ways.iter().enumerate().filter_map(joins).collect();
    if found.is_empty() {
        return None;
    }
    let measured = properties(space, regions);
    found.retain(|&(id, _, mouth_m)| mouth_m > config.min_alcove_mouth * measured[id].axes.major_m);
    if found.is_empty() {
        return None;
    }
    let mut label_of: Vec<Label> = regions.regions.iter().map(|region| region.label).collect();
    for (id, label, _) in found {
        label_of[id] = label;
    }
    let labeling: Vec<Label> = regions.region_of.iter().map(|id| label_of[id.index()]).collect();
    Some(connected(&space.graph, &labeling, regions.diagonal))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::OccupancyGrid;
    use crate::regions::DiagonalSteps;

    /// What becomes of a drawing, 0.5 m a letter: c, r and d are corridor, room and doorway.
    fn joined(drawing: &str) -> Option<String> {
        let free = drawing.replace(['r', 'c', 'd'], ".");
        let space = FreeSpace::of(&OccupancyGrid::from_ascii(0.5, &free));
        let letters: Vec<char> = drawing.lines().rev().flat_map(str::chars).filter(|&c| c != '#').collect();
        let label = |letter: char| Label(['c', 'r', 'd'].iter().position(|&c| c == letter).unwrap() as u8);
        let labels: Vec<Label> = letters.into_iter().map(label).collect();
        let regions = connected(&space.graph, &labels, DiagonalSteps::default());
        let found = join_alcoves(&space, &regions, &LabelSet::default(), &SpaceConfig::default())?;
        let labels = found.labeling();
        Some(space.graph.to_ascii(|node| ['c', 'r', 'd'][labels[node].index()]))
    }

    #[test]
    fn a_lane_in_a_room_is_a_part_of_it_with_two_doors_or_fewer() {
        assert_eq!(joined("rrrr\nrccr\nrrrr\n").unwrap(), "rrrr\nrrrr\nrrrr\n");
        assert_eq!(joined("rrrr\nrrrr\nccc#\nccc#\n#d##\n").unwrap(), "rrrr\nrrrr\nrrr#\nrrr#\n#d##\n");
        assert_eq!(joined("rrrr\nrrrr\nccc#\nd#d#\n").unwrap(), "rrrr\nrrrr\nrrr#\nd#d#\n");
    }

    #[test]
    fn a_corridor_is_none() {
        // With three doors, between two rooms, larger than the room, longer than its mouth is wide.
        for corridor in [
            "rrrrrr\nrrrrrr\nccccc#\nd#d#d#\n",
            "rrrrrr\nrrrrrr\n##cc##\n##cc##\nrrrrrr\nrrrrrr\n",
            "rr##\ncccc\ncccc\n",
            "rrrr\nrrrr\nc###\nc###\nc###\nc###\n",
        ] {
            assert_eq!(joined(corridor), None, "{corridor}");
        }
        // A room at the end of a corridor stays too.
        assert_eq!(joined("cccc\ncccc\n#rr#\n"), None);
    }
}
