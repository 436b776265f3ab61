//! How good a labeling is: cell, class and room measures.

mod metrics;
mod rooms;

pub use metrics::{CellScores, ClassScores, Confusion};
pub use rooms::{MIN_ROOM_CELLS, RoomScores, room_scores};
