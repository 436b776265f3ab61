//! One file a command.

pub(crate) mod align;
pub(crate) mod edit;
pub(crate) mod evaluate;
pub(crate) mod export;
pub(crate) mod features;
pub(crate) mod generate;
pub(crate) mod info;
pub(crate) mod labels;
pub(crate) mod list;
pub(crate) mod locate;
pub(crate) mod map;
pub(crate) mod page;
mod plans;
pub(crate) mod replay;
pub(crate) mod route;
pub(crate) mod scan;
pub(crate) mod shell;
pub(crate) mod site;
pub(crate) mod train;
pub(crate) mod verify;

/// How a command ended that could do its work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// All done.
    Done,
    /// Done, but a requested check failed, or some maps of several could not be labeled.
    CheckFailed,
}
