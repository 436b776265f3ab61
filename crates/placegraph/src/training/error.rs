//! Why no model can be trained.

use crate::boost::AdaBoostError;

/// Why no model can be trained.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TrainError {
    /// A setting outside its range.
    #[error("expected {expected} as {field}")]
    Setting {
        /// The setting.
        field: &'static str,
        /// Its range.
        expected: &'static str,
    },
    /// Labels of another size than the map.
    #[error(
        "expected labels of {} x {} cells, found {} x {}, map {map:?}",
        expected.0, expected.1, found.0, found.1
    )]
    Size {
        /// Columns and rows of the map.
        expected: (u32, u32),
        /// Columns and rows of the labels.
        found: (u32, u32),
        /// The map's name.
        map: String,
    },
    /// A label that the label set lacks.
    #[error("expected labels from 1 to {n_labels}, found {found}, map {map:?}")]
    Label {
        /// Number of classes.
        n_labels: usize,
        /// The label found, counted from 1.
        found: u8,
        /// The map's name.
        map: String,
    },
    /// A map whose cells are of another size than the first map's, where that matters.
    #[error("map {map:?} has another resolution than the first map: a network needs maps of one resolution")]
    Resolution {
        /// The map's name.
        map: String,
    },
    /// A window without cells of the map.
    #[error("expected a window inside of {} x {} cells, map {map:?}", size.0, size.1)]
    Window {
        /// Columns and rows of the map.
        size: (u32, u32),
        /// The map's name.
        map: String,
    },
    /// A model to start from with other classes.
    #[error(
        "expected the classes of the model to start from, {}, found {}",
        expected.join(", "), found.join(", ")
    )]
    BaseClasses {
        /// Its classes.
        expected: Vec<String>,
        /// The classes of the labels.
        found: Vec<String>,
    },
    /// A model to start from that has no stumps.
    #[error("expected a boosted model to start from, found one of the method {found}")]
    BaseMethod {
        /// Its method.
        found: &'static str,
    },
    /// No free cell has a label.
    #[error("expected labeled free cells, found none")]
    NoLabels,
    /// The list cannot be trained on the examples.
    #[error(transparent)]
    Boost(#[from] AdaBoostError),
    /// A class without cells.
    #[error("expected labeled free cells of every class, found none of {class:?}")]
    ClassAbsent {
        /// The class.
        class: String,
    },
    /// More examples than training can number.
    #[error("expected at most {limit} examples, found {found}: train on fewer cells per class")]
    TooManyExamples {
        /// Largest number.
        limit: usize,
        /// Number of examples.
        found: usize,
    },
}
