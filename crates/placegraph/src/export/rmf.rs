//! Open-RMF: the navigation graph of fleet adapters, and the building file of the traffic editor.
//!
//! Lanes are straight, so every bend of a route is a vertex. A doorway becomes one vertex on each of its sides,
//! lanes between them, and a door from jamb to jamb. A lane names the door that it crosses, which is how RMF's own editor
//! finds out when it makes a navigation graph of a building file. Coordinates are meters of the
//! map frame, y up.

mod graph;
mod lift;

use std::borrow::Cow;
use std::collections::BTreeMap;

use serde::Serialize;
use serde_saphyr::FlowSeq;

use self::graph::Graph;
use self::lift::{BuildingLift, NavLift};
use super::ExportError;
use super::nav2_masks::gray_png;
use super::yaml::{tenth_mm, xy, yaml_bytes};
use crate::geom::Point2;
use crate::grid::{Grid, GridShape};
use crate::topology::{PlaceId, PlaceRaster, TopologicalMap};

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

/// A parameter of the building file: number of its type, and value.
type Parameter<T> = FlowSeq<(u8, T)>;

fn string(value: &str) -> Parameter<&str> {
    FlowSeq((1, value))
}

fn integer(value: i64) -> Parameter<i64> {
    FlowSeq((2, value))
}

fn double(value: f64) -> Parameter<f64> {
    FlowSeq((3, value))
}

fn boolean(value: bool) -> Parameter<bool> {
    FlowSeq((4, value))
}

#[derive(Serialize)]
struct LaneParameters<'a> {
    bidirectional: Parameter<bool>,
    graph_idx: Parameter<i64>,
    orientation: Parameter<&'a str>,
}

#[derive(Serialize)]
struct DoorParameters {
    motion_axis: Parameter<&'static str>,
    motion_degrees: Parameter<f64>,
    motion_direction: Parameter<i64>,
    name: Parameter<String>,
    plugin: Parameter<&'static str>,
    right_left_ratio: Parameter<f64>,
    #[serde(rename = "type")]
    kind: Parameter<&'static str>,
}

#[derive(Serialize)]
#[expect(clippy::struct_field_names, reason = "the names of the format")]
struct FloorParameters<'a> {
    texture_name: Parameter<&'a str>,
    texture_rotation: Parameter<f64>,
    texture_scale: Parameter<f64>,
}

#[derive(Serialize)]
struct Floor<'a> {
    parameters: FloorParameters<'a>,
    vertices: FlowSeq<Vec<usize>>,
}

/// A picture under the building. The editor places its first pixel at the translation, rows along the turned y axis: in Cartesian meters
/// the first row is the lowest.
#[derive(Serialize)]
struct Layer<'a> {
    filename: &'a str,
    visible: bool,
    color: FlowSeq<[f64; 4]>,
    features: [(); 0],
    transform: LayerTransform,
}

#[derive(Serialize)]
struct LayerTransform {
    /// Clockwise.
    yaw: f64,
    translation_x: f64,
    translation_y: f64,
    /// Meters per pixel.
    scale: f64,
}

impl<'a> Layer<'a> {
    fn of(shape: &GridShape, filename: &'a str) -> Self {
        let origin = shape.frame.map_from_grid();
        let transform = LayerTransform {
            yaw: 0.0 - origin.yaw_rad,
            translation_x: origin.x,
            translation_y: origin.y,
            scale: shape.frame.resolution_m(),
        };
        Self { filename, visible: true, color: FlowSeq([0.2, 0.2, 0.25, 1.0]), features: [], transform }
    }
}

#[derive(Serialize)]
struct BuildingLevel<'a> {
    layers: BTreeMap<&'a str, Layer<'a>>,
    elevation: f64,
    vertices: Vec<(f64, f64, f64, String, VertexParameters)>,
    lanes: Vec<(usize, usize, LaneParameters<'a>)>,
    doors: Vec<(usize, usize, DoorParameters)>,
    floors: Vec<Floor<'a>>,
    walls: [(); 0],
    measurements: [(); 0],
}

#[derive(Default, Serialize)]
struct VertexParameters {
    #[serde(skip_serializing_if = "Option::is_none")]
    lift_cabin: Option<Parameter<String>>,
}

#[derive(Serialize)]
struct Building<'a> {
    name: &'a str,
    coordinate_system: &'a str,
    levels: BTreeMap<&'a str, BuildingLevel<'a>>,
    lifts: BTreeMap<&'a str, BuildingLift<'a>>,
}

/// The building file, in Cartesian meters: lanes, doors, a floor per place, and lifts.
///
/// # Errors
/// None for maps that this library built.
pub fn rmf_building(building: &RmfBuilding<'_>) -> Result<Vec<u8>, ExportError> {
    let levels = building.levels.iter().enumerate();
    let levels = levels.map(|(position, level)| {
        (level.name.as_str(), BuildingLevel::of(level, &building.stops_on(position)))
    });
    let lifts = building.lifts.iter();
    let lifts = lifts.filter_map(|lift| Some((lift.name.as_str(), BuildingLift::of(lift, building)?)));
    let file = Building {
        name: &building.name,
        coordinate_system: "cartesian_meters",
        levels: levels.collect(),
        lifts: lifts.collect(),
    };
    yaml_bytes(&file, "RMF building")
}

impl<'a> BuildingLevel<'a> {
    fn of(level: &'a RmfLevel<'_>, stops: &[(&RmfLift, &RmfStop)]) -> Self {
        let RmfLevel { map, shape, background, elevation_m, .. } = level;
        let reached = map.reached();
        let graph = Graph::new(&reached, level, stops);
        let corner =
            |at: Point2| (tenth_mm(at.x), tenth_mm(at.y), 0.0, String::new(), VertexParameters::default());
        let vertices = graph.vertices.iter().map(|vertex| {
            let lift_cabin = vertex.lift.map(|lift| FlowSeq((1, lift.to_owned())));
            let (x, y, z, ..) = corner(vertex.at);
            (x, y, z, vertex.name.clone(), VertexParameters { lift_cabin })
        });
        let mut vertices: Vec<_> = vertices.collect();
        let lanes = graph.lanes.iter().map(|lane| {
            let parameters = LaneParameters {
                bidirectional: boolean(true),
                graph_idx: integer(0),
                orientation: string(""),
            };
            (lane.from, lane.to, parameters)
        });
        let lanes = lanes.collect();
        let mut doors = Vec::new();
        for &(name, jambs) in &graph.doors {
            doors.push((vertices.len(), vertices.len() + 1, door_parameters(name)));
            vertices.extend(jambs.map(corner));
        }
        let mut floors = Vec::new();
        for part in map.places.iter().flat_map(|place| &place.outline) {
            let first = vertices.len();
            let outline = simplified(&part.exterior, SIMPLER_CELLS * shape.frame.resolution_m());
            vertices.extend(outline.into_iter().map(corner));
            let parameters = FloorParameters {
                texture_name: string("blue_linoleum"),
                texture_rotation: double(0.0),
                texture_scale: double(1.0),
            };
            floors.push(Floor { parameters, vertices: FlowSeq((first..vertices.len()).collect()) });
        }
        Self {
            layers: BTreeMap::from([("map", Layer::of(shape, background))]),
            elevation: *elevation_m,
            vertices,
            lanes,
            doors,
            floors,
            walls: [],
            measurements: [],
        }
    }
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

/// How far a floor's corner may be from the simpler outline, in cells.
const SIMPLER_CELLS: f64 = 1.5;

/// The ring without the corners that are nearer than `tolerance_m` to the line that remains, at least three [Douglas and Peucker 1973].
fn simplified(ring: &[Point2], tolerance_m: f64) -> Vec<Point2> {
    // From its first corner to the one farthest from that, and back.
    let Some(&first) = ring.first() else { return Vec::new() };
    let far = |ring: &[Point2], from: Point2| {
        let distances = ring.iter().map(|point| point.distance(from)).enumerate();
        distances.fold((0, 0.0), |best, next| if next.1 > best.1 { next } else { best }).0
    };
    let opposite = far(ring, first);
    let closed: Vec<Point2> = ring.iter().copied().chain([first]).collect();
    let mut simpler = thinned(&closed[..=opposite], tolerance_m);
    simpler.pop();
    simpler.extend(thinned(&closed[opposite..], tolerance_m));
    simpler.pop();
    if simpler.len() < 3 { ring.to_vec() } else { simpler }
}

fn thinned(line: &[Point2], tolerance_m: f64) -> Vec<Point2> {
    let [first, .., last] = line else { return line.to_vec() };
    let along = *last - *first;
    let length = along.length();
    let off = |point: Point2| {
        if length > 0.0 { (along.cross(point - *first) / length).abs() } else { point.distance(*first) }
    };
    let farthest = line.iter().map(|&point| off(point)).enumerate();
    let (index, distance) = farthest.fold((0, 0.0), |best, next| if next.1 > best.1 { next } else { best });
    if distance <= tolerance_m || index == 0 || index + 1 == line.len() {
        return vec![*first, *last];
    }
    let mut left = thinned(&line[..=index], tolerance_m);
    left.pop();
    left.extend(thinned(&line[index..], tolerance_m));
    left
}

fn door_parameters(name: &str) -> DoorParameters {
    DoorParameters {
        motion_axis: string("start"),
        motion_degrees: double(90.0),
        motion_direction: integer(1),
        name: FlowSeq((1, name.to_owned())),
        plugin: string("normal"),
        right_left_ratio: double(1.0),
        kind: string("hinged"),
    }
}
