//! What was typed, read: the model, the masks, and for every map its edits and its earlier result.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, ensure};
use placegraph::export::{Format, MaskSettings, TopologyDocument};
use placegraph::geom::Point2;
use placegraph::model::sha256_hex;
use placegraph::pipeline;
use placegraph::topology::edits::{Edit, EditFile};
use placegraph::topology::reach::Robot;

use super::jobs::Job;
use crate::args::{Formats, GeoArg, MapArgs, PointArg, ReadArgs, RulesArg};
use crate::document;
use crate::model::NamedModel;
use crate::read;

/// What holds for all maps of a run.
#[derive(Debug)]
pub(super) struct Setup<'a> {
    pub(super) args: &'a MapArgs,
    pub(super) model: NamedModel,
    pub(super) masks: MaskSettings,
    /// The formats asked for, each once, in the order of the table.
    pub(super) formats: Vec<&'static Format>,
    /// What results depend on beside map, model, formats and what belongs to a single map, always in the same words.
    options: Vec<String>,
}

/// What belongs to a single map.
#[derive(Debug)]
pub(super) struct Context {
    pub(super) config: pipeline::Config,
    /// The edit file.
    pub(super) edits: PathBuf,
    /// Name of the frame that the earlier result is in.
    pub(super) previous_frame_id: Option<String>,
    /// What results depend on beside map and model, as the document names it.
    pub(super) options: Vec<String>,
}

impl<'a> Setup<'a> {
    /// Reads the files that hold for all maps.
    pub(super) fn new(args: &'a MapArgs) -> Result<Self> {
        ensure!(
            args.maps.len() == 1 || (args.previous.is_none() && args.edits.is_none()),
            "expected one map with --previous or --edits, found {}",
            args.maps.len()
        );
        let model = NamedModel::load(args.model.as_deref())?;
        model.check_method(args.method)?;
        let (masks, masks_hash) = read::masks(args.masks.as_deref())?;
        masks.check(&model.model.label_set)?;
        let formats = Formats::in_order(&args.export);
        Ok(Self { options: options(args, masks_hash.as_deref()), args, model, masks, formats })
    }

    /// The names of the classes, in the order of their labels.
    pub(super) fn classes(&self) -> Vec<&str> {
        self.model.model.label_set.classes().iter().map(|class| class.name.as_str()).collect()
    }

    /// Reads the files that belong to the map of `job`.
    pub(super) fn context(&self, _job: &Job) -> Result<Context> {
        let mut options = self.options.clone();
        options.extend(self.formats.iter().map(|format| format!("--export {}", format.name)));
        let read = |path: &Path| document::read_hashed(path, self.args.read.max_cells);
        let previous = self.args.previous.as_deref().map(read).transpose()?;
        let edits = self.args.edits.as_deref().map(read_edits).transpose()?;
        options.extend(previous.as_ref().map(|(_, hash)| format!("--previous sha256:{hash}")));
        options.extend(edits.as_ref().map(|(_, hash)| format!("--edits sha256:{hash}")));
        let previous = previous.map(|(document, _)| document);
        let config = pipeline::Config {
            correction: !self.args.no_correction,
            edits: edits.map(|(edits, _)| edits).unwrap_or_default(),
            robot: Robot {
                radius_m: self.args.robot_radius,
                from: self.args.from.map(|point| Point2::new(point.x, point.y)),
            },
            previous: previous.as_ref().map(TopologyDocument::topology),
            align_previous: self.args.align,
            ..if self.args.no_doorways { pipeline::Config::chapter() } else { pipeline::Config::default() }
        };
        Ok(Context {
            config,
            edits: self.args.edits.clone().unwrap_or_default(),
            previous_frame_id: previous.map(|document| document.map.frame_id),
            options,
        })
    }
}

/// The edits in a file, and the hash of the bytes that they were read from.
fn read_edits(path: &Path) -> Result<(Vec<Edit>, String)> {
    let text = read::text(path, "edit file")?;
    let file = EditFile::from_toml(&text).with_context(|| format!("in {}", path.display()))?;
    Ok((file.edits, sha256_hex(text.as_bytes())))
}

/// What was typed that results depend on, always in the same words; a file by its content. Every argument is named
/// here: a new one does not compile until it has its place.
fn options(args: &MapArgs, masks_hash: Option<&str>) -> Vec<String> {
    let MapArgs {
        // Told by the document's `map` and `model`.
        maps: _,
        model: _,
        // Of these the result does not depend.
        out: _,
        method: _,
        resume: _,
        // Added where the formats and the files of a map are read.
        export: _,
        previous: _,
        edits: _,
        masks: _,
        stages,
        probabilities,
        no_doorways,
        no_correction,
        georeference,
        align,
        robot_radius,
        from,
        read:
            ReadArgs {
                resolution,
                rules,
                trust_thresholds,
                // What they refuse has no result.
                allow_outside: _,
                max_cells: _,
            },
    } = args;
    let switches = [
        (*stages, "--stages"),
        (*probabilities, "--probabilities"),
        (*no_doorways, "--no-doorways"),
        (*no_correction, "--no-correction"),
        (*rules == RulesArg::Humble, "--rules humble"),
        (*align, "--align"),
        (*rules == RulesArg::Ros1, "--rules ros1"),
        (*trust_thresholds, "--trust-thresholds"),
    ];
    let mut options: Vec<String> =
        switches.into_iter().filter(|(is_on, _)| *is_on).map(|(_, name)| name.to_owned()).collect();
    options.extend((*robot_radius > 0.0).then(|| format!("--robot-radius {robot_radius}")));
    options.extend(georeference.map(|GeoArg(place)| {
        format!("--georeference {},{},{}", place.latitude_deg, place.longitude_deg, place.heading_deg)
    }));
    options.extend(from.map(|PointArg { x, y }| format!("--from {x},{y}")));
    options.extend(resolution.map(|resolution| format!("--resolution {resolution}")));
    options.extend(masks_hash.map(|hash| format!("--masks sha256:{hash}")));
    options
}
