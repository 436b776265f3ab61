//! Predicted against true labels, cell by cell: confusion, accuracy, per-class rates (Sect. 4.8).
//!
//! The success rate of the chapter is [`CellScores::accuracy`]: correct cells over labeled cells. Borders in
//! hand-drawn truth are uncertain by a cell, so the accuracy with that tolerance is reported too.

use std::fmt;

use serde::Serialize;

use crate::grid::{Connectivity, Grid};
use crate::labels::{ConfusionMatrix, Label, LabelSet};

/// Counts of true and predicted classes, for one or more maps.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Confusion {
    /// Cells by true class (row) and predicted class (column).
    #[serde(flatten)]
    pub matrix: ConfusionMatrix,
    /// Wrong cells whose predicted label occurs in the truth within their 8-neighborhood.
    pub n_near: u64,
}

/// Rates of one class; `None` where a rate would be 0/0.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClassScores {
    /// Name of the class.
    pub name: String,
    /// Cells that truly have the class.
    pub n_cells: u64,
    /// Cells of the class among those labeled so.
    pub precision: Option<f64>,
    /// Cells labeled so among those of the class.
    pub recall: Option<f64>,
    /// Harmonic mean of precision and recall, 2 tp / (2 tp + fp + fn).
    pub f1: Option<f64>,
    /// Intersection over union, tp / (tp + fp + fn).
    pub iou: Option<f64>,
}

/// All measures over cells; `None` if nothing was counted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CellScores {
    /// Number of cells with a true label; only they count.
    pub n_cells: u64,
    /// Correct cells among them.
    pub accuracy: Option<f64>,
    /// Accuracy if a label that the truth has within one cell (8-neighborhood) counts as correct.
    pub accuracy_within_one_cell: Option<f64>,
    /// Mean F1 of the classes that occur in truth or prediction; absent classes are omitted.
    pub macro_f1: Option<f64>,
    /// The rates of every class.
    pub classes: Vec<ClassScores>,
    /// The counts behind them.
    pub confusion: Confusion,
}

impl Confusion {
    /// Empty counts.
    pub fn none(label_set: &LabelSet) -> Self {
        Self { matrix: ConfusionMatrix::new(label_set.len()), n_near: 0 }
    }

    /// Counts the cells of one map that have a true label.
    ///
    /// # Panics
    /// If the grids differ in size, or a label is not of `label_set`.
    pub fn count(predicted: &Grid<Option<Label>>, truth: &Grid<Option<Label>>, label_set: &LabelSet) -> Self {
        assert_eq!(
            (predicted.width(), predicted.height()),
            (truth.width(), truth.height()),
            "prediction and truth are of one map"
        );
        let mut confusion = Self::none(label_set);
        for (index, (&predicted, &true_label)) in predicted.values().iter().zip(truth.values()).enumerate() {
            let Some(true_label) = true_label else { continue };
            confusion.matrix.count(true_label, predicted);
            let is_near = || {
                let cell = truth.cell(index);
                let around = Connectivity::Eight.steps().iter().filter_map(|&step| truth.offset(cell, step));
                around.into_iter().any(|near| truth[near] == predicted)
            };
            if predicted.is_some() && predicted != Some(true_label) && is_near() {
                confusion.n_near += 1;
            }
        }
        confusion
    }

    /// Adds the counts of another map with the same classes.
    ///
    /// # Panics
    /// If the number of classes differs.
    pub fn add(&mut self, other: &Self) {
        self.matrix.add(&other.matrix);
        self.n_near += other.n_near;
    }

    /// The measures that follow from the counts.
    pub fn scores(&self, label_set: &LabelSet) -> CellScores {
        let matrix = &self.matrix;
        let class_scores = |label: Label| ClassScores {
            name: label_set.class(label).name.clone(),
            n_cells: matrix.n_true(label),
            precision: matrix.precision(label),
            recall: matrix.recall(label),
            f1: matrix.f1(label),
            iou: matrix.iou(label),
        };
        let (n_cells, n_correct) = (matrix.total(), matrix.n_correct());
        CellScores {
            n_cells,
            accuracy: matrix.accuracy(),
            accuracy_within_one_cell: (n_cells > 0)
                .then(|| (n_correct + self.n_near) as f64 / n_cells as f64),
            macro_f1: matrix.macro_f1(),
            classes: label_set.labels().map(class_scores).collect(),
            confusion: self.clone(),
        }
    }
}

/// A share as a percentage, or a dash.
pub(super) struct Percent(pub(super) Option<f64>);

impl fmt::Display for Percent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Some(share) => f.pad(&format!("{:.2} %", 100.0 * share)),
            None => f.pad("–"),
        }
    }
}

impl fmt::Display for CellScores {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let longest = self.classes.iter().map(|class| class.name.chars().count()).max().unwrap_or(0);
        let width = longest.max("true class".len());
        writeln!(f, "labeled cells        {:>11}", self.n_cells)?;
        writeln!(f, "accuracy             {:>11}", Percent(self.accuracy))?;
        writeln!(f, "  within one cell    {:>11}", Percent(self.accuracy_within_one_cell))?;
        writeln!(f, "macro F1             {:>11}", Percent(self.macro_f1))?;
        writeln!(f)?;
        let header = ["cells", "precision", "recall", "F1", "IoU"].map(|name| format!("{name:>11}")).concat();
        writeln!(f, "{:width$}{header}", "class")?;
        for class in &self.classes {
            let ClassScores { name, n_cells, precision, recall, f1, iou } = class;
            let rates = [precision, recall, f1, iou].map(|&rate| format!("{:>11}", Percent(rate))).concat();
            writeln!(f, "{name:width$}{n_cells:>11}{rates}")?;
        }
        writeln!(f)?;
        let names = self.classes.iter().map(|class| class.name.as_str()).chain(["none"]);
        let header = names.map(|name| format!(" {name:>10}")).collect::<Vec<_>>().concat();
        writeln!(f, "{:width$}{header}", "true class")?;
        for (class, row) in self.classes.iter().zip(&self.confusion.matrix.counts) {
            let counts = row.iter().map(|count| format!(" {count:>10}")).collect::<Vec<_>>().concat();
            writeln!(f, "{:width$}{counts}", class.name)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eval::drawn::grid;

    fn share(found: Option<f64>, part: f64, whole: f64) -> bool {
        found.is_some_and(|found| (found - part / whole).abs() < 1e-12)
    }

    #[test]
    fn counted_by_hand() {
        let truth = grid("cccrr cccrr .....");
        let predicted = grid("ccrrr cc.rd ccccc");
        let confusion = Confusion::count(&predicted, &truth, &LabelSet::default());
        assert_eq!(confusion.matrix.counts, [[4, 1, 0, 1], [0, 3, 1, 0], [0, 0, 0, 0]]);
        // The r in the third column is next to true r; the d is nowhere near a d.
        assert_eq!(confusion.n_near, 1);

        let scores = confusion.scores(&LabelSet::default());
        assert_eq!(scores.n_cells, 10);
        assert!(share(scores.accuracy, 7.0, 10.0));
        assert!(share(scores.accuracy_within_one_cell, 8.0, 10.0));
        let [corridor, room, doorway] = &scores.classes[..] else { panic!("three classes") };
        assert!(share(corridor.precision, 4.0, 4.0) && share(corridor.recall, 4.0, 6.0));
        assert!(share(corridor.f1, 8.0, 10.0) && share(corridor.iou, 4.0, 6.0));
        assert!(share(room.precision, 3.0, 4.0) && share(room.recall, 3.0, 4.0));
        assert!(share(room.f1, 6.0, 8.0) && share(room.iou, 3.0, 5.0));
        // A doorway was predicted and none is there.
        assert!(share(doorway.precision, 0.0, 1.0) && doorway.recall.is_none());
        assert!(share(scores.macro_f1, 0.8 + 0.75, 3.0));
    }

    #[test]
    fn absent_classes_are_left_out_of_the_mean() {
        let scores =
            Confusion::count(&grid("cr"), &grid("cr"), &LabelSet::default()).scores(&LabelSet::default());
        assert_eq!(scores.classes[2].f1, None);
        assert!(share(scores.macro_f1, 1.0, 1.0));
    }

    #[test]
    fn nothing_labeled_has_no_accuracy() {
        let scores =
            Confusion::count(&grid("cr"), &grid(".."), &LabelSet::default()).scores(&LabelSet::default());
        assert_eq!((scores.accuracy, scores.macro_f1), (None, None));
        assert!(scores.to_string().contains("–"));
    }

    #[test]
    fn two_maps_add_up() {
        let set = LabelSet::default();
        let mut both = Confusion::count(&grid("cr"), &grid("cc"), &set);
        both.add(&Confusion::count(&grid("rr"), &grid("rc"), &set));
        assert_eq!(both.matrix.counts[0][..2], [1, 2]);
        assert_eq!(both.n_near, 1);
    }
}
