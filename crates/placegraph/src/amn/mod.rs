//! Instance-based associative Markov networks (Sect. 4.6).

pub mod infer;
pub mod learn;
pub mod maxflow;
pub mod model;
pub mod nearest;
mod working_set;
