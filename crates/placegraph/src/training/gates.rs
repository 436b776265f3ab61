//! Training of the gate model ([`GateModel`]) on maps whose doorways and rooms are known.

use std::collections::{BTreeMap, BTreeSet};

use super::calibration::{Answered, calibrated};
use crate::boost::AdaBoostError;
use crate::doorways::{DoorwayConfig, Gate, GateModel, strips};
use crate::geom::Vec2;
use crate::grid::{Cell, CellGraph, Connectivity, FreeSpace, Grid};
use crate::labels::{Label, LabelSet, Role};
use crate::progress::Progress;

/// A gate with its true kind, as far as it is known.
#[derive(Clone, Debug, PartialEq)]
pub struct GateExample {
    /// Its figures.
    pub figures: Vec<f32>,
    /// Whether it is a doorway.
    pub is_doorway: Option<bool>,
    /// Whether it separates two rooms, as a doorway or an opening.
    pub parts: Option<bool>,
}

/// Cells so near to a doorway count as it, in meters: people draw doors at different depths.
const NEAR_M: f64 = 0.3;
/// Smallest doorway that counts, in m².
const MIN_DOORWAY_M2: f64 = 0.05;
/// Where the rooms on both sides of a gate are read: so far beyond its narrow part, in meters, and so far from the middle, in
/// widths.
const ROOM_AT_M: [f64; 3] = [0.3, 0.5, 0.8];
const ROOM_ACROSS: [f64; 3] = [-0.25, 0.0, 0.25];

/// What `gates` are by the drawn `labels` and `rooms` (ids from 1, 0 for none).
///
/// A gate is a doorway if half of its strip and half of a drawn doorway lie within 0.3 m of each other, and none if less than a
/// quarter of its strip lies near one; what is between, or mostly unlabeled, is not known. It separates two rooms if these are the
/// rooms on its two sides.
pub fn gate_examples(
    space: &FreeSpace,
    gates: &[Gate],
    labels: &Grid<Option<Label>>,
    rooms: Option<&Grid<u16>>,
    label_set: &LabelSet,
    config: &DoorwayConfig,
) -> Vec<GateExample> {
    let resolution_m = space.resolution_m();
    let is_doorway = |cell: &Option<Label>| cell.is_some_and(|label| label_set.role(label) == Role::Doorway);
    let doorways = Doorways::of(&labels.map(is_doorway), resolution_m);
    let strips = strips(space, gates, config);
    let example = |(gate, strip): (&Gate, &Vec<usize>)| {
        let cells: Vec<Cell> = strip.iter().map(|&node| space.graph.cell(node)).collect();
        let n_unlabeled = cells.iter().filter(|&&cell| labels[cell].is_none()).count();
        GateExample {
            figures: gate.figures.clone(),
            is_doorway: doorways.matched(&cells).or_else(|| {
                let share = doorways.share_near(&cells);
                (2 * n_unlabeled <= cells.len() && share < 0.25 && !cells.is_empty()).then_some(false)
            }),
            parts: rooms.and_then(|rooms| parts(gate, resolution_m, rooms)),
        }
    };
    gates.iter().zip(&strips).map(example).collect()
}

/// The drawn doorways of a map.
struct Doorways {
    /// Number of the doorway of a cell, from 1; 0 for none.
    of: Grid<u32>,
    sizes: Vec<usize>,
    reach: i32,
}

impl Doorways {
    fn of(is_doorway: &Grid<bool>, resolution_m: f64) -> Self {
        let (width, height) = (is_doorway.width(), is_doorway.height());
        let graph = CellGraph::from_free(width, height, |index| is_doorway.values()[index]);
        let mut of = Grid::filled(width, height, 0);
        let mut sizes = Vec::new();
        for start in 0..graph.n_nodes() {
            if of[graph.cell(start)] != 0 {
                continue;
            }
            let number = sizes.len() as u32 + 1;
            let mut members = vec![start];
            of[graph.cell(start)] = number;
            let mut next = 0;
            while let Some(&node) = members.get(next) {
                next += 1;
                for neighbor in graph.neighbors(node, Connectivity::Eight) {
                    if of[graph.cell(neighbor)] == 0 {
                        of[graph.cell(neighbor)] = number;
                        members.push(neighbor);
                    }
                }
            }
            sizes.push(members.len());
        }
        let min_cells = MIN_DOORWAY_M2 / (resolution_m * resolution_m);
        for number in of.values_mut() {
            if *number != 0 && (sizes[*number as usize - 1] as f64) < min_cells {
                *number = 0;
            }
        }
        Self { of, sizes, reach: ((NEAR_M / resolution_m).round() as i32).max(1) }
    }

    /// The cells of doorways within reach of `cell`, along rows and columns.
    fn near(&self, cell: Cell) -> impl Iterator<Item = (u32, Cell)> {
        let reach = self.reach;
        let steps = (-reach..=reach).flat_map(move |y| {
            let columns = reach - y.abs();
            (-columns..=columns).map(move |x| (x, y))
        });
        steps.filter_map(move |step| {
            let near = self.of.offset(cell, step)?;
            (self.of[near] != 0).then(|| (self.of[near], near))
        })
    }

    fn share_near(&self, cells: &[Cell]) -> f64 {
        let n_near = cells.iter().filter(|&&cell| self.near(cell).next().is_some()).count();
        n_near as f64 / cells.len().max(1) as f64
    }

    /// `Some(true)` if half of `cells` are near a doorway, of which half is near them.
    fn matched(&self, cells: &[Cell]) -> Option<bool> {
        let mut reached: BTreeMap<u32, BTreeSet<(u32, u32)>> = BTreeMap::new();
        for (number, near) in cells.iter().flat_map(|&cell| self.near(cell)) {
            reached.entry(number).or_default().insert((near.x, near.y));
        }
        let is_half =
            |(number, near): (&u32, &BTreeSet<_>)| 2 * near.len() >= self.sizes[*number as usize - 1];
        (reached.iter().any(is_half) && self.share_near(cells) >= 0.5).then_some(true)
    }
}

/// Whether the rooms on both sides of a gate differ, if both are known.
fn parts(gate: &Gate, resolution_m: f64, rooms: &Grid<u16>) -> Option<bool> {
    let along = Vec2::new(-gate.across().y, gate.across().x);
    let room = |direction: f64| {
        let mut n_of: BTreeMap<u16, usize> = BTreeMap::new();
        for (beyond_m, across) in ROOM_AT_M.iter().flat_map(|b| ROOM_ACROSS.iter().map(move |a| (b, a))) {
            let at = gate.center()
                + along * (direction * (gate.depth_cells() / 2.0 + beyond_m / resolution_m))
                + gate.across() * (across * gate.width_cells());
            let is_inside =
                (0.0..rooms.width() as f64).contains(&at.x) && (0.0..rooms.height() as f64).contains(&at.y);
            let room = if is_inside { rooms[Cell::new(at.x as u32, at.y as u32)] } else { 0 };
            if room != 0 {
                *n_of.entry(room).or_default() += 1;
            }
        }
        n_of.into_iter().max_by_key(|&(_, n)| n).filter(|&(_, n)| n >= 3).map(|(room, _)| room)
    };
    Some(room(1.0)? != room(-1.0)?)
}

/// Trains a gate model on the examples of several maps, with this many stumps for either question.
///
/// Probabilities are calibrated on examples that a classifier had not seen: half of the maps after the other.
///
/// # Errors
/// If no example, or every one, is a doorway, or separates rooms.
pub fn learn_gates(
    maps: &[Vec<GateExample>],
    n_rounds: usize,
    sources: Vec<String>,
    progress: &dyn Progress,
) -> Result<GateModel, AdaBoostError> {
    let n_figures = maps.iter().flatten().next().map_or(0, |example| example.figures.len());
    let learned = |truth: fn(&GateExample) -> Option<bool>, progress: &dyn Progress| {
        let answered = |example| learned_from(example, truth);
        let maps: Vec<Vec<Answered>> = maps.iter().map(|map| map.iter().map(answered).collect()).collect();
        calibrated(&maps, n_figures, n_rounds, progress).map(|(calibrated, _)| calibrated)
    };
    let is_doorway = |example: &GateExample| example.is_doorway;
    // A doorway parts what it joins, whatever the rooms are.
    let parts =
        |example: &GateExample| if example.is_doorway == Some(true) { Some(true) } else { example.parts };
    Ok(GateModel { doorway: learned(is_doorway, progress)?, parting: learned(parts, progress)?, sources })
}

fn learned_from(example: &GateExample, truth: fn(&GateExample) -> Option<bool>) -> Answered<'_> {
    (&example.figures, truth(example))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::doorways::gates;
    use crate::grid::OccupancyGrid;
    use crate::labels::LabelField;
    use crate::progress::Silent;

    /// Two rooms of 3 m by 4 m at 0.1 m, and a door of 0.9 m in the wall between them, in columns 31 and 32 and rows 16 to 24.
    fn two_rooms() -> (OccupancyGrid, FreeSpace) {
        let row = |y: u32| {
            let is_wall = |x: u32| {
                x == 0 || y == 0 || x == 63 || y == 41 || ((31..33).contains(&x) && !(16..25).contains(&y))
            };
            (0..64).map(|x| if is_wall(x) { '#' } else { '.' }).collect::<String>()
        };
        let map = OccupancyGrid::from_ascii(0.1, &(0..42).map(row).collect::<Vec<_>>().join("\n"));
        let space = FreeSpace::of(&map);
        (map, space)
    }

    fn example(label: impl Fn(Cell) -> Option<Label>) -> GateExample {
        let (map, space) = two_rooms();
        let field = LabelField::from_rows(3, [0.0, 1.0, 0.0].repeat(space.graph.n_nodes()));
        let label_set = LabelSet::default();
        let gates = gates(&space, [&field; 2], &label_set, &DoorwayConfig::default());
        assert_eq!(gates.len(), 1);
        let (mut labels, mut rooms) = (map.cells.map(|_| None), map.cells.map(|_| 0));
        for &cell in space.graph.cells() {
            labels[cell] = label(cell);
            rooms[cell] = if cell.x < 32 { 1 } else { 2 };
        }
        gate_examples(&space, &gates, &labels, Some(&rooms), &label_set, &DoorwayConfig::default()).remove(0)
    }

    #[test]
    fn a_gate_is_what_was_drawn_there() {
        let room = Some(Label(1));
        let drawn = |cell: Cell| {
            if (30..34).contains(&cell.x) && (17..26).contains(&cell.y) { Some(Label(2)) } else { room }
        };
        let door = example(drawn);
        assert_eq!((door.is_doorway, door.parts), (Some(true), Some(true)));
        let opening = example(|_| room);
        assert_eq!((opening.is_doorway, opening.parts), (Some(false), Some(true)));
        let unlabeled = example(|_| None);
        assert_eq!(unlabeled.is_doorway, None);
        // A doorway drawn over both rooms is not this one.
        assert_ne!(example(|cell| if cell.y < 30 { Some(Label(2)) } else { room }).is_doorway, Some(true));
    }

    #[test]
    fn a_model_tells_the_figure_that_decides() {
        // Of two figures, the second decides.
        let of = |index: u32| GateExample {
            figures: vec![(index % 3) as f32, (index % 5) as f32],
            is_doorway: Some(index % 5 > 2),
            parts: Some(index % 5 > 1),
        };
        let maps: Vec<Vec<GateExample>> =
            (0..4).map(|map| (0..30).map(|index| of(index + map)).collect()).collect();
        let model = learn_gates(&maps, 5, vec!["own".into()], &Silent).unwrap();
        for index in 0..15 {
            let example = of(index);
            assert_eq!(model.doorway.probability(&example.figures) > 0.5, example.is_doorway.unwrap());
            assert_eq!(model.parting.probability(&example.figures) > 0.5, example.parts.unwrap());
        }
    }
}
