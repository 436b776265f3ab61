//! What `placegraph site` takes.

use std::path::PathBuf;

use clap::Args;

use super::{FILES, Formats, HISTORY, ROBOT, ReadArgs, values};

#[derive(Debug, Args)]
pub(crate) struct SiteArgs {
    /// Site file: `[[floor]]` tables with `level` and `map`, `[[lift]]` and `[[stairs]]` tables with `name` and `at`
    #[arg(value_name = "SITE.toml")]
    pub(crate) site: PathBuf,
    /// Write site.json and its files to this folder, and the result of each floor to a folder inside it
    #[arg(short, long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Label with this model [default: the model inside the program]
    #[arg(long, value_name = "FILE")]
    pub(crate) model: Option<PathBuf>,
    /// Also write these formats for each floor
    #[arg(long, value_parser = Formats::parser(), value_delimiter = ',', value_name = "FORMAT,...")]
    pub(crate) export: Vec<Formats>,
    /// Read the costs, limits and zones of masks from this file
    #[arg(long, help_heading = FILES, value_name = "MASKS.toml")]
    pub(crate) masks: Option<PathBuf>,
    /// Keep routes, stations and masks this far from obstacles, and check that the robot gets to the lifts
    #[arg(long, help_heading = ROBOT, value_name = "METERS", default_value_t = 0.0, value_parser = values::radius)]
    pub(crate) robot_radius: f64,
    /// Keep the numbers and names of an earlier run; give its folder, which may be the folder of --out
    #[arg(long, help_heading = HISTORY, value_name = "DIR")]
    pub(crate) previous: Option<PathBuf>,
    /// Also replace files that placegraph did not write
    #[arg(long, help_heading = FILES)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) read: ReadArgs,
}
