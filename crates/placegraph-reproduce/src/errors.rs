//! Where the wrong cells lie, and of what kind they are.

use placegraph::grid::{Grid, MapFrame};
use placegraph::labels::{Label, LabelSet};
use placegraph::pipeline::Analysis;
use placegraph::regions::{DiagonalSteps, Region, connected};

use super::buildings::Building;
use super::results::{DOORWAY, Errors, Patch, compare, painted};

/// Patches that are listed.
const N_PATCHES: usize = 5;

/// The wrong cells of `analysis` where `truth` has a label.
pub(super) fn errors(building: &Building, analysis: &Analysis, truth: &Grid<Option<Label>>) -> Errors {
    let found = painted(truth, analysis.space.graph.cells(), &analysis.labeling);
    let scores = compare(&found, truth);
    let wrong = analysis.space.graph.cells().iter().filter_map(|&cell| {
        let (found, truth) = (found[cell]?, truth[cell]?);
        (found != truth).then_some((cell, truth, found))
    });
    let wrong: Vec<_> = wrong.collect();
    let is_doorway = |&&(_, truth, found): &&(_, Label, Label)| truth == DOORWAY || found == DOORWAY;
    let disputed = |other: &Grid<Option<Label>>| {
        wrong.iter().filter(|&&(cell, _, found)| other[cell] == Some(found)).count() as u64
    };
    Errors {
        n_wrong: wrong.len() as u64,
        n_doorway: wrong.iter().filter(is_doorway).count() as u64,
        n_near: scores.confusion.n_near,
        n_disputed: building.second_drawing.as_ref().map(disputed),
        patches: patches(&building.map.grid.frame, analysis, truth),
    }
}

/// The largest connected sets of cells that are wrong in the same way.
fn patches(frame: &MapFrame, analysis: &Analysis, truth: &Grid<Option<Label>>) -> Vec<Patch> {
    let label_set = LabelSet::default();
    let n = label_set.len() as u8;
    let graph = &analysis.space.graph;
    // 0 is right or not scored; every kind of error is a label of its own.
    let kinds: Vec<Label> = graph
        .cells()
        .iter()
        .zip(&analysis.labeling)
        .map(|(&cell, found)| match truth[cell] {
            Some(truth) if truth != *found => Label(1 + truth.0 * n + found.0),
            _ => Label(0),
        })
        .collect();
    let regions = connected(graph, &kinds, DiagonalSteps::default());
    let mut sums = vec![[0.0; 2]; regions.regions.len()];
    for (cell, id) in graph.cells().iter().zip(&regions.region_of) {
        let center = frame.center(*cell);
        sums[id.index()][0] += center.x;
        sums[id.index()][1] += center.y;
    }
    let mut patches: Vec<_> =
        regions.regions.iter().zip(sums).filter(|(region, _)| region.label != Label(0)).collect();
    // A stable sort: patches of equal size stay in the order of the map.
    patches.sort_by_key(|(region, _)| std::cmp::Reverse(region.n_cells));
    let name = |label: u8| label_set.class(Label(label)).name.clone();
    let patch = |(region, sum): (&Region, [f64; 2])| Patch {
        n_cells: region.n_cells,
        center_m: sum.map(|sum| sum / f64::from(region.n_cells)),
        truth: name((region.label.0 - 1) / n),
        found: name((region.label.0 - 1) % n),
    };
    patches.into_iter().take(N_PATCHES).map(patch).collect()
}
