//! A recording of ROS 2 (MCAP) with what the ROS node publishes: grids of labels and places, markers, the document.
//!
//! Every channel is latched (`offered_qos_profiles` says transient local): who subscribes while it is played gets the last message.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::time::Duration;

use mcap::records::MessageHeader;
use mcap::{WriteOptions, Writer};
use serde::Serialize;

use super::ExportError;
use crate::geom::Point2;
use crate::grid::{Grid, GridShape, Occupancy};
use crate::labels::LabelSet;
use crate::messages::{
    Color, Header, MapMetaData, Marker, MarkerArray, OccupancyGrid, Point, Pose, Quaternion, Text, Time,
    to_cdr,
};
use crate::topology::{Place, PlaceRaster, TopologicalMap};

/// A type of ROS and the text of its definition.
type Schema = (&'static str, &'static str);

const GRID: Schema =
    ("nav_msgs/msg/OccupancyGrid", include_str!("../../assets/ros2msg/OccupancyGrid.ros2msg"));
const MARKERS: Schema =
    ("visualization_msgs/msg/MarkerArray", include_str!("../../assets/ros2msg/MarkerArray.ros2msg"));
const TEXT: Schema = ("std_msgs/msg/String", include_str!("../../assets/ros2msg/String.ros2msg"));

/// What rosbag2 writes of a latched topic.
const LATCHED: &str = "- history: keep_last\n  depth: 1\n  reliability: reliable\n  durability: transient_local\n  \
    deadline:\n    sec: 9223372036\n    nsec: 854775807\n  lifespan:\n    sec: 9223372036\n    nsec: 854775807\n  \
    liveliness: automatic\n  liveliness_lease_duration:\n    sec: 9223372036\n    nsec: 854775807\n  \
    avoid_ros_namespace_conventions: false\n";

/// What a recording is made of.
#[derive(Debug)]
pub struct RecordingInput<'a> {
    /// The places.
    pub map: &'a TopologicalMap,
    /// The classes.
    pub labels: &'a LabelSet,
    /// The grid of the map.
    pub shape: &'a GridShape,
    /// Name of the frame.
    pub frame_id: &'a str,
    /// The map's cells, if they are known.
    pub occupancy: Option<&'a Grid<Occupancy>>,
    /// `topology.json`.
    pub document: String,
    /// The time of every message, since 1970.
    pub written: Duration,
    /// What wrote the file.
    pub library: &'a str,
}

/// The bytes of the recording: `/map` if the cells are known, and below `/placegraph/` `labels` (k for the k-th class), `regions`
/// (numbers of places from 1 to 100 and then from 1 again), `markers` and `topology`. Cells of no place are −1.
///
/// # Errors
/// What the writer says; never for maps of less than 4 GB.
pub fn recording(input: &RecordingInput<'_>) -> Result<Vec<u8>, ExportError> {
    let stamp = Time::from_ns(nanoseconds(input.written));
    let header = Header { stamp, frame_id: input.frame_id.to_owned() };
    let raster = PlaceRaster::new(input.map, *input.shape);
    let of_places = |value: &dyn Fn(&Place) -> i8| {
        let mut grid = empty_grid(input.shape, &header);
        for y in 0..input.shape.height {
            let start = y as usize * input.shape.width as usize;
            for span in raster.row(y) {
                let Some(place) = input.map.place(span.place) else { continue };
                grid.data[start + span.start as usize..start + span.end as usize].fill(value(place));
            }
        }
        grid
    };
    let label = |place: &Place| input.labels.label(&place.class).map_or(-1, |label| label.0 as i8 + 1);
    let number = |place: &Place| (place.id.0.saturating_sub(1) % 100 + 1) as i8;

    let mut file = Recording::new(input)?;
    if let Some(occupancy) = input.occupancy {
        let data = occupancy.values().iter().map(|state| match state {
            Occupancy::Free => 0,
            Occupancy::Occupied => 100,
            Occupancy::Unknown => -1,
        });
        file.add("/map", GRID, &OccupancyGrid { data: data.collect(), ..empty_grid(input.shape, &header) })?;
    }
    file.add("/placegraph/labels", GRID, &of_places(&label))?;
    file.add("/placegraph/regions", GRID, &of_places(&number))?;
    file.add("/placegraph/markers", MARKERS, &markers(input.map, input.labels, &header))?;
    file.add("/placegraph/topology", TEXT, &Text { data: input.document.clone() })?;
    file.finish()
}

fn nanoseconds(since_1970: Duration) -> u64 {
    u64::try_from(since_1970.as_nanos()).unwrap_or(u64::MAX)
}

fn empty_grid(shape: &GridShape, header: &Header) -> OccupancyGrid {
    let origin = shape.frame.map_from_grid();
    let info = MapMetaData {
        map_load_time: header.stamp,
        resolution: shape.frame.resolution_m() as f32,
        width: shape.width,
        height: shape.height,
        origin: Pose {
            position: Point { x: origin.x, y: origin.y, z: 0.0 },
            orientation: Quaternion::from_yaw(origin.yaw_rad),
        },
    };
    let n_cells = shape.width as usize * shape.height as usize;
    OccupancyGrid { header: header.clone(), info, data: vec![-1; n_cells] }
}

// Types and actions of `visualization_msgs/Marker`.
const LINE_LIST: i32 = 5;
const SPHERE_LIST: i32 = 7;
const TEXT_VIEW_FACING: i32 = 9;
const DELETE_ALL: i32 = 3;

// Heights in meters: lines above the map, names above lines.
const OUTLINE_Z: f64 = 0.02;
const GRAPH_Z: f64 = 0.04;
const DOOR_Z: f64 = 0.06;
const NAME_Z: f64 = 0.10;

const BLACK: Color = Color { r: 0.0, g: 0.0, b: 0.0, a: 1.0 };
const DOOR: Color = Color { r: 0.84, g: 0.37, b: 0.0, a: 1.0 };

/// Outlines, graph, doors and names as markers; first of all one that deletes what was there before. A marker of a place has the
/// place's number.
fn markers(map: &TopologicalMap, labels: &LabelSet, header: &Header) -> MarkerArray {
    let new = |ns: &str, id: u32, kind, scale: [f64; 3], color| {
        let [x, y, z] = scale;
        let pose = Pose { orientation: Quaternion::from_yaw(0.0), ..Pose::default() };
        let (header, ns, id, scale) = (header.clone(), ns.to_owned(), id as i32, Point { x, y, z });
        Marker { header, ns, id, kind, pose, scale, color, ..Marker::default() }
    };
    let clear = Marker { action: DELETE_ALL, ..new("", 0, LINE_LIST, [0.0; 3], BLACK) };
    let mut markers = vec![clear];
    for place in &map.places {
        let points = place.rings().flat_map(|ring| {
            let closed: Vec<Point2> = ring.iter().chain(ring.first()).copied().collect();
            pieces(&closed, OUTLINE_Z)
        });
        let outline = new("outlines", place.id.0, LINE_LIST, [0.04, 0.0, 0.0], color_of(place, labels));
        markers.push(Marker { points: points.collect(), ..outline });
    }
    let routes = map.connections.iter().filter_map(|connection| connection.route.as_ref());
    let ways = routes.flat_map(|route| pieces(&route.line, GRAPH_Z)).collect();
    let stations = map.places.iter().map(|place| at(place.anchor, GRAPH_Z)).collect();
    markers.push(Marker { points: ways, ..new("graph", 0, LINE_LIST, [0.05, 0.0, 0.0], BLACK) });
    markers.push(Marker { points: stations, ..new("graph", 1, SPHERE_LIST, [0.2; 3], BLACK) });
    for place in &map.places {
        markers.push(if let Some(doorway) = &place.doorway {
            let points = doorway.jambs.map(|jamb| at(jamb, DOOR_Z)).to_vec();
            Marker { points, ..new("doors", place.id.0, LINE_LIST, [0.08, 0.0, 0.0], DOOR) }
        } else {
            let height_m = (place.clearance_m / 2.0).clamp(0.2, 0.6);
            let mut name = new("names", place.id.0, TEXT_VIEW_FACING, [0.0, 0.0, height_m], BLACK);
            name.pose.position = at(place.anchor, NAME_Z);
            Marker { text: place.name.clone(), ..name }
        });
    }
    MarkerArray { markers }
}

fn color_of(place: &Place, labels: &LabelSet) -> Color {
    labels.label(&place.class).map_or(BLACK, |label| {
        let [r, g, b] = labels.class(label).color.map(|value| f32::from(value) / 255.0);
        Color { r, g, b, a: 1.0 }
    })
}

fn at(point: Point2, z: f64) -> Point {
    Point { x: point.x, y: point.y, z }
}

/// The ends of every piece of a line, as lists of lines have them.
fn pieces(line: &[Point2], z: f64) -> Vec<Point> {
    line.windows(2).flat_map(|ends| [at(ends[0], z), at(ends[1], z)]).collect()
}

/// A file that messages are added to.
struct Recording {
    writer: Writer<Cursor<Vec<u8>>>,
    schemas: BTreeMap<&'static str, u16>,
    time_ns: u64,
}

impl Recording {
    fn new(input: &RecordingInput<'_>) -> Result<Self, ExportError> {
        let options = WriteOptions::new().profile("ros2").library(input.library).compression(None);
        let writer =
            options.create(Cursor::new(Vec::new())).map_err(|error| ExportError::writer("MCAP", &error))?;
        Ok(Self { writer, schemas: BTreeMap::new(), time_ns: nanoseconds(input.written) })
    }

    fn add<T: Serialize>(&mut self, topic: &str, schema: Schema, message: &T) -> Result<(), ExportError> {
        let failed = |error: &dyn std::fmt::Display| ExportError::writer("MCAP", &error.to_string());
        let bytes = to_cdr(message).map_err(|error| failed(&error))?;
        let (name, text) = schema;
        let schema_id = match self.schemas.get(name) {
            Some(&id) => id,
            None => {
                self.writer.add_schema(name, "ros2msg", text.as_bytes()).map_err(|error| failed(&error))?
            }
        };
        self.schemas.insert(name, schema_id);
        let about = BTreeMap::from([("offered_qos_profiles".to_owned(), LATCHED.to_owned())]);
        let channel_id =
            self.writer.add_channel(schema_id, topic, "cdr", &about).map_err(|error| failed(&error))?;
        let header =
            MessageHeader { channel_id, sequence: 0, log_time: self.time_ns, publish_time: self.time_ns };
        self.writer.write_to_known_channel(&header, &bytes).map_err(|error| failed(&error))
    }

    fn finish(mut self) -> Result<Vec<u8>, ExportError> {
        self.writer.finish().map_err(|error| ExportError::writer("MCAP", &error))?;
        Ok(self.writer.into_inner().into_inner())
    }
}
