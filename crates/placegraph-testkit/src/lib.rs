//! Oracles for the tests: slow, plain and obviously right.
#![allow(clippy::expect_used, clippy::unwrap_used, reason = "a wrong call of an oracle must stop the test")]

pub mod boost;
pub mod distance;
pub mod networks;
pub mod plain_features;
pub mod plain_searches;
pub mod rays;
pub mod regions;
pub mod relax;
pub mod scenes;
pub mod segments;
