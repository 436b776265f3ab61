//! What was typed, read: the model, the masks, and for every map its edits and its earlier result.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, ensure};
use placegraph::export::{Format, MaskSettings, TopologyDocument};
use placegraph::geom::Point2;
use placegraph::import::ReadOptions;
use placegraph::model::sha256_hex;
use placegraph::pipeline;
use placegraph::result::{InputHashes, ResultContents, ResultOptions};
use placegraph::topology::edits::{Edit, EditFile};
use placegraph::topology::reach::Robot;

use super::jobs::Job;
use crate::args::{Formats, MapArgs};
use crate::document::{self, DOCUMENT};
use crate::model::NamedModel;
use crate::read;

/// What holds for all maps of a run.
#[derive(Debug)]
pub(super) struct Setup<'a> {
    pub(super) args: &'a MapArgs,
    pub(super) model: NamedModel,
    /// How maps are read.
    pub(super) read: ReadOptions,
    pub(super) masks: MaskSettings,
    /// SHA-256 of the mask file.
    masks_hash: Option<String>,
    /// The formats asked for, each once, in the order of the table.
    pub(super) formats: Vec<&'static Format>,
    /// Whether the run is about a single map that was named itself.
    pub(super) is_single: bool,
    /// How many maps lie in each folder.
    neighbors: BTreeMap<PathBuf, usize>,
}

/// What belongs to a single map.
#[derive(Debug)]
pub(super) struct Context {
    pub(super) config: pipeline::Config,
    /// The folder of the result.
    pub(super) folder: PathBuf,
    /// The edit file.
    pub(super) edits: PathBuf,
    /// Whether the earlier result is the one that will be replaced.
    pub(super) continues: bool,
    /// Files that the run reads in addition to the map.
    pub(super) inputs: Vec<PathBuf>,
    /// Name of the frame that the earlier result is in.
    pub(super) previous_frame_id: Option<String>,
    /// The options that the result depends on, as its document lists them.
    pub(super) options: Vec<String>,
}

impl<'a> Setup<'a> {
    /// Reads the files that hold for all maps.
    pub(super) fn new(args: &'a MapArgs, jobs: &[Job]) -> Result<Self> {
        let is_single = matches!(jobs, [job] if job.name.is_none());
        if let (false, Some(edits)) = (is_single, &args.edits) {
            ensure!(
                edits.file_name() == Some(edits.as_os_str()),
                "for several maps, --edits takes the name of a file next to each map, such as edits.toml; found {}",
                edits.display()
            );
        }
        if let Some(previous) = &args.previous {
            let is_there = if is_single { previous.exists() } else { previous.is_dir() };
            ensure!(
                is_there || *previous == args.out,
                "expected {} as --previous, found none at {}",
                if is_single { "a topology.json or its folder" } else { "the folder of an earlier run" },
                previous.display()
            );
        }
        let model = NamedModel::load(args.model.as_deref())?;
        model.check_method(args.method)?;
        let (masks, masks_hash) = read::masks(args.masks.as_deref())?;
        masks.check(&model.model.label_set)?;
        let formats = Formats::in_order(&args.export);
        let mut neighbors = BTreeMap::new();
        for job in jobs {
            *neighbors.entry(folder_of(&job.map)).or_default() += 1;
        }
        let read = read::options(&args.read);
        Ok(Self { args, model, read, masks, masks_hash, formats, is_single, neighbors })
    }

    /// The names of the classes, in the order of their labels.
    pub(super) fn classes(&self) -> Vec<&str> {
        self.model.model.label_set.classes().iter().map(|class| class.name.as_str()).collect()
    }

    /// What the files of a result depend on besides the map.
    pub(super) fn contents(&self) -> ResultContents<'_> {
        ResultContents {
            stages: self.args.stages,
            probabilities: self.args.probabilities,
            formats: &self.formats,
            masks: &self.masks,
            georeference: self.args.georeference.map(|place| place.0),
            written: document::fixed_time().unwrap_or_default(),
        }
    }

    /// Reads the files that belong to the map of `job`.
    pub(super) fn context(&self, job: &Job) -> Result<Context> {
        let folder = self.args.out.join(&job.place);
        let read = |path: &Path| document::read_hashed(path, self.args.read.max_cells);
        let previous_path = self.previous(job);
        let previous = previous_path.as_deref().map(read).transpose()?;
        let edits_path = self.edits(job)?;
        let edits = edits_path.as_deref().map(read_edits).transpose()?;
        let inputs = InputHashes {
            masks: self.masks_hash.clone(),
            previous: previous.as_ref().map(|(_, hash)| hash.clone()),
            edits: edits.as_ref().map(|(_, hash)| hash.clone()),
        };
        let previous = previous.map(|(document, _)| document);
        let config = pipeline::Config {
            correction: !self.args.no_correction,
            edits: edits.map(|(edits, _)| edits).unwrap_or_default(),
            robot: Robot {
                radius_m: self.args.robot_radius,
                from: self.args.from.map(|point| Point2::new(point.x, point.y)),
            },
            previous: previous.as_ref().map(TopologyDocument::topology),
            hold: self.args.hold,
            align_previous: self.args.align,
            ..if self.args.no_doorways { pipeline::Config::chapter() } else { pipeline::Config::default() }
        };
        let options =
            ResultOptions { read: &self.read, config: &config, contents: &self.contents(), inputs: &inputs };
        let options = options.words();
        let shared = [&self.args.model, &self.args.masks].into_iter().flatten().cloned();
        Ok(Context {
            config,
            continues: self.args.previous.as_deref().is_some_and(|previous| {
                previous == self.args.out
                    || same_file::is_same_file(in_folder(previous, job), folder.join(DOCUMENT))
                        .unwrap_or(false)
            }),
            folder,
            inputs: shared.chain(edits_path.clone()).collect(),
            edits: edits_path.unwrap_or_default(),
            previous_frame_id: previous.map(|document| document.map.frame_id),
            options,
        })
    }

    /// The earlier result of the map, if it has one.
    fn previous(&self, job: &Job) -> Option<PathBuf> {
        let path = in_folder(self.args.previous.as_deref()?, job);
        path.exists().then_some(path)
    }

    /// The edit file of the map: the named file for a single map, else the file of that name next to it, if there is one.
    fn edits(&self, job: &Job) -> Result<Option<PathBuf>> {
        let Some(edits) = &self.args.edits else { return Ok(None) };
        if self.is_single {
            return Ok(Some(edits.clone()));
        }
        let folder = folder_of(&job.map);
        let stem = job.map.file_stem().unwrap_or_default().to_string_lossy();
        let own = folder.join(format!("{stem}.{}", edits.display()));
        if own.exists() {
            return Ok(Some(own));
        }
        let common = folder.join(edits);
        if !common.exists() {
            return Ok(None);
        }
        let n_maps = self.neighbors.get(&folder).copied().unwrap_or(1);
        ensure!(
            n_maps == 1,
            "{} lies next to {n_maps} maps of this run: rename it to {}",
            common.display(),
            own.display()
        );
        Ok(Some(common))
    }
}

/// The document of the map in the folder of an earlier run; a file is the document itself.
fn in_folder(previous: &Path, job: &Job) -> PathBuf {
    if previous.is_dir() { previous.join(&job.place).join(DOCUMENT) } else { previous.to_owned() }
}

fn folder_of(map: &Path) -> PathBuf {
    map.parent().unwrap_or(Path::new("")).to_owned()
}

/// The edits in a file, and the hash of the bytes that they were read from.
pub(crate) fn read_edits(path: &Path) -> Result<(Vec<Edit>, String)> {
    let text = read::text(path, "edit file")?;
    let file = EditFile::from_toml(&text).with_context(|| format!("in {}", path.display()))?;
    Ok((file.edits, sha256_hex(text.as_bytes())))
}
