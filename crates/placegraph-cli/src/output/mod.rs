//! What goes out: sets of files that are written whole or not at all, results on standard output, words for people.

mod replace;
mod set;
mod target;

use std::io::{ErrorKind, Write};

use anyhow::Result;

pub(crate) use replace::lock_and_recover;
pub(crate) use set::{Committed, Existing, OutputSet};
pub(crate) use target::{Target, write_file};

/// Prints results on standard output; an error if they do not arrive. Whoever reads it may stop: the command goes on,
/// and its status stands.
pub(crate) fn print(text: &str) -> Result<()> {
    print_bytes(text.as_bytes())
}

/// As [`print`], for what is no text.
pub(crate) fn print_bytes(bytes: &[u8]) -> Result<()> {
    let mut stdout = std::io::stdout().lock();
    // Text without a final newline would stay in the buffer, and with it the error of a full disk.
    match stdout.write_all(bytes).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}

/// Prints results as JSON on standard output.
pub(crate) fn print_json(value: &impl serde::Serialize) -> Result<()> {
    print(&format!("{}\n", serde_json::to_string_pretty(value)?))
}

/// Prints a message for people on standard error; it is not an error if nobody reads it.
pub(crate) fn complain(message: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{message}");
}

/// `fields` as a line of comma-separated values (RFC 4180, with plain line ends).
pub(crate) fn csv_row(fields: impl Iterator<Item = String>) -> String {
    let escaped = |field: String| {
        if field.contains(['"', ',', '\n', '\r']) {
            format!("\"{}\"", field.replace('"', "\"\""))
        } else {
            field
        }
    };
    fields.map(escaped).collect::<Vec<_>>().join(",") + "\n"
}
