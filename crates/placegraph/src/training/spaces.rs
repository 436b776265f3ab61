//! Training of the model of spaces ([`SpaceModel`]) on maps whose corridors and rooms are known.

use super::calibration::{Answered, calibrated};
use crate::boost::{AdaBoostError, Calibrated};
use crate::grid::{FreeSpace, Grid};
use crate::labels::{Label, LabelSet, Role};
use crate::progress::{Progress, Silent};
use crate::spaces::{Measurements, Pieces, SpaceModel};

/// A piece counts once for so many square meters, in m²: a wrong corridor costs as many cells as it has.
const AREA_OF_ONE_M2: f64 = 8.0;
/// A piece counts at most so often.
const MAX_TIMES: usize = 6;
/// Smaller pieces are not learned from, in m².
const MIN_AREA_M2: f64 = 1.0;

/// The pieces of a map with their true kind, as far as it is known.
#[derive(Clone, Debug, PartialEq)]
pub struct SpaceExamples {
    /// What was measured of the pieces.
    pub measurements: Measurements,
    /// Whether a piece is a passage.
    pub is_passage: Vec<Option<bool>>,
}

/// What `pieces` are by the drawn `labels`: passages where as many of the cells are drawn as a passage as are drawn as a place. Of a piece
/// smaller than 1 m², or with more cells without such a label than with one, it is not known.
pub fn space_examples(
    space: &FreeSpace,
    pieces: &Pieces,
    measurements: Measurements,
    labels: &Grid<Option<Label>>,
    label_set: &LabelSet,
) -> SpaceExamples {
    let mut counts = vec![[0usize; 3]; pieces.len()];
    for (node, cell) in space.graph.cells_in_rows(0..space.graph.height()).enumerate() {
        let Some(piece) = pieces.piece_of(node) else { continue };
        let kind = match labels[cell].map(|label| label_set.role(label)) {
            Some(Role::Passage) => 0,
            Some(Role::Place) => 1,
            Some(Role::Doorway) | None => 2,
        };
        counts[piece][kind] += 1;
    }
    let known = |(&[n_passage, n_place, n_other], area_m2): (&[usize; 3], f64)| {
        (area_m2 >= MIN_AREA_M2 && n_passage + n_place >= n_other).then_some(n_passage >= n_place)
    };
    let is_passage = counts.iter().zip(measurements.areas_m2()).map(known).collect();
    SpaceExamples { measurements, is_passage }
}

/// Trains a model of spaces on the pieces of several maps, with this many stumps in either round.
///
/// Probabilities are calibrated, and the second round learns from those of the first, on maps that a classifier had not seen: half
/// of the maps after the other.
///
/// # Errors
/// If no piece, or every one, is a passage.
pub fn learn_spaces(
    mut maps: Vec<SpaceExamples>,
    n_rounds: usize,
    sources: Vec<String>,
    progress: &dyn Progress,
) -> Result<SpaceModel, AdaBoostError> {
    let (first, held_out) = round(&maps, Measurements::n_first_round(), n_rounds, &Silent)?;
    for (map, probabilities) in maps.iter_mut().zip(&held_out) {
        map.measurements.set_first_round(probabilities);
    }
    let n_figures = crate::spaces::figure_table().len();
    let (second, _) = round(&maps, n_figures, n_rounds, progress)?;
    Ok(SpaceModel { first, second, sources })
}

/// A classifier over the first `n_figures` figures, and the probability of every piece by one that has not seen its map.
fn round(
    maps: &[SpaceExamples],
    n_figures: usize,
    n_rounds: usize,
    progress: &dyn Progress,
) -> Result<(Calibrated, Vec<Vec<f64>>), AdaBoostError> {
    let figures: Vec<Vec<Vec<f32>>> = maps.iter().map(|map| map.measurements.figures()).collect();
    // What is not known counts once, so that it gets a probability.
    let times = |area_m2: f64, is_known: bool| {
        if is_known { ((area_m2 / AREA_OF_ONE_M2).ceil() as usize).clamp(1, MAX_TIMES) } else { 1 }
    };
    let of_map = |map: &SpaceExamples| -> Vec<(usize, usize)> {
        let areas_m2 = map.measurements.areas_m2();
        let pieces = areas_m2.iter().zip(&map.is_passage);
        pieces.map(|(&area_m2, known)| times(area_m2, known.is_some())).zip(0..).collect()
    };
    let counted: Vec<Vec<(usize, usize)>> = maps.iter().map(of_map).collect();
    let repeated = counted.iter().zip(maps).zip(&figures).map(|((counted, map), figures)| {
        let pieces = counted.iter().flat_map(|&(times, piece)| std::iter::repeat_n(piece, times));
        pieces.map(|piece| (figures[piece].as_slice(), map.is_passage[piece])).collect::<Vec<Answered>>()
    });
    let (calibrated, held_out) = calibrated(&repeated.collect::<Vec<_>>(), n_figures, n_rounds, progress)?;
    // One probability for each piece again.
    let once = counted.iter().zip(held_out).map(|(counted, repeated)| {
        let mut rest = repeated.as_slice();
        let first = |&(times, _): &(usize, usize)| {
            let (own, others) = rest.split_at(times);
            rest = others;
            own[0]
        };
        counted.iter().map(first).collect()
    });
    Ok((calibrated, once.collect()))
}
