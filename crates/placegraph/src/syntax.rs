//! What a parser of JSON, TOML or YAML says of text that it cannot read.

use std::fmt;

/// Why text cannot be read, in the words of its parser: what is wrong, and in which line and column.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct SyntaxError {
    message: String,
}

impl SyntaxError {
    /// Wraps what a parser said.
    pub(crate) fn of(error: &impl fmt::Display) -> Self {
        Self { message: error.to_string() }
    }
}
