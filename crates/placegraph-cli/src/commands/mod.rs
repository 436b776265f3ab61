//! One file a command.

pub mod evaluate;
pub mod features;
pub mod generate;
pub mod info;
pub mod map;
pub mod scan;
pub mod train;

/// How a command ended that could do its work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// All done.
    Done,
    /// Done, but a requested check failed, or some maps of several could not be labeled.
    CheckFailed,
}
