//! A labeled map, and its files.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use placegraph::export::{
    Export, FORMATS, FileRecord, Format, MapInfo, MaskSettings, ModelInfo, RasterError, SkippedFormat,
    TopologyDocument, label_png, overview_png, probability_npy, raster_yaml, region_png,
};
use placegraph::geom::Point2;
use placegraph::grid::{Grid, Occupancy, OccupancyGrid};
use placegraph::import::ros::Rules;
use placegraph::import::{self, LoadedMap, Severity, check, has_memory};
use placegraph::model::{Model as Trained, sha256_hex};
use placegraph::pipeline::{self, Analysis, Config};
use placegraph::progress::Progress;
use placegraph::topology::edits::{Edit, EditFile};
use placegraph::topology::reach::{self, GraphCheck, MAX_RADIUS_M, Robot};
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
#[expect(clippy::too_many_arguments, reason = "called from one place, which has names for them")]
pub(crate) fn label(
    py: Python<'_>,
    grid: &PyGrid,
    model: &Model,
    previous: Option<Vec<u8>>,
    edits: Option<PathBuf>,
    doorways: bool,
    correction: bool,
    robot: (f64, Option<(f64, f64)>),
    threads: Option<usize>,
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
    let choices =
        Choices { no_doorways: !doorways, no_correction: !correction, robot, ..grid.choices.clone() };
    let setup = Setup { map, model: trained, info, choices, previous, edits };
    long(py, threads, move |progress| setup.label(progress))
}

/// All that results depend on beside map and model.
#[derive(Clone, Debug, Default)]
pub(crate) struct Choices {
    pub(crate) no_doorways: bool,
    pub(crate) no_correction: bool,
    pub(crate) rules: Rules,
    pub(crate) trust_thresholds: bool,
    pub(crate) resolution_m: Option<f64>,
    pub(crate) robot: Robot,
    /// SHA-256 of the earlier result and of the edit file.
    pub(crate) previous: Option<String>,
    pub(crate) edits: Option<String>,
}

impl Choices {
    /// As the program names them in a document; `masks` is the hash of the mask file.
    fn words(&self, stages: bool, probabilities: bool, masks: Option<&str>) -> Vec<String> {
        let switches = [
            (stages, "--stages"),
            (probabilities, "--probabilities"),
            (self.no_doorways, "--no-doorways"),
            (self.no_correction, "--no-correction"),
            (self.rules == Rules::Humble, "--rules humble"),
            (self.rules == Rules::Ros1, "--rules ros1"),
            (self.trust_thresholds, "--trust-thresholds"),
        ];
        let mut words: Vec<String> =
            switches.into_iter().filter(|(is_on, _)| *is_on).map(|(_, name)| name.to_owned()).collect();
        let Robot { radius_m, from } = self.robot;
        words.extend((radius_m > 0.0).then(|| format!("--robot-radius {radius_m}")));
        words.extend(from.map(|Point2 { x, y }| format!("--from {x},{y}")));
        words.extend(self.resolution_m.map(|resolution_m| format!("--resolution {resolution_m}")));
        words.extend(masks.map(|hash| format!("--masks sha256:{hash}")));
        words.extend(self.previous.as_ref().map(|hash| format!("--previous sha256:{hash}")));
        words.extend(self.edits.as_ref().map(|hash| format!("--edits sha256:{hash}")));
        words
    }
}

/// Memory that a call takes beside the map and what grows with it.
const BASE_BYTES: u64 = 64 << 20;

/// A map and all that its labels depend on.
struct Setup {
    map: Arc<LoadedMap>,
    model: Arc<Trained>,
    info: ModelInfo,
    choices: Choices,
    previous: Option<Vec<u8>>,
    edits: Option<PathBuf>,
}

impl Setup {
    fn label(mut self, progress: &dyn Progress) -> Result<Labeled, Failure> {
        let previous = self.previous.as_deref().map(TopologyDocument::from_json).transpose();
        let previous = previous.map_err(|error| Failure::new(Exception::Topology, error))?;
        self.choices.previous = self.previous.as_deref().map(sha256_hex);
        let edits = self.read_edits()?;
        self.check_memory()?;
        let base = if self.choices.no_doorways { Config::chapter() } else { Config::default() };
        let config = Config {
            correction: !self.choices.no_correction,
            edits,
            robot: self.choices.robot,
            previous: previous.as_ref().map(TopologyDocument::topology),
            ..base
        };
        let info = MapInfo::of(&self.map.grid, &self.map.name, &self.map.hash);
        if let Some(found) = previous.map(|p| p.map.frame_id).filter(|found| *found != info.frame_id) {
            let text =
                format!("expected an earlier result in the frame {:?}, found {found:?}", info.frame_id);
            return Err(Failure::new(Exception::Topology, text));
        }
        let findings = check(&self.map).findings;
        let analysis = pipeline::analyze(&self.map.grid, &self.model, &config, progress);
        let classes = &self.model.label_set;
        let mut document = TopologyDocument::new(info, Some(self.info), classes, &analysis.topology);
        document.program.options = self.choices.words(false, false, None);
        let file = self.edits.unwrap_or_default();
        let outcomes = analysis.edit_outcomes.iter().zip(1..);
        let unapplied = outcomes.filter_map(|(outcome, n)| {
            let reason = outcome.as_ref().err()?;
            Some(format!("edit {n} of {} does not apply: {reason}", file.display()))
        });
        let unapplied: Vec<String> = unapplied.collect();
        let errors = findings.iter().filter(|finding| finding.severity() == Severity::Error);
        document.errors = errors.map(package::told).chain(unapplied.iter().cloned()).collect();
        document.findings = findings.iter().map(package::told).chain(unapplied).collect();
        document.graph = Some(GraphCheck::of(&analysis.topology, config.robot.radius_m));
        document.findings.extend(reach::remarks(&analysis.topology, &config.robot));
        Ok(Labeled { map: self.map, analysis, document, choices: self.choices })
    }

    fn read_edits(&mut self) -> Result<Vec<Edit>, Failure> {
        let Some(path) = &self.edits else { return Ok(Vec::new()) };
        let bytes = import::read(path, import::MAX_TEXT_BYTES)
            .map_err(|error| Failure::reading(Exception::Edit, path, &error))?;
        let text = String::from_utf8_lossy(&bytes);
        let file = EditFile::from_toml(&text)
            .map_err(|error| Failure::new(Exception::Edit, format!("{error} (in {})", path.display())))?;
        self.choices.edits = Some(sha256_hex(&bytes));
        Ok(file.edits)
    }

    fn check_memory(&self) -> Result<(), Failure> {
        let grid = &self.map.grid;
        let (n_cells, n_free) = (grid.cells.values().len() as u64, grid.count(Occupancy::Free) as u64);
        let n_labels = self.model.label_set.len();
        for n_places in [0, pipeline::n_parts(grid)] {
            let n_bytes = BASE_BYTES + pipeline::memory_bytes(n_cells, n_free, n_labels, n_places);
            if !has_memory(n_bytes) {
                let text = format!("not enough memory: labeling {n_free} free cells needs {n_bytes} bytes");
                return Err(Failure::new(Exception::Map, text));
            }
        }
        Ok(())
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
    choices: Choices,
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
            overview_png(self.drawn(), labeling, &self.document.classes, topology, &self.map.name)
        });
        PyBytes::new(py, &png)
    }

    /// Writes the files of the program's `map` into a folder, and returns their paths.
    fn save(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        export: Vec<String>,
        masks: Option<PathBuf>,
        stages: bool,
        probabilities: bool,
    ) -> PyResult<Vec<PathBuf>> {
        let asked = export.iter().map(|name| format(name)).collect::<PyResult<Vec<_>>>()?;
        // Each once, in the order of the table.
        let formats: Vec<&'static Format> =
            FORMATS.iter().filter(|known| asked.iter().any(|format| format.name == known.name)).collect();
        let written = py.detach(|| {
            let failed = |error: &dyn std::fmt::Display| Failure::new(Exception::Export, error);
            let (masks, masks_hash) = read_masks(masks.as_deref())?;
            let mut document = self.document.clone();
            document.program.options = self.choices.words(stages, probabilities, masks_hash.as_deref());
            let asked = formats.iter().map(|format| format!("--export {}", format.name));
            document.program.options.extend(asked);
            let mut files = self.pictures(stages, probabilities).map_err(|error| failed(&error))?;
            let mut skipped = Vec::new();
            let mut export = Export::new(&document, &masks).map_err(|error| failed(&error))?;
            self.complete(&mut export, formats.iter().any(|format| format.needs_cells));
            for format in &formats {
                match format.write(&export, &format.usual_name(&document.map.name)) {
                    Ok(written) => files.extend(written),
                    Err(error) => {
                        let (format, reason) = (format.name.to_owned(), error.to_string());
                        skipped.push(SkippedFormat { format, reason });
                    }
                }
            }
            document.skipped.extend(skipped);
            document.files = files.iter().map(|(name, bytes)| FileRecord::of(name, bytes)).collect();
            document.seal().map_err(|error| failed(&error))?;
            let json = document.to_json().map_err(|error| failed(&error))?;
            files.push(("topology.json".to_owned(), json.into_bytes()));
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
    ) -> PyResult<Vec<PathBuf>> {
        let format = self::format(format)?;
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
            self.complete(&mut export, format.needs_cells);
            let files = format.write(&export, &main).map_err(|error| failed(&error))?;
            let paths: Vec<PathBuf> = files.iter().map(|(name, _)| folder.join(name)).collect();
            for ((_, bytes), path) in files.iter().zip(&paths) {
                package::write_file(path, bytes)
                    .map_err(|error| Failure::of_file(Exception::Export, path, &error))?;
            }
            Ok::<_, Failure>(paths)
        });
        Ok(written?)
    }
}

impl Labeled {
    /// The files of every result but the document.
    fn pictures(&self, stages: bool, probabilities: bool) -> Result<Vec<(String, Vec<u8>)>, RasterError> {
        let (grid, analysis) = (self.drawn(), &self.analysis);
        let graph = &analysis.space.graph;
        let mut files: Vec<(&str, Vec<u8>)> = Vec::new();
        if stages {
            files.push(("labels.1-classified.png", label_png(graph, &analysis.classified)));
            files.push(("labels.2-smoothed.png", label_png(graph, &analysis.smoothed.most_likely())));
        }
        if probabilities {
            files.push(("probabilities.npy", probability_npy(graph, &analysis.smoothed)));
        }
        let Analysis { labeling, topology, .. } = analysis;
        files.push(("labels.png", label_png(graph, labeling)));
        files.push(("labels.yaml", raster_yaml("labels.png", &grid.frame).into_bytes()));
        files.push(("regions.png", region_png(graph, &analysis.regions, &analysis.place_ids)?));
        files.push(("regions.yaml", raster_yaml("regions.png", &grid.frame).into_bytes()));
        let overview = overview_png(grid, labeling, &self.document.classes, topology, &self.map.name);
        files.push(("overview.png", overview));
        Ok(files.into_iter().map(|(name, bytes)| (name.to_owned(), bytes)).collect())
    }

    /// Adds what a document does not hold.
    fn complete<'a>(&'a self, export: &mut Export<'a>, needs_cells: bool) {
        export.written = package::fixed_time().unwrap_or_default();
        if needs_cells {
            let (graph, smoothed) = (&self.analysis.space.graph, &self.analysis.smoothed);
            let mut most = Grid::filled(graph.width(), graph.height(), 0.0);
            for (node, cell) in graph.cells_in_rows(0..graph.height()).enumerate() {
                most[cell] = smoothed.row(node).iter().copied().fold(0.0, f32::max);
            }
            export.occupancy = Some(&self.drawn().cells);
            export.probability = Some(most);
        }
    }

    /// The map with the walls and openings that edits drew.
    fn drawn(&self) -> &OccupancyGrid {
        self.analysis.drawn.as_ref().unwrap_or(&self.map.grid)
    }
}

fn format(name: &str) -> PyResult<&'static Format> {
    Format::by_name(name).ok_or_else(|| {
        let names: Vec<&str> = FORMATS.iter().map(|format| format.name).collect();
        PyValueError::new_err(format!("expected one of {}, found {name:?}", names.join(", ")))
    })
}

fn read_masks(path: Option<&Path>) -> Result<(MaskSettings, Option<String>), Failure> {
    let at = path.unwrap_or(Path::new(""));
    package::masks(path).map_err(|error| Failure::of_file(Exception::Export, at, &error))
}

fn commit(files: Vec<(String, Vec<u8>)>, folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let written = package::write_result(folder, files)
        .map_err(|error| Failure::of_file(Exception::Export, folder, &error))?;
    Ok(written.iter().map(|name| folder.join(name)).collect())
}
