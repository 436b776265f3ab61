//! The cells that a beam enters, and their distances: the same for every cell of every map.
//!
//! Seen from the center of a cell, a beam of a given direction enters the same sequence of cells wherever it
//! starts. The sequences are worked out for the 46 directions of one octant, by the traversal of
//! Amanatides and Woo [1987] through empty space, and mirrored into the other seven, so that turning or
//! mirroring a map turns or mirrors its scans exactly.
//!
//! **Corners.** Only beams at odd multiples of 45° run through corners of cells. Such a beam goes on
//! diagonally, unless both cells next to the corner stop it: two obstacles that touch at a corner form a wall.

use std::f64::consts::FRAC_1_SQRT_2;

use super::N_BEAMS;
use crate::geom::Vec2;

/// Beams from 0° to 45°, both included.
pub(super) const N_OCTANT: usize = N_BEAMS / 8 + 1;
const QUARTER: usize = N_BEAMS / 4;

/// A cell that a beam enters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Step {
    /// Columns from the start cell.
    pub(super) x: i32,
    /// Rows from the start cell.
    pub(super) y: i32,
    /// Distance from the start cell's center to where the beam enters, in cells.
    pub(super) entry_cells: f64,
}

/// Where `beam` lies in the first octant, and how to get back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Octant {
    /// The beam of the first octant that it mirrors.
    pub(super) beam: usize,
    swap: bool,
    quarters: usize,
}

impl Octant {
    pub(super) fn of(beam: usize) -> Self {
        let in_quarter = beam % QUARTER;
        let swap = in_quarter >= N_OCTANT;
        let octant_beam = if swap { QUARTER - in_quarter } else { in_quarter };
        Self { beam: octant_beam, swap, quarters: beam / QUARTER % 4 }
    }

    /// Takes components from the first octant to the beam's own.
    pub(super) fn back<T: std::ops::Neg<Output = T>>(self, x: T, y: T) -> (T, T) {
        let (x, y) = if self.swap { (y, x) } else { (x, y) };
        match self.quarters {
            0 => (x, y),
            1 => (-y, x),
            2 => (-x, -y),
            _ => (y, -x),
        }
    }

    /// Whether the beam runs through corners of cells.
    pub(super) fn is_diagonal(self) -> bool {
        self.beam == N_OCTANT - 1
    }
}

/// Unit vector along `beam`, exactly symmetric: components of beams that mirror each other are equal.
pub fn beam_direction(beam: usize) -> Vec2 {
    let octant = Octant::of(beam);
    let along = octant_direction(octant.beam);
    // Adding 0 turns -0 into 0.
    let (x, y) = octant.back(along.x, along.y);
    Vec2::new(x + 0.0, y + 0.0)
}

fn octant_direction(beam: usize) -> Vec2 {
    if beam == N_OCTANT - 1 {
        return Vec2::new(FRAC_1_SQRT_2, FRAC_1_SQRT_2);
    }
    let angle = super::beam_angle_rad(beam);
    Vec2::new(angle.cos(), angle.sin())
}

/// The cells that `beam` of the first octant enters, nearest first, while their distance is below
/// `range_max_cells`, but at most `n_max`.
pub(super) fn octant_path(beam: usize, range_max_cells: f64, n_max: usize) -> Vec<Step> {
    let along = octant_direction(beam);
    let (mut x, mut y) = (0, 0);
    let mut path = Vec::new();
    while path.len() < n_max {
        // Distances to the sides of the current cell that the beam may leave through.
        let to_x = (x as f64 + 0.5) / along.x;
        let to_y = (y as f64 + 0.5) / along.y;
        let entry_cells = to_x.min(to_y);
        if entry_cells >= range_max_cells {
            break;
        }
        x += i32::from(to_x <= to_y);
        y += i32::from(to_y <= to_x);
        path.push(Step { x, y, entry_cells });
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flat_beam_enters_the_next_row_late() {
        // tan 20° = 0.364: the beam leaves row 0 at x = 0.5 / 0.364 = 1.37, in column 1 (which ends at 1.5).
        let path = octant_path(20, 2.6, 100);
        let cells: Vec<_> = path.iter().map(|step| (step.x, step.y)).collect();
        assert_eq!(cells, [(1, 0), (1, 1), (2, 1)]);
        assert!((path[1].entry_cells - 0.5 / 20f64.to_radians().sin()).abs() < 1e-12);
    }

    #[test]
    fn the_diagonal_goes_through_corners() {
        let cells: Vec<_> = octant_path(45, 4.0, 100).iter().map(|step| (step.x, step.y)).collect();
        assert_eq!(cells, [(1, 1), (2, 2), (3, 3)]);
    }

    #[test]
    fn directions_are_exact_under_quarter_turns_and_mirrors() {
        for beam in 0..N_BEAMS {
            let (here, turned) = (beam_direction(beam), beam_direction(beam + QUARTER));
            assert_eq!((turned.x, turned.y), (-here.y + 0.0, here.x));
            let mirrored = beam_direction((N_BEAMS - beam) % N_BEAMS);
            assert_eq!((mirrored.x, mirrored.y), (here.x, -here.y + 0.0));
            let angle = crate::scan::beam_angle_rad(beam);
            assert!((here.x - angle.cos()).abs() < 1e-15 && (here.y - angle.sin()).abs() < 1e-15);
        }
    }
}
