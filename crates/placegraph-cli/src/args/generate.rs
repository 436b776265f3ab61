//! What `generate` takes.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args;
use placegraph_generate::{Mapping, Style};

use super::values;

/// A heading of the help.
const PLANS: &str = "Surveyed buildings";

#[derive(Debug, Args)]
pub(crate) struct GenerateArgs {
    /// Generate buildings of this kind
    #[arg(long, value_parser = values::style(), default_value = Style::Mixed.name())]
    pub(crate) style: Style,
    /// Map surveyed buildings instead: floor plans (XML), or flats (JSON, one per line)
    #[arg(long, help_heading = PLANS, value_name = "FILE", conflicts_with = "style")]
    pub(crate) plan: Vec<PathBuf>,
    /// Write this license of the plans to objects.json
    #[arg(long, help_heading = PLANS, value_name = "LICENSE", requires = "plan")]
    pub(crate) license: Option<String>,
    /// Generate N buildings [default: 1, or each plan once]
    #[arg(long, value_name = "N")]
    pub(crate) count: Option<u64>,
    /// Set the seed: the same seed gives the same buildings
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Start with building I; plans are taken in turn
    #[arg(long, value_name = "I", default_value_t = 0)]
    pub(crate) first: u64,
    /// Make the maps this way
    #[arg(long, value_parser = values::mapping(), default_value = Mapping::Mixed.name())]
    pub(crate) mapping: Mapping,
    /// Set the meters per cell, 0.02 to 0.2 [default: random for each building]
    #[arg(long, value_name = "METERS")]
    pub(crate) resolution: Option<f64>,
    /// Also write the map after every N scans of the robot, into `growing` of each building
    #[arg(long, value_name = "N", conflicts_with_all = ["plan", "mapping"])]
    pub(crate) growing: Option<NonZeroUsize>,
    /// Write a folder per building to this folder
    #[arg(short, long, value_name = "DIR")]
    pub(crate) out: PathBuf,
}
