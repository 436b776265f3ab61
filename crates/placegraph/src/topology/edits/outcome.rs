//! Outcomes of edits.

use std::fmt;

use serde::Serialize;

use super::At;
use crate::topology::query::{UnknownPlace, listed};

/// The outcome of an edit.
pub type Outcome = Result<Applied, NotApplied>;

/// An edit that applied. `Display` describes it in a line.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Applied {
    /// The name of the action in the file.
    pub action: String,
    /// The places that it concerned, by the names they had before it.
    pub was: Vec<String>,
    /// The places in the result that they became, by name. Places that later edits removed are not listed.
    pub now: Vec<String>,
    /// The line as it was moved to the gap, in meters of the map frame.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<[At; 2]>,
}

impl fmt::Display for Applied {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (was, now) = (self.was.join(", "), self.now.join(", "));
        write!(f, "{}", self.action)?;
        match (was.is_empty(), now.is_empty()) {
            (false, false) => write!(f, ": {was} became {now}")?,
            (false, true) => write!(f, ": {was} removed")?,
            (true, false) => write!(f, ": {now} added")?,
            (true, true) => {}
        }
        if let Some([[ax, ay], [bx, by]]) = self.line {
            write!(f, ", along ({ax:.2}, {ay:.2}) to ({bx:.2}, {by:.2})")?;
        }
        Ok(())
    }
}

/// Why an edit does not apply to this map.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NotApplied {
    /// There is no place at the point.
    #[error("expected a place at ({x}, {y}), found {found}")]
    NoPlace {
        /// The point's first coordinate, in meters.
        x: f64,
        /// Its second coordinate, in meters.
        y: f64,
        /// What is there.
        found: &'static str,
    },
    /// No place has this name or number.
    #[error(transparent)]
    NoPlaceCalled(#[from] UnknownPlace),
    /// The model has no such class.
    #[error("expected one of the model's classes, {}, found {class:?}", listed(known))]
    NoClass {
        /// The name found.
        class: String,
        /// The names there are.
        known: Vec<String>,
    },
    /// The model has no class with the role doorway.
    #[error("expected a class with the role doorway, found none")]
    NoDoorwayClass,
    /// Another place has this name.
    #[error("another place is already called {name:?}: choose another name")]
    NameTaken {
        /// The name.
        name: String,
    },
    /// A name that a place cannot have.
    #[error(transparent)]
    Name(#[from] crate::topology::NameError),
    /// The line parts nothing.
    #[error(
        "expected a line from wall to wall that divides a place in two, found none within {within_m} m of \
         ({ax:.2}, {ay:.2}) to ({bx:.2}, {by:.2})"
    )]
    PartsNothing {
        /// First coordinate of the line's first end, in meters.
        ax: f64,
        /// Its second coordinate.
        ay: f64,
        /// First coordinate of its second end.
        bx: f64,
        /// Its second coordinate.
        by: f64,
        /// How far around it was looked, in meters.
        within_m: f64,
    },
    /// The opening leads from free space to none.
    #[error(
        "expected a line from free space through a wall to free space, found {found} at ({x:.2}, {y:.2})"
    )]
    LeadsNowhere {
        /// What is there.
        found: &'static str,
        /// First coordinate of the end in question, in meters.
        x: f64,
        /// Its second coordinate.
        y: f64,
    },
    /// There is nothing to open on the line.
    #[error("the line crosses no wall: all its cells are free")]
    NothingToOpen,
    /// The line lies where a doorway is.
    #[error("expected a passage without a doorway, found {name}: move or remove it instead")]
    IsDoorway {
        /// The doorway.
        name: String,
    },
    /// Fewer than two places.
    #[error("expected two or more places, found {} only", listed(found))]
    OnePlace {
        /// The one.
        found: Vec<String>,
    },
    /// The places do not touch.
    #[error("expected places that touch or share a doorway, found {}, which do not", listed(found))]
    NotTouching {
        /// The places.
        found: Vec<String>,
    },
    /// The place is not a doorway.
    #[error("expected a doorway, found {name}, a {class}")]
    NoDoorway {
        /// Its name.
        name: String,
        /// Its class.
        class: String,
    },
    /// A doorway without a neighbor.
    #[error("no place next to {name} can take its cells")]
    NothingBeside {
        /// The doorway.
        name: String,
    },
}
