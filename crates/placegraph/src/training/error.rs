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
    #[error("expected maps of one resolution for a network, found another, map {map:?}")]
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
    /// No free cell has a label.
    #[error("expected labeled free cells, found none")]
    NoLabels,
    /// The list cannot be learned from the examples taken.
    #[error(transparent)]
    Boost(#[from] AdaBoostError),
    /// A class of which there are no cells.
    #[error("expected labeled free cells of every class, found none of {class:?}")]
    ClassAbsent {
        /// The class.
        class: String,
    },
    /// More examples than training can number.
    #[error("expected at most {limit} examples, found {found}; fewer cells per class help")]
    TooManyExamples {
        /// Largest number.
        limit: usize,
        /// Number of examples.
        found: usize,
    },
}
