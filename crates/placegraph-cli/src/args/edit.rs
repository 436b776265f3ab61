//! Arguments of `placegraph edit`.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, Subcommand};
use placegraph::topology::edits::{At, Edit, Target};

use super::values::comma_separated;

#[derive(Debug, Args)]
pub(crate) struct EditArgs {
    #[command(subcommand)]
    pub(crate) action: EditCommand,
    /// Add the correction to this file; it is created if it does not exist
    #[arg(short, long, value_name = "EDITS.toml", global = true, default_value = "edits.toml")]
    pub(crate) file: PathBuf,
    /// Look up names in this result and write points instead, which stay valid when the map changes
    #[arg(long, value_name = "DIR", global = true)]
    pub(crate) result: Option<PathBuf>,
}

/// The kinds of corrections. A place is given by its name or by a point X,Y inside it. The ends of a line across a passage
/// may be up to half a meter away from the walls.
#[derive(Clone, Debug, Subcommand)]
pub(crate) enum EditCommand {
    /// Rename a place
    Rename {
        /// Place: its name, or a point X,Y inside it
        #[arg(value_name = "PLACE", allow_hyphen_values = true)]
        at: TargetArg,
        /// New name
        name: String,
    },
    /// Change the class of a place
    Relabel {
        /// Place: its name, or a point X,Y inside it
        #[arg(value_name = "PLACE", allow_hyphen_values = true)]
        at: TargetArg,
        /// New class
        class: String,
    },
    /// Cut a place along a line
    Split {
        /// Ends of the line, in meters in the map frame
        #[arg(value_name = "X0,Y0,X1,Y1", allow_hyphen_values = true)]
        line: LineArg,
    },
    /// Join places, including the doorways between them
    Merge {
        /// Places: their names, or points X,Y inside them; the first gives class, number and name
        #[arg(value_name = "PLACE", num_args = 2.., required = true)]
        at: Vec<TargetArg>,
    },
    /// Add a doorway
    AddDoorway {
        /// Both jambs, in meters in the map frame
        #[arg(value_name = "X0,Y0,X1,Y1", allow_hyphen_values = true)]
        line: LineArg,
    },
    /// Move a doorway
    MoveDoorway {
        /// Doorway: its name, or a point X,Y inside it
        #[arg(value_name = "PLACE", allow_hyphen_values = true)]
        at: TargetArg,
        /// Both jambs, in meters in the map frame
        #[arg(value_name = "X0,Y0,X1,Y1", allow_hyphen_values = true)]
        line: LineArg,
    },
    /// Remove a doorway; its cells join the neighbor with the longest common border
    RemoveDoorway {
        /// Doorway: its name, or a point X,Y inside it
        #[arg(value_name = "PLACE", allow_hyphen_values = true)]
        at: TargetArg,
    },
    /// Draw a wall that closes a gap
    Close {
        /// Ends of the wall, in meters in the map frame
        #[arg(value_name = "X0,Y0,X1,Y1", allow_hyphen_values = true)]
        line: LineArg,
    },
    /// Break an opening through a wall, for example for a door that was shut
    Open {
        /// Line through the opening, from free space to free space, in meters in the map frame
        #[arg(value_name = "X0,Y0,X1,Y1", allow_hyphen_values = true)]
        line: LineArg,
        /// Width of the opening
        #[arg(long, value_name = "METERS", default_value_t = 0.9)]
        width: f64,
    },
    /// Remove a place: it is not listed, not in graphs, and forbidden in masks
    Exclude {
        /// Place: its name, or a point X,Y inside it
        #[arg(value_name = "PLACE", allow_hyphen_values = true)]
        at: TargetArg,
    },
}

impl EditCommand {
    /// The edit, with its places as they were typed.
    pub(crate) fn edit(&self) -> Edit {
        match self.clone() {
            Self::Rename { at, name } => Edit::Rename { at: at.0, name },
            Self::Relabel { at, class } => Edit::Relabel { at: at.0, class },
            Self::Split { line } => Edit::Split { line: line.0 },
            Self::Merge { at } => Edit::Merge { at: at.into_iter().map(|at| at.0).collect() },
            Self::AddDoorway { line } => Edit::AddDoorway { line: line.0 },
            Self::MoveDoorway { at, line } => Edit::MoveDoorway { at: at.0, line: line.0 },
            Self::RemoveDoorway { at } => Edit::RemoveDoorway { at: at.0 },
            Self::Close { line } => Edit::Close { line: line.0 },
            Self::Open { line, width } => Edit::Open { line: line.0, width_m: width },
            Self::Exclude { at } => Edit::Exclude { at: at.0 },
        }
    }
}

/// A place: a point inside of it, or its name.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TargetArg(Target);

impl FromStr for TargetArg {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        match comma_separated::<f64>(text).as_deref() {
            Some(&[x, y]) => Ok(Self(Target::Point([x, y]))),
            _ if text.trim().is_empty() => {
                Err("expected X,Y or the name of a place, found nothing".to_owned())
            }
            _ => Ok(Self(Target::Named(text.to_owned()))),
        }
    }
}

/// The two ends of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LineArg([At; 2]);

impl FromStr for LineArg {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        match comma_separated::<f64>(text).as_deref() {
            Some(&[ax, ay, bx, by]) => Ok(Self([[ax, ay], [bx, by]])),
            _ => Err(format!("expected X0,Y0,X1,Y1 in meters, found {text:?}")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_names_and_lines() {
        assert_eq!("-1.5, 2".parse(), Ok(TargetArg(Target::Point([-1.5, 2.0]))));
        assert_eq!("room 7".parse(), Ok(TargetArg(Target::Named("room 7".into()))));
        assert_eq!("7".parse(), Ok(TargetArg(Target::Named("7".into()))));
        assert!(" ".parse::<TargetArg>().is_err());
        assert_eq!("0,1,-2,3.5".parse(), Ok(LineArg([[0.0, 1.0], [-2.0, 3.5]])));
        assert!("0,1,2".parse::<LineArg>().is_err());
        assert_eq!(
            " -1,-2.5".parse(),
            Ok(TargetArg(Target::Point([-1.0, -2.5]))),
            "as `no_option` guards it"
        );
    }
}
