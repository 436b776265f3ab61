//! The extension module `placegraph._native`: arrays and text in and out of the library.
//!
//! Python code in `python/placegraph` makes of it what users see. Here are only conversions: rows are turned
//! so that row 0 is the map's top, errors become exceptions, and long work runs without the GIL.

#![expect(clippy::needless_pass_by_value, reason = "what comes from Python comes as a value")]

mod arrays;
mod call;
mod error;
mod grid;
mod labeled;
mod learn;
mod model;
mod questions;

use std::ffi::OsString;
use std::io::Write;
use std::path::PathBuf;

use placegraph::export::MAX_DOCUMENT_BYTES;
use placegraph::import;
use placegraph_cli::package;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::error::{Exception, Failure};

/// Runs the program with `args`, the first of which is its own name, and returns its exit status.
#[pyfunction]
fn run_program(py: Python<'_>, args: Vec<OsString>) -> u8 {
    py.detach(|| {
        let status = placegraph_cli::run(args);
        // Nothing else writes out what is left in the buffer: Python ends the process. Nobody listening is no error.
        let _ = std::io::stdout().flush();
        status
    })
}

/// The bytes of the document of a topological map.
#[pyfunction]
fn read_file(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyBytes>> {
    let bytes = py.detach(|| import::read(&path, MAX_DOCUMENT_BYTES));
    let bytes = bytes.map_err(|error| Failure::reading(Exception::Topology, &path, &error))?;
    Ok(PyBytes::new(py, &bytes))
}

/// Writes a file, whole or not at all.
#[pyfunction]
fn write_file(py: Python<'_>, path: PathBuf, data: Vec<u8>) -> PyResult<()> {
    Ok(py
        .detach(|| package::write_file(&path, &data))
        .map_err(|error| Failure::of_file(Exception::Export, &path, &error))?)
}

/// Arrays and text in and out of the library placegraph.
#[pymodule]
mod _native {
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
    #[pymodule_export]
    use super::grid::Grid;
    #[pymodule_export]
    use super::labeled::{Labeled, Session, export_formats, label};
    #[pymodule_export]
    use super::learn::{
        evaluate, extract, feature_names, fit_list, generate, list_probabilities, train_model,
    };
    #[pymodule_export]
    use super::model::Model;
    #[pymodule_export]
    use super::questions::Questions;
    #[pymodule_export]
    use super::{read_file, run_program, write_file};
}
