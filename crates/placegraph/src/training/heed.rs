//! What painted doorways add to what the program knows of gates.

use super::GateExample;
use crate::boost::{Calibrated, StrongClassifier, WeightedStump, boost_from};
use crate::doorways::{DoorwayConfig, GateModel, figure_table};
use crate::features::{FeatureId, FeatureTable};
use crate::labels::Label;
use crate::progress::Silent;

/// Stumps that the painted doorways of `maps` add to what `base` says of gates: boosting goes on from its classifier. The number of rounds
/// makes the sum of −ln p least over all gates, each counted twice: as learned from, because the model will label these
/// maps too, and as held out (by maps where there are two or more). None if none helps, or nothing was painted.
pub fn heed_doorways(
    maps: &[Vec<GateExample>],
    base: &GateModel,
    config: &DoorwayConfig,
) -> Vec<WeightedStump> {
    let Calibrated { classifier, slope, offset } = &base.doorway;
    // Gates are doorways from this score on: there the boosted sum shall be 0.
    let least = (libm::log(config.min_doorway / (1.0 - config.min_doorway)) - offset) / slope;
    if !(least.is_finite() && *slope > 0.0) {
        return Vec::new();
    }
    let of_map = |(map, examples): (usize, &'_ Vec<GateExample>)| {
        let known =
            examples.iter().filter_map(|example| Some((example.figures.clone(), example.is_doorway?)));
        known
            .enumerate()
            .map(|(n, (figures, truth))| (if maps.len() > 1 { map } else { n } % N_FOLDS, figures, truth))
            .collect::<Vec<_>>()
    };
    let known: Vec<(usize, Vec<f32>, bool)> = maps.iter().enumerate().flat_map(of_map).collect();
    // The model has learned the labels of these maps by heart: what they say of its gates there, they say nowhere else.
    let is_geometry = |name: &str| !["scans", "smoothed", "support"].iter().any(|part| name.contains(part));
    let names = figure_table();
    let geometry: Vec<usize> = (0..names.len()).filter(|&at| is_geometry(names[at].0)).collect();
    let boosted = |kept: &dyn Fn(usize) -> bool| {
        let kept: Vec<&(usize, Vec<f32>, bool)> = known.iter().filter(|(fold, ..)| kept(*fold)).collect();
        let n_figures = kept.first()?.1.len();
        let figures: Vec<usize> = geometry.iter().copied().filter(|&at| at < n_figures).collect();
        let columns = figures.iter().flat_map(|&at| kept.iter().map(move |(_, figures, _)| figures[at]));
        let ids = figures.iter().map(|&at| FeatureId(at as u16)).collect();
        let table = FeatureTable::from_columns(ids, kept.len(), columns.collect());
        let rows: Vec<u32> = (0..kept.len() as u32).collect();
        let labels: Vec<Label> = kept.iter().map(|(.., truth)| Label(u8::from(!truth))).collect();
        let margin = |&row: &u32| (classifier.score(|id| kept[row as usize].1[id.0 as usize]) - least) as f32;
        let margins = |class: usize, rows: &[u32]| {
            if class == 0 { rows.iter().map(margin).collect() } else { Vec::new() }
        };
        let most = ROUNDS[ROUNDS.len() - 1];
        let mut found = boost_from(&table, &rows, &labels, 2, &margins, most, &Silent).ok()?;
        let mut stumps = found.swap_remove(0).stumps;
        for weighted in &mut stumps {
            weighted.alpha = weighted.alpha.min(MAX_VOTE);
        }
        Some(stumps)
    };
    let loss = |added: &[WeightedStump], examples: &[&(usize, Vec<f32>, bool)]| {
        let all = StrongClassifier { stumps: classifier.stumps.iter().chain(added).copied().collect() };
        let all = Calibrated { classifier: all, slope: *slope, offset: *offset };
        let of = |&&(_, ref figures, truth): &&(usize, Vec<f32>, bool)| {
            let p = all.probability(figures);
            -libm::log((if truth { p } else { 1.0 - p }).max(1e-9))
        };
        examples.iter().map(of).sum::<f64>()
    };
    let every: Vec<&(usize, Vec<f32>, bool)> = known.iter().collect();
    let mut added = boosted(&|_| true).unwrap_or_default();
    let mut losses = ROUNDS.map(|n| loss(&added[..n.min(added.len())], &every));
    for fold in 0..N_FOLDS {
        let out: Vec<&(usize, Vec<f32>, bool)> = known.iter().filter(|(of, ..)| *of == fold).collect();
        let added = boosted(&|other| other != fold).unwrap_or_default();
        for (sum, &n) in losses.iter_mut().zip(&ROUNDS) {
            *sum += loss(&added[..n.min(added.len())], &out);
        }
    }
    let best = (0..ROUNDS.len()).fold(0, |best, k| if losses[k] < losses[best] { k } else { best });
    added.truncate(ROUNDS[best]);
    added
}

/// Rounds to choose from, parts that are held out in turn.
const ROUNDS: [usize; 6] = [0, 1, 2, 4, 8, 16];
const N_FOLDS: usize = 4;
/// Largest vote of a stump: a few gates do not outvote the many that the base has seen.
const MAX_VOTE: f64 = 1.0;

#[cfg(test)]
mod tests {
    use super::super::learn_gates;
    use super::*;

    #[test]
    fn painted_doorways_are_heeded_where_the_base_is_wrong() {
        // The base goes by the first figure; what was painted, by the second.
        let of = |index: u32, decides: usize| {
            let figures = vec![(index % 3) as f32, (index % 5) as f32];
            // The base is not sure: every tenth gate is otherwise.
            let is_doorway =
                (figures[decides] > [0.5, 2.5][decides]) != (decides == 0 && index.is_multiple_of(10));
            GateExample { figures, is_doorway: Some(is_doorway), parts: Some(is_doorway) }
        };
        let maps = |decides| -> Vec<Vec<GateExample>> {
            (0..4).map(|map| (0..30).map(|index| of(index + map, decides)).collect()).collect()
        };
        let base = learn_gates(&maps(0), 5, Vec::new(), &Silent).unwrap();
        let config = DoorwayConfig::default();
        let heeded = |painted: &[Vec<GateExample>]| {
            let mut model = base.clone();
            let added = heed_doorways(painted, &base, &config);
            model.doorway.classifier.stumps.extend(&added);
            let n_right = painted.iter().flatten().filter(|example| {
                let is_doorway = model.doorway.probability(&example.figures) >= config.min_doorway;
                example.is_doorway == Some(is_doorway)
            });
            (added.len(), n_right.count())
        };
        let painted = maps(1);
        let is_right = |example: &&GateExample| {
            example.is_doorway == Some(base.doorway.probability(&example.figures) >= config.min_doorway)
        };
        let n_before = painted.iter().flatten().filter(is_right).count();
        let (n_added, n_right) = heeded(&painted);
        assert!(
            n_added > 0 && n_right > n_before + 20,
            "{n_added} stumps, {n_right} of 120, before {n_before}"
        );
        assert_eq!(heeded(&[vec![]]).0, 0, "nothing was painted");
    }
}
