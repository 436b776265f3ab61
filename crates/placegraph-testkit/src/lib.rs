//! Oracles for the tests: slow, plain and obviously right.

pub mod plain_features;
pub mod plain_searches;
pub mod rays;
pub mod scenes;
