//! Open-RMF: the navigation graph of fleet adapters, and the building file of the traffic editor.
//!
//! Lanes are straight, so every bend of a route is a vertex. A doorway becomes one vertex on each of its sides,
//! lanes between them, and a door from jamb to jamb. A lane names the door that it crosses, which is how RMF's own editor
//! finds out when it makes a navigation graph of a building file. Coordinates are meters of the
//! map frame, y up.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_saphyr::FlowSeq;

use super::ExportError;
use super::nav2_masks::gray_png;
use super::yaml::{tenth_mm, xy, yaml_bytes};
use crate::geom::Point2;
use crate::grid::{Grid, GridShape};
use crate::topology::{Connection, Place, PlaceId, PlaceRaster, TopologicalMap, segments_cross};

/// Names of the building and of its only level.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RmfInfo {
    /// Name of the building.
    pub building: String,
    /// Name of the level.
    pub level: String,
    /// File name of the picture that the editor shows under the building ([`rmf_background`]).
    pub background: String,
}

/// How far before and behind the door its vertices stand, in meters: the first that a straight lane through
/// free cells joins.
const DOOR_STANDOFFS_M: [f64; 5] = [0.8, 0.6, 0.4, 0.25, 0.1];

struct Vertex {
    at: Point2,
    name: String,
}

/// A straight way, to be driven in both directions.
struct Lane {
    from: usize,
    to: usize,
}

struct Graph<'a> {
    vertices: Vec<Vertex>,
    lanes: Vec<Lane>,
    /// Name and jambs of the doors.
    doors: Vec<(&'a str, [Point2; 2])>,
}

/// The navigation graph of what is not cut off in `map`.
///
/// # Errors
/// None for maps that this library built.
pub fn rmf_nav_graph(
    map: &TopologicalMap,
    shape: &GridShape,
    info: &RmfInfo,
) -> Result<Vec<u8>, ExportError> {
    #[derive(Serialize)]
    struct NavGraph<'a> {
        building_name: &'a str,
        levels: BTreeMap<&'a str, Level<'a>>,
        doors: BTreeMap<&'a str, Door<'a>>,
        lifts: BTreeMap<&'a str, ()>,
    }
    #[derive(Serialize)]
    struct Level<'a> {
        vertices: Vec<(f64, f64, VertexOptions<'a>)>,
        lanes: Vec<(usize, usize, LaneOptions<'a>)>,
    }
    #[derive(Serialize)]
    struct VertexOptions<'a> {
        name: &'a str,
        // Readers may ask for these three. What a vertex is used for, the operator says.
        is_charger: bool,
        is_holding_point: bool,
        is_parking_spot: bool,
    }
    impl<'a> VertexOptions<'a> {
        fn named(name: &'a str) -> Self {
            Self { name, is_charger: false, is_holding_point: false, is_parking_spot: false }
        }
    }
    #[derive(Serialize)]
    struct LaneOptions<'a> {
        /// 0 is no limit.
        speed_limit: f64,
        #[serde(skip_serializing_if = "Option::is_none")]
        door_name: Option<&'a str>,
    }
    #[derive(Serialize)]
    struct Door<'a> {
        endpoints: [FlowSeq<[f64; 2]>; 2],
        map: &'a str,
    }

    let reached = map.reached();
    let graph = Graph::new(&reached, shape);
    let vertices = graph
        .vertices
        .iter()
        .map(|vertex| (tenth_mm(vertex.at.x), tenth_mm(vertex.at.y), VertexOptions::named(&vertex.name)));
    let lanes = graph.lanes.iter().flat_map(|lane| {
        let door_name = graph.door_on(lane);
        let options = || LaneOptions { speed_limit: 0.0, door_name };
        [(lane.from, lane.to, options()), (lane.to, lane.from, options())]
    });
    let level = Level { vertices: vertices.collect(), lanes: lanes.collect() };
    let doors =
        graph.doors.iter().map(|&(name, jambs)| (name, Door { endpoints: jambs.map(xy), map: &info.level }));
    let file = NavGraph {
        building_name: &info.building,
        levels: BTreeMap::from([(info.level.as_str(), level)]),
        doors: doors.collect(),
        lifts: BTreeMap::new(),
    };
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
struct DoorParameters<'a> {
    motion_axis: Parameter<&'a str>,
    motion_degrees: Parameter<f64>,
    motion_direction: Parameter<i64>,
    name: Parameter<&'a str>,
    plugin: Parameter<&'a str>,
    right_left_ratio: Parameter<f64>,
    #[serde(rename = "type")]
    kind: Parameter<&'a str>,
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
#[expect(clippy::type_complexity, reason = "the tuples of the format")]
struct BuildingLevel<'a> {
    layers: BTreeMap<&'a str, Layer<'a>>,
    elevation: f64,
    vertices: Vec<(f64, f64, f64, &'a str, BTreeMap<&'a str, ()>)>,
    lanes: Vec<(usize, usize, LaneParameters<'a>)>,
    doors: Vec<(usize, usize, DoorParameters<'a>)>,
    floors: Vec<Floor<'a>>,
    walls: [(); 0],
    measurements: [(); 0],
}

#[derive(Serialize)]
struct Building<'a> {
    name: &'a str,
    coordinate_system: &'a str,
    levels: BTreeMap<&'a str, BuildingLevel<'a>>,
    lifts: BTreeMap<&'a str, ()>,
}

/// The building file of `map`, in Cartesian meters: lanes, doors, and a floor per place.
///
/// # Errors
/// None for maps that this library built.
pub fn rmf_building(map: &TopologicalMap, shape: &GridShape, info: &RmfInfo) -> Result<Vec<u8>, ExportError> {
    let reached = map.reached();
    let graph = Graph::new(&reached, shape);
    let corner = |at: Point2, name| (tenth_mm(at.x), tenth_mm(at.y), 0.0, name, BTreeMap::new());
    let mut vertices: Vec<_> =
        graph.vertices.iter().map(|vertex| corner(vertex.at, vertex.name.as_str())).collect();
    let lanes = graph.lanes.iter().map(|lane| {
        let parameters =
            LaneParameters { bidirectional: boolean(true), graph_idx: integer(0), orientation: string("") };
        (lane.from, lane.to, parameters)
    });
    let lanes = lanes.collect();
    let mut doors = Vec::new();
    for &(name, jambs) in &graph.doors {
        doors.push((vertices.len(), vertices.len() + 1, door_parameters(name)));
        vertices.extend(jambs.map(|jamb| corner(jamb, "")));
    }
    let mut floors = Vec::new();
    for part in map.places.iter().flat_map(|place| &place.outline) {
        let first = vertices.len();
        let outline = simplified(&part.exterior, SIMPLER_CELLS * shape.frame.resolution_m());
        vertices.extend(outline.into_iter().map(|at| corner(at, "")));
        let parameters = FloorParameters {
            texture_name: string("blue_linoleum"),
            texture_rotation: double(0.0),
            texture_scale: double(1.0),
        };
        floors.push(Floor { parameters, vertices: FlowSeq((first..vertices.len()).collect()) });
    }
    let level = BuildingLevel {
        layers: BTreeMap::from([("map", Layer::of(shape, &info.background))]),
        elevation: 0.0,
        vertices,
        lanes,
        doors,
        floors,
        walls: [],
        measurements: [],
    };
    let file = Building {
        name: &info.building,
        coordinate_system: "cartesian_meters",
        levels: BTreeMap::from([(info.level.as_str(), level)]),
        lifts: BTreeMap::new(),
    };
    yaml_bytes(&file, "RMF building")
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

fn door_parameters(name: &str) -> DoorParameters<'_> {
    DoorParameters {
        motion_axis: string("start"),
        motion_degrees: double(90.0),
        motion_direction: integer(1),
        name: string(name),
        plugin: string("normal"),
        right_left_ratio: double(1.0),
        kind: string("hinged"),
    }
}

impl<'a> Graph<'a> {
    fn new(map: &'a TopologicalMap, shape: &GridShape) -> Self {
        let raster = PlaceRaster::new(map, *shape);
        let mut graph = Self { vertices: Vec::new(), lanes: Vec::new(), doors: Vec::new() };
        // Vertex where a connection's line meets a place: the place's own, or one before the door.
        let mut gate_of: BTreeMap<(PlaceId, PlaceId), usize> = BTreeMap::new();
        let mut standoff_of: BTreeMap<PlaceId, f64> = BTreeMap::new();
        for place in &map.places {
            let gates = graph.add_place(map, place, &raster, &mut standoff_of);
            gate_of.extend(gates.into_iter().map(|(other, vertex)| ((place.id, other), vertex)));
        }
        for connection in map.connections.iter().filter(|connection| connection.route.is_some()) {
            let ends = [(connection.a, connection.b), (connection.b, connection.a)];
            let [Some(&from), Some(&to)] = ends.map(|key| gate_of.get(&key)) else { continue };
            let [cut_a, cut_b] =
                [connection.a, connection.b].map(|id| standoff_of.get(&id).copied().unwrap_or(0.0));
            graph.add_route(connection, [cut_a, cut_b], [from, to]);
        }
        graph
    }

    /// Adds the vertices of `place`; returns for every neighbor the vertex that leads to it.
    fn add_place(
        &mut self,
        map: &TopologicalMap,
        place: &'a Place,
        raster: &PlaceRaster,
        standoff_of: &mut BTreeMap<PlaceId, f64>,
    ) -> Vec<(PlaceId, usize)> {
        let lines: Vec<(PlaceId, Vec<Point2>)> = map
            .connections_of(place.id)
            .filter(|connection| connection.route.is_some())
            .map(|connection| (connection.other_end(place.id), connection.line_from(place.id)))
            .collect();
        let jambs = place.doorway.as_ref().filter(|_| lines.len() > 1).map(|doorway| doorway.jambs);
        let Some((jambs, standoff_m)) =
            jambs.and_then(|jambs| Some((jambs, standoff(&lines, jambs, raster)?)))
        else {
            self.vertices.push(Vertex { at: map.station(place), name: place.name.clone() });
            return lines.iter().map(|&(other, _)| (other, self.vertices.len() - 1)).collect();
        };
        standoff_of.insert(place.id, standoff_m);
        self.doors.push((&place.name, jambs));
        let first = self.vertices.len();
        for (side, (_, line)) in lines.iter().enumerate() {
            let name = format!("{}/{}", place.name, side + 1);
            self.vertices.push(Vertex { at: trimmed(line, standoff_m)[0], name });
        }
        for from in first..self.vertices.len() {
            let others = from + 1..self.vertices.len();
            self.lanes.extend(others.map(|to| Lane { from, to }));
        }
        lines.iter().enumerate().map(|(side, &(other, _))| (other, first + side)).collect()
    }

    /// Adds the bends of a route and the lanes between them; `cut` meters at its ends belong to doors.
    fn add_route(&mut self, connection: &Connection, cut: [f64; 2], gates: [usize; 2]) {
        let mut line = trimmed(&connection.line_from(connection.b), cut[1]);
        line.reverse();
        let line = trimmed(&line, cut[0]);
        let mut last = gates[0];
        for &at in &line[1..line.len().max(2) - 1] {
            self.vertices.push(Vertex { at, name: String::new() });
            self.lanes.push(Lane { from: last, to: self.vertices.len() - 1 });
            last = self.vertices.len() - 1;
        }
        self.lanes.push(Lane { from: last, to: gates[1] });
    }

    /// The door that `lane` crosses.
    fn door_on(&self, lane: &Lane) -> Option<&'a str> {
        let [from, to] = [lane.from, lane.to].map(|index| self.vertices[index].at);
        let crossed = |(_, [a, b]): &&(&str, [Point2; 2])| segments_cross(*a, *b, from, to);
        self.doors.iter().find(crossed).map(|&(name, _)| name)
    }
}

/// The first distance from the door at which straight lanes between all its sides run through free cells and one of them crosses
/// the line between the `jambs`, at most half of the shortest line. `None` if there is none.
fn standoff(lines: &[(PlaceId, Vec<Point2>)], jambs: [Point2; 2], raster: &PlaceRaster) -> Option<f64> {
    let shortest = lines.iter().map(|(_, line)| length(line)).min_by(f64::total_cmp)?;
    DOOR_STANDOFFS_M.into_iter().filter(|&standoff_m| standoff_m <= 0.5 * shortest).find(|&standoff_m| {
        let gates: Vec<Point2> = lines.iter().map(|(_, line)| trimmed(line, standoff_m)[0]).collect();
        let lanes =
            || gates.iter().enumerate().flat_map(|(i, &a)| gates[i + 1..].iter().map(move |&b| (a, b)));
        lanes().all(|(a, b)| raster.is_free_between(a, b))
            && lanes().any(|(a, b)| segments_cross(jambs[0], jambs[1], a, b))
    })
}

fn length(line: &[Point2]) -> f64 {
    line.windows(2).map(|ends| ends[0].distance(ends[1])).sum()
}

/// The rest of `line` after its first `cut_m` meters; at least its last point.
fn trimmed(line: &[Point2], cut_m: f64) -> Vec<Point2> {
    let mut left = cut_m;
    for (index, ends) in line.windows(2).enumerate() {
        let leg = ends[0].distance(ends[1]);
        if left < leg {
            let start = ends[0] + (ends[1] - ends[0]) * (left / leg);
            return std::iter::once(start).chain(line[index + 1..].iter().copied()).collect();
        }
        left -= leg;
    }
    line.last().copied().into_iter().collect()
}
