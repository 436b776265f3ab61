//! Rules for the names of places.

use crate::text::is_shown;

/// Longest name of a place, in characters.
pub const MAX_NAME_CHARS: usize = 200;

/// Why a text cannot be the name of a place.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NameError {
    /// Nothing, or only blanks.
    #[error("expected a name of 1 to {MAX_NAME_CHARS} characters, found an empty one")]
    Empty,
    /// Too long.
    #[error("expected a name of 1 to {MAX_NAME_CHARS} characters, found {found}")]
    Long {
        /// Number of its characters.
        found: usize,
    },
    /// A line break, a tab, or what terminals take for a command.
    #[error("expected a name of printable characters, found {found:?} in it")]
    Control {
        /// The character.
        found: char,
    },
    /// A number would be taken for the number of a place.
    #[error("expected a name that is not a number, found {found:?}: numbers are given by the program")]
    Number {
        /// The name.
        found: String,
    },
    /// Consumers take names for paths and topics.
    #[error("expected a name without '/', found {found:?}")]
    Slash {
        /// The name.
        found: String,
    },
}

/// Whether `name` can be the name of a place: 1 to [`MAX_NAME_CHARS`] printable characters, not a number, no `/`.
///
/// # Errors
/// If it cannot, with the reason.
pub fn check_name(name: &str) -> Result<(), NameError> {
    if name.trim().is_empty() {
        return Err(NameError::Empty);
    }
    let n_chars = name.chars().count();
    if n_chars > MAX_NAME_CHARS {
        return Err(NameError::Long { found: n_chars });
    }
    if let Some(found) = name.chars().find(|&c| !is_shown(c)) {
        return Err(NameError::Control { found });
    }
    if name.trim().parse::<f64>().is_ok() {
        return Err(NameError::Number { found: name.to_owned() });
    }
    if name.contains('/') {
        return Err(NameError::Slash { found: name.to_owned() });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_people_pass_and_traps_do_not() {
        for name in ["kitchen", "Büro 3.14", "会议室", "room 7", "a", &"x".repeat(200), "O'Hara \"lab\" <1>"]
        {
            assert_eq!(check_name(name), Ok(()), "{name:?}");
        }
        let long = "é".repeat(201);
        for name in
            ["", "  ", "7", " 7 ", "-3.5", "1e3", "NaN", "a/b", "a\nb", "a\u{1b}[31m", "a\u{202e}b", &long]
        {
            assert!(check_name(name).is_err(), "{name:?}");
        }
        assert_eq!(check_name(&long), Err(NameError::Long { found: 201 }));
    }
}
