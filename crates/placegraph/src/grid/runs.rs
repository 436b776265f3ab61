//! The map as runs: maximal stretches of neighboring cells of a row with one value.
//!
//! Regions, contacts and outlines only change where runs end, so they are computed from runs: a few hundred
//! thousand where a map has millions of cells. Cost: one pass over the nodes.

use super::disjoint_sets::DisjointSets;
use super::{CellGraph, DiagonalSteps};

/// A maximal stretch of free cells of one row with one value.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run {
    /// Node of its leftmost cell; the others follow.
    pub(crate) first_node: u32,
    /// Row.
    pub(crate) y: u32,
    /// Column of its leftmost cell.
    pub(crate) start: u32,
    /// Column after its rightmost cell.
    pub(crate) end: u32,
    /// What its cells have in common: a label or a region.
    pub(crate) value: u32,
}

impl Run {
    /// Its nodes.
    pub(crate) fn nodes(&self) -> std::ops::Range<usize> {
        self.first_node as usize..(self.first_node + self.end - self.start) as usize
    }
}

/// The runs of a map, in row-major order.
#[derive(Debug)]
pub(crate) struct Runs {
    runs: Vec<Run>,
    /// Where the runs of a row begin; one more entry than rows.
    row_starts: Vec<usize>,
}

/// Where two runs touch: a straight stretch of cell sides between two grid corners, or a single corner.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touch {
    /// The two runs, by position.
    pub(crate) runs: [usize; 2],
    /// The lower left end of the common border, in cells from the lower left corner of the grid.
    pub(crate) from: (u32, u32),
    /// The upper right end; equal to `from` where the runs touch at a corner only.
    pub(crate) to: (u32, u32),
}

impl Touch {
    /// Number of cell sides of the common border.
    pub(crate) fn n_sides(&self) -> u32 {
        self.to.0 - self.from.0 + self.to.1 - self.from.1
    }
}

impl Runs {
    /// The runs of equal `value` of the nodes of `graph`.
    pub(crate) fn new(graph: &CellGraph, value: impl Fn(usize) -> u32) -> Self {
        let mut runs: Vec<Run> = Vec::new();
        let mut row_starts = Vec::with_capacity(graph.height() as usize + 1);
        let mut node = 0;
        for y in 0..graph.height() {
            let row_start = runs.len();
            row_starts.push(row_start);
            for x in graph.columns(y, 0..graph.width()) {
                let value = value(node as usize);
                match runs[row_start..].last_mut() {
                    Some(run) if run.end == x && run.value == value => run.end += 1,
                    _ => runs.push(Run { first_node: node, y, start: x, end: x + 1, value }),
                }
                node += 1;
            }
        }
        row_starts.push(runs.len());
        Self { runs, row_starts }
    }

    /// All runs, in row-major order.
    pub(crate) fn all(&self) -> &[Run] {
        &self.runs
    }

    /// Shows `visit` every pair of runs of which cells are neighbors, in a fixed order.
    pub(crate) fn for_each_touch(&self, diagonal: DiagonalSteps, mut visit: impl FnMut(Touch)) {
        for y in 0..self.row_starts.len() - 1 {
            let row = self.row_starts[y]..self.row_starts[y + 1];
            for i in row.start + 1..row.end {
                if self.runs[i - 1].end == self.runs[i].start {
                    let x = self.runs[i].start;
                    visit(Touch { runs: [i - 1, i], from: (x, y as u32), to: (x, y as u32 + 1) });
                }
            }
            if y > 0 {
                self.for_each_touch_below(self.row_starts[y - 1]..row.start, row, diagonal, &mut visit);
            }
        }
    }

    /// The pairs with one run in `row` and one in the row `below` it.
    fn for_each_touch_below(
        &self,
        below: std::ops::Range<usize>,
        row: std::ops::Range<usize>,
        diagonal: DiagonalSteps,
        visit: &mut impl FnMut(Touch),
    ) {
        let mut first = below.start;
        for i in row {
            let upper = &self.runs[i];
            while first < below.end && self.runs[first].end < upper.start {
                first += 1;
            }
            for j in (first..below.end).take_while(|&j| self.runs[j].start <= upper.end) {
                let lower = &self.runs[j];
                let (from, to) = (upper.start.max(lower.start), upper.end.min(lower.end));
                let touches = from < to
                    || match diagonal {
                        DiagonalSteps::Never => false,
                        DiagonalSteps::Any => true,
                        DiagonalSteps::ThroughFree => self.corner_has_third_free_cell(j, i),
                    };
                if touches {
                    visit(Touch { runs: [j, i], from: (from, upper.y), to: (to, upper.y) });
                }
            }
        }
    }

    /// Whether one of the two other cells around the corner at which the runs `lower` and `upper` touch is
    /// free: then a run ends or begins there next to one of them.
    fn corner_has_third_free_cell(&self, lower: usize, upper: usize) -> bool {
        let meets = |left: usize, right: usize| {
            self.runs.get(right).is_some_and(|right| {
                let left = &self.runs[left];
                left.y == right.y && left.end == right.start
            })
        };
        if self.runs[lower].end == self.runs[upper].start {
            upper > 0 && meets(upper - 1, upper) || meets(lower, lower + 1)
        } else {
            meets(upper, upper + 1) || lower > 0 && meets(lower - 1, lower)
        }
    }
}

/// The component of every run and the number of components, numbered by their first run.
pub(crate) fn components(runs: &Runs, diagonal: DiagonalSteps) -> (Vec<u32>, usize) {
    let all = runs.all();
    let mut sets = DisjointSets::new(all.len());
    runs.for_each_touch(diagonal, |touch| {
        let [a, b] = touch.runs;
        if all[a].value == all[b].value {
            sets.unite(a, b);
        }
    });
    let mut component_of = Vec::with_capacity(all.len());
    let mut n_components = 0;
    for run in 0..all.len() {
        // The representative is the first run of its set, so it was numbered before.
        let representative = sets.find(run);
        component_of.push(if representative == run {
            n_components += 1;
            n_components - 1
        } else {
            component_of[representative]
        });
    }
    (component_of, n_components as usize)
}
