//! What single steps after the decision list do: iterations of the relaxation, and each correction.

use anyhow::Result;
use placegraph::grid::{Grid, OccupancyGrid};
use placegraph::labels::{Label, LabelSet};
use placegraph::pipeline::classify;
use placegraph::progress::Silent;
use placegraph::regions::{DiagonalSteps, Thresholds, connected, correct};
use placegraph::relax::{RelaxConfig, relax_in_place};

use super::experiment::{Run, boosted};
use super::results::{Correction, Point, score};

/// The relaxed labels after each number of `iterations`, in ascending order.
pub(super) fn iterations(
    run: &Run,
    map: &OccupancyGrid,
    truth: &Grid<Option<Label>>,
    iterations: &[u32],
) -> Result<Vec<Point>> {
    let compatibility = &boosted(&run.trained.model)?.compatibility;
    let space = &run.analysis.space;
    let graph = &space.graph;
    let (mut field, mut done) = (classify(map, space, &run.trained.model, &Silent).field, 0);
    let points = iterations.iter().map(|&n| {
        let more = RelaxConfig { iterations: n - done, patience: None };
        relax_in_place(graph, &mut field, compatibility, &more);
        done = n;
        Point { at: n as usize, scores: score(graph.cells(), &field.most_likely(), truth) }
    });
    Ok(points.collect())
}

/// The relaxed labels with either correction, and with both.
pub(super) fn corrections(run: &Run, truth: &Grid<Option<Label>>) -> Vec<Correction> {
    let both = Thresholds::default();
    let none = Thresholds { min_place_m2: 0.0, min_doorway_m2: 0.0, min_doorway_neighbors: 0, ..both };
    let variants = [
        ("none", none),
        ("rooms and corridors below 1 m²", Thresholds { min_place_m2: both.min_place_m2, ..none }),
        ("doorways below 0.1 m², or with fewer than two neighbors", Thresholds { min_place_m2: 0.0, ..both }),
        ("both", both),
    ];
    let space = &run.analysis.space;
    let graph = &space.graph;
    let regions = connected(graph, &run.analysis.smoothed.most_likely(), DiagonalSteps::default());
    let correction = |(name, thresholds): (&'static str, Thresholds)| {
        let corrected = correct(space, &regions, &LabelSet::default(), &thresholds);
        Correction {
            name,
            n_relabeled_regions: corrected.places.n_regions + corrected.doorways.n_regions,
            n_regions: corrected.regions.regions.len(),
            scores: score(graph.cells(), &corrected.regions.labeling(), truth),
        }
    };
    variants.into_iter().map(correction).collect()
}
