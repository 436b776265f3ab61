//! How good a labeling is: cell, class, door and room measures.

mod door_scores;
mod doors;
#[cfg(test)]
mod drawn;
mod metrics;
mod paired;
mod rooms;

pub use door_scores::{DoorGroup, DoorRates, DoorScores};
pub use doors::{DOOR_REACH_M, DoorCounts, DoorTally, MIN_DOOR_AREA_M2};
pub use metrics::{CellScores, ClassScores, Confusion};
pub use paired::PairedTest;
pub use rooms::{MIN_ROOM_CELLS, RoomScores, room_scores};
