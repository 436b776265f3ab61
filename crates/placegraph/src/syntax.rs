//! Errors of JSON, TOML and YAML parsers.

use std::fmt;

/// Why text cannot be read, in the words of its parser: what is wrong, and in which line and column, on one line.
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

    /// Wraps what the TOML reader said of `text`, without its picture of the line.
    #[cfg(feature = "import")]
    pub(crate) fn of_toml(error: &toml::de::Error, text: &str) -> Self {
        let before = error.span().and_then(|span| text.get(..span.start));
        let place = before.map_or_else(String::new, |before| {
            let start = before.rfind('\n').map_or(0, |end| end + 1);
            let (line, column) = (before.matches('\n').count() + 1, before[start..].chars().count() + 1);
            format!("line {line}, column {column}: ")
        });
        // Some messages go on with a list of what was expected.
        let message = error.message().lines().map(str::trim).collect::<Vec<_>>().join(", ");
        Self { message: place + &message }
    }
}

/// Wraps the error of the TOML reader for `text`, without its picture of the line.
///
/// # Errors
/// If it is no TOML, or not that of a `T`.
#[cfg(feature = "import")]
pub fn from_toml<T: serde::de::DeserializeOwned>(text: &str) -> Result<T, SyntaxError> {
    toml::from_str(text).map_err(|error| SyntaxError::of_toml(&error, text))
}

#[cfg(all(test, feature = "import"))]
mod tests {
    use super::*;

    #[derive(Debug, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Example {
        _name: String,
        _n: u8,
    }

    #[test]
    fn errors_are_one_line_with_one_place() {
        let cases = [
            ("_name = 'a'\n_n = 300\n", "line 2, column 6: "),
            ("_name = 'a'\n  m = 1\n", "line 2, column 3: "),
            ("_name = \n", "line 1, column "),
            ("_name = 'ä'\n_name = 'b'\n", "line 2, column 1: "),
        ];
        for (text, place) in cases {
            let message = from_toml::<Example>(text).unwrap_err().to_string();
            assert!(message.starts_with(place) && message.lines().count() == 1, "{message}");
            assert_eq!(message.matches("line ").count(), 1, "{message}");
        }
    }
}
