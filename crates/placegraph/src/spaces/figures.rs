//! What is measured of a piece of free space: the figures that a [`SpaceModel`](super::SpaceModel) looks at.
//!
//! "Scans" is the field of single scans, "smoothed" the field after relaxation. The *evidence* of a cell is the share of
//! passages among all classes that are no doorway.

use std::collections::BTreeSet;

use super::pieces::Pieces;
use crate::grid::{CellGraph, FreeSpace, squared_clearances};
use crate::labels::{LabelField, LabelSet, Role};

/// Smaller pieces are no places, but a part of what joins their neighbors, in m².
pub(super) const MIN_PLACE_M2: f64 = 1.0;

/// One figure of a piece.
#[derive(Clone, Copy)]
pub(super) struct Figure {
    /// Name in model files.
    pub(super) name: &'static str,
    /// What it is, with its unit.
    pub(super) about: &'static str,
    of: fn(&Measured) -> f64,
}

macro_rules! registry {
    ($($name:literal, $about:literal, $of:expr;)*) => {
        /// All figures. Those of the round before come last.
        pub(super) const REGISTRY: &[Figure] = &[$(Figure { name: $name, about: $about, of: $of }),*];
    };
}

registry! {
    "passage_scans", "mean evidence of a passage, scans", |m| m.mean(m.evidence[0]);
    "passage_smoothed", "the same, smoothed", |m| m.mean(m.evidence[1]);
    "passage_middle", "the same, scans, weighted by the distance to a wall",
        |m| m.evidence_middle as f64 / STEPS / m.clearance.max(1) as f64;
    "passage_share", "share of cells with evidence of at least a half, smoothed", |m| m.n_passage as f64 / m.n_cells as f64;
    "slenderness", "area over the square of twice the largest distance to a wall",
        |m| m.area_m2 / (2.0 * m.clearance_max_m()).powi(2);
    "slenderness_mean", "area over the square of four times the mean distance to a wall",
        |m| m.area_m2 / (4.0 * m.clearance_m()).powi(2);
    "clearance_fill", "mean over largest distance to a wall", |m| m.clearance_m() / m.clearance_max_m();
    "degree_by_size", "number of neighbors over the square root of the area, 1/m", |m| m.degree() as f64 / m.area_m2.sqrt();
    "leaf_share", "share of the neighbors that have no other neighbor", |m| m.n_leaves as f64 / m.degree().max(1) as f64;
    "around_mean", "mean of the neighbors' mean evidence, scans", |m| m.around_mean;
    "above_around", "own mean evidence less that of the neighbors, scans", |m| m.mean(m.evidence[0]) - m.around_mean;
    "earlier", "probability of a passage by the first round", |m| m.earlier.own;
    "earlier_mean", "mean of the neighbors' probabilities by the first round", |m| m.earlier.mean;
    "earlier_max", "largest of them", |m| m.earlier.max;
    "earlier_min", "smallest of them; 1 without neighbors", |m| m.earlier.min;
    "earlier_sum", "sum of them", |m| m.earlier.sum;
}

/// Number of figures that are known in the first round.
pub(super) fn n_first_round() -> usize {
    REGISTRY.iter().take_while(|figure| !figure.name.starts_with("earlier")).count()
}

/// What was measured of a piece. Sums over cells are of whole steps: the same in any order, so that a turned map has the same.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Measured {
    n_cells: usize,
    pub(super) area_m2: f64,
    /// Evidence of scans and smoothed, in [`STEPS`].
    evidence: [u64; 2],
    /// Evidence of scans times distance to a wall.
    evidence_middle: u128,
    /// Distance to a wall, in [`STEPS`] of a cell, and the largest.
    clearance: u64,
    clearance_max: u64,
    /// Every class's probability by scans.
    pub(super) classes: Vec<u64>,
    n_passage: usize,
    /// Pieces beyond a doorway or an opening.
    neighbors: BTreeSet<u32>,
    n_leaves: usize,
    around_mean: f64,
    earlier: Earlier,
    resolution_m: f64,
}

/// Steps of a probability, or of a cell.
const STEPS: f64 = 65536.0;

/// What the first round says of a piece and of its neighbors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Earlier {
    own: f64,
    sum: f64,
    mean: f64,
    max: f64,
    min: f64,
}

impl Measured {
    /// The values of [`REGISTRY`].
    pub(super) fn figures(&self) -> Vec<f32> {
        REGISTRY.iter().map(|figure| (figure.of)(self) as f32).collect()
    }

    /// Takes note of the probabilities that the first round gives all pieces, of which this one is number `own`.
    pub(super) fn set_earlier(&mut self, probabilities: &[f64], own: usize) {
        let around = self.of_neighbors(probabilities);
        let sum: f64 = around.iter().sum();
        self.earlier = Earlier {
            own: probabilities[own],
            sum,
            mean: sum / around.len().max(1) as f64,
            max: around.last().copied().unwrap_or(0.0),
            min: around.first().copied().unwrap_or(1.0),
        };
    }

    /// The values of the neighbors, lowest first: their sum is the same whatever the pieces' numbers.
    fn of_neighbors(&self, values: &[f64]) -> Vec<f64> {
        let mut around: Vec<f64> = self.neighbors.iter().map(|&other| values[other as usize]).collect();
        around.sort_by(f64::total_cmp);
        around
    }

    /// Mean over the cells of a sum of [`STEPS`].
    fn mean(&self, sum: u64) -> f64 {
        sum as f64 / STEPS / self.n_cells as f64
    }

    fn clearance_m(&self) -> f64 {
        self.mean(self.clearance) * self.resolution_m
    }

    fn clearance_max_m(&self) -> f64 {
        self.clearance_max as f64 / STEPS * self.resolution_m
    }

    fn degree(&self) -> usize {
        self.neighbors.len()
    }
}

/// Measures every piece; the first round is not known yet. Walls are what is not free in `bare`. Cost: linear in nodes.
pub(super) fn measure(
    space: &FreeSpace,
    bare: &CellGraph,
    pieces: &Pieces,
    fields: [&LabelField; 2],
    label_set: &LabelSet,
) -> Vec<Measured> {
    let graph = &space.graph;
    let resolution_m = space.resolution_m();
    let empty = Measured { classes: vec![0; label_set.len()], resolution_m, ..Measured::default() };
    let mut measured = vec![empty; pieces.len()];
    let clearances = clearances(graph, bare);
    let steps = |value: f64| (value * STEPS).round() as u64;
    for node in 0..graph.n_nodes() {
        let Some(piece) = pieces.piece_of(node) else { continue };
        let m = &mut measured[piece];
        let [by_scan, smoothed] = fields.map(|field| evidence(field.row(node), label_set));
        m.evidence[0] += steps(by_scan);
        m.evidence[1] += steps(smoothed);
        for (sum, &p) in m.classes.iter_mut().zip(fields[0].row(node)) {
            *sum += steps(f64::from(p));
        }
        let clearance = steps(f64::from(clearances[node]));
        m.evidence_middle += u128::from(steps(by_scan)) * u128::from(clearance);
        m.n_passage += usize::from(smoothed >= 0.5);
        m.clearance += clearance;
        m.clearance_max = m.clearance_max.max(clearance);
        m.n_cells += 1;
    }
    for m in &mut measured {
        m.area_m2 = m.n_cells as f64 * resolution_m * resolution_m;
    }
    connect(graph, pieces, &mut measured);
    measured
}

/// The share of passages among all classes that are no doorway.
fn evidence(row: &[f32], label_set: &LabelSet) -> f64 {
    let of_role = |role: Role| -> f64 {
        label_set.labels().filter(|&l| label_set.role(l) == role).map(|l| f64::from(row[l.index()])).sum()
    };
    (of_role(Role::Passage) / (1.0 - of_role(Role::Doorway)).max(1e-6)).clamp(0.0, 1.0)
}

/// Distance of every node of `graph` to the nearest side of a cell that is not free in `bare`, in cells.
fn clearances(graph: &CellGraph, bare: &CellGraph) -> Vec<f32> {
    let mut of_bare = Vec::with_capacity(bare.n_nodes());
    let to_side = |squared: &i64| ((*squared as f64).sqrt() - 0.5) as f32;
    squared_clearances(bare, |_, _| true, |_, run| of_bare.extend(run.iter().map(to_side)));
    let cells = bare.cells_in_rows(0..bare.height()).zip(of_bare);
    cells.filter(|&(cell, _)| graph.is_free(cell)).map(|(_, clearance)| clearance).collect()
}

/// Fills in what depends on the neighbors: pieces that one doorway or opening joins.
fn connect(graph: &CellGraph, pieces: &Pieces, measured: &mut [Measured]) {
    let is_place: Vec<bool> = measured.iter().map(|m| m.area_m2 >= MIN_PLACE_M2).collect();
    for joined in pieces.joined(graph, &is_place) {
        for &piece in &joined {
            let others = joined.iter().filter(|&&other| other != piece);
            measured[piece as usize].neighbors.extend(others);
        }
    }
    let degrees: Vec<usize> = measured.iter().map(Measured::degree).collect();
    let means: Vec<f64> = measured.iter().map(|m| m.mean(m.evidence[0])).collect();
    for m in measured {
        m.n_leaves = m.neighbors.iter().filter(|&&other| degrees[other as usize] == 1).count();
        m.around_mean = m.of_neighbors(&means).iter().sum::<f64>() / m.degree().max(1) as f64;
    }
}

#[cfg(test)]
mod tests {
    use super::super::pieces_between;
    use super::*;
    use crate::grid::OccupancyGrid;
    use crate::labels::Label;

    /// Two rooms and a corridor, 0.5 m a cell, joined by the doorways of the first column beside each room; the evidence of the corridor
    /// is 0.8 by scans and 1 smoothed, that of rooms 0.2 and 0.
    fn figures(drawing: &str) -> Vec<Vec<f32>> {
        let space = FreeSpace::of(&OccupancyGrid::from_ascii(0.5, &drawing.replace(['c', 'r', 'd'], ".")));
        let lines: Vec<&str> = drawing.split_whitespace().rev().collect();
        let letter = |node: usize| {
            let cell = space.graph.cell(node);
            lines[cell.y as usize].as_bytes()[cell.x as usize]
        };
        let labeling: Vec<Label> = (0..space.graph.n_nodes())
            .map(|node| Label(b"crd".iter().position(|&l| l == letter(node)).unwrap() as u8))
            .collect();
        let row = |label: &Label| if *label == Label(0) { [0.64, 0.16, 0.2] } else { [0.16, 0.64, 0.2] };
        let sure = |label: &Label| if *label == Label(0) { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
        let scans = LabelField::from_rows(3, labeling.iter().flat_map(row).collect());
        let smoothed = LabelField::from_rows(3, labeling.iter().flat_map(sure).collect());
        let set = LabelSet::default();
        let pieces = pieces_between(&space, &labeling, &[], &set);
        let measured = measure(&space, &space.graph, &pieces, [&scans, &smoothed], &set);
        let mut with_first_round = measured.clone();
        let probabilities: Vec<f64> = (0..measured.len()).map(|piece| 0.25 * piece as f64).collect();
        for (piece, m) in with_first_round.iter_mut().enumerate() {
            m.set_earlier(&probabilities, piece);
        }
        with_first_round.iter().map(Measured::figures).collect()
    }

    fn value(figures: &[f32], name: &str) -> f32 {
        figures[REGISTRY.iter().position(|figure| figure.name == name).unwrap()]
    }

    #[test]
    fn figures_worked_by_hand() {
        // From below: a corridor of 9 x 2 cells (4.5 m²), two doorways, rooms of 4 x 3 and 4 x 3 cells (3 m²).
        let figures = figures(
            "
            rrrr#rrrr
            rrrr#rrrr
            rrrr#rrrr
            #d####d##
            ccccccccc
            ccccccccc",
        );
        let [corridor, room, other] = &figures[..] else { panic!("{} pieces", figures.len()) };
        let close = |a: f32, b: f32| assert!((a - b).abs() < 1e-3, "{a} {b}");
        close(value(corridor, "passage_scans"), 0.8);
        close(value(corridor, "passage_smoothed"), 1.0);
        close(value(corridor, "passage_middle"), 0.8);
        close(value(corridor, "passage_share"), 1.0);
        close(value(room, "passage_scans"), 0.2);
        close(value(room, "passage_share"), 0.0);
        close(value(corridor, "degree_by_size"), 2.0 / 4.5f32.sqrt());
        close(value(corridor, "leaf_share"), 1.0);
        close(value(room, "leaf_share"), 0.0);
        close(value(corridor, "around_mean"), 0.2);
        close(value(room, "above_around"), -0.6);
        // Of the corridor's 18 cells 16 are half a cell from a side, 0.25 m; those below a doorway see the ends of walls diagonally.
        let below = (2f32.sqrt() - 0.5) * 0.5;
        let mean = (16.0 * 0.25 + 2.0 * below) / 18.0;
        close(value(corridor, "slenderness"), 4.5 / (2.0 * below).powi(2));
        close(value(corridor, "slenderness_mean"), 4.5 / (4.0 * mean).powi(2));
        close(value(corridor, "clearance_fill"), mean / below);
        // Probabilities 0, 0.25 and 0.5.
        close(value(corridor, "earlier"), 0.0);
        close(value(corridor, "earlier_mean"), 0.375);
        close(value(corridor, "earlier_max"), 0.5);
        close(value(corridor, "earlier_min"), 0.25);
        close(value(corridor, "earlier_sum"), 0.75);
        close(value(other, "earlier"), 0.5);
        assert_eq!(n_first_round(), REGISTRY.len() - 5);
    }

    #[test]
    fn pieces_too_small_for_a_place_join_what_is_beside_them() {
        // Two cells (0.5 m²) between two doorways: the room and the corridor are neighbors.
        let figures = figures("rrrrdccdcccccccc\nrrrr########cccc\nrrrr########cccc");
        assert_eq!(figures.len(), 3);
        let degrees: Vec<bool> = figures.iter().map(|f| value(f, "degree_by_size") > 0.0).collect();
        assert_eq!(degrees.iter().filter(|&&has| has).count(), 2, "{degrees:?}");
    }
}
