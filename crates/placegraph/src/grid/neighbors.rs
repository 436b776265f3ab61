//! The two neighborhoods of a cell.

use serde::{Deserialize, Serialize};

/// Which of the cells around a cell are its neighbors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Connectivity {
    /// Cells that share a side: `|dx| + |dy| = 1`.
    Four,
    /// Cells that share a side or a corner: `max(|dx|, |dy|) = 1`.
    Eight,
}

impl Connectivity {
    /// Steps to the neighbors, rows from below, left to right.
    pub const fn steps(self) -> &'static [(i32, i32)] {
        match self {
            Self::Four => &[(0, -1), (-1, 0), (1, 0), (0, 1)],
            Self::Eight => &[(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)],
        }
    }

    /// The half of [`Connectivity::steps`] that leads to earlier cells in row-major order.
    pub const fn steps_back(self) -> &'static [(i32, i32)] {
        match self {
            Self::Four => &[(0, -1), (-1, 0)],
            Self::Eight => &[(-1, -1), (0, -1), (1, -1), (-1, 0)],
        }
    }
}

/// When two cells that share only a corner are connected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DiagonalSteps {
    /// Allow the step if at least one of the two cells that it passes is free, so that no step crosses a diagonal
    /// wall.
    #[default]
    ThroughFree,
    /// Always: plain 8-connectivity.
    Any,
    /// Never: 4-connectivity.
    Never,
}
