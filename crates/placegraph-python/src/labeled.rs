//! A labeled map, and its files.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use placegraph::export::{
    Export, FORMATS, FRAME_ID, Format, Georeference, MaskSettings, ModelInfo, TopologyDocument, overview_png,
};
use placegraph::geom::Point2;
use placegraph::import::{self, LoadedMap, ReadOptions, check};
use placegraph::model::{Model as Trained, sha256_hex};
use placegraph::pipeline::{self, Analysis, Config};
use placegraph::progress::Progress;
use placegraph::result::{Files, InputHashes, LabeledMap, ResultContents, ResultOptions, check_size};
use placegraph::session;
use placegraph::topology::edits::{Edit, EditFile};
use placegraph::topology::reach::{MAX_RADIUS_M, Robot};
use placegraph_cli::package;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays;
use crate::call::long;
use crate::error::{Exception, Failure};
use crate::grid::Grid as PyGrid;
use crate::model::Model;

/// Labels `grid` with `model`. `previous` is the document of an earlier result, `edits` the path of an edit file.
#[pyfunction]
#[expect(
    clippy::too_many_arguments,
    clippy::fn_params_excessive_bools,
    reason = "called from one place, which has names for them"
)]
pub(crate) fn label(
    py: Python<'_>,
    grid: &PyGrid,
    model: &Model,
    previous: Option<Vec<u8>>,
    edits: Option<PathBuf>,
    doorways: bool,
    correction: bool,
    align: bool,
    hold: bool,
    robot: (f64, Option<(f64, f64)>),
    threads: Option<usize>,
    session: Option<&Session>,
) -> PyResult<Labeled> {
    let (radius_m, from) = robot;
    if !(0.0..=MAX_RADIUS_M).contains(&radius_m) {
        let text = format!("expected a robot's radius of 0 to {MAX_RADIUS_M} m, found {radius_m}");
        return Err(PyValueError::new_err(text));
    }
    if from.is_some_and(|(x, y)| !(x.is_finite() && y.is_finite())) {
        return Err(PyValueError::new_err("expected two finite numbers as the robot's position"));
    }
    let robot = Robot { radius_m, from: from.map(|(x, y)| Point2::new(x, y)) };
    let (map, trained, info) = (Arc::clone(&grid.map), Arc::clone(&model.model), model.info());
    let config = Config {
        correction,
        robot,
        hold,
        align_previous: align,
        ..if doorways { Config::default() } else { Config::chapter() }
    };
    let read = grid.read.clone();
    let session = session.map(|session| Arc::clone(&session.0));
    let setup = Setup { map, model: trained, info, read, config, previous, edits, session };
    long(py, threads, move |progress| setup.label(progress))
}

/// What is known of one map of a building, for the next one.
#[pyclass(frozen, module = "placegraph._native")]
#[derive(Debug)]
pub(crate) struct Session(Arc<Mutex<session::Session>>);

#[pymethods]
impl Session {
    #[new]
    fn new(model: &Model) -> Self {
        Self(Arc::new(Mutex::new(session::Session::new((*model.model).clone()))))
    }
}

/// A map and all that its labels depend on.
struct Setup {
    map: Arc<LoadedMap>,
    model: Arc<Trained>,
    info: ModelInfo,
    read: ReadOptions,
    config: Config,
    previous: Option<Vec<u8>>,
    edits: Option<PathBuf>,
    /// What is known of the map before.
    session: Option<Arc<Mutex<session::Session>>>,
}

impl Setup {
    fn label(mut self, progress: &dyn Progress) -> Result<Labeled, Failure> {
        let previous = self.previous.as_deref().map(TopologyDocument::from_json).transpose();
        let previous = previous.map_err(|error| Failure::new(Exception::Topology, error))?;
        let (edits, edits_hash) = self.read_edits()?;
        let inputs = InputHashes {
            previous: self.previous.as_deref().map(sha256_hex),
            edits: edits_hash,
            ..InputHashes::default()
        };
        check_size(&self.map, &self.model, self.config.correction)
            .map_err(|error| Failure::new(Exception::Map, error))?;
        self.config.edits = edits;
        self.config.previous = previous.as_ref().map(TopologyDocument::topology);
        if let Some(found) = previous.map(|p| p.map.frame_id).filter(|found| found != FRAME_ID) {
            let text = format!("expected an earlier result in the frame {FRAME_ID:?}, found {found:?}");
            return Err(Failure::new(Exception::Topology, text));
        }
        let findings = check(&self.map).findings;
        let analysis = match &self.session {
            // A panic leaves a session with less than it knew, not with something wrong.
            Some(session) => {
                let mut session = session.lock().unwrap_or_else(PoisonError::into_inner);
                session.update(&self.map.grid, &self.config, progress).analysis
            }
            None => pipeline::analyze(&self.map.grid, &self.model, &self.config, progress),
        };
        let labeled = LabeledMap { map: &self.map, classes: &self.model.label_set, analysis: &analysis };
        let edits = self.edits.unwrap_or_default().display().to_string();
        let mut document = labeled.document(self.info, &findings, &self.config.robot, &edits);
        // Results name them by their hashes.
        let config = Config { edits: Vec::new(), previous: None, ..self.config };
        let made = Made { read: self.read, config, inputs };
        document.program.options = made.words(&contents(&MaskSettings::default()), None);
        Ok(Labeled { map: self.map, analysis, document, made })
    }

    /// The edits, and the hash of their file.
    fn read_edits(&self) -> Result<(Vec<Edit>, Option<String>), Failure> {
        let Some(path) = &self.edits else { return Ok((Vec::new(), None)) };
        let bytes = import::read(path, import::MAX_TEXT_BYTES)
            .map_err(|error| Failure::reading(Exception::Edit, path, &error))?;
        let text = String::from_utf8_lossy(&bytes);
        let file = EditFile::from_toml(&text)
            .map_err(|error| Failure::new(Exception::Edit, format!("{error} (in {})", path.display())))?;
        Ok((file.edits, Some(sha256_hex(&bytes))))
    }
}

/// How a result was made.
#[derive(Debug)]
struct Made {
    read: ReadOptions,
    config: Config,
    inputs: InputHashes,
}

impl Made {
    /// The options of a result with these files.
    fn words(&self, contents: &ResultContents<'_>, masks_hash: Option<String>) -> Vec<String> {
        let inputs = InputHashes { masks: masks_hash, ..self.inputs.clone() };
        ResultOptions { read: &self.read, config: &self.config, contents, inputs: &inputs }.words()
    }
}

/// The files that every result has.
fn contents(masks: &MaskSettings) -> ResultContents<'_> {
    ResultContents {
        stages: false,
        probabilities: false,
        formats: &[],
        masks,
        georeference: None,
        written: package::fixed_time().unwrap_or_default(),
    }
}

/// The names of all formats, and what each is.
#[pyfunction]
pub(crate) fn export_formats() -> Vec<(&'static str, &'static str)> {
    FORMATS.iter().map(|format| (format.name, format.doc)).collect()
}

/// All that the pipeline found.
#[pyclass(frozen, module = "placegraph._native")]
#[derive(Debug)]
pub(crate) struct Labeled {
    map: Arc<LoadedMap>,
    analysis: Analysis,
    document: TopologyDocument,
    made: Made,
}

#[pymethods]
impl Labeled {
    /// The class of every free cell, counted from 1; 0 elsewhere.
    fn labels<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u8>>> {
        let labels = &self.analysis.labeling;
        arrays::from_nodes(py, &self.analysis.space.graph, |node| labels[node].0 + 1)
    }

    /// The number of its place for every cell of one; 0 elsewhere.
    fn regions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        let Analysis { regions, place_ids, .. } = &self.analysis;
        let number = |node: usize| place_ids[regions.region_of[node].index()].map_or(0, |id| id.0);
        arrays::from_nodes(py, &self.analysis.space.graph, number)
    }

    /// The probability of every class in every free cell after the neighbors were heard; 0 elsewhere.
    fn probabilities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let (graph, smoothed) = (&self.analysis.space.graph, &self.analysis.smoothed);
        let (n_labels, height, width) =
            (smoothed.n_labels(), graph.height() as usize, graph.width() as usize);
        let mut values = vec![0.0; n_labels * height * width];
        for (node, cell) in graph.cells_in_rows(0..graph.height()).enumerate() {
            let pixel = (height - 1 - cell.y as usize) * width + cell.x as usize;
            for (k, p) in smoothed.row(node).iter().enumerate() {
                values[k * height * width + pixel] = *p;
            }
        }
        PyArray1::from_vec(py, values).reshape([n_labels, height, width])
    }

    /// The class of every free cell by its own scan alone, counted from 1; 0 elsewhere.
    fn classified<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u8>>> {
        let labels = &self.analysis.classified;
        arrays::from_nodes(py, &self.analysis.space.graph, |node| labels[node].0 + 1)
    }

    /// The topological map as a document.
    fn topology_json(&self, py: Python<'_>) -> PyResult<String> {
        let json = py.detach(|| self.document.to_json());
        Ok(json.map_err(|error| Failure::new(Exception::Topology, error))?)
    }

    /// What changed since the earlier result, as JSON.
    fn changes_json(&self) -> String {
        serde_json::to_string(&self.analysis.changes).unwrap_or_default()
    }

    /// The overview as a PNG file.
    fn overview_png<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        let png = py.detach(|| {
            let Analysis { labeling, topology, .. } = &self.analysis;
            overview_png(self.labeled().grid(), labeling, &self.document.classes, topology, &self.map.name)
        });
        PyBytes::new(py, &png)
    }

    /// Writes the files of the program's `map` into a folder, and returns their paths.
    #[expect(clippy::too_many_arguments, reason = "called from one place, which has names for them")]
    fn save(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        export: Vec<String>,
        masks: Option<PathBuf>,
        stages: bool,
        probabilities: bool,
        georeference: Option<(f64, f64, f64)>,
    ) -> PyResult<Vec<OsString>> {
        let georeference = georeference.map(on_earth).transpose()?;
        let asked = export.iter().map(|name| format(name)).collect::<PyResult<Vec<_>>>()?;
        // Each once, in the order of the table.
        let formats: Vec<&'static Format> =
            FORMATS.iter().filter(|known| asked.iter().any(|format| format.name == known.name)).collect();
        let written = py.detach(|| {
            let failed = |error: &dyn std::fmt::Display| Failure::new(Exception::Export, error);
            let (masks, masks_hash) = read_masks(masks.as_deref())?;
            let mut document = self.document.clone();
            let contents =
                ResultContents { stages, probabilities, formats: &formats, georeference, ..contents(&masks) };
            document.program.options = self.made.words(&contents, masks_hash);
            let files = self.labeled().files(&mut document, &contents).map_err(|error| failed(&error))?;
            commit(files, &folder)
        });
        Ok(written?)
    }

    /// Writes one format to a file, or into a folder, and returns the paths of its files.
    fn export(
        &self,
        py: Python<'_>,
        format: &str,
        path: PathBuf,
        masks: Option<PathBuf>,
        georeference: Option<(f64, f64, f64)>,
    ) -> PyResult<Vec<OsString>> {
        let format = self::format(format)?;
        let georeference = georeference.map(on_earth).transpose()?;
        let is_folder = path.is_dir();
        let usual = format.usual_name(&self.document.map.name);
        let named = path.file_name().filter(|_| !is_folder).map(|name| name.to_string_lossy().into_owned());
        let main = named.unwrap_or(usual);
        let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let folder = if is_folder { path.as_path() } else { parent };
        let written = py.detach(|| {
            let failed = |error: &dyn std::fmt::Display| {
                Failure::new(Exception::Export, format!("cannot write {main}: {error}"))
            };
            let (masks, _) = read_masks(masks.as_deref())?;
            let mut export = Export::new(&self.document, &masks).map_err(|error| failed(&error))?;
            export.written = package::fixed_time().unwrap_or_default();
            export.georeference = georeference;
            let labeled = self.labeled();
            if format.needs_cells {
                labeled.add_cells(&mut export);
            }
            let files = format.write(&export, &main).map_err(|error| failed(&error))?;
            let paths: Vec<PathBuf> = files.iter().map(|(name, _)| folder.join(name)).collect();
            for ((_, bytes), path) in files.iter().zip(&paths) {
                package::write_file(path, bytes)
                    .map_err(|error| Failure::of_file(Exception::Export, path, &error))?;
            }
            Ok::<_, Failure>(paths.into_iter().map(PathBuf::into_os_string).collect())
        });
        Ok(written?)
    }
}

impl Labeled {
    fn labeled(&self) -> LabeledMap<'_> {
        LabeledMap { map: &self.map, classes: &self.document.classes, analysis: &self.analysis }
    }
}

fn format(name: &str) -> PyResult<&'static Format> {
    Format::by_name(name).ok_or_else(|| {
        let names: Vec<&str> = FORMATS.iter().map(|format| format.name).collect();
        PyValueError::new_err(format!("expected one of {}, found {name:?}", names.join(", ")))
    })
}

/// Latitude and longitude of the map frame's origin, and where its y axis points, in degrees.
fn on_earth((latitude_deg, longitude_deg, heading_deg): (f64, f64, f64)) -> PyResult<Georeference> {
    Georeference::new(latitude_deg, longitude_deg, heading_deg).ok_or_else(|| {
        let most = Georeference::MAX_LATITUDE_DEG;
        PyValueError::new_err(format!(
            "expected a latitude to {most}, a longitude to 180 and a heading to 360 degrees, found {latitude_deg}, {longitude_deg} \
             and {heading_deg}"
        ))
    })
}

fn read_masks(path: Option<&Path>) -> Result<(MaskSettings, Option<String>), Failure> {
    let at = path.unwrap_or(Path::new(""));
    package::masks(path).map_err(|error| Failure::of_file(Exception::Export, at, &error))
}

fn commit(files: Files, folder: &Path) -> Result<Vec<OsString>, Failure> {
    let written = package::write_result(folder, files)
        .map_err(|error| Failure::of_file(Exception::Export, folder, &error))?;
    Ok(written.iter().map(|name| folder.join(name).into_os_string()).collect())
}
