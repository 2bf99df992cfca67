//! What decides a picture besides its scene.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use trueray::pattern::Pattern;
use trueray::settings::Convention;

/// Convention, depth and samples.
#[pyclass(frozen, module = "trueray._native")]
#[derive(Clone, Copy)]
pub(crate) struct Settings(trueray::Settings);

#[pymethods]
impl Settings {
    #[new]
    fn new(convention: &str, max_depth: u32, samples: u32) -> PyResult<Self> {
        let wrong = |argument, why| PyValueError::new_err(format!("{argument}: {why}"));
        let convention: Convention = convention.parse().map_err(|why| wrong("convention", why))?;
        let pattern = Pattern::grid_of(samples).map_err(|why| wrong("samples", why))?;
        if max_depth > trueray::Settings::MAX_DEPTH {
            return Err(wrong("max_depth", format!("expected 0 to {}", trueray::Settings::MAX_DEPTH)));
        }
        Ok(Self(trueray::Settings { max_depth, pattern, ..convention.settings() }))
    }
}

impl Settings {
    /// With the eye of a scene.
    pub(crate) fn seen(&self, view: trueray::View) -> trueray::Settings {
        trueray::Settings { view, ..self.0 }
    }
}
