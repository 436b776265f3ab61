//! What `train` and `evaluate` take.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{METHOD, ReadArgs, values, values::CropArg};

/// A heading of the help.
const ROOMS: &str = "Rooms";

/// Sets of features; `docs/features.md` has their members.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum FeaturesArg {
    /// All features
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

/// What is held out as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum HoldOutArg {
    /// All maps of a building
    Buildings,
    /// Square blocks of 4 m
    Blocks,
}

#[derive(Debug, Args)]
pub(crate) struct TrainArgs {
    /// Training file: `[[map]]` tables with `map`, `labels`, optional `crop`; optional `[classes]`
    #[arg(value_name = "TRAINING.toml", required_unless_present = "map", conflicts_with_all = ["map", "labels", "crop", "classes"])]
    pub(crate) manifest: Option<PathBuf>,
    /// Train on this map alone
    #[arg(long, requires = "labels", value_name = "MAP")]
    pub(crate) map: Option<PathBuf>,
    /// Labels of that map: an image (0 none, k class k, 255 ignore; or colors), labelme, COCO or GeoJSON, or a topology.json
    #[arg(long, requires = "map", value_name = "LABELS")]
    pub(crate) labels: Option<PathBuf>,
    /// Classes of these labels: TOML with [classes], a model, or the labels.yaml of a result [default: corridor, room, doorway]
    #[arg(long, requires = "map", value_name = "FILE")]
    pub(crate) classes: Option<PathBuf>,
    /// Train only on these pixels of that map, y down, upper bounds exclusive; scans still see the whole map
    #[arg(long, requires = "map", value_name = "X0,Y0,X1,Y1")]
    pub(crate) crop: Option<CropArg>,
    /// Write the model to this file
    #[arg(short, long, value_name = "MODEL")]
    pub(crate) output: PathBuf,
    /// Train a model of this method
    #[arg(long, help_heading = METHOD, value_enum, default_value_t = MethodArg::Boosted)]
    pub(crate) method: MethodArg,
    /// Train as the chapter does: 100 rounds, temperature 1, one scale, all cells; for a network: distances alone
    #[arg(long, help_heading = METHOD, conflicts_with_all = ["rounds", "temperature", "scales", "max_speck", "hold_out"])]
    pub(crate) chapter: bool,
    /// Start from this model instead of from nothing, `default` for the one inside the program: your maps are added to what it
    /// learned from
    #[arg(long, help_heading = METHOD, value_name = "MODEL", conflicts_with_all = ["chapter", "features", "max_speck"])]
    pub(crate) base: Option<PathBuf>,
    /// Choose features from this set [default: all; for a network: freiburg203]
    #[arg(long, help_heading = METHOD, value_enum, value_name = "SET")]
    pub(crate) features: Option<FeaturesArg>,
    /// Boost for T rounds [default: chosen by cross-validation]
    #[arg(long, help_heading = METHOD, value_name = "T")]
    pub(crate) rounds: Option<usize>,
    /// Set the temperature of the confidences [default: chosen by cross-validation]
    #[arg(long, help_heading = METHOD, value_name = "TAU")]
    pub(crate) temperature: Option<f64>,
    /// Scale the training buildings by each of these factors, so that the model fits larger and smaller ones
    /// [default: 0.7,1,1.4,2; for a network: 1]
    #[arg(long, help_heading = METHOD, value_delimiter = ',', value_name = "S,...")]
    pub(crate) scales: Option<Vec<f64>>,
    /// Let the scans of the model pass through free-standing obstacles that are at most this long and wide [default: 0]
    #[arg(long, help_heading = METHOD, value_name = "METERS")]
    pub(crate) max_speck: Option<f64>,
    /// Train on at most N cells of each class, evenly spread [default: 3000; for a network: 6000; with --chapter: all]
    #[arg(long, help_heading = METHOD, value_name = "N")]
    pub(crate) max_cells_per_class: Option<usize>,
    /// Hold out these as a whole, to choose and to judge [default: buildings, where there are two or more]
    #[arg(long, help_heading = METHOD, value_enum, value_name = "WHAT")]
    pub(crate) hold_out: Option<HoldOutArg>,
    /// Also write the report as a page, with pictures of the errors and a learning curve
    #[arg(long, value_name = "HTML")]
    pub(crate) report: Option<PathBuf>,
    /// Print the report as JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) read: ReadArgs,
}

#[derive(Debug, Args)]
pub(crate) struct EvaluateArgs {
    /// Label image to evaluate, or a folder with a folder per map, as `map` writes it
    #[arg(value_name = "PREDICTION")]
    pub(crate) prediction: PathBuf,
    /// True labels, as `train` reads them (0 none, k class k, 255 ignore); or a folder with a folder per map
    #[arg(value_name = "LABELS")]
    pub(crate) labels: PathBuf,
    /// Set the meters per pixel, to evaluate doorways as objects too [default, for folders: from the map.yaml next to the truth]
    #[arg(long, value_name = "METERS")]
    pub(crate) resolution: Option<f64>,
    /// For folders: the name of the true labels in the folder of each map
    #[arg(long, value_name = "NAME", default_value = "labels.png")]
    pub(crate) truth: PathBuf,
    /// For folders: also write the table as comma-separated values
    #[arg(long, value_name = "FILE")]
    pub(crate) csv: Option<PathBuf>,
    /// Evaluate only these pixels, y down, upper bounds exclusive
    #[arg(long, value_name = "X0,Y0,X1,Y1")]
    pub(crate) crop: Option<CropArg>,
    /// True rooms: an image of room numbers, 0 none, or a Valetudo JSON with segments
    #[arg(long, help_heading = ROOMS, requires = "regions", value_name = "IMAGE")]
    pub(crate) rooms: Option<PathBuf>,
    /// Found regions: an image of region numbers, 0 none
    #[arg(long, help_heading = ROOMS, requires = "rooms", value_name = "IMAGE")]
    pub(crate) regions: Option<PathBuf>,
    /// Take the classes from this model
    #[arg(long, value_name = "FILE", conflicts_with = "classes")]
    pub(crate) model: Option<PathBuf>,
    /// Take the classes from this file: TOML with [classes], a model, or the labels.yaml of a result
    /// [default: from the files next to the prediction, else corridor, room, doorway]
    #[arg(long, value_name = "FILE")]
    pub(crate) classes: Option<PathBuf>,
    /// For folders: also compare with the results in this folder, map by map, with a paired test
    #[arg(long, value_name = "FOLDER")]
    pub(crate) against: Option<PathBuf>,
    /// Exit with status 1 if the cell accuracy is below this share
    #[arg(long, value_name = "SHARE", value_parser = values::share)]
    pub(crate) min_accuracy: Option<f64>,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// Formats of labels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum LabelFormatArg {
    /// Image with a palette, for GIMP and Krita
    Png,
    /// Polygons for labelme
    Labelme,
    /// COCO annotations: polygons and masks
    Coco,
    /// Polygons in meters of the map frame, for QGIS
    Geojson,
}

#[derive(Debug, Args)]
pub(crate) struct LabelsArgs {
    /// Map that the labels belong to
    #[arg(value_name = "MAP")]
    pub(crate) map: PathBuf,
    /// Labels to start from: the folder of a result, a label image, labelme, COCO or GeoJSON, or a topology.json
    #[arg(long, value_name = "RESULT|LABELS")]
    pub(crate) from: PathBuf,
    /// Format to write
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub(crate) to: LabelFormatArg,
    /// Write the labels to this file
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: PathBuf,
    /// Take the classes from this file: TOML with [classes], a model, or the labels.yaml of a result [default: those of the labels]
    #[arg(long, value_name = "FILE")]
    pub(crate) classes: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) read: ReadArgs,
}
