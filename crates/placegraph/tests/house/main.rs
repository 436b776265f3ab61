//! Rules of the source itself and of the pages made from it.
//!
//! One program for many files: each program is linked on its own, which takes longer than to compile a file.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stdout, reason = "helpers of tests")]

mod cited_files;
mod dependency_order;
mod exports_page;
mod features_page;
mod licenses;
mod method_page;
mod variables;
