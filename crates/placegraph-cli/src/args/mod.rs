//! What can be typed, exactly as typed.

mod edit;
mod examples;
mod generate;
mod read;
mod site;
mod train;
mod values;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;

pub(crate) use edit::EditArgs;
pub(crate) use generate::GenerateArgs;
use placegraph::export::Format;
pub(crate) use read::{ReadArgs, RulesArg};
pub(crate) use site::SiteArgs;
pub(crate) use train::{
    EvaluateArgs, FeaturesArg, HoldOutArg, LabelFormatArg, LabelsArgs, MethodArg, TrainArgs,
};
pub(crate) use values::{CropArg, Formats, GeoArg, PlacePointArg, PointArg, no_option};

/// The default limit on the cells of a map.
pub(crate) const MAX_CELLS: u64 = 400_000_000;

/// Without it, help and manual page would begin with the description of the package.
const ABOUT: &str =
    "Turns the occupancy grid map of a building into corridors, rooms, doorways and how they connect";

// Headings of the help.
const ALL: &str = "All commands";
const READING: &str = "Reading maps";
const FILES: &str = "Files";
const METHOD: &str = "Method";
const ROBOT: &str = "Robot";
const HISTORY: &str = "Edits and earlier results";

/// From an occupancy grid map to corridors, rooms, doorways and how they connect.
#[derive(Debug, Parser)]
#[command(name = "placegraph", version, about = ABOUT, arg_required_else_help = true, after_help = examples::PROGRAM)]
pub(crate) struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Use N threads, at most 256 [default: all cores]; the result does not depend on it
    #[arg(long, global = true, help_heading = ALL, value_name = "N", value_parser = clap::value_parser!(u16).range(0..=256))]
    pub(crate) threads: Option<u16>,
    /// Print the time of each stage
    #[arg(short, long, global = true, help_heading = ALL)]
    pub(crate) verbose: bool,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Label maps: find places, doorways and how they connect
    #[command(after_help = examples::MAP)]
    Map(MapArgs),
    /// Show what a map file contains, and check it
    #[command(after_help = examples::INFO)]
    Info(InfoArgs),
    /// Train a model on labeled maps
    #[command(after_help = examples::TRAIN)]
    Train(TrainArgs),
    /// Convert labels of a map, or pre-label it: from a result to labelme, COCO, GeoJSON or an image
    #[command(after_help = examples::LABELS)]
    Labels(LabelsArgs),
    /// Compare label images with the truth
    #[command(after_help = examples::EVALUATE)]
    Evaluate(EvaluateArgs),
    /// Simulate a scan and print its features
    #[command(after_help = examples::SCAN)]
    Scan(ScanArgs),
    /// List the features and their formulas
    #[command(after_help = examples::FEATURES)]
    Features(FeaturesArgs),
    /// Generate maps of buildings with perfect labels
    #[command(after_help = examples::GENERATE)]
    Generate(GenerateArgs),
    /// Convert a topology.json to the format of another program
    #[command(after_help = examples::EXPORT)]
    Export(ExportArgs),
    /// Write a browser page that labels a map and edits its places
    #[command(after_help = examples::PAGE)]
    Page(PageArgs),
    /// Find the turn and the shift between the frames of two results
    #[command(after_help = examples::ALIGN)]
    Align(AlignArgs),
    /// List the places of a result
    #[command(after_help = examples::LIST)]
    List(ListArgs),
    /// Add a correction to an edit file
    #[command(after_help = examples::EDIT)]
    Edit(EditArgs),
    /// Label the growing maps of a building one after another: a folder of maps, or a recording
    #[command(after_help = examples::REPLAY)]
    Replay(ReplayArgs),
    /// Label the floors of a site and join them by lifts and stairs
    #[command(after_help = examples::SITE)]
    Site(SiteArgs),
    /// Check that the files of results are complete and unchanged
    #[command(after_help = examples::VERIFY)]
    Verify(VerifyArgs),
    /// Find the place that contains a point
    #[command(after_help = examples::WHERE)]
    Where(WhereArgs),
    /// Find a route between two places
    #[command(after_help = examples::ROUTE)]
    Route(RouteArgs),
    /// Print completions for a shell
    #[command(after_help = examples::COMPLETIONS)]
    Completions(CompletionsArgs),
    /// Print the manual page of the program or of a command
    #[command(after_help = examples::MAN)]
    Man(ManArgs),
}

#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "a flag of the command line each")]
pub(crate) struct MapArgs {
    #[arg(required = true, value_name = "MAP", help = read::maps("Maps to label") + ". A folder stands for all maps in it, except plain images")]
    pub(crate) maps: Vec<PathBuf>,
    /// Write the results to this folder; several maps get a folder each inside it
    #[arg(short, long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Label with this model [default: the model inside the program]
    #[arg(long, value_name = "FILE")]
    pub(crate) model: Option<PathBuf>,
    /// Fail unless the model uses this method
    #[arg(long, help_heading = METHOD, value_enum)]
    pub(crate) method: Option<MethodArg>,
    /// Also write the labels after classification and after smoothing
    #[arg(long, help_heading = FILES)]
    pub(crate) stages: bool,
    /// Also write the probabilities of all classes, as a NumPy array
    #[arg(long, help_heading = FILES)]
    pub(crate) probabilities: bool,
    /// Skip geometric doorway detection; take doorways from the classifier alone
    #[arg(long, help_heading = METHOD)]
    pub(crate) no_doorways: bool,
    /// Skip the region corrections (Sect. 4.7): keep small regions and doorways that join nothing
    #[arg(long, help_heading = METHOD)]
    pub(crate) no_correction: bool,
    /// Also write these formats
    #[arg(long, value_parser = Formats::parser(), value_delimiter = ',', value_name = "FORMAT,...")]
    pub(crate) export: Vec<Formats>,
    /// Read the costs, limits and zones of masks from this file
    #[arg(long, help_heading = FILES, value_name = "MASKS.toml")]
    pub(crate) masks: Option<PathBuf>,
    /// Write GeoJSON in degrees: give the latitude and longitude of the origin of the map frame, and the direction of its y
    /// axis, clockwise from north
    #[arg(long, help_heading = FILES, value_name = "LAT,LON,HEADING", allow_hyphen_values = true)]
    pub(crate) georeference: Option<GeoArg>,
    /// Keep routes, stations and masks this far from obstacles, and check the graph for a robot of this radius
    #[arg(long, help_heading = ROBOT, value_name = "METERS", default_value_t = 0.0, value_parser = values::radius)]
    pub(crate) robot_radius: f64,
    /// Mark places as cut off if the robot cannot reach them from here [default: from the largest part]
    #[arg(long, help_heading = ROBOT, value_name = "X,Y", allow_hyphen_values = true)]
    pub(crate) from: Option<PointArg>,
    /// Keep the numbers and names of an earlier result and print the changes; give its topology.json, or the folder of the
    /// earlier run, which may be the folder of --out
    #[arg(long, help_heading = HISTORY, value_name = "RESULT")]
    pub(crate) previous: Option<PathBuf>,
    /// Hold on to the doorways and classes of the earlier result: they go only with more evidence than is needed to decide anew
    #[arg(long, help_heading = HISTORY, requires = "previous", conflicts_with = "align")]
    pub(crate) hold: bool,
    /// Find the turn and the shift to the frame of the earlier result first
    #[arg(long, help_heading = HISTORY, requires = "previous")]
    pub(crate) align: bool,
    /// Apply the corrections in this file; for several maps, give the name of the file next to each map: edits.toml also
    /// stands for floor1.edits.toml next to floor1.yaml
    #[arg(long, help_heading = HISTORY, value_name = "EDITS.toml")]
    pub(crate) edits: Option<PathBuf>,
    /// Keep results that are unchanged and come from the same map, model, options and version; only add missing formats of
    /// --export to them
    #[arg(long, help_heading = HISTORY)]
    pub(crate) resume: bool,
    /// Also replace files that placegraph did not write
    #[arg(long, help_heading = FILES)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) read: ReadArgs,
}

#[derive(Debug, Args)]
pub(crate) struct InfoArgs {
    #[arg(value_name = "MAP", help = read::maps("Map to check"))]
    pub(crate) map: PathBuf,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) read: ReadArgs,
}

#[derive(Debug, Args)]
pub(crate) struct ScanArgs {
    #[arg(value_name = "MAP", help = read::maps("Map to scan in"))]
    pub(crate) map: PathBuf,
    /// Scan from this point, in meters in the map frame
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    pub(crate) at: PointArg,
    /// Scan as this model does [default: the model inside the program]
    #[arg(long, value_name = "FILE")]
    pub(crate) model: Option<PathBuf>,
    /// Also draw the scan into this PNG file
    #[arg(short, long, value_name = "PNG")]
    pub(crate) output: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) read: ReadArgs,
}

#[derive(Debug, Args)]
pub(crate) struct FeaturesArgs {
    /// Print the list in this format
    #[arg(long, value_enum, default_value_t = ListFormat::Text)]
    pub(crate) format: ListFormat,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ListFormat {
    /// One line per feature
    Text,
    /// The documentation page, in Markdown
    Md,
}

#[derive(Debug, Args)]
pub(crate) struct ExportArgs {
    /// Result of `placegraph map`: its topology.json
    #[arg(value_name = "TOPOLOGY.json")]
    pub(crate) topology: PathBuf,
    /// Write this format
    #[arg(long, value_parser = values::format(), value_name = "FORMAT")]
    pub(crate) to: &'static Format,
    /// Write to this file, to an existing folder under the usual name, or with - to standard output
    #[arg(short, long, value_name = "PATH")]
    pub(crate) output: PathBuf,
    /// Read the costs, limits and zones of masks from this file
    #[arg(long, value_name = "MASKS.toml")]
    pub(crate) masks: Option<PathBuf>,
    /// Show this map, from which the result was made, in formats with cells, such as report
    #[arg(long, value_name = "MAP")]
    pub(crate) map: Option<PathBuf>,
    /// Write GeoJSON in degrees: give the latitude and longitude of the origin of the map frame, and the direction of its y
    /// axis, clockwise from north
    #[arg(long, value_name = "LAT,LON,HEADING", allow_hyphen_values = true)]
    pub(crate) georeference: Option<GeoArg>,
    /// Also replace files that placegraph did not write
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) read: ReadArgs,
}

#[derive(Debug, Args)]
pub(crate) struct AlignArgs {
    /// Earlier result: its folder or its topology.json
    #[arg(value_name = "OLD")]
    pub(crate) old: PathBuf,
    /// Later result
    #[arg(value_name = "NEW")]
    pub(crate) new: PathBuf,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ListArgs {
    /// Result of `placegraph map`: its folder or its topology.json
    #[arg(value_name = "RESULT")]
    pub(crate) result: PathBuf,
    /// List only places of this class
    #[arg(long, value_name = "CLASS")]
    pub(crate) class: Option<String>,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct VerifyArgs {
    /// Folders of results, or folders that contain such folders
    #[arg(required = true, value_name = "RESULT")]
    pub(crate) results: Vec<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct PageArgs {
    /// Write the page to this file
    #[arg(short, long, value_name = "PAGE.html")]
    pub(crate) output: PathBuf,
    #[arg(long, value_name = "MAP", conflicts_with = "result", help = read::maps_but_recordings("Open with this map"))]
    pub(crate) map: Option<PathBuf>,
    /// Set the meters per pixel of an image without a YAML file
    #[arg(long, value_name = "METERS", requires = "map")]
    pub(crate) resolution: Option<f64>,
    /// Start with these edits of the map
    #[arg(long, value_name = "EDITS.toml", requires = "map")]
    pub(crate) edits: Option<PathBuf>,
    /// Open with the result in this folder
    #[arg(long, value_name = "DIR")]
    pub(crate) result: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct ReplayArgs {
    /// Folder of maps, which are read in the order of their names, or a recording: MCAP, .db3, .bag, or the folder
    /// of `ros2 bag record`
    #[arg(value_name = "FOLDER|RECORDING")]
    pub(crate) source: PathBuf,
    /// Write a picture of each step, a table, and the last topology.json to this folder
    #[arg(short, long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Label with this model [default: the model inside the program]
    #[arg(long, value_name = "FILE")]
    pub(crate) model: Option<PathBuf>,
    /// Apply the corrections in this file to every map
    #[arg(long, value_name = "EDITS.toml")]
    pub(crate) edits: Option<PathBuf>,
    /// Decide every label anew; by default doorways and classes of the step before go only with more evidence
    #[arg(long)]
    pub(crate) no_hold: bool,
    /// Also label every map from scratch, compare the results, and print the times
    #[arg(long)]
    pub(crate) check: bool,
    #[command(flatten)]
    pub(crate) read: ReadArgs,
}

#[derive(Debug, Args)]
pub(crate) struct WhereArgs {
    /// Result of `placegraph map`: its topology.json
    #[arg(value_name = "TOPOLOGY.json")]
    pub(crate) topology: PathBuf,
    /// Look up this point, in meters; add its frame to have it checked
    #[arg(long, value_name = "X,Y[,FRAME]", allow_hyphen_values = true)]
    pub(crate) at: PlacePointArg,
    /// Refuse results of maps with more than N cells
    #[arg(long, help_heading = READING, value_name = "N", default_value_t = MAX_CELLS)]
    pub(crate) max_cells: u64,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct RouteArgs {
    /// Result of `placegraph map`: its topology.json; or that of `placegraph site`: its site.json
    #[arg(value_name = "TOPOLOGY.json")]
    pub(crate) topology: PathBuf,
    /// Name or number of the first place; in a site, its name
    #[arg(value_name = "FROM")]
    pub(crate) from: String,
    /// Name or number of the last place; in a site, its name
    #[arg(value_name = "TO")]
    pub(crate) to: String,
    /// Also take the stairs of a site, as people do
    #[arg(long)]
    pub(crate) stairs: bool,
    /// Refuse results of maps with more than N cells
    #[arg(long, help_heading = READING, value_name = "N", default_value_t = MAX_CELLS)]
    pub(crate) max_cells: u64,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct CompletionsArgs {
    /// Print completions for this shell
    #[arg(value_enum, value_name = "SHELL")]
    pub(crate) shell: Shell,
}

#[derive(Debug, Args)]
pub(crate) struct ManArgs {
    /// Print the page of this command [default: the page of the program]
    #[arg(value_name = "COMMAND")]
    pub(crate) command: Option<String>,
}
