//! Regions as a segmentation into rooms, with the measures of [Bormann et al. 2016].
//!
//! An *instance* is a region without the doorway role; a *room* is a set of cells with one id in the truth.
//! Both count from 101 free cells on. Cells in no room are ignored.

use std::collections::BTreeMap;
use std::fmt;

use serde::Serialize;

use crate::grid::{CellGraph, Grid};
use crate::labels::{LabelSet, Role};
use crate::regions::RegionMap;

/// Smallest number of cells of an instance or a room that counts.
pub const MIN_ROOM_CELLS: u64 = 101;

/// Smallest share that makes a part of a split or of a merger.
const MIN_PART_FRAC: f64 = 0.1;

/// How well regions and rooms agree; `None` if there is nothing to compare.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RoomScores {
    /// Number of rooms.
    pub n_rooms: usize,
    /// Number of instances that have cells in rooms.
    pub n_instances: usize,
    /// Mean over instances of the largest overlap with a room, by the instance's cells in rooms.
    pub precision: Option<f64>,
    /// Mean over rooms of the largest overlap with an instance, by the room's cells.
    pub recall: Option<f64>,
    /// Mean over rooms of the largest intersection over union with an instance, cells in rooms only.
    pub mean_iou: Option<f64>,
    /// Rooms in which at least two instances each have a tenth of the cells.
    pub n_split_rooms: usize,
    /// Instances in which at least two rooms each have a tenth of the cells in rooms.
    pub n_merging_instances: usize,
}

/// Compares `regions` with the rooms of the truth: ids from 1, 0 for no room. Cost: linear in nodes.
///
/// # Panics
/// If `rooms` is not of the size of the map.
pub fn room_scores(
    graph: &CellGraph,
    regions: &RegionMap,
    label_set: &LabelSet,
    rooms: &Grid<u32>,
) -> RoomScores {
    assert_eq!(
        (rooms.width(), rooms.height()),
        (graph.width(), graph.height()),
        "rooms and regions are of one map"
    );
    let is_instance = |id: usize| {
        let region = &regions.regions[id];
        label_set.role(region.label) != Role::Doorway && region.n_cells as u64 >= MIN_ROOM_CELLS
    };
    let mut room_cells: BTreeMap<u32, u64> = BTreeMap::new();
    let mut overlaps: BTreeMap<(usize, u32), u64> = BTreeMap::new();
    for (cell, id) in graph.cells_in_rows(0..graph.height()).zip(&regions.region_of) {
        let room = rooms[cell];
        if room > 0 {
            *room_cells.entry(room).or_insert(0) += 1;
            *overlaps.entry((id.index(), room)).or_insert(0) += 1;
        }
    }
    overlaps.retain(|&(instance, _), _| is_instance(instance));
    let mut instance_cells: BTreeMap<usize, u64> = BTreeMap::new();
    for (&(instance, _), n) in &overlaps {
        *instance_cells.entry(instance).or_insert(0) += n;
    }
    room_cells.retain(|_, n| *n >= MIN_ROOM_CELLS);

    let of_instance = |&id: &usize| overlaps.range((id, 0)..=(id, u32::MAX)).map(|(_, &n)| n);
    let of_room = |&id: &u32| overlaps.iter().filter(move |((_, room), _)| *room == id);
    let is_parted = |overlap: &mut dyn Iterator<Item = u64>, whole: u64| {
        overlap.filter(|&n| n as f64 >= MIN_PART_FRAC * whole as f64).count() >= 2
    };
    let iou =
        |(instance, n): (usize, u64), whole: u64| n as f64 / (instance_cells[&instance] + whole - n) as f64;
    RoomScores {
        n_rooms: room_cells.len(),
        n_instances: instance_cells.len(),
        precision: mean(
            instance_cells
                .iter()
                .map(|(id, &whole)| of_instance(id).max().unwrap_or(0) as f64 / whole as f64),
        ),
        recall: mean(
            room_cells
                .iter()
                .map(|(id, &whole)| of_room(id).map(|(_, &n)| n).max().unwrap_or(0) as f64 / whole as f64),
        ),
        mean_iou: mean(room_cells.iter().map(|(id, &whole)| {
            of_room(id).map(|(&(instance, _), &n)| iou((instance, n), whole)).fold(0.0, f64::max)
        })),
        n_split_rooms: room_cells
            .iter()
            .filter(|&(id, &whole)| is_parted(&mut of_room(id).map(|(_, &n)| n), whole))
            .count(),
        n_merging_instances: instance_cells
            .iter()
            .filter(|&(id, &whole)| is_parted(&mut of_instance(id), whole))
            .count(),
    }
}

/// The mean of `values`, or `None` if there are none.
fn mean(values: impl ExactSizeIterator<Item = f64>) -> Option<f64> {
    let n = values.len();
    (n > 0).then(|| values.sum::<f64>() / n as f64)
}

impl fmt::Display for RoomScores {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |share: Option<f64>| match share {
            Some(share) => format!("{:.2} %", 100.0 * share),
            None => "–".to_owned(),
        };
        writeln!(f, "rooms                {:>11}", self.n_rooms)?;
        writeln!(f, "instances            {:>11}", self.n_instances)?;
        writeln!(f, "room precision       {:>11}", percent(self.precision))?;
        writeln!(f, "room recall          {:>11}", percent(self.recall))?;
        writeln!(f, "mean best IoU        {:>11}", percent(self.mean_iou))?;
        writeln!(f, "split rooms          {:>11}", self.n_split_rooms)?;
        writeln!(f, "merging instances    {:>11}", self.n_merging_instances)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Occupancy;
    use crate::labels::Label;
    use crate::regions::{DiagonalSteps, connected};

    /// A map of 40 by 10 free cells, labels and rooms by column.
    fn scores(label: impl Fn(u32) -> u8, room: impl Fn(u32) -> u32) -> RoomScores {
        let graph = CellGraph::new(&Grid::filled(40, 10, Occupancy::Free));
        let labels: Vec<Label> = graph.cells().iter().map(|cell| Label(label(cell.x))).collect();
        let rooms = Grid::from_rows(40, 10, graph.cells().iter().map(|cell| room(cell.x)).collect());
        let regions = connected(&graph, &labels, DiagonalSteps::ThroughFree);
        room_scores(&graph, &regions, &LabelSet::default(), &rooms)
    }

    #[test]
    fn worked_by_hand() {
        // Instances: 0..15 and 16..40; 15 is a doorway. Rooms: 0..20 and 20..36; the rest is in no room.
        let found = scores(
            |x| match x {
                0..15 => 1,
                15 => 2,
                _ => 0,
            },
            |x| match x {
                0..20 => 1,
                20..36 => 2,
                _ => 0,
            },
        );
        assert_eq!((found.n_rooms, found.n_instances), (2, 2));
        // Largest overlaps: 150 of 150 and 160 of 200 by instance, 150 of 200 and 160 of 160 by room, as
        // shares of the unions 150 of 200 and 160 of 200.
        let close = |found: Option<f64>, expected: f64| (found.unwrap() - expected).abs() < 1e-12;
        assert!(close(found.precision, 0.9));
        assert!(close(found.recall, 0.875));
        assert!(close(found.mean_iou, 0.775));
        // Room 1 has 150 and 40 of 200 cells; the second instance has 40 and 160 of 200.
        assert_eq!((found.n_split_rooms, found.n_merging_instances), (1, 1));
    }

    #[test]
    fn a_hundred_cells_do_not_count() {
        let found = scores(|x| u8::from(x < 10), |x| if x < 10 { 1 } else { 2 });
        assert_eq!((found.n_rooms, found.n_instances), (1, 1));
        assert_eq!((found.precision, found.n_split_rooms), (Some(1.0), 0));
    }

    #[test]
    fn no_rooms_no_scores() {
        let found = scores(|_| 0, |_| 0);
        assert_eq!((found.precision, found.recall, found.mean_iou), (None, None, None));
    }
}
