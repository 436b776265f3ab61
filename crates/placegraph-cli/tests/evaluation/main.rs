//! The default model and every export on real maps.
//!
//! One program for many files: each program is linked on its own, which takes longer than to compile a file.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stdout, reason = "helpers of tests")]

mod default_model;
mod evaluation_maps;
#[path = "../program/running/mod.rs"]
mod running;
