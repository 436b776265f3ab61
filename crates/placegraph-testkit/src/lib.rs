//! Oracles for the tests: slow, plain and obviously right.

pub mod boost;
pub mod relax;
