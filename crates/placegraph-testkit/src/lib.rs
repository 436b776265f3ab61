//! Oracles for the tests: slow, plain and obviously right.

pub mod distance;
pub mod regions;
pub mod segments;
