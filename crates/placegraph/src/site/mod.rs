//! Sites of several floors: each is a labeled map of its own; lifts and stairs join them to one topological map (`docs/sites.md`).
//!
//! [`SiteFile`] says which maps are the floors. [`stops`] finds the places that lifts and stairs stop at, [`SiteDocument::join`]
//! joins the floors, and [`SiteDocument::route`] finds the way from a place of one floor to that of another.

mod document;
mod error;
mod file;
mod files;
mod pose;
mod route;

pub use document::{FORMAT, Level, Shaft, ShaftKind, SiteDocument, Stop, VERSION, is_site};
pub use error::SiteError;
pub use file::{CABIN_M, Floor, STOREY_M, Shaft as ShaftEntry, SiteFile};
pub use route::{Leg, RIDE_M, SiteRoute};

use crate::document::TopologyDocument;
use crate::geom::Point2;
use crate::pipeline::Analysis;
use crate::topology::{Approach, approaches};

/// Name of the document in the folder of a site.
pub const DOCUMENT: &str = "site.json";

/// A labeled floor.
#[derive(Clone, Debug)]
pub struct LabeledFloor {
    /// The document of its result.
    pub document: TopologyDocument,
    /// Where lifts and stairs stop on it ([`stops`]).
    pub stops: Vec<Option<Stop>>,
}

/// Where each of the lifts and stairs of `file` stops on `level`, whose map was labeled for a robot that needs `radius_m` meters on
/// all sides. Stairs are for people: the robot need not fit.
///
/// # Errors
/// If one is not in free space, in no place, or where the robot does not get.
pub fn stops(
    file: &SiteFile,
    level: &str,
    analysis: &Analysis,
    radius_m: f64,
) -> Result<Vec<Option<Stop>>, SiteError> {
    let entrances = file.entrances(level);
    let of_kind = |is_wanted: bool| {
        let kinds = entrances.iter().zip(file.shafts());
        kinds.filter(move |(_, (_, is_lift))| *is_lift == is_wanted).filter_map(|(at, _)| *at)
    };
    let reach = |points: Vec<Point2>, radius_m: f64| {
        let Analysis { topology, space, regions, place_ids, .. } = analysis;
        if points.is_empty() {
            return Vec::new();
        }
        approaches(topology, space, regions, place_ids, radius_m, &points)
    };
    let lifts = reach(of_kind(true).collect(), radius_m);
    let stairs = reach(of_kind(false).collect(), 0.0);
    let mut found = lifts.into_iter().chain(stairs);
    let stop = |((shaft, _), at): ((&ShaftEntry, bool), &Option<Point2>)| {
        let Some(at) = *at else { return Ok(None) };
        let (shaft, level) = (shaft.name.clone(), level.to_owned());
        match found.next() {
            Some(Approach::From { place, route }) => Ok(Some(Stop { level, at, place, route })),
            Some(Approach::TooNarrow { place }) => {
                let place =
                    analysis.topology.place(place).map(|place| place.name.clone()).unwrap_or_default();
                Err(SiteError::TooNarrow { shaft, level, place, radius_m })
            }
            Some(Approach::NotFree) => Err(SiteError::NotFree { shaft, level, x: at.x, y: at.y }),
            Some(Approach::NoPlace) | None => Err(SiteError::NoPlace { shaft, level, x: at.x, y: at.y }),
        }
    };
    file.shafts().zip(&entrances).map(stop).collect()
}
