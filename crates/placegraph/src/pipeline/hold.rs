//! The labels of an earlier result, cell by cell.

use super::Config;
use crate::grid::{FreeSpace, GridShape};
use crate::labels::{Label, LabelSet};
use crate::topology::PlaceRaster;

/// The label that every node of `space` had in the earlier result, if it is held on to. One in another frame is not: its cells are
/// found only after places are.
pub(super) fn labels(space: &FreeSpace, label_set: &LabelSet, config: &Config) -> Option<Vec<Option<Label>>> {
    let previous = config.previous.as_ref().filter(|_| config.hold && !config.align_previous)?;
    let graph = &space.graph;
    let shape = GridShape { frame: space.frame, width: graph.width(), height: graph.height() };
    let label = |class: &str| label_set.labels().find(|&label| label_set.class(label).name == class);
    let raster = PlaceRaster::new(previous, shape);
    let mut held = vec![None; graph.n_nodes()];
    for y in 0..graph.height() {
        let nodes = graph.nodes_in_rows(y..y + 1);
        let mut cells = graph.cells_in_rows(y..y + 1).zip(nodes).peekable();
        for span in raster.row(y) {
            let label = previous.place(span.place).and_then(|place| label(&place.class));
            while cells.next_if(|(cell, _)| cell.x < span.start).is_some() {}
            while let Some((_, node)) = cells.next_if(|(cell, _)| cell.x < span.end) {
                held[node] = label;
            }
        }
    }
    Some(held)
}
