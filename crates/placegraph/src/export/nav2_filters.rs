//! All Nav2 masks together: one parameter file and a launch file that starts a pair of servers for each.
//!
//! A parameter file per mask cannot simply be put after another: each sets the list of the costmap's filters. Names of nodes and topics are
//! those of Nav2's own bringup.

use serde_json::{Value, json};

use super::nav2_masks::{MaskFiles, Parameters};
use super::yaml::yaml_bytes;
use super::{ExportError, Keepout, MaskSheet, SpeedLimit, ZonePer, keepout_mask, speed_mask, zone_mask};
use crate::topology::TopologicalMap;

/// What is before the parameters.
const HEAD: &str = "\
# Costmap filters of a placegraph result, to be merged into the parameters of Navigation 2.
# The launch file beside this one starts the servers; it finds the masks in its own folder.
# Zones: Navigation 2 has nav2_costmap_2d::ZoneParameterFilter since 2026. Where yours has it, add
# zone_parameter_filter to the list of filters of the global costmap.
";

/// The mask files of the three filters, their parameters in one file, and a launch file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FilterFiles {
    /// The parameters, YAML.
    pub parameters: Vec<u8>,
    /// The launch file, Python.
    pub launch: Vec<u8>,
    /// Keep-out, speed and zones.
    pub masks: [MaskFiles; 3],
}

/// The masks of `map`, with the parameters of all their servers; `sheets` name the files of keep-out, speed and
/// zones.
///
/// # Errors
/// As the masks alone.
pub fn nav2_filters(
    map: &TopologicalMap,
    sheets: &[MaskSheet; 3],
    keepout: &Keepout,
    speed: &SpeedLimit,
    zones: ZonePer,
) -> Result<FilterFiles, ExportError> {
    let masks = [
        keepout_mask(map, &sheets[0], keepout)?,
        speed_mask(map, &sheets[1], speed)?,
        zone_mask(map, &sheets[2], zones)?,
    ];
    let mut nodes = json!({});
    for mask in &masks {
        join(&mut nodes, &mask.nodes);
    }
    // Not every release knows the zones' filter, and a costmap with an unknown filter does not start.
    let listed = &mut nodes["global_costmap"]["global_costmap"]["ros__parameters"]["filters"];
    if let Value::Array(filters) = listed {
        filters.retain(|filter| filter != "zone_parameter_filter");
    }
    let mut parameters = HEAD.as_bytes().to_vec();
    parameters.extend(yaml_bytes(&nodes, "filter parameters")?);
    Ok(FilterFiles { parameters, launch: launch(sheets).into_bytes(), masks })
}

/// Adds `more` to `all`: members of objects each, lists one after the other.
fn join(all: &mut Parameters, more: &Parameters) {
    match (all, more) {
        (Value::Object(all), Value::Object(more)) => {
            for (key, value) in more {
                match all.get_mut(key) {
                    Some(found) => join(found, value),
                    None => {
                        all.insert(key.clone(), value.clone());
                    }
                }
            }
        }
        (Value::Array(all), Value::Array(more)) => all.extend(more.iter().cloned()),
        (all, more) => all.clone_from(more),
    }
}

/// The launch file: two servers for each mask and a lifecycle manager for all.
fn launch(sheets: &[MaskSheet; 3]) -> String {
    let line = |(name, sheet): (&str, &MaskSheet)| format!("    '{name}': {},", python_text(&sheet.map_name));
    let masks: Vec<String> =
        ["keepout", "speed", "zone_parameter"].into_iter().zip(sheets).map(line).collect();
    LAUNCH.replace("    MASKS", &masks.join("\n"))
}

/// A text as Python writes it.
fn python_text(text: &str) -> String {
    format!("{:?}", text.chars().filter(|c| !c.is_control()).collect::<String>())
}

const LAUNCH: &str = "\
\"\"\"Mask servers of Navigation 2's costmap filters, written by placegraph.

ros2 launch ./nav2_filters.launch.py params_file:=/absolute/path/of/your/nav2_params.yaml
\"\"\"
import os

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

FOLDER = os.path.dirname(os.path.abspath(__file__))
MASKS = {
    MASKS
}


def generate_launch_description():
    params_file = LaunchConfiguration('params_file')
    use_sim_time = LaunchConfiguration('use_sim_time')
    nodes, names = [], []
    for name, mask in MASKS.items():
        nodes.append(Node(
            package='nav2_map_server', executable='map_server', name=f'{name}_filter_mask_server', output='screen',
            parameters=[params_file, {'yaml_filename': os.path.join(FOLDER, mask), 'use_sim_time': use_sim_time}]))
        nodes.append(Node(
            package='nav2_map_server', executable='costmap_filter_info_server',
            name=f'{name}_costmap_filter_info_server', output='screen',
            parameters=[params_file, {'use_sim_time': use_sim_time}]))
        names += [f'{name}_filter_mask_server', f'{name}_costmap_filter_info_server']
    nodes.append(Node(
        package='nav2_lifecycle_manager', executable='lifecycle_manager', name='lifecycle_manager_costmap_filters',
        output='screen',
        parameters=[{'use_sim_time': use_sim_time, 'autostart': LaunchConfiguration('autostart'), 'node_names': names}]))
    return LaunchDescription([
        DeclareLaunchArgument('params_file', default_value=os.path.join(FOLDER, 'nav2_filters.yaml')),
        DeclareLaunchArgument('use_sim_time', default_value='false'),
        DeclareLaunchArgument('autostart', default_value='true'),
        *nodes,
    ])
";
