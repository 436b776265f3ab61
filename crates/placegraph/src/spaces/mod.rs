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
//! Cost: some minimum cuts per label over the nodes ([`crate::cuts::expand`]): exact for two labels. Spaces that do not
//! touch are cut each on its own: memory is 2 bytes a node, and 46 per cell of the rectangles around those that are at work, which
//! are together no larger than the map. With two labels a space of more than a million cells is first cut in tiles, twice each;
//! what no tile is certain of is then cut in pieces. The result is the same.
//! Evidence is rounded to 2⁻¹⁴ of what an edge costs.
//!
//! The field should be one that has not heard the neighbors yet: the relaxation makes every cell as sure as its
//! surroundings, a doubtful patch no less than a clear one.
//!
//! Then pieces between doorways and openings are labeled as wholes ([`passages`], [`label_whole`]), and alcoves join the place that
//! they open to ([`join_alcoves`]).
//!
//! **Deviation.** The chapter has no such stage; it can be left out. It is the chapter's associative network
//! (Sect. 4.6) with one weight, on the field of either method.

mod alcoves;
mod evidence;
mod figures;
mod model;
mod passages;
mod piece;
mod pieces;
mod whole;

use rayon::prelude::*;

use crate::grid::{CellGraph, DiagonalSteps, FreeSpace, Obstacles, Run, Runs, components};
use crate::labels::{Held, Label, LabelField, LabelSet, Labeling, Role};
use evidence::Evidence;
use piece::{Piece, Rectangle};

pub use alcoves::join_alcoves;
pub use model::SpaceModel;
pub use passages::{Measurements, figure_table, passages};
pub use pieces::Pieces;

/// The weights of evidence and border, each with its source.
#[derive(Clone, Debug, PartialEq)]
pub struct SpaceConfig {
    /// s: how much evidence an area of one square meter has, against one meter of border. Default 3: `docs/default-model.md`, "What was
    /// tried": real and generated buildings.
    pub evidence_per_m: f64,
    /// Probabilities below this one, and above one minus it, count as this: neighboring cells err together, and
    /// none of them is as sure as it says. Default 0.1: the same page.
    pub least_probability: f64,
    /// Share of the cells of a piece that must agree for all of it to take their label. Default 0.75: of 0.6 to 0.8 the one that does
    /// best on real and generated buildings (`docs/default-model.md`). Above 1, none does.
    pub min_agreement: f64,
    /// What was learned of pieces.
    pub model: SpaceModel,
    /// Least probability by `model` that a piece is a passage, for all of it to become one. Default 0.6 (`docs/default-model.md` has the
    /// curve). Above 1, none does, nor where cells are labeled by another model than the built-in one, whose evidence `model` knows.
    pub min_passage: f64,
    /// Most doors of an alcove, a passage that is a part of the place that it opens to ([`join_alcoves`]). Default 2: what has three is a
    /// corridor (`docs/default-model.md`).
    pub max_alcove_doors: usize,
    /// Least share of an alcove's length over which it opens to its place. Default 1/3: the middle of where it makes no difference (the
    /// same page). Infinite, there are no alcoves.
    pub min_alcove_mouth: f64,
    /// The odds of a label that a cell had in an earlier result which is held on to are multiplied by this. Default 2.
    pub held_odds: f64,
    /// Obstacles that stand free and are at most this long and wide are furniture: no walls of a corridor. Default 2.5: a bed, a
    /// row of two desks.
    pub max_furniture_m: f64,
    /// Cells of the largest rectangle that is cut as a whole. Default 2²⁰, of which a cut takes 40 MB; larger ones are cut in tiles
    /// first, which takes three times as long. It changes no label.
    pub max_cut: usize,
    /// Side of the tiles of a larger one, in cells. Default 128: measured. It changes no label.
    pub tile_cells: u32,
}

impl Default for SpaceConfig {
    fn default() -> Self {
        Self {
            evidence_per_m: 3.0,
            least_probability: 0.1,
            min_agreement: 0.75,
            model: SpaceModel::builtin(),
            min_passage: 0.6,
            max_alcove_doors: 2,
            min_alcove_mouth: 1.0 / 3.0,
            held_odds: 2.0,
            max_furniture_m: 2.5,
            max_cut: 1 << 20,
            tile_cells: 128,
        }
    }
}

/// `labeling` with all cells that are no doorway labeled anew; doorways stay.
///
/// # Examples
/// ```
/// use placegraph::grid::{FreeSpace, OccupancyGrid};
/// use placegraph::labels::{Label, LabelField, LabelSet};
/// use placegraph::spaces::{SpaceConfig, label};
///
/// // A patch that looks like a corridor, in a room of 3 m by 1.5 m.
/// let space = FreeSpace::of(&OccupancyGrid::from_ascii(0.5, "......\n......\n......"));
/// let is_patch = |node: usize| node == 8 || node == 9;
/// let row = |node: usize| if is_patch(node) { [0.8, 0.2, 0.0] } else { [0.2, 0.8, 0.0] };
/// let field = LabelField::from_rows(3, (0..18).flat_map(row).collect());
/// let by_cell = field.most_likely();
/// let as_a_whole = label(&space, &field, &by_cell, &LabelSet::default(), &SpaceConfig::default(), None);
/// let draw = |labels: &[Label]| space.graph.to_ascii(|node| ['c', 'r', 'd'][labels[node].index()]);
/// assert_eq!(draw(&by_cell), "rrrrrr\nrrccrr\nrrrrrr\n");
/// assert_eq!(draw(&as_a_whole), "rrrrrr\nrrrrrr\nrrrrrr\n");
/// ```
///
/// `held` are the labels of an earlier result: a cell that had one counts as more like it ([`SpaceConfig::held_odds`]).
///
/// # Panics
/// If `field`, `labeling` or `held` do not belong to `space`, or a label is not of `label_set`.
pub fn label(
    space: &FreeSpace,
    field: &LabelField,
    labeling: &[Label],
    label_set: &LabelSet,
    config: &SpaceConfig,
    held: Held<'_>,
) -> Labeling {
    let graph = &space.graph;
    assert!(field.n_nodes() == graph.n_nodes() && labeling.len() == graph.n_nodes(), "one label per node");
    let is_doorway = |label: &Label| label_set.role(*label) == Role::Doorway;
    let mut candidates: Vec<Label> = label_set.labels().filter(|label| !is_doorway(label)).collect();
    // Borders of equal cost lie as the order of the labels has it: not as the classes are numbered.
    candidates.sort_by_key(|&label| &label_set.class(label).name);
    if candidates.len() < 2 {
        return labeling.to_vec();
    }
    let evidence =
        Evidence { candidates: &candidates, config, scale: config.evidence_per_m * space.resolution_m() };
    let edge = vec![1.0; candidates.len()];
    let row = |node: usize, out: &mut Vec<f64>| {
        evidence.append(field.row(node), held.and_then(|held| held[node]), out);
    };
    let mut found: Vec<Option<Label>> = vec![None; graph.n_nodes()];
    let is_too_large =
        |space: &Vec<Run>| candidates.len() == 2 && Rectangle::around(space).n_cells() > config.max_cut;
    let spaces = pieces(graph, |node| !is_doorway(&labeling[node]));
    let (too_large, mut spaces): (Vec<_>, Vec<_>) = spaces.into_iter().partition(is_too_large);
    if !too_large.is_empty() {
        let mut is_open = vec![false; graph.n_nodes()];
        too_large.iter().flatten().for_each(|run| is_open[run.nodes()].fill(true));
        found = certain(graph, config.tile_cells, &is_open, &edge, row);
        spaces.extend(pieces(graph, |node| is_open[node] && found[node].is_none()));
    }
    let start = |node: usize| Label(candidates.iter().position(|&c| c == labeling[node]).unwrap_or(0) as u8);
    let label_piece = |runs: &Vec<Run>| {
        let is_member = |node: usize| {
            let after = runs.partition_point(|run| run.nodes().start <= node);
            after > 0 && runs[after - 1].nodes().contains(&node)
        };
        let piece = Piece::new(graph, Rectangle::around(runs), is_member);
        let labels = if candidates.len() == 2 {
            let [labels] = piece.best_within(&edge, row, [&|node: usize| found[node]]);
            labels
        } else {
            piece.best(&edge, start, row)
        };
        (piece.nodes, labels)
    };
    let n_cells = graph.width() as usize * graph.height() as usize;
    // Large ones one by one, the others in parallel: their rectangles together are never larger than the map.
    let is_large =
        |runs: &Vec<Run>| Rectangle::around(runs).n_cells() > n_cells / rayon::current_num_threads();
    let (large, small): (Vec<_>, Vec<_>) = spaces.into_iter().partition(is_large);
    let mut labeled: Vec<(Vec<u32>, Labeling)> = large.iter().map(label_piece).collect();
    labeled.par_extend(small.par_iter().map(label_piece));
    for (nodes, labels) in labeled {
        for (node, label) in nodes.into_iter().zip(labels) {
            found[node as usize] = Some(label);
        }
    }
    let labels = labeling.iter().zip(found);
    labels.map(|(&label, found)| found.map_or(label, |found| candidates[found.index()])).collect()
}

/// The pieces between the doorways of `labeling` and `cuts`: nodes on the lines of gates, which no step of four crosses.
pub fn pieces_between(
    space: &FreeSpace,
    labeling: &[Label],
    cuts: &[Vec<usize>],
    label_set: &LabelSet,
) -> Pieces {
    Pieces::of(&space.graph, labeling, |label| label_set.role(label) != Role::Doorway, cuts)
}

/// The free cells, and those of furniture: it is no wall.
fn without_furniture(space: &FreeSpace, config: &SpaceConfig) -> CellGraph {
    Obstacles::of(&space.graph).cleared(space.in_cells(config.max_furniture_m).round() as u32)
}

/// `labeling` where every one of `pieces` that is `given` a label has it throughout, any other one of which most cells agree has their
/// label, and every patch inside of a place has the label of that place; doorways stay.
///
/// What a gate parts is a place of its own, or a part of one. Pieces of which fewer cells agree keep the borders that they have. Cost:
/// linear in the nodes.
pub fn label_whole(
    space: &FreeSpace,
    labeling: Labeling,
    pieces: &Pieces,
    given: &[Option<Label>],
    label_set: &LabelSet,
    config: &SpaceConfig,
) -> Labeling {
    let is_open = |label: Label| label_set.role(label) != Role::Doorway;
    let bare = without_furniture(space, config);
    whole::label_whole(&space.graph, &bare, labeling, is_open, pieces, given, config.min_agreement)
}

/// The labels of nodes that the best labeling has whatever lies around their tile, of two labels.
///
/// More neighbors with a label never take it from a node: where one is best although all around the tile have the other, it is
/// best. What a tile leaves open is near its border, or doubtful.
fn certain(
    graph: &CellGraph,
    side: u32,
    is_open: &[bool],
    edge: &[f64],
    row: impl Fn(usize, &mut Vec<f64>) + Sync,
) -> Vec<Option<Label>> {
    let all = |label: Label| move |node: usize| is_open[node].then_some(label);
    let tiles = Rectangle::tiles(graph, side);
    let of_tile = |tile: &Rectangle| {
        let piece = Piece::new(graph, tile.clone(), |node| is_open[node]);
        let given: [&dyn Fn(usize) -> Option<Label>; 2] = [&all(Label(0)), &all(Label(1))];
        let [among_first, among_second] = piece.best_within(edge, &row, given);
        let same =
            among_first.into_iter().zip(among_second).map(|(one, other)| (one == other).then_some(one));
        same.collect::<Vec<_>>()
    };
    let of_tiles: Vec<_> = tiles.par_iter().map(of_tile).collect();
    let mut found = vec![None; graph.n_nodes()];
    for (tile, labels) in tiles.iter().zip(of_tiles) {
        let nodes = tile.nodes(graph).filter(|&(node, _)| is_open[node]);
        for ((node, _), label) in nodes.zip(labels) {
            found[node] = label;
        }
    }
    found
}

/// Pieces are cut together, in the rectangle of the map, where their own rectangles overlap more than so many times.
const MAX_OVERLAP: usize = 8;

/// The runs of every maximal set of 8-connected nodes that are open, or of all such nodes together.
fn pieces(graph: &CellGraph, is_open: impl Fn(usize) -> bool) -> Vec<Vec<Run>> {
    let runs = Runs::new(graph, |node| u32::from(is_open(node)));
    let (component_of, n_components) = components(&runs, DiagonalSteps::Any);
    let mut pieces = vec![Vec::new(); n_components];
    for (&run, &component) in runs.all().iter().zip(&component_of).filter(|(run, _)| run.value == 1) {
        pieces[component as usize].push(run);
    }
    pieces.retain(|piece| !piece.is_empty());
    let n_cells = graph.width() as usize * graph.height() as usize;
    if pieces.iter().map(|piece| Rectangle::around(piece).n_cells()).sum::<usize>() > MAX_OVERLAP * n_cells {
        return vec![runs.all().iter().copied().filter(|run| run.value == 1).collect()];
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cuts::{Potentials, expand};
    use crate::geom::Pose2;
    use crate::grid::{Cell, Connectivity, Grid, MapFrame, Occupancy};

    const CORRIDOR: Label = Label(0);
    const ROOM: Label = Label(1);
    const DOORWAY: Label = Label(2);

    /// A free rectangle of `width` by `height` cells of 0.1 m.
    fn free(width: u32, height: u32) -> CellGraph {
        CellGraph::new(&Grid::filled(width, height, Occupancy::Free))
    }

    fn space(graph: &CellGraph) -> FreeSpace {
        FreeSpace { frame: MapFrame::new(0.1, Pose2::default()).unwrap(), graph: graph.clone() }
    }

    /// Labels by `label`, each nine times as probable as the other place.
    fn labeled(graph: &CellGraph, by: impl Fn(Cell) -> Label) -> Labeling {
        let labeling: Labeling = graph.cells().iter().map(|&cell| by(cell)).collect();
        let row = |label: &Label| match *label {
            CORRIDOR => [0.9, 0.1, 0.0],
            ROOM => [0.1, 0.9, 0.0],
            _ => [0.0, 0.0, 1.0],
        };
        let field = LabelField::from_rows(3, labeling.iter().flat_map(row).collect());
        label(&space(graph), &field, &labeling, &LabelSet::default(), &SpaceConfig::default(), None)
    }

    #[test]
    fn a_patch_inside_a_space_joins_it() {
        // 10 x 10 cells: evidence 100 · 3 · 0.1 · ln 9 = 66 against a border of 3 edges for each of 40 sides.
        let graph = free(40, 40);
        let is_patch = |cell: Cell| (15..25).contains(&cell.x) && (15..25).contains(&cell.y);
        let labels = labeled(&graph, |cell| if is_patch(cell) { CORRIDOR } else { ROOM });
        assert!(labels.iter().all(|&label| label == ROOM));
    }

    #[test]
    fn a_space_with_a_short_border_stays() {
        // 20 x 20 cells, open over one side of 20: evidence 264 against a border of 58 edges.
        let graph = free(60, 20);
        let labels = labeled(&graph, |cell| if cell.x < 20 { CORRIDOR } else { ROOM });
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
        assert_eq!(labeled(&graph, label), expected);
    }

    /// Numbers from 0 to 1 that look random.
    fn noise(n: usize) -> impl Iterator<Item = f32> {
        let mut state = 1u32;
        std::iter::repeat_with(move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / 16_777_216.0
        })
        .take(n)
    }

    #[test]
    fn spaces_cut_on_their_own_are_those_of_one_cut() {
        // Doorways on bent lines, so that spaces of all sizes lie in each other's rectangles.
        let graph = free(150, 110);
        let is_doorway = |cell: Cell| {
            (cell.x + cell.y * cell.y / 40).is_multiple_of(37) || (cell.y + cell.x / 9).is_multiple_of(29)
        };
        let labeling: Labeling =
            graph.cells().iter().map(|&cell| if is_doorway(cell) { DOORWAY } else { ROOM }).collect();
        let patches: Vec<f32> = noise(400).collect();
        let corridor = |cell: Cell| patches[(cell.x / 9 + cell.y / 7 * 20) as usize];
        let row = |(cell, own): (&Cell, f32)| {
            let p = 0.7 * corridor(*cell) + 0.3 * own;
            [p, 1.0 - p, 0.0]
        };
        let values = graph.cells().iter().zip(noise(graph.n_nodes())).flat_map(row).collect();
        let field = LabelField::from_rows(3, values);
        let config = SpaceConfig { evidence_per_m: 9.0, ..SpaceConfig::default() };
        let label_set = LabelSet::default();
        let found = label(&space(&graph), &field, &labeling, &label_set, &config, None);
        for max_cut in [0, 400] {
            let config = SpaceConfig { max_cut, ..config.clone() };
            let in_cuts = label(&space(&graph), &field, &labeling, &label_set, &config, None);
            assert_eq!(in_cuts, found, "what is larger than {max_cut} cells in tiles");
        }

        let mut cells = Grid::filled(150, 110, Occupancy::Free);
        for &cell in graph.cells().iter().filter(|cell| is_doorway(**cell)) {
            cells[cell] = Occupancy::Occupied;
        }
        let whole = CellGraph::new(&cells);
        let evidence = Evidence { candidates: &[CORRIDOR, ROOM], config: &config, scale: 0.9 };
        let mut node = Vec::new();
        for &cell in whole.cells() {
            evidence.append(field.row(graph.node_at(cell).unwrap()), None, &mut node);
        }
        let potentials = Potentials { node, edge: vec![1.0; 2], connectivity: Connectivity::Eight };
        let expected = expand(&whole, &potentials, &vec![ROOM; whole.n_nodes()]);
        assert!(expected.contains(&CORRIDOR) && expected.contains(&ROOM));
        for (&cell, &label) in whole.cells().iter().zip(&expected) {
            assert_eq!(found[graph.node_at(cell).unwrap()], label, "{cell:?}");
        }
        // Of what a tile is certain, the best labeling has; small tiles are certain of little, large ones of most.
        let row = |node: usize, out: &mut Vec<f64>| out.extend_from_slice(potentials.row(node));
        let mut n_certain = Vec::new();
        for side in [5, 16, 64, 200] {
            let certain = certain(&whole, side, &vec![true; whole.n_nodes()], &[1.0; 2], row);
            assert!(
                certain.iter().zip(&expected).all(|(found, label)| found.is_none_or(|found| found == *label))
            );
            n_certain.push(certain.iter().flatten().count());
        }
        assert!(n_certain.is_sorted() && n_certain[0] < n_certain[3], "{n_certain:?}");
        assert_eq!(n_certain[3], whole.n_nodes(), "the map is one tile");
    }
}
