//! The method up to the labels: scans, features, classifiers, networks, relaxation, training.
//!
//! One program for many files: each program is linked on its own, which takes longer than to compile a file.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stdout, reason = "helpers of tests")]

mod amn_learn;
mod amn_maps;
mod amn_model;
mod amn_oracles;
mod boost_oracle;
mod chapter_floor;
mod features_golden;
mod features_oracle;
mod features_properties;
mod labeled_halves;
mod maps;
mod relax_oracle;
mod scan_oracles;
mod training;
