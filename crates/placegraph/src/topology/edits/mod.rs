//! Corrections by hand that are replayed on every run (`docs/edits.md`).
//!
//! Edits mean a place by a point inside of it, in meters of the map frame, or by its name: that which the place
//! has in the result without edits, or the one that an earlier edit gave. They are applied in the order of the file:
//! walls and openings to the map before it is labeled, all others to the regions, before the topological map is
//! built. An edit that does not apply changes nothing and is reported.
//!
//! ```toml
//! [[edit]]
//! action = "rename"
//! at = [12.5, 3.0]
//! name = "kitchen"
//!
//! [[edit]]
//! action = "split"
//! line = [[4.0, 0.0], [4.0, 2.5]]
//! ```
//!
//! Cost: `O(n)` for every edit, n cells.

mod editor;
mod gap;
mod numbering;
mod outcome;
mod target;
mod walls;

use serde::{Deserialize, Serialize};

pub use editor::apply;
pub use numbering::{Edited, Numbering};
pub use outcome::{Applied, NotApplied, Outcome};
pub use target::{At, Target};
pub use walls::{OnMap, apply_to_map};

use super::names::{NameError, check_name};
use crate::syntax::SyntaxError;
#[cfg(feature = "import")]
use crate::syntax::from_toml;

/// An edit file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EditFile {
    /// The edits, in the order they are applied.
    #[serde(default, rename = "edit")]
    pub edits: Vec<Edit>,
}

/// Why an edit file cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EditFileError {
    /// Not TOML, or an unknown action or key.
    #[error("expected an edit file: {error}")]
    Toml {
        /// What the TOML reader found, and where.
        error: SyntaxError,
    },
    /// A coordinate is not a number.
    #[error("expected finite numbers in edit {edit}, found {found}")]
    Number {
        /// Number of the edit, from 1.
        edit: usize,
        /// The number found.
        found: f64,
    },
    /// A name that a place cannot have.
    #[error("in edit {edit}: {error}")]
    Name {
        /// Number of the edit, from 1.
        edit: usize,
        /// What is wrong with it.
        error: NameError,
    },
    /// A width that an opening cannot have.
    #[error("expected a width of {MIN_OPENING_M} to {MAX_OPENING_M} m in edit {edit}, found {found}")]
    Width {
        /// Number of the edit, from 1.
        edit: usize,
        /// The width found.
        found: f64,
    },
}

/// Narrowest opening that can be drawn, in meters.
pub const MIN_OPENING_M: f64 = 0.1;
/// Widest opening that can be drawn, in meters.
pub const MAX_OPENING_M: f64 = 20.0;

impl EditFile {
    /// Parses the text of an edit file.
    ///
    /// # Errors
    /// If it is not TOML, has an unknown action or key, a number that is not finite, or a name that a place cannot have.
    #[cfg(feature = "import")]
    pub fn from_toml(text: &str) -> Result<Self, EditFileError> {
        let file: Self = from_toml(text).map_err(|error| EditFileError::Toml { error })?;
        file.check()?;
        Ok(file)
    }

    /// Checks numbers and names, which the types do not.
    ///
    /// # Errors
    /// If a number is not finite, or a name or a width is not allowed.
    pub fn check(&self) -> Result<(), EditFileError> {
        for (kind, edit) in self.edits.iter().zip(1..) {
            if let Some(&found) = kind.points().as_flattened().iter().find(|v| !v.is_finite()) {
                return Err(EditFileError::Number { edit, found });
            }
            if let Edit::Rename { name, .. } = kind {
                check_name(name).map_err(|error| EditFileError::Name { edit, error })?;
            }
            if let Edit::Open { width_m: found, .. } = *kind
                && !(MIN_OPENING_M..=MAX_OPENING_M).contains(&found)
            {
                return Err(EditFileError::Width { edit, found });
            }
        }
        Ok(())
    }
}

/// One correction. Every `at` is a point inside the place, or its name. A `line` across a passage may end up to half
/// a meter away from the walls: it is moved to the nearest gap between them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "action", rename_all = "snake_case", deny_unknown_fields)]
#[non_exhaustive]
pub enum Edit {
    /// Gives a place a name.
    Rename {
        /// The place.
        at: Target,
        /// Its name.
        name: String,
    },
    /// Gives a place another class.
    Relabel {
        /// The place.
        at: Target,
        /// Name of the class.
        class: String,
    },
    /// Cuts every place that the line cuts through into its parts; the largest part keeps number and name.
    Split {
        /// The two ends of the line.
        line: [At; 2],
    },
    /// Joins places that touch, or that only doorways part; these are joined as well. The first gives class, number
    /// and name.
    Merge {
        /// Each of them.
        at: Vec<Target>,
    },
    /// Makes a doorway of the free cells within 0.1 m of the line. What it cuts apart becomes several places.
    AddDoorway {
        /// From jamb to jamb.
        line: [At; 2],
    },
    /// Puts a doorway elsewhere: it keeps number and name.
    MoveDoorway {
        /// The doorway.
        at: Target,
        /// From jamb to jamb.
        line: [At; 2],
    },
    /// Gives the cells of a doorway to the neighbor it shares the longest border with.
    RemoveDoorway {
        /// The doorway.
        at: Target,
    },
    /// Draws a wall that closes a gap, before the map is labeled.
    Close {
        /// From wall to wall.
        line: [At; 2],
    },
    /// Breaks an opening through walls or unknown space, before the map is labeled: a door that was shut.
    Open {
        /// The way through, from free space to free space; ends may lie up to half a meter before it.
        line: [At; 2],
        /// Width of the opening, in meters.
        #[serde(default = "usual_opening")]
        width_m: f64,
    },
    /// Removes a place: it is not listed, not in graphs, and forbidden in masks.
    Exclude {
        /// What is a place until then.
        at: Target,
    },
}

/// Width of an opening that says none: a door's.
fn usual_opening() -> f64 {
    0.9
}

impl Edit {
    /// The name of the action in the file.
    pub fn action(&self) -> &'static str {
        match self {
            Self::Rename { .. } => "rename",
            Self::Relabel { .. } => "relabel",
            Self::Split { .. } => "split",
            Self::Merge { .. } => "merge",
            Self::AddDoorway { .. } => "add_doorway",
            Self::MoveDoorway { .. } => "move_doorway",
            Self::RemoveDoorway { .. } => "remove_doorway",
            Self::Close { .. } => "close",
            Self::Open { .. } => "open",
            Self::Exclude { .. } => "exclude",
        }
    }

    /// Whether it changes the map itself.
    pub fn is_on_map(&self) -> bool {
        matches!(self, Self::Close { .. } | Self::Open { .. })
    }

    /// The places that it changes.
    pub fn targets(&self) -> &[Target] {
        match self {
            Self::Rename { at, .. }
            | Self::Relabel { at, .. }
            | Self::MoveDoorway { at, .. }
            | Self::RemoveDoorway { at }
            | Self::Exclude { at } => std::slice::from_ref(at),
            Self::Merge { at } => at,
            Self::Split { .. } | Self::AddDoorway { .. } | Self::Close { .. } | Self::Open { .. } => &[],
        }
    }

    /// The targets of the edit, to be replaced.
    pub fn targets_mut(&mut self) -> &mut [Target] {
        match self {
            Self::Rename { at, .. }
            | Self::Relabel { at, .. }
            | Self::MoveDoorway { at, .. }
            | Self::RemoveDoorway { at }
            | Self::Exclude { at } => std::slice::from_mut(at),
            Self::Merge { at } => at,
            Self::Split { .. } | Self::AddDoorway { .. } | Self::Close { .. } | Self::Open { .. } => &mut [],
        }
    }

    /// Its line, if it has one.
    fn line(&self) -> Option<[At; 2]> {
        match self {
            Self::Split { line }
            | Self::AddDoorway { line }
            | Self::MoveDoorway { line, .. }
            | Self::Close { line }
            | Self::Open { line, .. } => Some(*line),
            Self::Rename { .. }
            | Self::Relabel { .. }
            | Self::Merge { .. }
            | Self::RemoveDoorway { .. }
            | Self::Exclude { .. } => None,
        }
    }

    /// All points that it names.
    fn points(&self) -> Vec<At> {
        let of_targets = self.targets().iter().filter_map(Target::point);
        of_targets.chain(self.line().into_iter().flatten()).collect()
    }
}
