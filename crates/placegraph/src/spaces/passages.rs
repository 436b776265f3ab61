//! Pieces of free space that are passages as wholes.

use super::figures::{self, Measured};
use super::{Pieces, SpaceConfig, without_furniture};
use crate::boost::Calibrated;
use crate::grid::FreeSpace;
use crate::labels::{Label, LabelField, LabelSet, Role};

/// Names and meanings of the figures of a piece.
pub fn figure_table() -> Vec<(&'static str, &'static str)> {
    figures::REGISTRY.iter().map(|figure| (figure.name, figure.about)).collect()
}

/// What was measured of the pieces of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurements(Vec<Measured>);

impl Measurements {
    /// Measures `pieces`. `fields` are the distributions by single scans and smoothed. Cost: linear in nodes.
    pub fn of(
        space: &FreeSpace,
        pieces: &Pieces,
        fields: [&LabelField; 2],
        label_set: &LabelSet,
        config: &SpaceConfig,
    ) -> Self {
        Self(figures::measure(space, &without_furniture(space, config), pieces, fields, label_set))
    }

    /// The values of [`figure_table`] of every piece, in its order. Those of the first round, the last ones, are 0 until
    /// [`Measurements::set_first_round`].
    pub fn figures(&self) -> Vec<Vec<f32>> {
        self.0.iter().map(Measured::figures).collect()
    }

    /// The area of every piece, in m².
    pub fn areas_m2(&self) -> Vec<f64> {
        self.0.iter().map(|measured| measured.area_m2).collect()
    }

    /// Number of figures that the first round has.
    pub fn n_first_round() -> usize {
        figures::n_first_round()
    }

    /// Takes note of the probabilities that the first round gives the pieces.
    pub fn set_first_round(&mut self, probabilities: &[f64]) {
        for (own, measured) in self.0.iter_mut().enumerate() {
            measured.set_earlier(probabilities, own);
        }
    }
}

/// The pieces that are passages as wholes, whatever their cells say: those of at least 1 m² whose probability is at least
/// [`SpaceConfig::min_passage`], each with the class of role passage that single scans find most probable in it.
///
/// Scans see the shape of a hall; that it is where all doors lead to, only the graph of the pieces shows. `fields` are the distributions by
/// single scans and smoothed. Cost: linear in nodes.
pub fn passages(
    space: &FreeSpace,
    pieces: &Pieces,
    fields: [&LabelField; 2],
    label_set: &LabelSet,
    config: &SpaceConfig,
) -> Vec<Option<Label>> {
    let passages: Vec<Label> =
        label_set.labels().filter(|&label| label_set.role(label) == Role::Passage).collect();
    let has_places = label_set.labels().any(|label| label_set.role(label) == Role::Place);
    if passages.is_empty() || !has_places || config.min_passage > 1.0 {
        return vec![None; pieces.len()];
    }
    let mut measurements = Measurements::of(space, pieces, fields, label_set, config);
    let probabilities = |measurements: &Measurements, by: &Calibrated| -> Vec<f64> {
        measurements.figures().iter().map(|figures| by.probability(figures)).collect()
    };
    let first = probabilities(&measurements, &config.model.first);
    measurements.set_first_round(&first);
    let second = probabilities(&measurements, &config.model.second);
    let of_piece = |(measured, &p): (&Measured, &f64)| {
        let is_passage = measured.area_m2 >= figures::MIN_PLACE_M2 && p >= config.min_passage;
        // Ties go to the lower label.
        let best = passages.iter().rev().max_by_key(|label| measured.classes[label.index()]);
        best.copied().filter(|_| is_passage)
    };
    measurements.0.iter().zip(&second).map(of_piece).collect()
}

#[cfg(test)]
mod tests {
    use super::super::pieces_between;
    use super::*;
    use crate::geom::Pose2;
    use crate::grid::{Cell, CellGraph, MapFrame};
    use crate::labels::Labeling;

    const CORRIDOR: Label = Label(0);
    const ROOM: Label = Label(1);
    const DOORWAY: Label = Label(2);

    /// A hall of 8 m by 6 m with `n_rooms` rooms of 2 m by 2 m around it, 0.1 m a cell, behind doorways of 0.9 m; scans are undecided.
    fn hub(n_rooms: u32) -> (FreeSpace, Labeling, LabelField) {
        let (width, height) = (122, 102);
        let is_in = |x: u32, y: u32, left: u32, bottom: u32, w: u32, h: u32| {
            (left..left + w).contains(&x) && (bottom..bottom + h).contains(&y)
        };
        // Rooms below and above the hall.
        let room = |index: u32| (21 + index / 2 * 20, if index.is_multiple_of(2) { 1 } else { 82 });
        let kind = |x: u32, y: u32| {
            if is_in(x, y, 21, 21, 80, 60) {
                return Some(ROOM);
            }
            (0..n_rooms).find_map(|index| {
                let (left, bottom) = room(index);
                let door = if bottom == 1 { 20 } else { 81 };
                let is_door = is_in(x, y, left + 5, door, 9, 1);
                let is_room = is_in(x, y, left, bottom, 19, 19);
                is_door.then_some(DOORWAY).or(is_room.then_some(ROOM))
            })
        };
        let cell = |index: usize| (index as u32 % width, index as u32 / width);
        let graph = CellGraph::from_free(width, height, |index| kind(cell(index).0, cell(index).1).is_some());
        let labeling: Labeling = graph.cells().iter().filter_map(|cell| kind(cell.x, cell.y)).collect();
        let row = |cell: &Cell| {
            if is_in(cell.x, cell.y, 21, 21, 80, 60) { [0.4, 0.5, 0.1] } else { [0.05, 0.9, 0.05] }
        };
        let field = LabelField::from_rows(3, graph.cells().iter().flat_map(row).collect());
        let frame = MapFrame::new(0.1, Pose2::default()).unwrap();
        (FreeSpace { frame, graph }, labeling, field)
    }

    #[test]
    fn a_hall_where_all_doors_lead_to_is_a_passage() {
        let set = LabelSet::default();
        let found = |n_rooms: u32, min_passage: f64| {
            let (space, labeling, field) = hub(n_rooms);
            let pieces = pieces_between(&space, &labeling, &[], &set);
            let config = SpaceConfig { min_passage, ..SpaceConfig::default() };
            let found = passages(&space, &pieces, [&field; 2], &set, &config);
            assert_eq!(found.len(), 1 + n_rooms as usize);
            found.into_iter().flatten().collect::<Vec<_>>()
        };
        assert_eq!(found(8, 0.5), [CORRIDOR], "the hall, and none of the rooms");
        assert_eq!(found(1, 0.5), [], "one door does not make a passage");
        assert_eq!(found(8, 1.1), [], "switched off");
    }

    #[test]
    fn docs_list_the_figures() {
        let row = |&(name, about): &(&str, &str)| format!("| `{name}` | {about} |");
        let rows = figure_table().iter().map(row).collect::<Vec<_>>().join("\n") + "\n";
        let page =
            std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/spaces.md")).unwrap();
        assert!(page.ends_with(&rows), "docs/spaces.md should end with\n{rows}");
    }
}
