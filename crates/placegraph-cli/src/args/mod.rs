//! What can be typed, exactly as typed.

mod edit;
mod values;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;

pub(crate) use edit::EditArgs;
use placegraph::export::Format;
pub(crate) use values::{CropArg, Formats, GeoArg, PlacePointArg, PointArg};

/// Most cells of a map unless asked otherwise.
pub(crate) const MAX_CELLS: u64 = 400_000_000;

/// Without it, help and manual page would begin with the description of the package.
const ABOUT: &str =
    "Turns the occupancy grid map of a building into corridors, rooms, doorways and how they connect";

/// From an occupancy grid map to corridors, rooms, doorways and how they connect.
#[derive(Debug, Parser)]
#[command(name = "placegraph", version, about = ABOUT, arg_required_else_help = true)]
pub(crate) struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Threads to work with, at most 256 [default: all cores]; the result does not depend on it
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(0..=256))]
    pub(crate) threads: Option<u16>,
    /// Tell how long each stage took
    #[arg(short, long, global = true)]
    pub(crate) verbose: bool,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Label a map: places, doorways and how they connect
    Map(MapArgs),
    /// Check a map before it is labeled
    Info(InfoArgs),
    /// Train a model from labeled maps
    Train(TrainArgs),
    /// Compare label images with the truth
    Evaluate(EvaluateArgs),
    /// Simulate one scan and show its features
    Scan(ScanArgs),
    /// List the features
    Features(FeaturesArgs),
    /// Make buildings with perfect labels, as a robot would map them
    Generate(GenerateArgs),
    /// Write a topology.json in another program's format
    Export(ExportArgs),
    /// Write the page for the browser: drop a map, see its places, mend them
    Page(PageArgs),
    /// Find the turn and the shift between the frames of two results
    Align(AlignArgs),
    /// List the places of a result
    List(ListArgs),
    /// Write a correction into an edit file: docs/edits.md
    Edit(EditArgs),
    /// Check that results are as they were written
    Verify(VerifyArgs),
    /// Tell which place a point lies in
    Where(WhereArgs),
    /// Tell the way from one place to another
    Route(RouteArgs),
    /// Print completions for a shell
    Completions(CompletionsArgs),
    /// Print the manual page, of the program or of a command
    Man(ManArgs),
}

/// How a map file is read.
#[derive(Debug, Args)]
pub(crate) struct ReadArgs {
    /// Meters per pixel of a map that is an image without a YAML file
    #[arg(long, value_name = "METERS")]
    pub(crate) resolution: Option<f64>,
    /// Read YAML file and image as map_server of this release does: docs/maps.md
    #[arg(long, value_enum, default_value_t = RulesArg::Jazzy)]
    pub(crate) rules: RulesArg,
    /// Read gray 205 as the file's thresholds say, even where they turn unexplored space free
    #[arg(long)]
    pub(crate) trust_thresholds: bool,
    /// Read an image that a map file names outside of its own folder
    #[arg(long)]
    pub(crate) allow_outside: bool,
    /// Refuse maps with more cells than this
    #[arg(long, value_name = "N", default_value_t = MAX_CELLS)]
    pub(crate) max_cells: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum RulesArg {
    /// ROS 2 Jazzy, Kilted and later
    #[value(alias = "nav2")]
    Jazzy,
    /// ROS 2 Foxy, Humble and Iron: alpha and colors count otherwise
    Humble,
    /// ROS 1
    Ros1,
}

#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "a flag of the command line each")]
pub(crate) struct MapArgs {
    /// Maps: map_server YAML, image (with --resolution), CARMEN map or Valetudo JSON; a folder stands for all maps in it, except
    /// images alone
    #[arg(required = true, value_name = "MAP")]
    pub(crate) maps: Vec<PathBuf>,
    /// Folder for the results; several maps get a folder each in it
    #[arg(short, long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Model to label with [default: the one inside the program]
    #[arg(long, value_name = "FILE")]
    pub(crate) model: Option<PathBuf>,
    /// Refuse a model of another method
    #[arg(long, value_enum)]
    pub(crate) method: Option<MethodArg>,
    /// Also write the labels after classification and after smoothing
    #[arg(long)]
    pub(crate) stages: bool,
    /// Also write the probabilities of all classes, as a NumPy array
    #[arg(long)]
    pub(crate) probabilities: bool,
    /// Take doorways only from the classifier, not from narrow passages of the map
    #[arg(long)]
    pub(crate) no_doorways: bool,
    /// Leave small regions and doorways that join nothing as they are
    #[arg(long)]
    pub(crate) no_correction: bool,
    /// Also write these formats: docs/exports.md
    #[arg(long, value_parser = Formats::parser(), value_delimiter = ',', value_name = "FORMAT,...")]
    pub(crate) export: Vec<Formats>,
    /// What the costs, limits and zones of masks are: docs/exports.md
    #[arg(long, value_name = "MASKS.toml")]
    pub(crate) masks: Option<PathBuf>,
    /// Where the map stands on Earth, so that GeoJSON is in degrees: of the map frame's origin, and where its y axis points,
    /// clockwise from north
    #[arg(long, value_name = "LAT,LON,HEADING", allow_hyphen_values = true)]
    pub(crate) georeference: Option<GeoArg>,
    /// What the robot's center needs on all sides: routes, stations and masks keep it, and the graph is checked
    #[arg(long, value_name = "METERS", default_value_t = 0.0, value_parser = values::radius)]
    pub(crate) robot_radius: f64,
    /// Where the robot is: what cannot be reached from there is cut off [default: what the largest part does not reach]
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    pub(crate) from: Option<PointArg>,
    /// Keep the numbers and names of an earlier result, and print what changed: its topology.json, or the folder of the
    /// earlier run, which may be that of --out
    #[arg(long, value_name = "RESULT")]
    pub(crate) previous: Option<PathBuf>,
    /// The earlier result is in another frame: find the turn and the shift first
    #[arg(long, requires = "previous")]
    pub(crate) align: bool,
    /// Apply these corrections by hand: docs/edits.md. Of several maps, the name of the file that lies beside each, such
    /// as edits.toml or floor1.edits.toml for floor1.yaml
    #[arg(long, value_name = "EDITS.toml")]
    pub(crate) edits: Option<PathBuf>,
    /// Keep the results that are as they were written and made from the same map, model, options and version; other
    /// formats of --export are added to them
    #[arg(long)]
    pub(crate) resume: bool,
    /// Replace files that are no results of placegraph, too
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) read: ReadArgs,
}

/// Sets of features; `docs/features.md` has their members.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum FeaturesArg {
    /// All of them
    All,
    /// The 203 of the author's program
    Freiburg203,
    /// The 183 with a number in the book
    Chapter183,
    /// The 152 from before the chapter
    Old152,
    /// The 120 that take half the time
    Lean120,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MethodArg {
    /// Boosted decision list, then relaxation
    Boosted,
    /// Instance-based associative Markov network
    Iamn,
}

#[derive(Debug, Args)]
pub(crate) struct InfoArgs {
    /// The map
    #[arg(value_name = "MAP")]
    pub(crate) map: PathBuf,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) read: ReadArgs,
}

#[derive(Debug, Args)]
pub(crate) struct TrainArgs {
    /// Training file: `[[map]]` tables with `map`, `labels`, optional `crop`; optional `[classes]`
    #[arg(value_name = "TRAINING.toml", required_unless_present = "map", conflicts_with_all = ["map", "labels", "crop"])]
    pub(crate) manifest: Option<PathBuf>,
    /// Train from this one map
    #[arg(long, requires = "labels", value_name = "MAP")]
    pub(crate) map: Option<PathBuf>,
    /// Labels of that map: 0 none, k class k, 255 ignore
    #[arg(long, requires = "map", value_name = "IMAGE")]
    pub(crate) labels: Option<PathBuf>,
    /// Use only these pixels of it, y down, upper bounds exclusive; scans still see the whole map
    #[arg(long, requires = "map", value_name = "X0,Y0,X1,Y1")]
    pub(crate) crop: Option<CropArg>,
    /// Where to write the model
    #[arg(short, long, value_name = "MODEL")]
    pub(crate) output: PathBuf,
    /// How cells shall be labeled
    #[arg(long, value_enum, default_value_t = MethodArg::Boosted)]
    pub(crate) method: MethodArg,
    /// The chapter's own setting: 100 rounds, temperature 1, one scale; of the network: distances alone
    #[arg(long, conflicts_with_all = ["rounds", "temperature", "scales", "max_speck"])]
    pub(crate) chapter: bool,
    /// Features to choose from [default: all; of a network: freiburg203]
    #[arg(long, value_enum, value_name = "SET")]
    pub(crate) features: Option<FeaturesArg>,
    /// Boosting rounds [default: chosen by cross-validation]
    #[arg(long, value_name = "T")]
    pub(crate) rounds: Option<usize>,
    /// Temperature of the confidences [default: chosen by cross-validation]
    #[arg(long, value_name = "TAU")]
    pub(crate) temperature: Option<f64>,
    /// Train on the building at these scales
    #[arg(long, value_delimiter = ',', value_name = "S,...")]
    pub(crate) scales: Option<Vec<f64>>,
    /// When maps are labeled, scans pass through obstacles that stand free and are at most this long and wide, in meters
    /// [default: 0]
    #[arg(long, value_name = "METERS")]
    pub(crate) max_speck: Option<f64>,
    /// Train on at most so many cells of each class, evenly taken [default: all]
    #[arg(long, value_name = "N")]
    pub(crate) max_cells_per_class: Option<usize>,
    /// Print the report as JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) read: ReadArgs,
}

#[derive(Debug, Args)]
pub(crate) struct EvaluateArgs {
    /// Label image to judge, or a folder with a folder per map, as `map` writes it
    #[arg(value_name = "PREDICTION")]
    pub(crate) prediction: PathBuf,
    /// The truth: 0 none, k class k, 255 ignore; or a folder with a folder per map
    #[arg(value_name = "LABELS")]
    pub(crate) labels: PathBuf,
    /// Meters per pixel: doorways are judged as objects too [default: what a map.yaml beside the truth says, of folders]
    #[arg(long, value_name = "METERS")]
    pub(crate) resolution: Option<f64>,
    /// Name of the truth in the folder of each map
    #[arg(long, value_name = "NAME", default_value = "labels.png")]
    pub(crate) truth: PathBuf,
    /// Also write the table of the maps as comma-separated values, of folders
    #[arg(long, value_name = "FILE")]
    pub(crate) csv: Option<PathBuf>,
    /// Judge only these pixels, y down, upper bounds exclusive
    #[arg(long, value_name = "X0,Y0,X1,Y1")]
    pub(crate) crop: Option<CropArg>,
    /// True rooms: an image of room numbers, 0 none, or a Valetudo JSON with its segments
    #[arg(long, requires = "regions", value_name = "IMAGE")]
    pub(crate) rooms: Option<PathBuf>,
    /// Found regions: an image of region numbers, 0 none
    #[arg(long, requires = "rooms", value_name = "IMAGE")]
    pub(crate) regions: Option<PathBuf>,
    /// Take the classes from this model [default: corridor, room, doorway]
    #[arg(long, value_name = "FILE")]
    pub(crate) model: Option<PathBuf>,
    /// Exit with status 1 where the cell accuracy is below this share
    #[arg(long, value_name = "SHARE", value_parser = values::share)]
    pub(crate) min_accuracy: Option<f64>,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ScanArgs {
    /// The map
    #[arg(value_name = "MAP")]
    pub(crate) map: PathBuf,
    /// Position of the scan in meters of the map frame
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    pub(crate) at: PointArg,
    /// Scan as this model does [default: the one inside the program]
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
    /// How to list them
    #[arg(long, value_enum, default_value_t = ListFormat::Text)]
    pub(crate) format: ListFormat,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ListFormat {
    /// A line each
    Text,
    /// The documentation page
    Md,
}

#[derive(Debug, Args)]
pub(crate) struct GenerateArgs {
    /// Kind of building
    #[arg(long, value_enum, default_value_t = StyleArg::Mixed)]
    pub(crate) style: StyleArg,
    /// Map surveyed buildings instead of drawing some: floor plans (XML) or flats (JSON, a line each); docs/generated-buildings.md
    #[arg(long, value_name = "FILE", conflicts_with = "style")]
    pub(crate) plan: Vec<PathBuf>,
    /// License of the plans, for objects.json
    #[arg(long, value_name = "LICENSE", requires = "plan")]
    pub(crate) license: Option<String>,
    /// Number of buildings [default: 1, or all plans once]
    #[arg(long, value_name = "N")]
    pub(crate) count: Option<u64>,
    /// Same seed, same buildings
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Index of the first building; plans are taken in turn
    #[arg(long, value_name = "I", default_value_t = 0)]
    pub(crate) first: u64,
    /// How the maps come about
    #[arg(long, value_enum, default_value_t = MappingArg::Mixed)]
    pub(crate) mapping: MappingArg,
    /// Meters per cell, 0.02 to 0.2 [default: drawn per building]
    #[arg(long, value_name = "METERS")]
    pub(crate) resolution: Option<f64>,
    /// Folder for the buildings, a folder each
    #[arg(short, long, value_name = "DIR")]
    pub(crate) out: PathBuf,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum StyleArg {
    Office,
    Home,
    Hospital,
    Hotel,
    School,
    Warehouse,
    /// Any of the six above
    Mixed,
    /// Lobbies that lie open, wide and deep doors, stubs of corridors
    Campus,
    /// Desks on an open floor around a core
    OpenOffice,
    /// Narrow hallways, closets, leaves and furniture in the way
    Flat,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MappingArg {
    /// A robot drives through and maps what its laser sees
    Slam,
    /// A drawing without furniture
    Clean,
    /// A drawing with furniture
    Furnished,
    /// Any of them, most often the robot
    Mixed,
}

#[derive(Debug, Args)]
pub(crate) struct ExportArgs {
    /// A result of `placegraph map`
    #[arg(value_name = "TOPOLOGY.json")]
    pub(crate) topology: PathBuf,
    /// What to write
    #[arg(long, value_parser = values::format(), value_name = "FORMAT")]
    pub(crate) to: &'static Format,
    /// Where to write it: a file, an existing folder for a file with the usual name, or - for standard output
    #[arg(short, long, value_name = "PATH")]
    pub(crate) output: PathBuf,
    /// What the costs, limits and zones of masks are: docs/exports.md
    #[arg(long, value_name = "MASKS.toml")]
    pub(crate) masks: Option<PathBuf>,
    /// The map that the result was made from, for its picture in the report
    #[arg(long, value_name = "MAP")]
    pub(crate) map: Option<PathBuf>,
    /// Where the map stands on Earth, so that GeoJSON is in degrees: of the map frame's origin, and where its y axis points,
    /// clockwise from north
    #[arg(long, value_name = "LAT,LON,HEADING", allow_hyphen_values = true)]
    pub(crate) georeference: Option<GeoArg>,
    /// Replace files that are no results of placegraph, too
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) read: ReadArgs,
}

#[derive(Debug, Args)]
pub(crate) struct AlignArgs {
    /// The earlier result: its folder or its topology.json
    #[arg(value_name = "OLD")]
    pub(crate) old: PathBuf,
    /// The later one
    #[arg(value_name = "NEW")]
    pub(crate) new: PathBuf,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ListArgs {
    /// A result of `placegraph map`: its folder or its topology.json
    #[arg(value_name = "RESULT")]
    pub(crate) result: PathBuf,
    /// Only places of this class
    #[arg(long, value_name = "CLASS")]
    pub(crate) class: Option<String>,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct VerifyArgs {
    /// Folders of results, or folders that hold such
    #[arg(required = true, value_name = "RESULT")]
    pub(crate) results: Vec<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct PageArgs {
    /// File to write
    #[arg(short, long, value_name = "PAGE.html")]
    pub(crate) output: PathBuf,
    /// Open this map: map_server YAML, image (with --resolution) or CARMEN map
    #[arg(long, value_name = "MAP", conflicts_with = "result")]
    pub(crate) map: Option<PathBuf>,
    /// Meters per pixel of a map that is an image without a YAML file
    #[arg(long, value_name = "METERS", requires = "map")]
    pub(crate) resolution: Option<f64>,
    /// Begin with these edits of the map
    #[arg(long, value_name = "EDITS.toml", requires = "map")]
    pub(crate) edits: Option<PathBuf>,
    /// Open with the result in this folder
    #[arg(long, value_name = "DIR")]
    pub(crate) result: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct WhereArgs {
    /// A result of `placegraph map`
    #[arg(value_name = "TOPOLOGY.json")]
    pub(crate) topology: PathBuf,
    /// The point in meters, and the frame that it is in if that is to be checked
    #[arg(long, value_name = "X,Y[,FRAME]", allow_hyphen_values = true)]
    pub(crate) at: PlacePointArg,
    /// Refuse results of maps with more cells than this
    #[arg(long, value_name = "N", default_value_t = MAX_CELLS)]
    pub(crate) max_cells: u64,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct RouteArgs {
    /// A result of `placegraph map`
    #[arg(value_name = "TOPOLOGY.json")]
    pub(crate) topology: PathBuf,
    /// Name or number of the first place
    #[arg(value_name = "FROM")]
    pub(crate) from: String,
    /// Name or number of the last place
    #[arg(value_name = "TO")]
    pub(crate) to: String,
    /// Refuse results of maps with more cells than this
    #[arg(long, value_name = "N", default_value_t = MAX_CELLS)]
    pub(crate) max_cells: u64,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct CompletionsArgs {
    /// The shell
    #[arg(value_enum, value_name = "SHELL")]
    pub(crate) shell: Shell,
}

#[derive(Debug, Args)]
pub(crate) struct ManArgs {
    /// The command
    #[arg(value_name = "COMMAND")]
    pub(crate) command: Option<String>,
}
