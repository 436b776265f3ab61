//! Doorways as objects: the true doors that were found, and the found doors that are true.
//!
//! A *door* is a connected set (8-neighborhood) of cells whose class has the doorway role. A true door of at
//! least [`MIN_DOOR_AREA_M2`] is *found* if a quarter of its cells lie within [`DOOR_REACH_M`] of predicted
//! door cells; a predicted door is *right* if a quarter of its cells lie within that reach of true door cells.
//! Predicted doors of which more than half the cells have no true label do not count. Distances are counted
//! along rows and columns, rounded to whole cells. Cost: linear in cells.

use std::collections::BTreeMap;

use crate::grid::{Connectivity, Grid};
use crate::labels::{Label, LabelSet, Role};

/// Smallest area of a true door that counts, in square meters.
pub const MIN_DOOR_AREA_M2: f64 = 0.05;

/// Distance within which true and predicted door cells match, in meters.
pub const DOOR_REACH_M: f64 = 0.3;

/// Share of a door's cells that must match.
const MIN_MATCH_FRAC: f64 = 0.25;

/// Upper bounds of the width classes, in meters; the last class has none.
const WIDTH_BOUNDS_M: [f64; 4] = [0.8, 1.2, 1.6, 2.0];

/// Most pairs of jamb cells that are compared to measure one width.
const MAX_JAMB_PAIRS: usize = 1_000_000;

/// Numbers of doors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DoorTally {
    /// True doors that count.
    pub n_true: u64,
    /// Those among them that were found.
    pub n_found: u64,
    /// Predicted doors that count.
    pub n_predicted: u64,
    /// Those among them that are right.
    pub n_right: u64,
}

impl DoorTally {
    fn add(&mut self, other: &Self) {
        self.n_true += other.n_true;
        self.n_found += other.n_found;
        self.n_predicted += other.n_predicted;
        self.n_right += other.n_right;
    }
}

/// The doors of one or more maps, counted: all of them, by clear width and by what they join.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DoorCounts {
    /// All doors.
    pub all: DoorTally,
    /// By width: one entry per width class, then one for doors of unknown width.
    pub by_width: [DoorTally; WIDTH_BOUNDS_M.len() + 2],
    /// By the classes on both sides, the lower one first; `None` for a side without labeled cells.
    pub by_sides: BTreeMap<[Option<Label>; 2], DoorTally>,
}

impl DoorCounts {
    /// Counts the doors of one map. True doors are grouped by the truth around them, predicted ones by the
    /// prediction.
    ///
    /// # Panics
    /// If the grids differ in size, or a label is not of `label_set`.
    pub fn count(
        predicted: &Grid<Option<Label>>,
        truth: &Grid<Option<Label>>,
        label_set: &LabelSet,
        resolution_m: f64,
    ) -> Self {
        assert_eq!(
            (predicted.width(), predicted.height()),
            (truth.width(), truth.height()),
            "prediction and truth are of one map"
        );
        // Halves go to the even number, as in the rule's reference.
        let reach_cells = (DOOR_REACH_M / resolution_m).round_ties_even().max(1.0);
        let is_door = |label: &Option<Label>| label.is_some_and(|l| label_set.role(l) == Role::Doorway);
        let (true_cells, predicted_cells) = (truth.map(is_door), predicted.map(is_door));
        let near = |cells: &Grid<bool>| distances(cells).map(|&d| f64::from(d) <= reach_cells);
        let (near_true, near_predicted) = (near(&true_cells), near(&predicted_cells));
        let matches = |cells: &[usize], near: &Grid<bool>| {
            let n_near = cells.iter().filter(|&&index| near.values()[index]).count();
            n_near as f64 >= MIN_MATCH_FRAC * cells.len() as f64
        };

        let mut counts = Self::default();
        for cells in patches(&true_cells) {
            if cells.len() as f64 * resolution_m * resolution_m >= MIN_DOOR_AREA_M2 {
                let n_found = u64::from(matches(&cells, &near_predicted));
                let tally = DoorTally { n_true: 1, n_found, ..DoorTally::default() };
                counts.add_door(&Surroundings::of(&cells, truth, &true_cells, resolution_m), &tally);
            }
        }
        for cells in patches(&predicted_cells) {
            let n_unlabeled = cells.iter().filter(|&&index| truth.values()[index].is_none()).count();
            if 2 * n_unlabeled <= cells.len() {
                let n_right = u64::from(matches(&cells, &near_true));
                let tally = DoorTally { n_predicted: 1, n_right, ..DoorTally::default() };
                counts.add_door(&Surroundings::of(&cells, predicted, &predicted_cells, resolution_m), &tally);
            }
        }
        counts
    }

    /// Adds the doors of another map with the same classes.
    pub fn add(&mut self, other: &Self) {
        self.all.add(&other.all);
        for (own, other) in self.by_width.iter_mut().zip(&other.by_width) {
            own.add(other);
        }
        for (sides, other) in &other.by_sides {
            self.by_sides.entry(*sides).or_default().add(other);
        }
    }

    fn add_door(&mut self, around: &Surroundings, tally: &DoorTally) {
        self.all.add(tally);
        let class = |width_m: f64| WIDTH_BOUNDS_M.iter().filter(|&&bound_m| width_m >= bound_m).count();
        self.by_width[around.width_m.map_or(WIDTH_BOUNDS_M.len() + 1, class)].add(tally);
        self.by_sides.entry(around.sides).or_default().add(tally);
    }

    /// Names of the groups of [`DoorCounts::by_width`], in their order.
    pub fn width_names() -> Vec<String> {
        let [first, .., last] = WIDTH_BOUNDS_M;
        let between = WIDTH_BOUNDS_M.windows(2).map(|bounds| format!("{} to {} m", bounds[0], bounds[1]));
        let ends = [format!("{last} m and more"), "unknown".to_owned()];
        [format!("below {first} m")].into_iter().chain(between).chain(ends).collect()
    }
}

/// How many steps along rows and columns it is from every cell to the nearest that is set.
fn distances(cells: &Grid<bool>) -> Grid<u32> {
    let mut distances = cells.map(|&is_set| if is_set { 0 } else { u32::MAX });
    let (width, n) = (cells.width() as usize, cells.values().len());
    let values = distances.values_mut();
    let mut relax = |index: usize, beside: usize| {
        values[index] = values[index].min(values[beside].saturating_add(1));
    };
    for index in 0..n {
        if index % width > 0 {
            relax(index, index - 1);
        }
        if index >= width {
            relax(index, index - width);
        }
    }
    for index in (0..n).rev() {
        if index % width + 1 < width {
            relax(index, index + 1);
        }
        if index + width < n {
            relax(index, index + width);
        }
    }
    distances
}

/// The connected sets (8-neighborhood) of set cells, as indices, by their first cell.
fn patches(cells: &Grid<bool>) -> Vec<Vec<usize>> {
    let mut is_left = cells.clone();
    let mut patches = Vec::new();
    for first in 0..cells.values().len() {
        if !is_left.values()[first] {
            continue;
        }
        is_left.values_mut()[first] = false;
        let mut patch = vec![first];
        let mut next = 0;
        while next < patch.len() {
            let cell = cells.cell(patch[next]);
            for near in Connectivity::Eight.steps().iter().filter_map(|&step| cells.offset(cell, step)) {
                if std::mem::take(&mut is_left[near]) {
                    patch.push(cells.index(near));
                }
            }
            next += 1;
        }
        patches.push(patch);
    }
    patches
}

/// What lies around a door in its own label image.
struct Surroundings {
    /// Distance of the jambs: the two longest stretches of cells without a label next to the door.
    width_m: Option<f64>,
    /// Classes of the two longest stretches of labeled cells next to the door, the lower one first.
    sides: [Option<Label>; 2],
}

impl Surroundings {
    fn of(door: &[usize], labels: &Grid<Option<Label>>, is_door: &Grid<bool>, resolution_m: f64) -> Self {
        let beside = door.iter().flat_map(|&index| {
            let cell = labels.cell(index);
            Connectivity::Four.steps().iter().filter_map(move |&step| labels.offset(cell, step))
        });
        let mut beside: Vec<usize> = beside.filter(|&near| !is_door[near]).map(|n| labels.index(n)).collect();
        beside.sort_unstable();
        beside.dedup();
        let (fronts, jambs): (Vec<usize>, Vec<usize>) =
            beside.into_iter().partition(|&index| labels.values()[index].is_some());
        let fronts = stretches(&fronts, labels.width());
        let mut sides = [0, 1].map(|k| fronts.get(k).and_then(|front| most_frequent(front, labels)));
        sides.sort_unstable();
        let jambs = stretches(&jambs, labels.width());
        let width_m = match jambs.as_slice() {
            [first, second, ..] if first.len() * second.len() <= MAX_JAMB_PAIRS => {
                let squared = first.iter().flat_map(|&a| second.iter().map(move |&b| (a, b)));
                let squared = squared.map(|(a, b)| {
                    let (a, b) = (labels.cell(a), labels.cell(b));
                    f64::from(a.x.abs_diff(b.x)).powi(2) + f64::from(a.y.abs_diff(b.y)).powi(2)
                });
                // From the face of one jamb to the face of the other.
                Some((squared.fold(f64::INFINITY, f64::min).sqrt() - 1.0) * resolution_m)
            }
            _ => None,
        };
        Self { width_m, sides }
    }
}

/// The connected sets (8-neighborhood) of `cells`, ascending indices in rows of `width`: longest first, then by
/// their first cell.
fn stretches(cells: &[usize], width: u32) -> Vec<Vec<usize>> {
    let width = width as usize;
    let mut is_left = vec![true; cells.len()];
    let mut stretches = Vec::new();
    for first in 0..cells.len() {
        if !std::mem::take(&mut is_left[first]) {
            continue;
        }
        let mut stretch = vec![first];
        let mut next = 0;
        while next < stretch.len() {
            let (x, y) = (cells[stretch[next]] % width, cells[stretch[next]] / width);
            for row in y.saturating_sub(1)..=y + 1 {
                let lowest = row * width + x.saturating_sub(1);
                let from = cells.partition_point(|&cell| cell < lowest);
                let until = row * width + (x + 2).min(width);
                for position in (from..cells.len()).take_while(|&position| cells[position] < until) {
                    if std::mem::take(&mut is_left[position]) {
                        stretch.push(position);
                    }
                }
            }
            next += 1;
        }
        stretches.push(stretch.into_iter().map(|position| cells[position]).collect::<Vec<_>>());
    }
    stretches.sort_by_key(|stretch| std::cmp::Reverse(stretch.len()));
    stretches
}

/// The label that most of the cells have, the lower one of two.
fn most_frequent(cells: &[usize], labels: &Grid<Option<Label>>) -> Option<Label> {
    let mut counts: BTreeMap<Label, usize> = BTreeMap::new();
    for label in cells.iter().filter_map(|&index| labels.values()[index]) {
        *counts.entry(label).or_default() += 1;
    }
    counts.into_iter().rev().max_by_key(|&(_, n)| n).map(|(label, _)| label)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eval::drawn::grid;

    fn count(predicted: &str, truth: &str, resolution_m: f64) -> DoorCounts {
        DoorCounts::count(&grid(predicted), &grid(truth), &LabelSet::default(), resolution_m)
    }

    const TWO_DOORS: &str = "
        ccccccccccccc
        ##dd#####ddd#
        ##dd#####ddd#
        ##dd#####ddd#
        rrrrr###rrrrr
        rrrrr###rrrrr";

    #[test]
    fn worked_by_hand() {
        // 0.1 m a cell, a reach of 3 cells. The cell on the wall is near all 6 cells of the left door, and has
        // no true label. The cell in the lower right corner is near one of the 9 cells of the right door: it is
        // right, and the door is not found. The cell in the lower left corner is 4 steps from the left door.
        let predicted = "
            ccccccccccccc
            #############
            #d###########
            #############
            rrrrr###rrrrr
            drrrr###rrrrd";
        let found = count(predicted, TWO_DOORS, 0.1);
        assert_eq!(found.all, DoorTally { n_true: 2, n_found: 1, n_predicted: 2, n_right: 1 });
        // Two more near cells make a third of the right door.
        let nearer = predicted.replace("drrrr###rrrrd", "drrrr###rrrdd");
        assert_eq!(count(&nearer, TWO_DOORS, 0.1).all.n_found, 2);
    }

    #[test]
    fn small_true_doors_and_no_predicted_ones_are_left_out() {
        // 4 and 5 cells of 0.01 m2; corners connect.
        let truth = "ddd#ddd ..d#d.d";
        let none = "....... .......";
        assert_eq!(count(none, truth, 0.1).all, DoorTally { n_true: 1, ..DoorTally::default() });
        assert_eq!(count(truth, none, 0.1).all, DoorTally::default());
    }

    #[test]
    fn widths_run_from_jamb_to_jamb_and_sides_are_what_lies_before_and_behind() {
        // 0.5 m a cell: 1 and 1.5 m wide.
        let found = count(TWO_DOORS, TWO_DOORS, 0.5);
        let one = DoorTally { n_true: 1, n_found: 1, n_predicted: 1, n_right: 1 };
        let none = DoorTally::default();
        assert_eq!(found.by_width, [none, one, one, none, none, none]);
        let sides = [Some(Label(0)), Some(Label(1))];
        let mut two = one;
        two.add(&one);
        assert_eq!(found.by_sides, BTreeMap::from([(sides, two)]));
        let mut both_maps = found.clone();
        both_maps.add(&found);
        assert_eq!((both_maps.all.n_true, both_maps.by_width[2].n_right), (4, 2));
        let text = found.scores(&LabelSet::default()).to_string();
        assert!(text.contains("0.8 to 1.2 m") && text.contains("corridor / room"), "{text}");
    }

    #[test]
    fn steps_are_those_of_a_plain_search() {
        let cells = grid("d......... ....#..... .......... ........d. .....#....").map(Option::is_some);
        let found = distances(&cells);
        for cell in cells.cells() {
            let steps = cells.cells().filter(|&other| cells[other]);
            let steps = steps.map(|other| cell.x.abs_diff(other.x) + cell.y.abs_diff(other.y));
            assert_eq!(Some(found[cell]), steps.min());
        }
    }
}
