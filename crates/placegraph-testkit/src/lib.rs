//! Oracles for the tests: slow, plain and obviously right.

pub mod boost;
pub mod distance;
pub mod regions;
pub mod relax;
