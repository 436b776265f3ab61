//! Nav2 costmap filter masks: keep-out, speed and zone parameters, each an image with its map file and the
//! parameters of the servers that publish it.
//!
//! Masks are images of mode raw: a pixel is the cell's value, 0 to 100, or 255 for unknown. Costmaps ignore a
//! rotation of the mask, so a rotated map is refused, or resampled on an upright grid.

use std::collections::BTreeMap;

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use serde::{Deserialize, Serialize};
use serde_saphyr::FlowSeq;

use super::ExportError;
use super::yaml::yaml_bytes;
use crate::grid::{Grid, GridShape};
use crate::topology::{Place, PlaceRaster, TopologicalMap};

/// A mask and the parameters of its servers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MaskFiles {
    /// Gray image, PNG.
    pub image: Vec<u8>,
    /// Map file of the image, YAML.
    pub map: Vec<u8>,
    /// Parameters of the mask server, the filter info server and the costmap's filter, YAML.
    pub parameters: Vec<u8>,
    /// The same, to be joined with those of other masks.
    pub(super) nodes: Parameters,
}

/// How to make masks of a rotated map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Rotated {
    /// Not at all.
    #[default]
    Refuse,
    /// On an upright grid of the same resolution; borders move by up to half a cell.
    Resample,
}

/// The grid and the file names of a mask.
#[derive(Clone, Debug, PartialEq)]
pub struct MaskSheet {
    /// The grid of the map.
    pub shape: GridShape,
    /// How a rotated grid is treated.
    pub rotated: Rotated,
    /// Name of the image file that the map file refers to.
    pub image_name: String,
    /// Name of the map file that the parameters refer to.
    pub map_name: String,
    /// Name of the frame.
    pub frame_id: String,
}

/// A value per class, with exceptions for places by name.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ValueOf {
    /// By name of the class.
    pub class: BTreeMap<String, f64>,
    /// By name of the place; wins over its class.
    pub place: BTreeMap<String, f64>,
}

impl ValueOf {
    pub(super) fn get(&self, place: &Place) -> Option<f64> {
        self.place.get(&place.name).or_else(|| self.class.get(&place.class)).copied()
    }

    /// Values for places that the map does not have would silently have no effect.
    fn check(&self, map: &TopologicalMap, min: f64, max: f64) -> Result<(), ExportError> {
        let is_place = |name: &String| map.places.iter().any(|place| place.name == *name);
        if let Some(found) = self.place.keys().find(|name| !is_place(name)) {
            return Err(ExportError::UnknownPlace { found: found.clone() });
        }
        for (subject, &found) in self.class.iter().chain(&self.place) {
            if !(min..=max).contains(&found) {
                return Err(ExportError::Value { subject: subject.clone(), min, max, found });
            }
        }
        Ok(())
    }
}

/// Where a robot must not go.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Keepout {
    /// 100 forbids, 1 to 99 raises the cost, 0 has no effect. Without an entry: 0.
    pub cost: ValueOf,
    /// Cost of cells outside of all places: walls, unknown space.
    pub elsewhere: u8,
}

impl Default for Keepout {
    /// Places are free, everything else is forbidden.
    fn default() -> Self {
        Self { cost: ValueOf::default(), elsewhere: 100 }
    }
}

impl Keepout {
    pub(super) fn check(&self, map: &TopologicalMap) -> Result<(), ExportError> {
        let (min, max) = (0.0, 100.0);
        self.cost.check(map, min, max)?;
        if self.elsewhere > 100 {
            let (subject, found) = ("elsewhere".to_owned(), self.elsewhere.into());
            return Err(ExportError::Value { subject, min, max, found });
        }
        Ok(())
    }
}

/// How fast a robot may go.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, tag = "unit", rename_all = "snake_case")]
pub enum SpeedLimit {
    /// In percent of the robot's maximum, above 0 to 100.
    Percent {
        /// The limits; without an entry there is none.
        limit: ValueOf,
    },
    /// In meters per second, above 0 to 1000. A cell holds a hundredth of the largest limit.
    MetersPerSecond {
        /// The limits; without an entry there is none.
        limit: ValueOf,
    },
}

impl Default for SpeedLimit {
    /// Half speed in doorways.
    fn default() -> Self {
        let class = BTreeMap::from([("doorway".to_owned(), 50.0)]);
        Self::Percent { limit: ValueOf { class, place: BTreeMap::new() } }
    }
}

/// Faster than any robot.
const MAX_SPEED_M_PER_S: f64 = 1000.0;

/// What makes a zone in the zone mask.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ZonePer {
    /// Every class.
    #[default]
    Class,
    /// Every place; at most 100.
    Place,
}

/// The keep-out mask (filter type 0).
///
/// # Errors
/// If the map is rotated and that is refused, a cost is not in 0 to 100, or one is given to a place that the map does
/// not have.
pub fn keepout_mask(
    map: &TopologicalMap,
    sheet: &MaskSheet,
    keepout: &Keepout,
) -> Result<MaskFiles, ExportError> {
    keepout.check(map)?;
    let elsewhere = keepout.elsewhere;
    // What is cut off is closed unless the place itself is named.
    let paint = |place: &Place| match keepout.cost.place.get(&place.name) {
        None if place.cut_off => elsewhere,
        _ => keepout.cost.get(place).unwrap_or(0.0).round() as u8,
    };
    let filter = Filter::new("keepout_filter", "nav2_costmap_2d::KeepoutFilter", 0);
    mask_files(map, sheet, elsewhere, paint, &filter)
}

/// The speed mask (filter type 1 in percent, 2 in meters per second).
///
/// # Errors
/// If the map is rotated and that is refused, a limit is not above 0 (and at most 100 in percent), or one is given to
/// a place that the map does not have.
pub fn speed_mask(
    map: &TopologicalMap,
    sheet: &MaskSheet,
    speed: &SpeedLimit,
) -> Result<MaskFiles, ExportError> {
    let (limit, kind, max) = match speed {
        SpeedLimit::Percent { limit } => (limit, 1, 100.0),
        SpeedLimit::MetersPerSecond { limit } => {
            (limit, 2, limit.class.values().chain(limit.place.values()).copied().fold(0.01, f64::max))
        }
    };
    limit.check(map, max / 100.0, max.min(MAX_SPEED_M_PER_S))?;
    // A cell of 0 would be no limit at all.
    let paint =
        |place: &Place| limit.get(place).map_or(0, |value| (100.0 * value / max).round().max(1.0) as u8);
    let mut filter = Filter::new("speed_filter", "nav2_costmap_2d::SpeedFilter", kind);
    filter.multiplier = max / 100.0;
    mask_files(map, sheet, 0, paint, &filter)
}

/// The zone-parameter mask (filter type 4): a state per class or per place, numbered from 1; elsewhere 0, the
/// nominal values. The parameters declare every state with one set-point as an example: a state that is not
/// declared is an error in Nav2.
///
/// # Errors
/// If the map is rotated and that is refused, or there are more than 100 zones.
pub fn zone_mask(map: &TopologicalMap, sheet: &MaskSheet, per: ZonePer) -> Result<MaskFiles, ExportError> {
    let key = |place: &Place| match per {
        ZonePer::Class => place.class.clone(),
        ZonePer::Place => place.name.clone(),
    };
    let mut zones: Vec<String> = Vec::new();
    for zone in map.places.iter().map(key) {
        if !zones.contains(&zone) {
            zones.push(zone);
        }
    }
    if zones.len() > 100 {
        return Err(ExportError::TooManyZones { found: zones.len() });
    }
    let id =
        |place: &Place| zones.iter().position(|zone| *zone == key(place)).map_or(0, |index| index as u8 + 1);
    let mut filter = Filter::new("zone_parameter_filter", "nav2_costmap_2d::ZoneParameterFilter", 4);
    filter.zones.clone_from(&zones);
    mask_files(map, sheet, 0, id, &filter)
}

/// Largest mask of a smaller map.
const MAX_MASK_CELLS: u64 = 400_000_000;

/// A costmap filter and how it reads its mask.
struct Filter {
    name: &'static str,
    plugin: &'static str,
    kind: u8,
    multiplier: f64,
    zones: Vec<String>,
}

impl Filter {
    fn new(name: &'static str, plugin: &'static str, kind: u8) -> Self {
        Self { name, plugin, kind, multiplier: 1.0, zones: Vec::new() }
    }
}

fn mask_files(
    map: &TopologicalMap,
    sheet: &MaskSheet,
    elsewhere: u8,
    paint: impl Fn(&Place) -> u8,
    filter: &Filter,
) -> Result<MaskFiles, ExportError> {
    let yaw_rad = sheet.shape.frame.map_from_grid().yaw_rad;
    let shape = match sheet.rotated {
        _ if yaw_rad.abs() < 1e-12 => sheet.shape,
        Rotated::Refuse => return Err(ExportError::Rotated { yaw_rad }),
        Rotated::Resample => sheet.shape.upright(),
    };
    let n_cells = |shape: &GridShape| u64::from(shape.width) * u64::from(shape.height);
    // A thin map turned by 45 degrees fills little of its upright grid.
    let max_cells = n_cells(&sheet.shape).max(MAX_MASK_CELLS);
    if n_cells(&shape) > max_cells {
        return Err(ExportError::TooManyCells { width: shape.width, height: shape.height, max_cells });
    }
    let raster = PlaceRaster::new(map, shape);
    let mut cells = Grid::filled(shape.width, shape.height, elsewhere);
    for y in 0..shape.height {
        for span in raster.row(y) {
            let Some(place) = map.place(span.place) else { continue };
            let start = y as usize * shape.width as usize;
            cells.values_mut()[start + span.start as usize..start + span.end as usize].fill(paint(place));
        }
    }
    let nodes = nodes(sheet, filter);
    Ok(MaskFiles {
        image: upright_png(&cells)?,
        map: map_yaml(&shape, &sheet.image_name)?,
        parameters: yaml_bytes(&nodes, "filter parameters")?,
        nodes,
    })
}

/// The image of `cells`, the first row lowest.
fn upright_png(cells: &Grid<u8>) -> Result<Vec<u8>, ExportError> {
    let pixels: Vec<u8> = (0..cells.height()).rev().flat_map(|y| cells.row(y)).copied().collect();
    gray_png(cells, &pixels)
}

/// An image of the size of `cells` with these pixels, row by row from the top.
pub(super) fn gray_png(cells: &Grid<u8>, pixels: &[u8]) -> Result<Vec<u8>, ExportError> {
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes)
        .write_image(pixels, cells.width(), cells.height(), ExtendedColorType::L8)
        .map_err(|error| ExportError::writer("PNG", &error))?;
    Ok(bytes)
}

#[derive(Serialize)]
struct MapYaml<'a> {
    image: &'a str,
    mode: &'a str,
    resolution: f64,
    origin: FlowSeq<[f64; 3]>,
    negate: u8,
    occupied_thresh: f64,
    free_thresh: f64,
}

fn map_yaml(shape: &GridShape, image: &str) -> Result<Vec<u8>, ExportError> {
    let origin = shape.frame.map_from_grid();
    let file = MapYaml {
        image,
        mode: "raw",
        resolution: shape.frame.resolution_m(),
        origin: FlowSeq([origin.x, origin.y, 0.0].map(|v| (v * 1e9).round() / 1e9 + 0.0)),
        negate: 0,
        // Without meaning in this mode, but the reader asks for them.
        occupied_thresh: 0.65,
        free_thresh: 0.196,
    };
    yaml_bytes(&file, "mask map")
}

/// Nested parameters of ROS nodes.
pub(super) type Parameters = serde_json::Value;

/// The parameters of a mask's own pair of servers, named as Nav2's bringup names them, and of the filter in the costmaps.
fn nodes(sheet: &MaskSheet, filter: &Filter) -> Parameters {
    use serde_json::json;
    let short = filter.name.trim_end_matches("_filter");
    let (info_topic, mask_topic) = (format!("/{short}_costmap_filter_info"), format!("/{short}_filter_mask"));
    let mut plugin = json!({
        "plugin": filter.plugin,
        "enabled": true,
        "filter_info_topic": info_topic,
    });
    if filter.kind == 4 {
        add_zones(&mut plugin, &filter.zones);
    }
    let node = |parameters: Parameters| json!({ "ros__parameters": parameters });
    let costmap = || node(json!({ "filters": [filter.name], filter.name: plugin }));
    let mut nodes = json!({
        format!("{short}_filter_mask_server"): node(json!({
            "yaml_filename": sheet.map_name,
            "topic_name": mask_topic,
            "frame_id": sheet.frame_id,
        })),
        format!("{short}_costmap_filter_info_server"): node(json!({
            "type": filter.kind,
            "filter_info_topic": info_topic,
            "mask_topic": mask_topic,
            "base": 0.0,
            "multiplier": filter.multiplier,
        })),
        "global_costmap": { "global_costmap": costmap() },
    });
    if filter.kind == 0 {
        // Where the planner must not go, the controller must not either.
        nodes["local_costmap"] = json!({ "local_costmap": costmap() });
    }
    nodes
}

/// Declares the states, and a set-point and its nominal value for each to start from.
fn add_zones(plugin: &mut Parameters, zones: &[String]) {
    use serde_json::json;
    let setpoint = |value: f64| json!({ "node": "controller_server", "parameter": "FollowPath.max_vel_x", "value": value });
    // Names of parameters hold letters, digits and underscores.
    let state = |index: usize, zone: &str| {
        let word: String = zone.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
        format!("zone_{}_{word}", index + 1)
    };
    let names: Vec<String> = zones.iter().enumerate().map(|(index, zone)| state(index, zone)).collect();
    for (index, name) in names.iter().enumerate() {
        plugin[name] = json!({ "id": index + 1, "setpoints": ["max_vel_x"], "max_vel_x": setpoint(0.5) });
    }
    plugin["states"] = json!(names);
    plugin["state_event_topic"] = json!("zone_filter_state");
    plugin["nominal_defaults"] = json!(["max_vel_x"]);
    plugin["nominal_defaults.max_vel_x"] = setpoint(0.5);
}
