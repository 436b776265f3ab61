//! The simulated laser scan (Sect. 4.4): 360 beams from the center of a free cell.

mod config;

pub use config::{N_BEAMS, ScanConfig, UnknownCells, beam_angle_rad};
