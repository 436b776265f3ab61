//! How map files are read.

use clap::{Args, ValueEnum};
use placegraph::import::Format;

use super::{MAX_CELLS, READING};

/// The help of a map: what it is for, and the kinds of map file.
pub(super) fn maps(what: &str) -> String {
    listed(what, |_| true)
}

/// The same for maps that are no recordings.
pub(super) fn maps_but_recordings(what: &str) -> String {
    listed(what, |format| format != Format::Recording)
}

fn listed(what: &str, is_read: impl Fn(Format) -> bool) -> String {
    let name = |format: Format| match format {
        Format::Image => "image (with --resolution)",
        other => other.name(),
    };
    let mut names: Vec<&str> = Format::ALL.into_iter().filter(|&format| is_read(format)).map(name).collect();
    let last = names.pop().unwrap_or_default();
    format!("{what}: {} or {last}", names.join(", "))
}

/// How a map file is read.
#[derive(Clone, Debug, Args)]
pub(crate) struct ReadArgs {
    /// Set the meters per pixel of an image without a YAML file
    #[arg(long, help_heading = READING, value_name = "METERS")]
    pub(crate) resolution: Option<f64>,
    /// Read YAML file and image as map_server of this release does
    #[arg(long, help_heading = READING, value_enum, default_value_t = RulesArg::Jazzy)]
    pub(crate) rules: RulesArg,
    /// Apply the thresholds of the YAML file to gray 205 too, even if this makes unexplored space free
    #[arg(long, help_heading = READING)]
    pub(crate) trust_thresholds: bool,
    /// Allow a map file to name an image outside of its own folder
    #[arg(long, help_heading = READING)]
    pub(crate) allow_outside: bool,
    /// Read the map on this topic of a recording [default: the only one with maps]
    #[arg(long, help_heading = READING, value_name = "TOPIC")]
    pub(crate) topic: Option<String>,
    /// Refuse maps with more than N cells
    #[arg(long, help_heading = READING, value_name = "N", default_value_t = MAX_CELLS)]
    pub(crate) max_cells: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum RulesArg {
    /// ROS 2 Jazzy, Kilted and later
    #[value(alias = "nav2")]
    Jazzy,
    /// ROS 2 Foxy, Humble and Iron: alpha and colors are read differently
    Humble,
    /// ROS 1
    Ros1,
}
