//! From labels to places: regions, the topological map, edits, identity, questions, routes; and what the whole pipeline
//! promises of generated buildings.
//!
//! One program for many files: each program is linked on its own, which takes longer than to compile a file.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stdout, reason = "helpers of tests")]

mod building;
mod hard_maps;
mod metamorphic;
mod regions_correction;
mod regions_oracles;
mod session;
mod site;
mod topology_align;
mod topology_doorways;
mod topology_edits;
mod topology_identity;
mod topology_oracles;
mod topology_query;
mod topology_reach;
mod topology_routes;
