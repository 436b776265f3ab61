//! Minimum cuts over the cells of a map, and the labelings that they find: α-expansion.
//!
//! The network of Sect. 4.6 and the spaces between doorways ([`crate::spaces`]) ask the same question: which labeling has
//! the highest score, if every node has a preference and neighbors with the same label are rewarded?

mod capacity;
mod expansion;
#[doc(hidden)]
pub mod maxflow;

pub(crate) use expansion::SmallExpansion;
pub use expansion::{Potentials, agreeing_edges, expand, expand_from_all};
