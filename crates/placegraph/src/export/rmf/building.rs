//! The building file of the traffic editor.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_saphyr::FlowSeq;

use super::graph::Graph;
use super::lift::BuildingLift;
use super::{RmfBuilding, RmfLevel, RmfLift, RmfStop};
use crate::export::ExportError;
use crate::export::yaml::{tenth_mm, yaml_bytes};
use crate::geom::Point2;
use crate::grid::GridShape;

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
