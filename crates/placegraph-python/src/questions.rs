//! Questions to a topological map.

use std::sync::OnceLock;

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use placegraph::export::TopologyDocument;
use placegraph::geom::Point2;
use placegraph::topology::TopologicalMap;
use placegraph::topology::query::{PlaceIndex, RouteIndex, Whereabouts};
use placegraph::topology::{PlaceId, PlaceRaster};
use pyo3::prelude::*;

use crate::call::long;
use crate::error::{Exception, Failure};

/// Answers questions to the document of a topological map.
#[pyclass(frozen, module = "placegraph._native")]
#[derive(Debug)]
pub(crate) struct Questions {
    document: TopologyDocument,
    map: TopologicalMap,
    places: OnceLock<PlaceIndex>,
}

#[pymethods]
impl Questions {
    #[new]
    fn new(py: Python<'_>, json: Vec<u8>) -> PyResult<Self> {
        let document = long(py, None, move |_| {
            TopologyDocument::from_json(&json).map_err(|error| Failure::new(Exception::Topology, error))
        })?;
        let map = document.topology();
        Ok(Self { document, map, places: OnceLock::new() })
    }

    /// The document as the program writes it.
    fn to_json(&self, py: Python<'_>) -> PyResult<String> {
        let json = py.detach(|| self.document.to_json());
        Ok(json.map_err(|error| Failure::new(Exception::Topology, error))?)
    }

    /// Whether a point lies in a place, the number of that place or the nearest one, and the distance to its border in meters.
    fn locate(&self, py: Python<'_>, x: f64, y: f64) -> PyResult<Option<(bool, u32, f64)>> {
        let shape = self.document.map.shape().map_err(|error| Failure::new(Exception::Topology, error))?;
        let found = py.detach(|| {
            let places = self.places.get_or_init(|| PlaceIndex::new(&self.map, shape));
            places.locate(Point2::new(x, y))
        });
        Ok(found.map(|whereabouts| match whereabouts {
            Whereabouts::Inside { place, border_m } => (true, place.0, border_m),
            Whereabouts::Outside { nearest, distance_m } => (false, nearest.0, distance_m),
        }))
    }

    /// The shortest way between two places: its places, its length in meters, and its corners, a row each.
    #[expect(clippy::type_complexity, reason = "three things, unpacked at once")]
    fn route<'py>(
        &self,
        py: Python<'py>,
        start: u32,
        goal: u32,
    ) -> PyResult<Option<(Vec<u32>, f64, Bound<'py, PyArray2<f64>>)>> {
        let shape = self.document.map.shape().map_err(|error| Failure::new(Exception::Topology, error))?;
        let way = py.detach(|| {
            let way = RouteIndex::new(&self.map).route(PlaceId(start), PlaceId(goal))?;
            Some(way.pulled_straight(&PlaceRaster::new(&self.map, shape)))
        });
        let Some(way) = way else { return Ok(None) };
        let corners: Vec<f64> = way.line.iter().flat_map(|point| [point.x, point.y]).collect();
        let line = PyArray1::from_vec(py, corners).reshape([way.line.len(), 2])?;
        Ok(Some((way.places.iter().map(|place| place.0).collect(), way.length_m, line)))
    }
}
