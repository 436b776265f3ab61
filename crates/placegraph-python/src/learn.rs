//! Features, training, evaluation, and generated buildings.

use std::sync::Arc;

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use placegraph::boost::{
    CompiledClassifiers, DecisionList, DecisionStump, Polarity, StrongClassifier, WeightedStump, adaboost,
    search_order, table_scores,
};
use placegraph::eval::Confusion;
use placegraph::features::{self, FeatureId, FeatureTable};
use placegraph::grid::{CellGraph, Grid as Cells};
use placegraph::labels::{Class, Label, LabelSet, Role};
use placegraph::learning::learn;
use placegraph::model::Model as TrainedModel;
use placegraph::training::{Choice, LabeledMap, NetworkConfig, TrainConfig, train, train_network};
use placegraph_generate::{Mapping, Options, Style};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays;
use crate::call::long;
use crate::error::{Exception, Failure};
use crate::grid::Grid;
use crate::model::Model;

/// Name, role and color of a class.
type ClassSpec = (String, String, [u8; 3]);

/// The names of the features of a set.
#[pyfunction]
pub(crate) fn feature_names(set: &str) -> PyResult<Vec<String>> {
    Ok(feature_set(set)?.iter().map(|id| id.feature().name.clone()).collect())
}

fn feature_set(set: &str) -> PyResult<Vec<FeatureId>> {
    Ok(match set {
        "all" => features::all(),
        "freiburg203" => features::freiburg203(),
        "chapter183" => features::chapter183(),
        "old152" => features::old152(),
        "lean120" => features::lean120(),
        found => {
            return Err(PyValueError::new_err(format!(
                "expected all, freiburg203, chapter183, old152 or lean120, found {found:?}"
            )));
        }
    })
}

fn named_features(names: &[String]) -> PyResult<Vec<FeatureId>> {
    let id = |name: &String| {
        let id = FeatureId::from_name(name);
        id.ok_or_else(|| PyValueError::new_err(format!("expected the name of a feature, found {name:?}")))
    };
    names.iter().map(id).collect()
}

/// The features of every free cell, a *row per feature*, and row from the top and column of the cells.
#[pyfunction]
#[expect(clippy::type_complexity, reason = "two arrays, unpacked at once")]
pub(crate) fn extract<'py>(
    py: Python<'py>,
    grid: &Grid,
    names: Vec<String>,
    model: Option<&Model>,
    threads: Option<usize>,
) -> PyResult<(Bound<'py, PyArray2<f32>>, Bound<'py, PyArray2<i64>>)> {
    let columns = named_features(&names)?;
    let n_columns = columns.len();
    let scan = model.map(|model| model.model.scan).unwrap_or_default();
    let map = Arc::clone(&grid.map);
    let (values, cells) = long(py, threads, move |progress| {
        let graph = CellGraph::new(&map.grid.cells);
        let table = features::extract(&map.grid, graph.cells(), &columns, &scan, progress);
        let values: Vec<f32> = (0..n_columns).flat_map(|column| table.column(column).to_vec()).collect();
        let top = graph.height() - 1;
        let cells = graph.cells().iter().flat_map(|cell| [i64::from(top - cell.y), i64::from(cell.x)]);
        Ok((values, cells.collect::<Vec<i64>>()))
    })?;
    let n = cells.len() / 2;
    Ok((arrays::array2(py, values, n_columns, n)?, arrays::array2(py, cells, n, 2)?))
}

/// What training is told, beside the maps.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct TrainSettings {
    method: String,
    chapter: bool,
    features: Option<String>,
    rounds: Option<usize>,
    temperature: Option<f64>,
    scales: Option<Vec<f64>>,
    max_speck_m: Option<f64>,
    max_cells_per_class: Option<usize>,
}

impl TrainSettings {
    fn apply(&self, mut config: TrainConfig) -> PyResult<TrainConfig> {
        if let Some(set) = &self.features {
            config.features = feature_set(set)?;
        }
        if let Some(rounds) = self.rounds {
            config.rounds = Choice::Set(rounds);
        }
        if let Some(temperature) = self.temperature {
            config.temperature = Choice::Set(temperature);
        }
        if let Some(scales) = &self.scales {
            config.scales.clone_from(scales);
        }
        config.scan.max_speck_m = self.max_speck_m.unwrap_or(config.scan.max_speck_m);
        config.max_cells_per_class = self.max_cells_per_class.or(config.max_cells_per_class);
        Ok(config)
    }
}

/// Trains a model on maps with their labels: 0 and 255 none, k the k-th of `classes`.
#[pyfunction]
pub(crate) fn train_model(
    py: Python<'_>,
    maps: Vec<(PyRef<'_, Grid>, Bound<'_, PyArray2<u8>>)>,
    classes: Vec<ClassSpec>,
    settings: TrainSettings,
    name: String,
    threads: Option<usize>,
) -> PyResult<Model> {
    let label_set = label_set(classes)?;
    let maps = maps
        .iter()
        .map(|(grid, labels)| {
            let map = &grid.map;
            let labels = label_grid(labels, &label_set)?;
            Ok(LabeledMap {
                name: map.name.clone(),
                grid: map.grid.clone(),
                labels,
                window: None,
                building: None,
            })
        })
        .collect::<PyResult<Vec<_>>>()?;
    let failed = |error| Failure::new(Exception::Training, error);
    let model = match settings.method.as_str() {
        "boosted" => {
            let config = settings.apply(if settings.chapter {
                TrainConfig::chapter()
            } else {
                TrainConfig::default()
            })?;
            long(py, threads, move |progress| {
                // The chapter has no stage for doorways.
                let learn = if settings.chapter { train } else { learn };
                learn(&maps, &label_set, &config, progress).map(|trained| trained.model).map_err(failed)
            })?
        }
        "iamn" => {
            let config = if settings.chapter { NetworkConfig::chapter() } else { NetworkConfig::default() };
            let config = NetworkConfig { base: settings.apply(config.base)?, ..config };
            long(py, threads, move |progress| {
                train_network(&maps, &label_set, &config, progress)
                    .map(|trained| trained.model)
                    .map_err(failed)
            })?
        }
        found => {
            return Err(PyValueError::new_err(format!(
                "expected boosted or iamn as method, found {found:?}"
            )));
        }
    };
    // A model is what its file says, so that it labels alike before and after it was saved.
    let saved =
        TrainedModel::from_json(&model.to_json()).map_err(|error| Failure::new(Exception::Model, error))?;
    Ok(Model { model: Arc::new(saved), name })
}

fn label_set(classes: Vec<ClassSpec>) -> PyResult<LabelSet> {
    let classes = classes.into_iter().map(|(name, role, color)| {
        let role = match role.as_str() {
            "place" => Role::Place,
            "passage" => Role::Passage,
            "doorway" => Role::Doorway,
            found => {
                return Err(PyValueError::new_err(format!(
                    "expected place, passage or doorway as the role of {name:?}, found {found:?}"
                )));
            }
        };
        Ok(Class { name, role, color })
    });
    let classes = classes.collect::<PyResult<Vec<_>>>()?;
    Ok(LabelSet::new(classes).map_err(|error| Failure::new(Exception::Training, error))?)
}

/// Labels of an array: 0 and 255 none, k the k-th class.
fn label_grid(array: &Bound<'_, PyArray2<u8>>, label_set: &LabelSet) -> PyResult<Cells<Option<Label>>> {
    let n_labels = label_set.len() as u8;
    if let Some(found) = array.try_readonly()?.as_array().iter().find(|&&v| v > n_labels && v < 255) {
        let text = format!("expected labels of 0 or 255 (none) or 1 to {n_labels}, found {found}");
        return Err(Failure::new(Exception::Training, text).into());
    }
    arrays::to_grid(array, |value| (1..=n_labels).contains(&value).then(|| Label(value - 1)))
}

/// Compares labels with the truth, both as in training: the scores as JSON, and as text.
#[pyfunction]
pub(crate) fn evaluate(
    py: Python<'_>,
    predicted: &Bound<'_, PyArray2<u8>>,
    truth: &Bound<'_, PyArray2<u8>>,
    classes: Vec<ClassSpec>,
) -> PyResult<(String, String)> {
    let label_set = label_set(classes)?;
    let (predicted, truth) = (label_grid(predicted, &label_set)?, label_grid(truth, &label_set)?);
    py.detach(|| {
        let scores = Confusion::count(&predicted, &truth, &label_set).scores(&label_set);
        let json =
            serde_json::to_string(&scores).map_err(|error| Failure::new(Exception::Internal, error))?;
        Ok((json, scores.to_string()))
    })
}

/// A generated building: its map, labels, rooms, graph as JSON, style, mapping, and its files.
#[pyfunction]
#[expect(clippy::type_complexity, reason = "the parts of a building, unpacked at once")]
pub(crate) fn generate<'py>(
    py: Python<'py>,
    style: &str,
    seed: u64,
    index: u64,
    mapping: &str,
    resolution: Option<f64>,
    name: String,
) -> PyResult<(
    Grid,
    Bound<'py, PyArray2<u8>>,
    Bound<'py, PyArray2<u16>>,
    String,
    (&'static str, &'static str),
    Vec<(&'static str, Bound<'py, PyBytes>)>,
)> {
    let style: Style = style.parse().map_err(|error| PyValueError::new_err(format!("{error}")))?;
    let mapping: Mapping = mapping.parse().map_err(|error| PyValueError::new_err(format!("{error}")))?;
    if let Some(found) = resolution.filter(|r| !(0.02..=0.2).contains(r)) {
        let text = format!("expected a resolution of 0.02 to 0.2 m, found {found}");
        return Err(PyValueError::new_err(text));
    }
    let options = Options { mapping, resolution_m: resolution };
    let (building, files) = long(py, None, move |_| {
        let building = placegraph_generate::generate(style, seed, index, &options);
        let files = placegraph_generate::files(&building);
        Ok((building, files.map_err(|error| Failure::new(Exception::Internal, error))?))
    })?;
    let graph =
        serde_json::to_string(&building.graph).map_err(|error| Failure::new(Exception::Internal, error))?;
    let labels = arrays::from_grid(py, &building.labels, |&label| label)?;
    let rooms = arrays::from_grid(py, &building.rooms, |&room| room)?;
    let kinds = (building.style.map_or("plan", Style::name), building.mapping.name());
    let files = files.iter().map(|(name, bytes)| (*name, PyBytes::new(py, bytes))).collect();
    Ok((Grid::drawn(building.map, name)?, labels, rooms, graph, kinds, files))
}

/// A class's classifier: feature, threshold, whether it says yes below, and vote of every stump.
type Stumps<'py> = (
    PyReadonlyArray1<'py, u16>,
    PyReadonlyArray1<'py, f32>,
    PyReadonlyArray1<'py, bool>,
    PyReadonlyArray1<'py, f64>,
);

/// The same, to be handed out.
type NewStumps<'py> = (
    Bound<'py, PyArray1<u16>>,
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<f64>>,
);

/// Learns a decision list from the rows of `x`, of the classes `y` from 0: its order, and the stumps of every class.
#[pyfunction]
pub(crate) fn fit_list<'py>(
    py: Python<'py>,
    x: PyReadonlyArray2<'py, f32>,
    y: PyReadonlyArray1<'py, u8>,
    n_classes: usize,
    n_rounds: usize,
    temperature: f64,
    threads: Option<usize>,
) -> PyResult<(Vec<u8>, Vec<NewStumps<'py>>)> {
    let table = table(&x)?;
    let labels: Vec<Label> = y.as_array().iter().map(|&k| Label(k)).collect();
    if labels.len() != table.n_rows() || labels.is_empty() {
        return Err(PyValueError::new_err("expected one class per row"));
    }
    if !(2..=LabelSet::MAX).contains(&n_classes) || labels.iter().any(|label| label.index() >= n_classes) {
        return Err(PyValueError::new_err(format!(
            "expected 2 to {} classes, found {n_classes}",
            LabelSet::MAX
        )));
    }
    let (order, classifiers) = long(py, threads, move |progress| {
        let rows: Vec<u32> = (0..labels.len() as u32).collect();
        let classifiers = adaboost(&table, &rows, &labels, n_classes, n_rounds, progress)
            .map_err(|error| Failure::new(Exception::Training, error))?;
        let scores = table_scores(&table, &rows, &CompiledClassifiers::new(&classifiers));
        let orders = search_order(&scores, &labels, &vec![1; n_classes], temperature);
        let best = orders.iter().reduce(|best, one| if one.accuracy > best.accuracy { one } else { best });
        let order = best.map(|best| best.order.iter().map(|label| label.0).collect()).unwrap_or_default();
        Ok((order, classifiers))
    })?;
    let arrays = classifiers.iter().map(|StrongClassifier { stumps }| {
        let column = |w: &WeightedStump| w.stump.feature.0;
        (
            PyArray1::from_iter(py, stumps.iter().map(column)),
            PyArray1::from_iter(py, stumps.iter().map(|w| w.stump.threshold)),
            PyArray1::from_iter(py, stumps.iter().map(|w| w.stump.polarity == Polarity::Below)),
            PyArray1::from_iter(py, stumps.iter().map(|w| w.alpha)),
        )
    });
    Ok((order, arrays.collect()))
}

/// The probability of every class, (n, K), for the rows of `x` by a list of [`fit_list`].
#[pyfunction]
pub(crate) fn list_probabilities<'py>(
    py: Python<'py>,
    x: PyReadonlyArray2<'py, f32>,
    order: Vec<u8>,
    classifiers: Vec<Stumps<'py>>,
    temperature: f64,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let table = table(&x)?;
    let (n, n_classes, n_columns) = (table.n_rows(), order.len(), table.columns().len());
    let classifiers: Vec<StrongClassifier> = classifiers.iter().map(classifier).collect();
    let stumps = || classifiers.iter().flat_map(|classifier| &classifier.stumps);
    if classifiers.len() != n_classes || stumps().any(|w| usize::from(w.stump.feature.0) >= n_columns) {
        return Err(PyValueError::new_err("expected rows with the features that the list was learned from"));
    }
    let order = order.into_iter().map(Label).collect();
    let values = long(py, threads, move |_| {
        let rows: Vec<u32> = (0..n as u32).collect();
        let scores = table_scores(&table, &rows, &CompiledClassifiers::new(&classifiers));
        Ok(DecisionList { order, classifiers, temperature }.classify(&scores).values().to_vec())
    })?;
    arrays::array2(py, values, n, n_classes)
}

fn classifier((features, thresholds, below, alphas): &Stumps<'_>) -> StrongClassifier {
    let (features, thresholds) = (features.as_array(), thresholds.as_array());
    let rest = below.as_array().into_iter().zip(alphas.as_array().into_iter().copied().collect::<Vec<_>>());
    let stumps =
        features.iter().zip(thresholds.iter()).zip(rest).map(|((&feature, &threshold), (&below, alpha))| {
            let polarity = if below { Polarity::Below } else { Polarity::Above };
            WeightedStump { stump: DecisionStump { feature: FeatureId(feature), threshold, polarity }, alpha }
        });
    StrongClassifier { stumps: stumps.collect() }
}

/// Rows of numbers as a table; its columns go by their position.
fn table(x: &PyReadonlyArray2<'_, f32>) -> PyResult<FeatureTable> {
    let view = x.as_array();
    let (n, n_columns) = view.dim();
    if n_columns > usize::from(u16::MAX) || n as u64 > u64::from(u32::MAX) {
        return Err(PyValueError::new_err(format!("expected at most 65535 features, found {n_columns}")));
    }
    let columns = (0..n_columns as u16).map(FeatureId).collect();
    Ok(FeatureTable::from_columns(columns, n, view.t().iter().copied().collect()))
}
