//! Open-RMF: the navigation graph of fleet adapters, and the building file of the traffic editor.
//!
//! Lanes are straight, so every bend of a route is a vertex. A doorway becomes one vertex on each of its sides,
//! lanes between them, and a door from jamb to jamb. A lane names the door that it crosses, which is how RMF's own editor
//! finds out when it makes a navigation graph of a building file. Coordinates are meters of the
//! map frame, y up.

mod building;
mod graph;
mod lift;

use std::borrow::Cow;
use std::collections::BTreeMap;

use serde::Serialize;
use serde_saphyr::FlowSeq;

use self::graph::Graph;
use self::lift::NavLift;
use super::ExportError;
use super::nav2_masks::gray_png;
use super::yaml::{tenth_mm, xy, yaml_bytes};
use crate::geom::Point2;
use crate::grid::{Grid, GridShape};
use crate::topology::{PlaceId, PlaceRaster, TopologicalMap};
pub use building::rmf_building;

/// A building of one level or several, in the frame of the building.
#[derive(Clone, Debug, PartialEq)]
pub struct RmfBuilding<'a> {
    /// Its name.
    pub name: String,
    /// Its levels.
    pub levels: Vec<RmfLevel<'a>>,
    /// Its lifts.
    pub lifts: Vec<RmfLift>,
}

/// A level of a building.
#[derive(Clone, Debug, PartialEq)]
pub struct RmfLevel<'a> {
    /// Its name.
    pub name: String,
    /// Its height, in meters.
    pub elevation_m: f64,
    /// Its places.
    pub map: Cow<'a, TopologicalMap>,
    /// The grid that their outlines run along.
    pub shape: GridShape,
    /// File name of the picture that the editor shows under the level ([`rmf_background`]).
    pub background: String,
}

/// A lift of a building.
#[derive(Clone, Debug, PartialEq)]
pub struct RmfLift {
    /// Its name.
    pub name: String,
    /// Size of the cabin: from the door of the first stop inwards, and across.
    pub size_m: [f64; 2],
    /// Where it stops. The cabin stands where it is on the first of these levels.
    pub stops: Vec<RmfStop>,
}

/// Where a lift stops.
#[derive(Clone, Debug, PartialEq)]
pub struct RmfStop {
    /// Position of the level in the building.
    pub level: usize,
    /// The place that leads into the cabin.
    pub place: PlaceId,
    /// From the place's station to the cabin.
    pub line: Vec<Point2>,
}

impl<'a> RmfBuilding<'a> {
    /// A building of a single level.
    pub fn of_level(
        name: &str,
        level: &str,
        map: &'a TopologicalMap,
        shape: GridShape,
        background: &str,
    ) -> Self {
        let level = RmfLevel {
            name: level.to_owned(),
            elevation_m: 0.0,
            map: Cow::Borrowed(map),
            shape,
            background: background.to_owned(),
        };
        Self { name: name.to_owned(), levels: vec![level], lifts: Vec::new() }
    }

    /// The lifts that stop on the level at `position`, and where.
    fn stops_on(&self, position: usize) -> Vec<(&RmfLift, &RmfStop)> {
        let stops = self.lifts.iter().flat_map(|lift| lift.stops.iter().map(move |stop| (lift, stop)));
        stops.filter(|(_, stop)| stop.level == position).collect()
    }
}

/// The navigation graph of the places that are not cut off.
///
/// # Errors
/// None for maps that this library built.
pub fn rmf_nav_graph(building: &RmfBuilding<'_>) -> Result<Vec<u8>, ExportError> {
    #[derive(Serialize)]
    struct NavGraph<'a> {
        building_name: &'a str,
        levels: BTreeMap<&'a str, Level>,
        doors: BTreeMap<String, Door<'a>>,
        lifts: BTreeMap<&'a str, NavLift>,
    }
    #[derive(Serialize)]
    struct Level {
        vertices: Vec<(f64, f64, VertexOptions)>,
        lanes: Vec<(usize, usize, LaneOptions)>,
    }
    #[derive(Serialize)]
    struct VertexOptions {
        name: String,
        // Readers may ask for these three. What a vertex is used for, the operator says.
        is_charger: bool,
        is_holding_point: bool,
        is_parking_spot: bool,
        #[serde(skip_serializing_if = "Option::is_none")]
        lift: Option<String>,
    }
    #[derive(Serialize)]
    struct LaneOptions {
        /// 0 is no limit.
        speed_limit: f64,
        #[serde(skip_serializing_if = "Option::is_none")]
        door_name: Option<String>,
    }
    #[derive(Serialize)]
    struct Door<'a> {
        endpoints: [FlowSeq<[f64; 2]>; 2],
        map: &'a str,
    }

    let (mut levels, mut doors) = (BTreeMap::new(), BTreeMap::new());
    for (position, level) in building.levels.iter().enumerate() {
        let reached = level.map.reached();
        let graph = Graph::new(&reached, level, &building.stops_on(position));
        let vertices = graph.vertices.iter().map(|vertex| {
            let options = VertexOptions {
                name: vertex.name.clone(),
                is_charger: false,
                is_holding_point: false,
                is_parking_spot: false,
                lift: vertex.lift.map(str::to_owned),
            };
            (tenth_mm(vertex.at.x), tenth_mm(vertex.at.y), options)
        });
        let lanes = graph.lanes.iter().flat_map(|lane| {
            let door_name = graph.door_on(lane);
            let options = || LaneOptions { speed_limit: 0.0, door_name: door_name.map(str::to_owned) };
            [(lane.from, lane.to, options()), (lane.to, lane.from, options())]
        });
        levels.insert(level.name.as_str(), Level { vertices: vertices.collect(), lanes: lanes.collect() });
        doors.extend(
            graph
                .doors
                .iter()
                .map(|&(name, jambs)| (name.to_owned(), Door { endpoints: jambs.map(xy), map: &level.name })),
        );
    }
    let lifts = building.lifts.iter().filter_map(|lift| Some((lift.name.as_str(), NavLift::of(lift)?)));
    let file = NavGraph { building_name: &building.name, levels, doors, lifts: lifts.collect() };
    yaml_bytes(&file, "RMF navigation graph")
}

/// The picture that the building file shows: places white on gray, the first row the lowest, as the editor wants it.
///
/// # Errors
/// None for maps that this library built.
pub fn rmf_background(map: &TopologicalMap, shape: &GridShape) -> Result<Vec<u8>, ExportError> {
    let raster = PlaceRaster::new(map, *shape);
    let mut cells = Grid::filled(shape.width, shape.height, 90u8);
    for y in 0..shape.height {
        for span in raster.row(y) {
            let start = y as usize * shape.width as usize;
            cells.values_mut()[start + span.start as usize..start + span.end as usize].fill(255);
        }
    }
    gray_png(&cells, cells.values())
}
