//! Generated buildings: the same from the same seed, with true labels.
//!
//! One program for many files: each program is linked on its own, which takes longer than to compile a file.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stdout, reason = "helpers of tests")]

mod reproducible;
mod surveyed;
mod truth;
