//! The spaces between the doorways, labeled as a whole: the labeling that agrees best with a field and has short
//! borders, by graph cuts.
//!
//! Doorways part a building into spaces. What a classifier calls corridor inside of a room is mostly the view through its
//! door, along a wall or past a pillar: a wrong patch of any size, with a long border. This stage weighs the
//! evidence of a patch, by area, against its border, by length: a patch stays where a short border parts it from
//! the rest, as a room that is open to a corridor. It finds the labeling y of all cells that are no doorway with
//! the largest s r² Σ_i ln p_i(y_i) − L(y), where L is the length of the borders between labels in meters as the edges
//! of the 8-neighborhood count it, r the resolution, and s the evidence per area ([`SpaceConfig`]).
//!
//! Cost: some minimum cuts per label over the nodes ([`crate::amn::infer::expand`]): exact for two labels.
//!
//! The field should be one that has not heard the neighbors yet: the relaxation makes every cell as sure as its
//! surroundings, a doubtful patch no less than a clear one.
//!
//! **Deviation.** The chapter has no such stage; it can be left out. It is the chapter's associative network
//! (Sect. 4.6) with one weight, on the field of either method.

use crate::amn::infer::{Potentials, expand};
use crate::grid::{CellGraph, Connectivity, Grid, Occupancy};
use crate::labels::{Label, LabelField, LabelSet, Labeling, Role};

/// The weights of evidence and border.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpaceConfig {
    /// s: how much evidence an area of one square meter has, against one meter of border. Default 3.
    pub evidence_per_m: f64,
    /// Probabilities below this one, and above one minus it, count as this: neighboring cells err together, and
    /// none of them is as sure as it says. Default 0.1.
    pub least_probability: f64,
}

impl Default for SpaceConfig {
    fn default() -> Self {
        Self { evidence_per_m: 3.0, least_probability: 0.1 }
    }
}

/// `labeling` with all cells that are no doorway labeled anew; doorways stay.
///
/// # Panics
/// If `field` or `labeling` do not belong to `graph`, or a label is not of `label_set`.
pub fn settle(
    graph: &CellGraph,
    resolution_m: f64,
    field: &LabelField,
    labeling: &[Label],
    label_set: &LabelSet,
    config: &SpaceConfig,
) -> Labeling {
    assert!(field.n_nodes() == graph.n_nodes() && labeling.len() == graph.n_nodes(), "one label per node");
    let is_doorway = |label: &Label| label_set.role(*label) == Role::Doorway;
    let mut candidates: Vec<Label> = label_set.labels().filter(|label| !is_doorway(label)).collect();
    // Borders of equal cost lie as the order of the labels has it: not as the classes are numbered.
    candidates.sort_by_key(|&label| &label_set.class(label).name);
    if candidates.len() < 2 {
        return labeling.to_vec();
    }
    let mut cells = Grid::filled(graph.width(), graph.height(), Occupancy::Occupied);
    let nodes: Vec<usize> = (0..graph.n_nodes()).filter(|&node| !is_doorway(&labeling[node])).collect();
    for &node in &nodes {
        cells[graph.cells()[node]] = Occupancy::Free;
    }
    let spaces = CellGraph::new(&cells);

    let evidence = Evidence { candidates: &candidates, config, scale: config.evidence_per_m * resolution_m };
    let potentials = Potentials {
        node: nodes.iter().flat_map(|&node| evidence.of(field.row(node))).collect(),
        edge: vec![1.0; candidates.len()],
        connectivity: Connectivity::Eight,
    };
    let position = |label: Label| candidates.iter().position(|&other| other == label).unwrap_or(0);
    let start: Labeling = nodes.iter().map(|&node| Label(position(labeling[node]) as u8)).collect();
    let mut settled = labeling.to_vec();
    for (&node, label) in nodes.iter().zip(expand(&spaces, &potentials, &start)) {
        settled[node] = candidates[label.index()];
    }
    settled
}

struct Evidence<'a> {
    candidates: &'a [Label],
    config: &'a SpaceConfig,
    /// Of a node, against an edge of the graph.
    scale: f64,
}

impl Evidence<'_> {
    /// The evidence of a node for every candidate: the scaled logarithm of its share among them.
    fn of(&self, row: &[f32]) -> Vec<f64> {
        let total: f64 = self.candidates.iter().map(|label| row[label.index()] as f64).sum();
        let least = self.config.least_probability;
        let share = |label: &Label| row[label.index()] as f64 / total.max(f64::MIN_POSITIVE);
        let bounded = |label| share(label).clamp(least, 1.0 - least);
        self.candidates.iter().map(|label| self.scale * bounded(label).ln()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Cell;

    const CORRIDOR: Label = Label(0);
    const ROOM: Label = Label(1);
    const DOORWAY: Label = Label(2);

    /// A free rectangle of `width` by `height` cells of 0.1 m.
    fn free(width: u32, height: u32) -> CellGraph {
        CellGraph::new(&Grid::filled(width, height, Occupancy::Free))
    }

    /// Labels by `label`, each nine times as probable as the other place.
    fn settled(graph: &CellGraph, label: impl Fn(Cell) -> Label) -> Labeling {
        let labeling: Labeling = graph.cells().iter().map(|&cell| label(cell)).collect();
        let row = |label: &Label| match *label {
            CORRIDOR => [0.9, 0.1, 0.0],
            ROOM => [0.1, 0.9, 0.0],
            _ => [0.0, 0.0, 1.0],
        };
        let field = LabelField::from_rows(3, labeling.iter().flat_map(row).collect());
        settle(graph, 0.1, &field, &labeling, &LabelSet::default(), &SpaceConfig::default())
    }

    #[test]
    fn evidence_is_the_scaled_logarithm_of_the_share_among_places() {
        let config = SpaceConfig { evidence_per_m: 2.0, least_probability: 0.1 };
        let evidence = Evidence { candidates: &[CORRIDOR, ROOM], config: &config, scale: 0.5 };
        let found = evidence.of(&[0.1, 0.3, 0.6]);
        assert!((found[0] - 0.5 * 0.25_f64.ln()).abs() < 1e-7, "{found:?}");
        assert!((found[1] - 0.5 * 0.75_f64.ln()).abs() < 1e-7, "{found:?}");
        assert!((evidence.of(&[0.0, 1.0, 0.0])[0] - 0.5 * 0.1_f64.ln()).abs() < 1e-7);
        assert!(evidence.of(&[0.0, 0.0, 1.0]).iter().all(|value| value.is_finite()));
    }

    #[test]
    fn a_patch_inside_a_space_joins_it() {
        // 10 x 10 cells: evidence 100 · 3 · 0.1 · ln 9 = 66 against a border of 3 edges for each of 40 sides.
        let graph = free(40, 40);
        let is_patch = |cell: Cell| (15..25).contains(&cell.x) && (15..25).contains(&cell.y);
        let labels = settled(&graph, |cell| if is_patch(cell) { CORRIDOR } else { ROOM });
        assert!(labels.iter().all(|&label| label == ROOM));
    }

    #[test]
    fn a_space_with_a_short_border_stays() {
        // 20 x 20 cells, open over one side of 20: evidence 264 against a border of 58 edges.
        let graph = free(60, 20);
        let labels = settled(&graph, |cell| if cell.x < 20 { CORRIDOR } else { ROOM });
        let expected: Labeling =
            graph.cells().iter().map(|cell| if cell.x < 20 { CORRIDOR } else { ROOM }).collect();
        assert_eq!(labels, expected);
    }

    #[test]
    fn doorways_stay_and_part_the_spaces() {
        // A small space behind a doorway has no border with the other one.
        let graph = free(20, 4);
        let label = |cell: Cell| match cell.x {
            0..4 => CORRIDOR,
            4..6 => DOORWAY,
            _ => ROOM,
        };
        let expected: Labeling = graph.cells().iter().map(|&cell| label(cell)).collect();
        assert_eq!(settled(&graph, label), expected);
    }
}
