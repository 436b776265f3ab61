//! LCAS topological map (tmap2): the YAML file of the topological navigation stack.
//!
//! A node per place at its station, edges in both directions along every route. Vertices of an outline are relative to
//! the node's position; nodes are not turned.

use serde::Serialize;
use std::collections::BTreeMap;

use crate::export::ExportError;
use crate::export::yaml::{tenth_mm, yaml_bytes};
use crate::topology::{Place, PlaceId, TopologicalMap};

/// The metadata of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TmapInfo {
    /// Name of the topological map and of its set of points.
    pub name: String,
    /// Name of the metric map.
    pub metric_map: String,
    /// Name of the frame that coordinates are in.
    pub frame_id: String,
    /// When the map was written, as `MM-DD-YYYY_HH-MM-SS`.
    pub last_updated: String,
}

/// How close a robot must come to a node, in meters, where the clearance allows no more.
const MIN_TOLERANCE_M: f64 = 0.1;

/// How far a robot may stay from a node, in meters.
const MAX_TOLERANCE_M: f64 = 0.5;

#[derive(Serialize)]
struct Tmap<'a> {
    meta: BTreeMap<&'static str, &'a str>,
    name: &'a str,
    metric_map: &'a str,
    pointset: &'a str,
    transformation: Transformation<'a>,
    nodes: Vec<Entry<'a>>,
}

#[derive(Serialize)]
struct Transformation<'a> {
    /// The newer name of the frame that nodes are given in, and the older one.
    topo_frame_id: &'a str,
    child: &'a str,
    parent: &'a str,
    rotation: Rotation,
    translation: Xyz,
}

#[derive(Serialize)]
struct Rotation {
    w: f64,
    x: f64,
    y: f64,
    z: f64,
}

const UNTURNED: Rotation = Rotation { w: 1.0, x: 0.0, y: 0.0, z: 0.0 };

#[derive(Serialize)]
struct Xyz {
    x: f64,
    y: f64,
    z: f64,
}

#[derive(Serialize)]
struct Entry<'a> {
    meta: EntryMeta<'a>,
    node: Node<'a>,
}

#[derive(Serialize)]
struct EntryMeta<'a> {
    map: &'a str,
    node: &'a str,
    pointset: &'a str,
    tag: [&'a str; 1],
}

#[derive(Serialize)]
struct Node<'a> {
    name: &'a str,
    parent_frame: &'a str,
    nav_frame: &'a str,
    pose: Pose,
    verts: Vec<Vertex>,
    edges: Vec<Edge<'a>>,
    properties: Properties<'a>,
    localise_by_topic: &'a str,
}

#[derive(Serialize)]
struct Pose {
    position: Xyz,
    orientation: Rotation,
}

#[derive(Serialize)]
struct Vertex {
    x: f64,
    y: f64,
}

#[derive(Serialize)]
struct Properties<'a> {
    xy_goal_tolerance: f64,
    yaw_goal_tolerance: f64,
    class: &'a str,
    area_m2: f64,
    probability: f64,
}

#[derive(Serialize)]
#[expect(clippy::struct_field_names, reason = "the names of the format")]
struct Edge<'a> {
    edge_id: String,
    node: &'a str,
    action: &'a str,
    action_type: &'a str,
    fail_policy: &'a str,
    fluid_navigation: bool,
    goal: BTreeMap<&'a str, BTreeMap<&'a str, &'a str>>,
    config: [&'a str; 0],
    properties: EdgeProperties,
}

#[derive(Serialize)]
struct EdgeProperties {
    length_m: f64,
}

/// The tmap2 file of the places of `map` that are not cut off.
///
/// # Errors
/// None for maps that this library built.
pub fn tmap2(map: &TopologicalMap, info: &TmapInfo) -> Result<Vec<u8>, ExportError> {
    let map = &map.reached();
    let file = Tmap {
        meta: BTreeMap::from([("last_updated", info.last_updated.as_str())]),
        name: &info.name,
        metric_map: &info.metric_map,
        pointset: &info.name,
        transformation: Transformation {
            topo_frame_id: &info.frame_id,
            child: &info.frame_id,
            parent: &info.frame_id,
            rotation: UNTURNED,
            translation: Xyz { x: 0.0, y: 0.0, z: 0.0 },
        },
        nodes: map.places.iter().map(|place| entry(map, place, info)).collect(),
    };
    yaml_bytes(&file, "tmap2")
}

fn entry<'a>(map: &'a TopologicalMap, place: &'a Place, info: &'a TmapInfo) -> Entry<'a> {
    let station = map.station(place);
    let verts = place.largest_exterior().iter();
    Entry {
        meta: EntryMeta {
            map: &info.metric_map,
            node: &place.name,
            pointset: &info.name,
            tag: [&place.class],
        },
        node: Node {
            name: &place.name,
            parent_frame: &info.frame_id,
            nav_frame: &info.frame_id,
            pose: Pose {
                position: Xyz { x: tenth_mm(station.x), y: tenth_mm(station.y), z: 0.0 },
                orientation: UNTURNED,
            },
            verts: verts
                .map(|corner| *corner - station)
                .map(|offset| Vertex { x: tenth_mm(offset.x), y: tenth_mm(offset.y) })
                .collect(),
            edges: edges(map, place),
            properties: Properties {
                xy_goal_tolerance: tenth_mm(place.clearance_m.clamp(MIN_TOLERANCE_M, MAX_TOLERANCE_M)),
                // Any heading will do.
                yaw_goal_tolerance: tenth_mm(std::f64::consts::TAU),
                class: &place.class,
                area_m2: tenth_mm(place.area_m2),
                probability: tenth_mm(place.probability),
            },
            localise_by_topic: "",
        },
    }
}

/// To every neighbor, and from a doorway to those that a shortcut leads to; one edge for each.
fn edges<'a>(map: &'a TopologicalMap, place: &'a Place) -> Vec<Edge<'a>> {
    let neighbors = map
        .connections_of(place.id)
        .filter_map(|connection| Some((connection.other_end(place.id), connection.route.as_ref()?)));
    let shortcuts = map.shortcuts.iter().filter_map(|way| match place.id {
        id if id == way.a => Some((way.b, &way.route)),
        id if id == way.b => Some((way.a, &way.route)),
        _ => None,
    });
    let mut shortest: BTreeMap<PlaceId, f64> = BTreeMap::new();
    for (other, route) in neighbors.chain(shortcuts) {
        let length_m = shortest.entry(other).or_insert(f64::INFINITY);
        *length_m = length_m.min(route.length_m);
    }
    shortest.into_iter().filter_map(|(other, length_m)| edge(map, place, other, length_m)).collect()
}

fn edge<'a>(map: &'a TopologicalMap, place: &'a Place, other: PlaceId, length_m: f64) -> Option<Edge<'a>> {
    let other = map.place(other)?;
    let target = BTreeMap::from([("header", "$node.parent_frame"), ("pose", "$node.pose")]);
    Some(Edge {
        edge_id: format!("{}_{}", place.name, other.name),
        node: &other.name,
        action: "NavigateToPose",
        action_type: "geometry_msgs/PoseStamped",
        fail_policy: "fail",
        fluid_navigation: true,
        goal: BTreeMap::from([("target_pose", target)]),
        config: [],
        properties: EdgeProperties { length_m: tenth_mm(length_m) },
    })
}
