//! Why a map cannot be written in a format.

/// Why a map cannot be written in a format.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// A format in whole centimeters.
    #[error("the format needs cells of whole centimeters, found {resolution_m} m")]
    Centimeters {
        /// Side of a cell.
        resolution_m: f64,
    },
    /// The consumer refuses a graph without edges.
    #[error("expected at least one connection with a route, found none: a route graph needs an edge")]
    NoRoute,
    /// Costmap masks are read without their rotation.
    #[error("the map is rotated by {yaw_rad} rad, which costmaps ignore in masks: resample the mask")]
    Rotated {
        /// The rotation found.
        yaw_rad: f64,
    },
    /// A value of a mask does not fit into a cell.
    #[error("expected a value from {min} to {max} for {subject:?}, found {found}")]
    Value {
        /// The class or place that it was given for.
        subject: String,
        /// Smallest value.
        min: f64,
        /// Largest value.
        max: f64,
        /// The value found.
        found: f64,
    },
    /// A mask file names a class that does not exist.
    #[error("the mask file names the class {found:?}; the classes are {}", known.join(", "))]
    UnknownClass {
        /// The name found.
        found: String,
        /// The classes that there are.
        known: Vec<String>,
    },
    /// A mask file gives a value to a place that the map does not have.
    #[error("the mask file gives a value to {found:?}, but the map has no place of this name")]
    UnknownPlace {
        /// The name found.
        found: String,
    },
    /// The main file of a format of several files has another ending.
    #[error("expected a name that ends in .yaml for a mask's map file, found {found:?}")]
    MainName {
        /// The name found.
        found: String,
    },
    /// A mask holds at most 100 states.
    #[error("expected at most 100 zones, found {found}: make one zone per class instead")]
    TooManyZones {
        /// How many there are.
        found: usize,
    },
    /// The upright grid of a rotated map is too large.
    #[error("expected a mask of at most {max_cells} cells, found {width} x {height}: the map is rotated")]
    TooManyCells {
        /// Columns of the mask.
        width: u32,
        /// Rows of the mask.
        height: u32,
        /// The limit.
        max_cells: u64,
    },
    /// The writer of the format refused; cannot happen for maps that this library built.
    #[error("cannot write {format}: {message}")]
    Writer {
        /// Name of the format.
        format: &'static str,
        /// What its writer says.
        message: String,
    },
}

impl ExportError {
    /// Wraps what the writer of `format` said.
    pub(crate) fn writer(format: &'static str, error: &impl std::fmt::Display) -> Self {
        Self::Writer { format, message: error.to_string() }
    }
}
