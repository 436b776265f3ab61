//! The program as its users run it.
//!
//! One program for many files: each program is linked on its own, which takes longer than to compile a file.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stdout, reason = "helpers of tests")]

mod batch;
mod commands;
mod dependencies;
mod edits;
mod evaluate;
mod exports;
mod extremes;
#[cfg(unix)]
mod faults;
mod frames;
mod labels;
mod limits;
mod names_last;
mod plans;
mod readers;
mod resume;
mod running;
mod safety;
#[cfg(target_os = "linux")]
mod sites;
mod soak;
mod tutorial;
mod vouching;
