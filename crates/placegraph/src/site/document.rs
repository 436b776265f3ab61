//! `site.json`: the floors of a site, and the lifts and stairs that join them.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use super::{CABIN_M, LabeledFloor, SiteError, SiteFile, pose};
use crate::document::{FileRecord, MapInfo, ProgramInfo, TopologyDocument, layout};
use crate::geom::{Point2, Pose2};
use crate::labels::LabelSet;
use crate::model::sha256_hex;
use crate::syntax::SyntaxError;
use crate::topology::query::UnknownPlace;
use crate::topology::{Connection, Place, PlaceId, Route, Shortcut, TopologicalMap};

/// The value of the member `format` in every document of a site.
pub const FORMAT: &str = "placegraph-site";
/// The version of the format that this program writes and reads.
pub const VERSION: u32 = 1;

/// Levels of the text that get lines of their own: places have one each.
const INDENTED_LEVELS: usize = 5;

/// The content of a `site.json`. The name of a place is unique in the site.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SiteDocument {
    /// [`FORMAT`].
    pub format: String,
    /// [`VERSION`].
    pub version: u32,
    /// The program that wrote the document.
    pub program: ProgramInfo,
    /// Name of the site.
    pub name: String,
    /// The classes, in the order of their labels.
    pub classes: LabelSet,
    /// The floors, in the order of the site file.
    pub levels: Vec<Level>,
    /// The lifts, then the stairs.
    pub shafts: Vec<Shaft>,
    /// What is wrong with the site, in plain words.
    #[serde(default)]
    pub findings: Vec<String>,
    /// The files beside the document, without the folders of the floors.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<FileRecord>,
    /// SHA-256 of the document without this member, in hexadecimal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sha256: Option<String>,
}

/// A floor. Its coordinates are those of its own map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Level {
    /// Name of the level, and of the folder of its result.
    pub level: String,
    /// Its name for people.
    pub name: String,
    /// Its height, in meters.
    pub elevation_m: f64,
    /// Where its map frame lies in the frame of the site.
    pub site_from_map: Pose2,
    /// SHA-256 of the document in the folder of its result, in hexadecimal.
    pub document_sha256: String,
    /// Its map.
    pub map: MapInfo,
    /// Its places, by id.
    pub places: Vec<Place>,
    /// Its connections, by their ends.
    pub connections: Vec<Connection>,
    /// Further ways between doors, by place and ends.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub shortcuts: Vec<Shortcut>,
}

/// What joins floors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ShaftKind {
    /// A lift, which robots take.
    Lift,
    /// Stairs, which people take.
    Stairs,
}

/// A lift, or stairs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shaft {
    /// Its name, which no place has.
    pub name: String,
    /// What it is.
    pub kind: ShaftKind,
    /// Size of the cabin in meters: from the door inwards, and across. Only for a lift.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size_m: Option<[f64; 2]>,
    /// Where it stops, in the order of the floors.
    pub stops: Vec<Stop>,
}

/// Where a lift or stairs can be entered.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stop {
    /// The level.
    pub level: String,
    /// A point in it, or right before it, in meters of the level's map frame.
    pub at: Point2,
    /// The place that contains the point.
    pub place: PlaceId,
    /// From the station of that place to the point.
    pub route: Route,
}

/// Whether `bytes` begin like a `site.json`.
pub fn is_site(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(4096)];
    head.windows(FORMAT.len()).any(|window| window == FORMAT.as_bytes())
}

impl SiteDocument {
    /// The site of `floors`, which are those of `file` in its order. It lists no files yet.
    ///
    /// A place that has the name of its class and number gets that of its level before it, so that its name is unique in the site;
    /// names that people gave stay. A part of a floor that is cut off there is not if a lift joins it to one that is not.
    ///
    /// # Errors
    /// If two places, or a place and a lift, have one name.
    pub fn join(file: &SiteFile, floors: &[LabeledFloor]) -> Result<Self, SiteError> {
        let poses = pose::poses(file);
        let levels = file.floors.iter().zip(floors).zip(&poses).map(|((floor, labeled), &site_from_map)| {
            let TopologyDocument { map, places, connections, shortcuts, sha256, .. } =
                labeled.document.clone();
            Level {
                level: floor.level.clone(),
                name: floor.name.clone().unwrap_or_else(|| floor.level.clone()),
                elevation_m: floor.elevation_m.unwrap_or_default(),
                site_from_map,
                document_sha256: sha256.unwrap_or_default(),
                map,
                places: places.into_iter().map(|place| named(place, &floor.level)).collect(),
                connections,
                shortcuts,
            }
        });
        let shafts = file.shafts().enumerate().map(|(index, (shaft, is_lift))| Shaft {
            name: shaft.name.clone(),
            kind: if is_lift { ShaftKind::Lift } else { ShaftKind::Stairs },
            size_m: is_lift.then(|| shaft.size_m.unwrap_or([CABIN_M; 2])),
            stops: floors.iter().filter_map(|floor| floor.stops[index].clone()).collect(),
        });
        let document = floors.first().map(|floor| &floor.document).ok_or(SiteError::NoFloor)?;
        let mut site = Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            program: ProgramInfo { options: Vec::new(), ..document.program.clone() },
            name: file.name.clone(),
            classes: document.classes.clone(),
            levels: levels.collect(),
            shafts: shafts.collect(),
            findings: pose::remarks(file, &poses),
            files: Vec::new(),
            sha256: None,
        };
        site.check_names()?;
        site.join_cut_off_parts();
        Ok(site)
    }

    /// The floor called `level`, and its position.
    pub fn level(&self, level: &str) -> Option<(usize, &Level)> {
        self.levels.iter().enumerate().find(|(_, found)| found.level == level)
    }

    /// The place called `name`, and the position of its level.
    ///
    /// # Errors
    /// If no place has this name, with those that begin like it.
    pub fn place_called(&self, name: &str) -> Result<(usize, &Place), UnknownPlace> {
        let places = || {
            self.levels
                .iter()
                .enumerate()
                .flat_map(|(level, l)| l.places.iter().map(move |place| (level, place)))
        };
        let known = || places().map(|(_, place)| place.name.clone()).collect();
        places().find(|(_, place)| place.name == name).ok_or_else(|| UnknownPlace::new(name, known()))
    }

    /// The floor at `position` as a document of its own, with the names of the site.
    pub fn document(&self, position: usize) -> TopologyDocument {
        let level = &self.levels[position];
        let mut document = TopologyDocument::new(level.map.clone(), None, &self.classes, &level.topology());
        document.program.clone_from(&self.program);
        document
    }

    /// The text of the document.
    ///
    /// # Errors
    /// If a number is out of the range of JSON; no document made by [`SiteDocument::join`] has one.
    pub fn to_json(&self) -> Result<String, SiteError> {
        layout::to_json(self, INDENTED_LEVELS)
            .map_err(|error| SiteError::Json { error: SyntaxError::of(&error) })
    }

    /// Stores the hash of the document in it.
    ///
    /// # Errors
    /// As [`SiteDocument::to_json`].
    pub fn seal(&mut self) -> Result<(), SiteError> {
        self.sha256 = None;
        self.sha256 = Some(sha256_hex(self.to_json()?.as_bytes()));
        Ok(())
    }

    /// Whether the document is unchanged since it was sealed.
    pub fn is_sealed(&self) -> bool {
        let mut again = self.clone();
        self.sha256.is_some() && again.seal().is_ok() && again.sha256 == self.sha256
    }

    /// Reads a document and checks what other code relies on: every floor like a document of its own, names, and stops.
    ///
    /// # Errors
    /// If the bytes are not JSON of this format and version, have unknown or missing members, or contradict themselves.
    pub fn from_json(bytes: &[u8]) -> Result<Self, SiteError> {
        #[derive(Deserialize)]
        struct Header {
            format: String,
            version: u64,
        }
        let syntax = |error: serde_json::Error| SiteError::Json { error: SyntaxError::of(&error) };
        let header: Header = serde_json::from_slice(bytes).map_err(syntax)?;
        if header.format != FORMAT {
            return Err(SiteError::Format { found: header.format });
        }
        if header.version != u64::from(VERSION) {
            return Err(SiteError::Version { found: header.version });
        }
        let site: Self = serde_json::from_slice(bytes).map_err(syntax)?;
        site.check()?;
        Ok(site)
    }

    fn check(&self) -> Result<(), SiteError> {
        let mut seen = BTreeSet::new();
        for (position, level) in self.levels.iter().enumerate() {
            if !seen.insert(&level.level) {
                return Err(SiteError::DoubleLevel { level: level.level.clone() });
            }
            let pose = [level.site_from_map.x, level.site_from_map.y, level.site_from_map.yaw_rad];
            if let Some(&found) = pose.iter().chain([&level.elevation_m]).find(|v| !(-1e9..=1e9).contains(*v))
            {
                return Err(SiteError::Number { of: format!("level {}", level.level), found });
            }
            let in_level = |error| SiteError::Level { level: level.level.clone(), error };
            self.document(position).check().map_err(in_level)?;
        }
        for shaft in &self.shafts {
            for Stop { level, at, place, route } in &shaft.stops {
                let is_there = self.level(level).is_some_and(|(_, level)| level.place(*place).is_some());
                if !is_there || route.line.is_empty() {
                    return Err(SiteError::Stop {
                        shaft: shaft.name.clone(),
                        level: level.clone(),
                        place: place.0,
                    });
                }
                let numbers = route.line.iter().chain([at]).flat_map(|point| [point.x, point.y]);
                let lengths = [route.length_m, route.clearance_m.unwrap_or_default()];
                if let Some(found) = numbers.chain(lengths).find(|v| !(-1e9..=1e9).contains(v)) {
                    return Err(SiteError::Number { of: format!("{} on {level}", shaft.name), found });
                }
            }
        }
        self.check_names()
    }

    fn check_names(&self) -> Result<(), SiteError> {
        let mut level_of: BTreeMap<&str, &str> = BTreeMap::new();
        let shafts = self.shafts.iter().map(|shaft| (shaft.name.as_str(), "its own"));
        let places = self
            .levels
            .iter()
            .flat_map(|level| level.places.iter().map(|place| (place.name.as_str(), level.level.as_str())));
        for (name, level) in shafts.chain(places) {
            if let Some(other) = level_of.insert(name, level) {
                let levels = [other, level].map(str::to_owned);
                return Err(SiteError::DoublePlace { name: name.to_owned(), levels });
            }
        }
        Ok(())
    }

    /// Parts that a lift joins to what is not cut off are not, either.
    fn join_cut_off_parts(&mut self) {
        let is_cut_off: BTreeMap<(usize, PlaceId), bool> = self
            .levels
            .iter()
            .enumerate()
            .flat_map(|(level, l)| l.places.iter().map(move |place| ((level, place.id), place.cut_off)))
            .collect();
        let mut open: Vec<(usize, PlaceId)> =
            is_cut_off.iter().filter(|(_, is_cut_off)| !**is_cut_off).map(|(key, _)| *key).collect();
        let mut reached: BTreeSet<(usize, PlaceId)> = open.iter().copied().collect();
        while let Some((level, place)) = open.pop() {
            let along = self.levels[level].connections.iter().filter(|connection| connection.route.is_some());
            let beside = along
                .filter(|connection| connection.a == place || connection.b == place)
                .map(|connection| (level, connection.other_end(place)));
            let key = |stop: &Stop| Some((self.level(&stop.level)?.0, stop.place));
            let lifts = self.shafts.iter().filter(|shaft| shaft.kind == ShaftKind::Lift);
            let above = lifts
                .filter(|lift| lift.stops.iter().any(|stop| key(stop) == Some((level, place))))
                .flat_map(|lift| lift.stops.iter().filter_map(key));
            for next in beside.chain(above).collect::<Vec<_>>() {
                if reached.insert(next) {
                    open.push(next);
                }
            }
        }
        for (position, level) in self.levels.iter_mut().enumerate() {
            for place in &mut level.places {
                place.cut_off = !reached.contains(&(position, place.id));
            }
        }
    }
}

/// `place` with a name that no other level has, unless people gave it one.
fn named(place: Place, level: &str) -> Place {
    let is_automatic = place.name == format!("{} {}", place.class, place.id.0);
    let name = if is_automatic { format!("{level} {}", place.name) } else { place.name.clone() };
    Place { name, ..place }
}

impl Level {
    /// The place numbered `id`.
    pub fn place(&self, id: PlaceId) -> Option<&Place> {
        self.places.binary_search_by_key(&id, |place| place.id).ok().map(|index| &self.places[index])
    }

    /// Its places and connections.
    pub fn topology(&self) -> TopologicalMap {
        TopologicalMap {
            places: self.places.clone(),
            connections: self.connections.clone(),
            shortcuts: self.shortcuts.clone(),
            last_id: self.places.last().map_or(PlaceId(0), |place| place.id),
        }
    }
}
