//! Boosted stumps over named figures, with probabilities calibrated on maps that they have not seen.

use crate::boost::{AdaBoostError, Calibrated, StrongClassifier, adaboost};
use crate::features::{FeatureId, FeatureTable};
use crate::labels::Label;
use crate::progress::{Progress, Silent};

/// The figures of an example, and its answer as far as it is known.
pub(super) type Answered<'a> = (&'a [f32], Option<bool>);

/// A calibrated classifier of `n_rounds` stumps over the figures at `columns`, learned from the examples of several maps, and for every
/// example the probability that a classifier gives it that was learned from the other half of the maps.
pub(super) fn calibrated(
    maps: &[Vec<Answered>],
    columns: usize,
    n_rounds: usize,
    progress: &dyn Progress,
) -> Result<(Calibrated, Vec<Vec<f64>>), AdaBoostError> {
    let all: Vec<Answered> = maps.iter().flatten().copied().collect();
    let classifier = boosted(&all, columns, n_rounds, progress)?;
    let mut scores: Vec<Vec<f64>> = vec![Vec::new(); maps.len()];
    let mut scored = Vec::new();
    for half in [0, 1] {
        let of_half = |wanted: usize| maps.iter().enumerate().filter(move |(index, _)| index % 2 == wanted);
        let seen: Vec<Answered> = of_half(1 - half).flat_map(|(_, examples)| examples).copied().collect();
        let other = boosted(&seen, columns, n_rounds, &Silent)?;
        for (index, examples) in of_half(half) {
            for &(figures, answer) in examples {
                let score = other.score(|id| figures[id.0 as usize]);
                scores[index].push(score);
                scored.extend(answer.map(|is_true| (score, f64::from(u8::from(is_true)))));
            }
        }
    }
    let (slope, offset) = logistic(&scored);
    let probability = |score: &f64| 1.0 / (1.0 + (-(slope * score + offset)).exp());
    let held_out = scores.iter().map(|scores| scores.iter().map(probability).collect()).collect();
    Ok((Calibrated { classifier, slope, offset }, held_out))
}

fn boosted(
    examples: &[Answered],
    columns: usize,
    n_rounds: usize,
    progress: &dyn Progress,
) -> Result<StrongClassifier, AdaBoostError> {
    let known: Vec<(&[f32], bool)> =
        examples.iter().filter_map(|&(figures, answer)| Some((figures, answer?))).collect();
    let values = (0..columns).flat_map(|column| known.iter().map(move |(figures, _)| figures[column]));
    let ids = (0..columns as u16).map(FeatureId).collect();
    let table = FeatureTable::from_columns(ids, known.len(), values.collect());
    let rows: Vec<u32> = (0..known.len() as u32).collect();
    let labels: Vec<Label> = known.iter().map(|&(_, is_true)| Label(u8::from(!is_true))).collect();
    Ok(adaboost(&table, &rows, &labels, 2, n_rounds, progress)?.swap_remove(0))
}

/// Slope and offset of the logistic function with the largest likelihood, by Newton's method [Platt 1999]. A step of a thousandth
/// towards the middle keeps it finite where scores part the examples.
fn logistic(scored: &[(f64, f64)]) -> (f64, f64) {
    let (mut slope, mut offset) = (1.0f64, 0.0f64);
    for _ in 0..100 {
        let (mut g, mut h) = ([1e-3 * slope, 1e-3 * offset], [1e-3, 0.0, 1e-3]);
        for &(score, truth) in scored {
            let p = 1.0 / (1.0 + (-(slope * score + offset)).exp());
            let weight = p * (1.0 - p);
            g[0] += (p - truth) * score;
            g[1] += p - truth;
            h[0] += weight * score * score;
            h[1] += weight * score;
            h[2] += weight;
        }
        let determinant = h[0] * h[2] - h[1] * h[1];
        slope -= (h[2] * g[0] - h[1] * g[1]) / determinant;
        offset -= (h[0] * g[1] - h[1] * g[0]) / determinant;
    }
    (slope, offset)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_are_calibrated() {
        // Of four examples with score 1 three are true, of four with score -1 one: the logarithm of the odds is ±ln 3.
        let of =
            |score: f64, n_true: usize| (0..4).map(move |index| (score, f64::from(u8::from(index < n_true))));
        let scored: Vec<(f64, f64)> = of(1.0, 3).chain(of(-1.0, 1)).collect();
        let (slope, offset) = logistic(&scored);
        assert!((slope - 3f64.ln()).abs() < 2e-3 && offset.abs() < 1e-9, "{slope} {offset}");
    }
}
