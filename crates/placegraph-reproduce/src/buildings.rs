//! The maps that the chapter names, and which part of them is learned from.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use placegraph::grid::{Cell, Grid};
use placegraph::import::{self, LabelCell, LabelCoding, ReadOptions};
use placegraph::labels::{Label, LabelSet};
use placegraph::training::{LabeledMap, Window};

/// Where a building's map is found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source {
    /// Folder with `map.yaml` and `labels.png`.
    pub(super) folder: &'static str,
    /// What the page calls it.
    pub(super) title: &'static str,
    /// Columns left of this one are for training, the others for the test.
    pub(super) split: u32,
    /// Folder with `labels_hand.png`: labels of the same map that were drawn apart. May be missing.
    pub(super) second_drawing: &'static str,
}

/// The sources of the chapter's three buildings. Splits are where no doorway is cut.
pub(super) const CHAPTER: [Source; 3] = [
    Source {
        folder: "fr79_slam",
        title: "building 79",
        split: 350,
        second_drawing: "ag_freiburg_building79",
    },
    Source {
        folder: "fr52_slam",
        title: "building 52",
        split: 270,
        second_drawing: "ag_freiburg_building52",
    },
    // The chapter only tests on this one; its split serves no experiment.
    Source { folder: "sdr_b_slam", title: "SDR site B", split: 0, second_drawing: "ag_lab_a" },
];

/// A map with labels, and a second drawing of the labels where there is one.
#[derive(Debug)]
pub(super) struct Building {
    pub(super) title: &'static str,
    /// The whole map, labels of free cells only.
    pub(super) map: LabeledMap,
    pub(super) split: u32,
    pub(super) second_drawing: Option<Grid<Option<Label>>>,
}

impl Building {
    /// Reads the building from its folder in `data`.
    pub(super) fn load(data: &Path, source: &Source) -> Result<Self> {
        let folder = data.join(source.folder);
        for name in ["map.yaml", "labels.png"] {
            let path = folder.join(name);
            ensure!(path.is_file(), "expected the file {}, found none: {}", path.display(), source.title);
        }
        let mut map = labeled_map(&folder, "labels.png", source.title)?;
        ensure!(
            source.split < map.grid.cells.width(),
            "expected more than {} columns in {}, found {}",
            source.split,
            folder.display(),
            map.grid.cells.width()
        );
        map.labels = on_free_cells(&map, &map.labels);
        let second = data.join(source.second_drawing);
        let second_drawing = second
            .join("labels_hand.png")
            .is_file()
            .then(|| labeled_map(&second, "labels_hand.png", source.title));
        let second_drawing = second_drawing.transpose().context("in the second drawing")?;
        let same_size = |other: &LabeledMap| {
            (other.labels.width(), other.labels.height()) == (map.labels.width(), map.labels.height())
        };
        let second_drawing = second_drawing.filter(same_size).map(|other| on_free_cells(&map, &other.labels));
        Ok(Self { title: source.title, map, split: source.split, second_drawing })
    }

    /// The map to learn from: columns left of the split.
    pub(super) fn left(&self) -> LabeledMap {
        let end = Cell::new(self.split, self.map.grid.cells.height());
        LabeledMap { window: Some(Window { min: Cell::new(0, 0), end }), ..self.map.clone() }
    }

    /// The true labels from column `first` on.
    pub(super) fn truth_from(&self, first: u32) -> Grid<Option<Label>> {
        from_column(first, &self.map.labels)
    }
}

/// The map in `folder`, with the labels in the image of this name.
fn labeled_map(folder: &Path, labels: &str, name: &str) -> Result<LabeledMap> {
    let options = ReadOptions::default();
    let grid = import::load_map(&folder.join("map.yaml"), &options)?.grid;
    let path = folder.join(labels);
    let in_labels = || format!("in the labels {}", path.display());
    let bytes = import::read_cells(&path, options.max_cells).with_context(in_labels)?;
    let size = (grid.cells.width(), grid.cells.height());
    let coding = LabelCoding::of(&LabelSet::default());
    let labels = import::read_labels(&bytes, size, &coding).with_context(in_labels)?;
    let labels = labels.map(|cell| match cell {
        LabelCell::Class(label) => Some(*label),
        LabelCell::None | LabelCell::Ignore => None,
    });
    Ok(LabeledMap { name: name.to_owned(), grid, labels, window: None, building: None })
}

/// `labels` from column `first` on.
pub(super) fn from_column(first: u32, labels: &Grid<Option<Label>>) -> Grid<Option<Label>> {
    masked(labels, |cell| cell.x >= first)
}

fn on_free_cells(map: &LabeledMap, labels: &Grid<Option<Label>>) -> Grid<Option<Label>> {
    masked(labels, |cell| map.grid.is_free(cell))
}

fn masked(labels: &Grid<Option<Label>>, keep: impl Fn(Cell) -> bool) -> Grid<Option<Label>> {
    let cells = labels.cells().zip(labels.values());
    let values = cells.map(|(cell, &label)| label.filter(|_| keep(cell))).collect();
    Grid::from_rows(labels.width(), labels.height(), values)
}
