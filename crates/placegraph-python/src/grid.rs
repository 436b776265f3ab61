//! The occupancy grid map.

use std::path::PathBuf;
use std::sync::Arc;

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use placegraph::geom::{Point2, Pose2};
use placegraph::grid::{Cell, Grid as Cells, MapFrame, Occupancy, OccupancyGrid};
use placegraph::import::image::{Channels, Raster, Samples};
use placegraph::import::ros::{self, Interpretation, Mode, Rules};
use placegraph::import::{
    self, Format, Gray205, LoadedMap, MapError, NamedFiles, ReadOptions, Source, has_memory,
};
use placegraph::model::sha256_hex;
use placegraph::scan;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays;
use crate::call::long;
use crate::error::{Exception, Failure};
use crate::model::Model;

/// Where an array's cells are: meters per cell, and x, y, yaw of the lower left corner.
type Frame = (f64, (f64, f64, f64));

/// A map: what is known of its cells, where they are, and how they were read.
#[pyclass(frozen, module = "placegraph._native")]
#[derive(Debug)]
pub(crate) struct Grid {
    pub(crate) map: Arc<LoadedMap>,
    /// How the map was read.
    pub(crate) read: ReadOptions,
}

#[pymethods]
impl Grid {
    /// Reads a map file.
    #[staticmethod]
    #[pyo3(signature = (path, resolution, rules, gray_205_as_file, allow_outside, max_cells))]
    fn load(
        py: Python<'_>,
        path: PathBuf,
        resolution: Option<f64>,
        rules: &str,
        gray_205_as_file: bool,
        allow_outside: bool,
        max_cells: u64,
    ) -> PyResult<Self> {
        let rules = match rules {
            "jazzy" => Rules::Jazzy,
            "humble" => Rules::Humble,
            "ros1" => Rules::Ros1,
            found => {
                let text = format!("expected rules to be one of jazzy, humble, ros1, found {found:?}");
                return Err(PyValueError::new_err(text));
            }
        };
        let options = ReadOptions {
            resolution_m: resolution,
            rules,
            gray_205: if gray_205_as_file { Gray205::AsFile } else { Gray205::Unknown },
            named_files: if allow_outside { NamedFiles::Anywhere } else { NamedFiles::Inside },
            max_cells,
            ..ReadOptions::default()
        };
        let read = options.clone();
        let map = long(py, None, move |_| {
            import::load_map(&path, &options).map_err(|error| Failure::map(&path, &error))
        })?;
        Ok(Self { map: Arc::new(map), read })
    }

    /// The map of an array of occupancies: -1 unknown, else 0 to 100.
    #[staticmethod]
    fn from_occupancy(
        array: &Bound<'_, PyArray2<i8>>,
        frame: Frame,
        thresholds: (f64, f64),
        name: String,
    ) -> PyResult<Self> {
        check_size(array.shape())?;
        let how = interpretation(Mode::Raw, false, thresholds);
        let cells = arrays::to_grid(array, |value| ros::occupancy(value, &how))?;
        Self::of_cells(cells, frame_of(frame)?, source(how), name)
    }

    /// The map of an array of gray values, read as map_server reads an image.
    #[staticmethod]
    fn from_gray(
        array: &Bound<'_, PyArray2<u8>>,
        frame: Frame,
        thresholds: (f64, f64),
        name: String,
        negate: bool,
        gray_205_as_file: bool,
    ) -> PyResult<Self> {
        check_size(array.shape())?;
        let [height, width] = [0, 1].map(|axis| array.shape()[axis] as u32);
        let samples = array.try_readonly()?.as_array().iter().copied().collect();
        let raster = Raster { width, height, channels: Channels::Gray, samples: Samples::Eight(samples) };
        let options = ReadOptions {
            gray_205: if gray_205_as_file { Gray205::AsFile } else { Gray205::Unknown },
            ..ReadOptions::default()
        };
        let how = interpretation(Mode::Trinary, negate, thresholds);
        let (cells, source) = import::read_image(raster, Format::Image, how, &options);
        Self::of_cells(cells, frame_of(frame)?, source, name)
    }

    #[getter]
    fn name(&self) -> &str {
        &self.map.name
    }

    #[getter]
    fn hash(&self) -> &str {
        &self.map.hash
    }

    #[getter]
    fn resolution(&self) -> f64 {
        self.map.grid.frame.resolution_m()
    }

    #[getter]
    fn origin(&self) -> (f64, f64, f64) {
        let Pose2 { x, y, yaw_rad } = self.map.grid.frame.map_from_grid();
        (x, y, yaw_rad)
    }

    #[getter]
    fn shape(&self) -> (u32, u32) {
        (self.map.grid.cells.height(), self.map.grid.cells.width())
    }

    /// The occupancies: 0 free, 100 occupied, -1 unknown.
    fn array<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i8>>> {
        arrays::from_grid(py, &self.map.grid.cells, |occupancy| match occupancy {
            Occupancy::Free => 0,
            Occupancy::Occupied => 100,
            Occupancy::Unknown => -1,
        })
    }

    /// What the check of the map found, worst first: severity, kind and text of each.
    fn findings(&self, py: Python<'_>) -> PyResult<Vec<(String, String, String)>> {
        let map = Arc::clone(&self.map);
        let check = long(py, None, move |_| Ok(import::check(&map)))?;
        let member = |value: &serde_json::Value| value.as_str().unwrap_or_default().to_owned();
        let describe = |finding: &import::Finding| {
            let kind = serde_json::to_value(finding).unwrap_or_default();
            let severity = serde_json::to_value(finding.severity()).unwrap_or_default();
            (member(&severity), member(&kind["finding"]), finding.to_string())
        };
        Ok(check.findings.iter().map(describe).collect())
    }

    /// The 360 ranges, in meters, of a scan from the center of the cell at a point of the map frame.
    fn scan<'py>(
        &self,
        py: Python<'py>,
        x: f64,
        y: f64,
        model: Option<&Model>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let cell = self.free_cell(Point2::new(x, y))?;
        let config = model.map(|model| model.model.scan).unwrap_or_default();
        let scan = scan::cast(&self.map.grid, cell, &config);
        Ok(PyArray1::from_slice(py, scan.ranges_m()))
    }

    /// Row from the top and column of the cell at a point of the map frame, or nothing outside of the map.
    fn cell_at(&self, x: f64, y: f64) -> Option<(u32, u32)> {
        let cell = self.inside(Point2::new(x, y))?;
        Some((self.map.grid.cells.height() - 1 - cell.y, cell.x))
    }
}

impl Grid {
    /// A map that was drawn, not read.
    pub(crate) fn drawn(grid: OccupancyGrid, name: String) -> PyResult<Self> {
        Self::of_cells(grid.cells, grid.frame, source(Interpretation::default()), name)
    }

    /// A map that was not read from a file. Its hash is that of all that is known of it.
    fn of_cells(cells: Cells<Occupancy>, frame: MapFrame, source: Source, name: String) -> PyResult<Self> {
        if name.is_empty() {
            return Err(PyValueError::new_err("expected a name of at least one character"));
        }
        let Pose2 { x, y, yaw_rad } = frame.map_from_grid();
        let mut bytes = b"placegraph array\n".to_vec();
        bytes.extend([frame.resolution_m(), x, y, yaw_rad].iter().flat_map(|value| value.to_le_bytes()));
        bytes.extend([cells.width(), cells.height()].iter().flat_map(|value| value.to_le_bytes()));
        bytes.extend(cells.values().iter().map(|&occupancy| occupancy as u8));
        let grid = OccupancyGrid { frame, cells };
        let map = LoadedMap { grid, name, source, hash: sha256_hex(&bytes), files: Vec::new() };
        Ok(Self { map: Arc::new(map), read: ReadOptions::default() })
    }

    fn inside(&self, point: Point2) -> Option<Cell> {
        let cells = &self.map.grid.cells;
        let cell = self.map.grid.frame.cell_at(point)?;
        (cell.x < cells.width() && cell.y < cells.height()).then_some(cell)
    }

    fn free_cell(&self, point: Point2) -> PyResult<Cell> {
        let Point2 { x, y } = point;
        let cell = self.inside(point).ok_or_else(|| {
            PyValueError::new_err(format!("expected a point inside the map, found ({x}, {y})"))
        })?;
        match self.map.grid.cells[cell] {
            Occupancy::Free => Ok(cell),
            other => {
                Err(PyValueError::new_err(format!("expected a free cell at ({x}, {y}), found {other:?}")))
            }
        }
    }
}

fn frame_of((resolution_m, (x, y, yaw_rad)): Frame) -> PyResult<MapFrame> {
    Ok(MapFrame::new(resolution_m, Pose2::new(x, y, yaw_rad))
        .map_err(|error| Failure::new(Exception::Map, error))?)
}

fn source(interpretation: Interpretation) -> Source {
    let gray_205 = Gray205::AsFile;
    Source {
        format: Format::Image,
        interpretation,
        gray_205,
        gray_205_cells: 0,
        transparent_cells: 0,
        blended_cells: 0,
        replaced_image: None,
    }
}

fn interpretation(mode: Mode, negate: bool, (occupied_thresh, free_thresh): (f64, f64)) -> Interpretation {
    Interpretation { mode, negate, occupied_thresh, free_thresh, rules: Rules::Jazzy }
}

/// Cells of a map at most, as of a map file.
const MAX_CELLS: u64 = 400_000_000;

fn check_size(shape: &[usize]) -> PyResult<()> {
    let [height, width] = [shape[0] as u64, shape[1] as u64];
    let error = if width == 0 || height == 0 {
        MapError::Empty { width, height }
    } else if width.saturating_mul(height) > MAX_CELLS {
        MapError::TooManyCells { width, height, max_cells: MAX_CELLS }
    } else if !has_memory(4 * width * height) {
        MapError::Memory { width, height, n_bytes: 4 * width * height }
    } else {
        return Ok(());
    };
    Err(Failure::new(Exception::Map, error).into())
}
