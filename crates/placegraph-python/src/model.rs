//! The trained model.

use std::path::PathBuf;
use std::sync::Arc;

use placegraph::export::ModelInfo;
use placegraph::import;
use placegraph::model::{MAX_BYTES, Method, Model as Trained};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::call::long;
use crate::error::{Exception, Failure};

/// All that labeling a map needs to know.
#[pyclass(frozen, module = "placegraph._native")]
#[derive(Debug)]
pub(crate) struct Model {
    pub(crate) model: Arc<Trained>,
    /// What results call it.
    pub(crate) name: String,
}

#[pymethods]
impl Model {
    /// Reads a model file.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let model = long(py, None, move |_| {
            let bytes = import::read(&path, MAX_BYTES as u64)
                .map_err(|error| Failure::reading(Exception::Model, &path, &error))?;
            Trained::from_json(&bytes)
                .map_err(|error| Failure::new(Exception::Model, format!("{error} (in {})", path.display())))
        })?;
        Ok(Self { model: Arc::new(model), name })
    }

    /// The model that comes with the package.
    #[staticmethod]
    fn default(py: Python<'_>) -> PyResult<Self> {
        let model = long(py, None, |_| Ok(Trained::builtin()))?;
        Ok(Self { model: Arc::new(model), name: "default".to_owned() })
    }

    /// The model in the bytes of a model file.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, data: Vec<u8>, name: String) -> PyResult<Self> {
        let read = move |_: &dyn placegraph::progress::Progress| {
            Trained::from_json(&data).map_err(|error| Failure::new(Exception::Model, error))
        };
        Ok(Self { model: Arc::new(long(py, None, read)?), name })
    }

    /// The bytes of the model's file.
    fn to_bytes<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &py.detach(|| self.model.to_json()))
    }

    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    #[getter]
    fn hash(&self) -> String {
        self.model.hash()
    }

    /// `boosted` or `iamn`.
    #[getter]
    fn method(&self) -> &'static str {
        self.model.method.name()
    }

    /// Name, role and color of every class.
    #[getter]
    fn classes(&self) -> Vec<(String, String, (u8, u8, u8))> {
        let role =
            |role| serde_json::to_value(role).unwrap_or_default().as_str().unwrap_or_default().to_owned();
        let classes = self.model.label_set.classes().iter();
        // Three bytes in a row would be handed out as bytes.
        classes.map(|class| (class.name.clone(), role(class.role), class.color.into())).collect()
    }

    /// Where the model comes from, as JSON.
    #[getter]
    fn record(&self) -> String {
        serde_json::to_string(&self.model.record).unwrap_or_default()
    }

    /// The features that the model looks at.
    #[getter]
    fn feature_names(&self) -> Vec<String> {
        let columns = match &self.model.method {
            Method::Boosted(boosted) => boosted.list.columns(),
            _ => Vec::new(),
        };
        columns.iter().map(|id| id.feature().name.clone()).collect()
    }
}

impl Model {
    pub(crate) fn info(&self) -> ModelInfo {
        ModelInfo { name: self.name.clone(), hash: self.model.hash() }
    }
}
