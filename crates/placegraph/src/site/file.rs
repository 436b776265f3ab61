//! The file that says which maps are the floors of a site, and what joins them.

use std::collections::BTreeMap;

use serde::{Deserialize, Deserializer};

use super::SiteError;
use crate::geom::{Point2, Pose2};
use crate::syntax::from_toml;
use crate::topology::check_name;

/// Height of a floor whose file does not give one over the floor before it, in meters.
pub const STOREY_M: f64 = 4.0;
/// Side of a lift's cabin whose file does not give one, in meters.
pub const CABIN_M: f64 = 1.6;
/// Most characters of the name of a site or of a level.
const MAX_LABEL_CHARS: usize = 60;
/// Farther from the origin than this is nothing, in meters.
const FARTHEST_M: f64 = 1e8;

/// A site file.
///
/// # Examples
/// ```
/// use placegraph::site::SiteFile;
///
/// let file = SiteFile::from_toml(
///     r#"
///     name = "clinic"
///     [[floor]]
///     level = "L1"
///     map = "ground/map.yaml"
///     [[floor]]
///     level = "L2"
///     map = "upper/map.yaml"
///     [[lift]]
///     name = "lift A"
///     at = { L1 = [3.0, 1.0], L2 = [3.0, 1.5] }
///     "#,
/// )?;
/// assert_eq!(file.floors[1].elevation_m, Some(4.0));
/// # Ok::<(), placegraph::site::SiteError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SiteFile {
    /// Name of the site.
    pub name: String,
    /// The floors, from the first.
    #[serde(default, rename = "floor")]
    pub floors: Vec<Floor>,
    /// The lifts.
    #[serde(default, rename = "lift")]
    pub lifts: Vec<Shaft>,
    /// The stairs: people take them, robots do not.
    #[serde(default)]
    pub stairs: Vec<Shaft>,
}

/// A floor of a site.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Floor {
    /// Name of the level, short: places are called by it, and a folder.
    #[serde(deserialize_with = "label")]
    pub level: String,
    /// Path of its map, relative to the site file.
    pub map: String,
    /// Its name for people; that of the level if none is given.
    #[serde(default)]
    pub name: Option<String>,
    /// Its height in meters; one without is [`STOREY_M`] over the floor before it, the first at 0.
    #[serde(default, alias = "elevation")]
    pub elevation_m: Option<f64>,
    /// Where its map frame lies in the frame of the site: x and y in meters, and the turn in degrees. Without it, the lifts that stop
    /// here decide.
    #[serde(default)]
    pub pose: Option<[f64; 3]>,
    /// Path of its edit file, relative to the site file.
    #[serde(default)]
    pub edits: Option<String>,
    /// Path of an earlier result, whose numbers and names go on, relative to the site file.
    #[serde(default)]
    pub previous: Option<String>,
}

/// A lift, or stairs.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shaft {
    /// Its name.
    pub name: String,
    /// A point in it, or right before it, in the map frame of every level where it can be entered.
    pub at: BTreeMap<String, [f64; 2]>,
    /// Size of the cabin in meters: from the door inwards, and across.
    #[serde(default)]
    pub size_m: Option<[f64; 2]>,
}

impl Floor {
    /// Where its map frame lies in the frame of the site, if the file says so.
    pub fn site_from_map(&self) -> Option<Pose2> {
        self.pose.map(|[x, y, turn_deg]| Pose2::new(x, y, turn_deg.to_radians()))
    }
}

/// A text, or a whole number: `level = 1`.
fn label<'de, D: Deserializer<'de>>(deserializer: D) -> Result<String, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Label {
        Text(String),
        Number(i64),
    }
    Ok(match Label::deserialize(deserializer)? {
        Label::Text(text) => text,
        Label::Number(number) => number.to_string(),
    })
}

impl SiteFile {
    /// Parses the text of a site file, and checks it. Floors without a height get theirs.
    ///
    /// # Errors
    /// If it is not TOML, has an unknown or missing key, two levels or two lifts of one name, a lift that stops on fewer than two
    /// levels or on an unknown one, or a number that cannot be.
    pub fn from_toml(text: &str) -> Result<Self, SiteError> {
        let mut file: Self = from_toml(text).map_err(|error| SiteError::Toml { error })?;
        check_label("a site", &file.name)?;
        file.check_floors()?;
        file.check_shafts()?;
        let mut before = -STOREY_M;
        for floor in &mut file.floors {
            before = *floor.elevation_m.get_or_insert(before + STOREY_M);
        }
        Ok(file)
    }

    /// Lifts, then stairs, and whether each is a lift.
    pub fn shafts(&self) -> impl Iterator<Item = (&Shaft, bool)> {
        let lifts = self.lifts.iter().map(|lift| (lift, true));
        lifts.chain(self.stairs.iter().map(|stairs| (stairs, false)))
    }

    /// Where each of [`shafts`](Self::shafts) can be entered on `level`.
    pub fn entrances(&self, level: &str) -> Vec<Option<Point2>> {
        let point = |shaft: &Shaft| shaft.at.get(level).map(|&[x, y]| Point2::new(x, y));
        self.shafts().map(|(shaft, _)| point(shaft)).collect()
    }

    fn check_floors(&self) -> Result<(), SiteError> {
        if self.floors.is_empty() {
            return Err(SiteError::NoFloor);
        }
        for (index, floor) in self.floors.iter().enumerate() {
            let level = &floor.level;
            check_label("a level", level)?;
            if let Some(name) = &floor.name {
                check_name(name)
                    .map_err(|error| SiteError::Name { what: format!("floor {level}"), error })?;
            }
            // Folders of some systems are the same in capitals.
            if self.floors[..index].iter().any(|other| other.level.to_lowercase() == level.to_lowercase()) {
                return Err(SiteError::DoubleLevel { level: level.clone() });
            }
            let numbers = floor.pose.iter().flatten().chain(&floor.elevation_m);
            check_numbers(numbers, || format!("the height or the pose of floor {level}"))?;
        }
        Ok(())
    }

    fn check_shafts(&self) -> Result<(), SiteError> {
        let mut names: Vec<&str> = Vec::new();
        for (shaft, _) in self.shafts() {
            let name = shaft.name.as_str();
            check_name(name).map_err(|error| SiteError::Name { what: "a lift".to_owned(), error })?;
            if names.contains(&name) {
                return Err(SiteError::DoubleShaft { name: name.to_owned() });
            }
            names.push(name);
            for (level, at) in &shaft.at {
                if !self.floors.iter().any(|floor| floor.level == *level) {
                    let known = self.floors.iter().map(|floor| floor.level.clone()).collect();
                    return Err(SiteError::UnknownLevel {
                        shaft: name.to_owned(),
                        level: level.clone(),
                        known,
                    });
                }
                check_numbers(at.iter(), || format!("the point of {name} on {level}"))?;
            }
            if shaft.at.len() < 2 {
                return Err(SiteError::FewLevels { shaft: name.to_owned(), n: shaft.at.len() });
            }
            if let Some(size_m) = shaft.size_m
                && !size_m.iter().all(|side_m| (0.3..=20.0).contains(side_m))
            {
                return Err(SiteError::Size { shaft: name.to_owned(), found: size_m });
            }
        }
        Ok(())
    }
}

/// What becomes the name of a file or a folder.
fn check_label(what: &'static str, found: &str) -> Result<(), SiteError> {
    let is_plain = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.' | ' ');
    let is_good = (1..=MAX_LABEL_CHARS).contains(&found.chars().count())
        && found.chars().all(is_plain)
        && found.trim() == found
        && !found.starts_with('.');
    if is_good { Ok(()) } else { Err(SiteError::Label { what, found: found.chars().take(200).collect() }) }
}

fn check_numbers<'a>(
    mut numbers: impl Iterator<Item = &'a f64>,
    of: impl Fn() -> String,
) -> Result<(), SiteError> {
    match numbers.find(|number| number.is_nan() || number.abs() > FARTHEST_M) {
        None => Ok(()),
        Some(&found) => Err(SiteError::Number { of: of(), found }),
    }
}
