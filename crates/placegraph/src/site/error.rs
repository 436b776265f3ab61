//! What can be wrong with a site.

use crate::document::TopologyError;
use crate::syntax::SyntaxError;
use crate::topology::NameError;
use crate::topology::query::listed;

/// Why a site file or a `site.json` cannot be read, or floors cannot be joined.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SiteError {
    /// Not TOML, or an unknown or missing key.
    #[error("expected a site file: {error}")]
    Toml {
        /// What the TOML reader found, and where.
        error: SyntaxError,
    },
    /// No floor.
    #[error("expected at least one [[floor]], found none")]
    NoFloor,
    /// A name of a site or of a level that cannot be the name of a file.
    #[error(
        "expected the name of {what}, which becomes the name of a file: 1 to 60 letters, digits, spaces, '-', '_' or '.', and no '.' \
         at the beginning; found {found:?}"
    )]
    Label {
        /// Site or level.
        what: &'static str,
        /// The name.
        found: String,
    },
    /// A name that a floor, a lift or stairs cannot have.
    #[error("the name of {what}: {error}")]
    Name {
        /// Whose name it is.
        what: String,
        /// What is wrong with it.
        error: NameError,
    },
    /// Two floors of one level.
    #[error("expected levels of different names, found {level:?} twice")]
    DoubleLevel {
        /// The level.
        level: String,
    },
    /// Two lifts or stairs of one name.
    #[error("expected lifts and stairs of different names, found {name:?} twice")]
    DoubleShaft {
        /// The name.
        name: String,
    },
    /// A lift stops on a level that no floor has.
    #[error("{shaft} stops on {level:?}, which is not a level of this site; there are {}", listed(known))]
    UnknownLevel {
        /// The lift or the stairs.
        shaft: String,
        /// The level that it names.
        level: String,
        /// The levels of the site.
        known: Vec<String>,
    },
    /// A lift that joins nothing.
    #[error("expected at least two levels on which {shaft} stops, found {n}")]
    FewLevels {
        /// The lift or the stairs.
        shaft: String,
        /// Number of its levels.
        n: usize,
    },
    /// A size that no cabin has.
    #[error("expected a cabin of {shaft} of 0.3 to 20 m, found {} by {} m", found[0], found[1])]
    Size {
        /// The lift.
        shaft: String,
        /// The size found.
        found: [f64; 2],
    },
    /// A number that cannot be a length on Earth.
    #[error("expected meters of a place on Earth in {of}, found {found}")]
    Number {
        /// What it belongs to.
        of: String,
        /// The number.
        found: f64,
    },
    /// A lift is not in free space.
    #[error(
        "{shaft} on {level} is at {x} {y}, which is not free in the map: give a point inside the cabin, or right before its door"
    )]
    NotFree {
        /// The lift or the stairs.
        shaft: String,
        /// The level.
        level: String,
        /// The point, in meters of the map frame.
        x: f64,
        /// Its second coordinate.
        y: f64,
    },
    /// A lift stands in free cells that are no place.
    #[error(
        "{shaft} on {level} is at {x} {y}, which is in no place: these cells are too small to be one, or an edit excluded them"
    )]
    NoPlace {
        /// The lift or the stairs.
        shaft: String,
        /// The level.
        level: String,
        /// The point, in meters of the map frame.
        x: f64,
        /// Its second coordinate.
        y: f64,
    },
    /// The robot cannot get to a lift.
    #[error(
        "a robot with a radius of {radius_m} m does not get from {place} to {shaft} on {level}: the way is too narrow"
    )]
    TooNarrow {
        /// The lift or the stairs.
        shaft: String,
        /// The level.
        level: String,
        /// The place that contains its point.
        place: String,
        /// The radius.
        radius_m: f64,
    },
    /// Two places, or a place and a lift, have one name.
    #[error("{name:?} is the name of two things, on {} and on {}: rename one of them in its edit file", levels[0], levels[1])]
    DoublePlace {
        /// The name.
        name: String,
        /// Their levels.
        levels: [String; 2],
    },
    /// Not JSON, or of other members.
    #[error("expected a site.json: {error}")]
    Json {
        /// What the reader found, and where.
        error: SyntaxError,
    },
    /// Another format.
    #[error("expected a document of the format {:?}, found {found:?}", super::FORMAT)]
    Format {
        /// The format found.
        found: String,
    },
    /// Another version of the format.
    #[error("expected version {} of the format, found {found}", super::VERSION)]
    Version {
        /// The version found.
        found: u64,
    },
    /// A floor contradicts itself, or cannot be written.
    #[error("level {level}: {error}")]
    Level {
        /// The level.
        level: String,
        /// What is wrong.
        error: TopologyError,
    },
    /// A stop is on a level or in a place that is not there.
    #[error("{shaft} stops on {level:?} in place {place}, which is not there")]
    Stop {
        /// The lift or the stairs.
        shaft: String,
        /// The level that it names.
        level: String,
        /// Number of the place that it names.
        place: u32,
    },
}
