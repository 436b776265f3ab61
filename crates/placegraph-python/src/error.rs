//! Errors of the library as exceptions of the package, with the same text.

use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};

use placegraph::import::MapError;
use pyo3::prelude::*;

/// The exceptions of `placegraph.errors` that are raised from here.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Exception {
    Map,
    Model,
    Topology,
    Edit,
    Training,
    Export,
    Internal,
}

impl Exception {
    const fn name(self) -> &'static str {
        match self {
            Self::Map => "MapError",
            Self::Model => "ModelError",
            Self::Topology => "TopologyError",
            Self::Edit => "EditError",
            Self::Training => "TrainingError",
            Self::Export => "ExportError",
            Self::Internal => "InternalError",
        }
    }
}

/// What went wrong, ready to become an exception once the GIL is held.
#[derive(Debug)]
pub(crate) struct Failure {
    exception: Exception,
    text: String,
    /// The system's error number and the file, where a file is at fault.
    file: Option<(i32, PathBuf)>,
}

impl Failure {
    pub(crate) fn new(exception: Exception, error: impl Display) -> Self {
        Self { exception, text: format!("{error:#}"), file: None }
    }

    /// Reading `path` failed, on the way to what `exception` is about.
    pub(crate) fn reading(exception: Exception, path: &Path, error: &MapError) -> Self {
        Self {
            file: at_fault(error, path),
            ..Self::new(exception, format!("could not read {}: {error}", path.display()))
        }
    }

    /// A map could not be read.
    pub(crate) fn map(path: &Path, error: &MapError) -> Self {
        Self { file: at_fault(error, path), ..Self::new(Exception::Map, error) }
    }

    /// The program's error about the file or folder at `path`.
    pub(crate) fn of_file(exception: Exception, path: &Path, error: &anyhow::Error) -> Self {
        let in_chain = error.chain().find_map(|cause| match cause.downcast_ref::<MapError>() {
            Some(error) => at_fault(error, path),
            None => cause.downcast_ref().and_then(number).map(|number| (number, path.to_owned())),
        });
        Self { file: in_chain, ..Self::new(exception, format!("{error:#}")) }
    }

    fn raise(self, py: Python<'_>) -> PyResult<PyErr> {
        let errors = py.import("placegraph.errors")?;
        let Some((number, path)) = self.file else {
            return Ok(PyErr::from_value(errors.getattr(self.exception.name())?.call1((self.text,))?));
        };
        Ok(PyErr::from_value(errors.getattr("file_error")?.call1((
            self.text,
            number,
            path.into_os_string(),
        ))?))
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        Python::attach(|py| failure.raise(py).unwrap_or_else(|error| error))
    }
}

/// The file that the system does not give, and its error number.
fn at_fault(error: &MapError, path: &Path) -> Option<(i32, PathBuf)> {
    match error {
        MapError::InFile { error, path } => at_fault(error, path),
        MapError::ImageFile { error, image } => at_fault(error, image),
        MapError::Io { error } => number(error).map(|number| (number, path.to_owned())),
        _ => None,
    }
}

fn number(error: &io::Error) -> Option<i32> {
    error.raw_os_error()
}
