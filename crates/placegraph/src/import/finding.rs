//! Findings of the check of a map, and their texts.

use std::fmt;

use serde::Serialize;

use super::ReplacedImage;
use super::check::{ISLAND_M2, MAX_CLEARANCE_M, MAX_EXTENT_M, MAX_MEDIAN_CLEARANCE_M};

/// The severity of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Worth knowing.
    Info,
    /// The result may be wrong.
    Warning,
    /// There is nothing to label.
    Error,
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Info => "note",
            Self::Warning => "warning",
            Self::Error => "error",
        })
    }
}

/// A finding of the check. `Display` says what it means and what to do.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "finding", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Finding {
    /// No cell is free.
    NoFreeCell,
    /// Gray 205 is free by the letter of the file, and was taken as unknown.
    Gray205Unknown {
        /// Cells of this gray.
        n_cells: u64,
        /// Their share of all cells.
        share: f64,
        /// The threshold that makes them free.
        free_thresh: f64,
    },
    /// Gray 205 is free by the thresholds of the file, and was read as free, as requested.
    Gray205Free {
        /// Cells of this gray.
        n_cells: u64,
        /// Their share of all cells.
        share: f64,
        /// The threshold that makes them free.
        free_thresh: f64,
    },
    /// Free cells form thin lines and occupied cells wide areas: the polarity is inverted.
    Inverted {
        /// Share of the free cells farther than 0.25 m, a robot's radius, from all others.
        wide_free: f64,
        /// Share of the occupied cells farther than that from all others.
        wide_occupied: f64,
    },
    /// Free cells lie at the image's border.
    OpenToBorder {
        /// How many.
        n_cells: u64,
    },
    /// A building of this size is hardly one, unless it is one large hall: the resolution is wrong.
    Resolution {
        /// Meters per cell.
        resolution_m: f64,
        /// Width and height of the largest free area's bounding box, in meters.
        extent_m: [f64; 2],
        /// Half of its cells are this far from all others, in meters.
        median_clearance_m: f64,
        /// Its farthest cell is this far from all others, in meters.
        largest_clearance_m: f64,
    },
    /// No cell is occupied: beams end at unknown cells only.
    NoOccupiedCell,
    /// No cell is unknown.
    NoUnknownCell,
    /// The YAML file names an image that does not exist; one of the same name next to the YAML file was read.
    ReplacedImage(ReplacedImage),
    /// The yaw of the origin is more than a full turn, as if it were in degrees.
    YawInDegrees {
        /// The yaw as written, taken as radians.
        yaw_rad: f64,
    },
    /// The picture was smoothed: most grays that no saver writes lie between those of their neighbors.
    Smoothed {
        /// How many pixels do.
        n_cells: u64,
        /// Their share of all pixels.
        share: f64,
    },
    /// Pixels that are not opaque were read as unknown.
    Transparent {
        /// How many.
        n_cells: u64,
    },
    /// Many small free areas that nothing leads to.
    Islands {
        /// Number of free areas below 0.25 m².
        n_islands: u64,
        /// Their area together, in square meters.
        area_m2: f64,
    },
    /// Unknown areas that free cells enclose, with hardly a wall between: the middle of halls, out of the lidar's reach.
    Unexplored {
        /// Number of such areas of at least 4 m².
        n_areas: u64,
        /// Their area together, in square meters.
        area_m2: f64,
        /// The area of all free cells, in square meters.
        free_m2: f64,
    },
}

impl Finding {
    /// The severity of the finding.
    pub const fn severity(&self) -> Severity {
        match self {
            Self::NoFreeCell => Severity::Error,
            Self::Gray205Unknown { .. }
            | Self::Gray205Free { .. }
            | Self::Inverted { .. }
            | Self::OpenToBorder { .. }
            | Self::Resolution { .. }
            | Self::ReplacedImage(_)
            | Self::YawInDegrees { .. }
            | Self::Unexplored { .. }
            | Self::NoOccupiedCell => Severity::Warning,
            Self::NoUnknownCell | Self::Smoothed { .. } | Self::Transparent { .. } | Self::Islands { .. } => {
                Severity::Info
            }
        }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NoFreeCell => {
                write!(f, "no cell is free: check mode, negate and the thresholds in the YAML file")
            }
            Self::Gray205Unknown { n_cells, share, free_thresh } => write!(
                f,
                "gray 205 ({n_cells} cells, {:.1} %) is what map savers write for unknown, but free_thresh \
                 {free_thresh} would make it free: it was read as unknown; write free_thresh: 0.196 into the \
                 YAML file, or, if these cells really are free, trust its thresholds",
                100.0 * share
            ),
            Self::Gray205Free { n_cells, share, free_thresh } => write!(
                f,
                "gray 205 ({n_cells} cells, {:.1} %) was read as free, as free_thresh {free_thresh} says; map \
                 savers write it for unknown, and then beams run through unexplored space: do not trust the \
                 thresholds, and it is read as unknown",
                100.0 * share
            ),
            Self::Inverted { wide_free, wide_occupied } => write!(
                f,
                "free and occupied look swapped: only {:.0} % of the free cells are wider than a robot, but \
                 {:.0} % of the occupied ones; check negate in the YAML file (white is free when it is 0)",
                100.0 * wide_free,
                100.0 * wide_occupied
            ),
            Self::OpenToBorder { n_cells } => write!(
                f,
                "{n_cells} free cells lie at the border of the image, where beams end as at a wall; if the \
                 outside is drawn as free, paint it unknown (gray 205), else give the map a margin"
            ),
            Self::Resolution {
                resolution_m,
                extent_m: [width, height],
                median_clearance_m,
                largest_clearance_m,
            } => {
                let may_be_hall = median_clearance_m > MAX_MEDIAN_CLEARANCE_M
                    && largest_clearance_m <= MAX_CLEARANCE_M
                    && width.max(height) <= MAX_EXTENT_M;
                let what = if may_be_hall {
                    "one large hall, or a building with a wrong resolution: check the resolution"
                } else {
                    "hardly a building: correct the resolution"
                };
                write!(
                    f,
                    "with {resolution_m} m per cell the largest free area spans {width:.1} m x {height:.1} m, half of \
                     it is within {median_clearance_m:.2} m of a wall and the widest spot {largest_clearance_m:.1} \
                     m from one, which is {what}"
                )
            }
            Self::NoOccupiedCell => write!(
                f,
                "no cell is occupied: check the thresholds in the YAML file; beams will end at unknown cells only"
            ),
            Self::NoUnknownCell => {
                write!(f, "no cell is unknown: every cell that is not free counts as wall")
            }
            Self::ReplacedImage(ReplacedImage { ref named, ref read }) => write!(
                f,
                "the YAML file names the image {named}, which is not there; {read} next to the YAML file was read \
                 instead: if it is the right one, write image: {read}"
            ),
            Self::YawInDegrees { yaw_rad } => write!(
                f,
                "the yaw of the origin, {yaw_rad}, is more than a full turn: map_server and this program take it as \
                 radians; if it is meant in degrees, write {:.6}",
                yaw_rad.to_radians()
            ),
            Self::Smoothed { n_cells, share } => write!(
                f,
                "{n_cells} pixels ({:.1} %) have a gray between those of their neighbors: if the picture was turned or \
                 scaled with smoothing, walls have gaps, and halos that read as free; make it again without \
                 interpolation (nearest neighbor)",
                100.0 * share
            ),
            Self::Transparent { n_cells } => {
                write!(f, "{n_cells} cells are transparent in the image and were read as unknown or dimmed")
            }
            Self::Unexplored { n_areas, area_m2, free_m2 } => write!(
                f,
                "{n_areas} unknown {} ({area_m2:.0} m² beside {free_m2:.0} m² of free cells) {} enclosed by free cells and \
                 not by walls: the hall was explored along its walls only, and what borders on unknown cells is taken for \
                 narrow; drive through the middle as well, or use a lidar of a longer range",
                if n_areas == 1 { "area" } else { "areas" },
                if n_areas == 1 { "is" } else { "are" },
            ),
            Self::Islands { n_islands, area_m2 } => write!(
                f,
                "{n_islands} islands of free cells below {ISLAND_M2} m² each ({area_m2:.1} m² together) are separated from the \
                 rest, mostly by beams that passed through windows; they take the label of the nearest free cells and form \
                 no places"
            ),
        }
    }
}
