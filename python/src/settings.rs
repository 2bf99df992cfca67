//! What decides a picture besides its scene.

use clap::ValueEnum;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use trueray::pattern::Placing;
use trueray::settings::Convention;
use trueray::{Filter, Pattern};

/// Convention, depth and samples.
#[pyclass(frozen, module = "trueray._native")]
#[derive(Clone, Copy)]
pub(crate) struct Settings(trueray::Settings);

#[pymethods]
impl Settings {
    #[new]
    fn new(convention: &str, max_depth: u32, samples: u32, pattern: &str, filter: &str) -> PyResult<Self> {
        let wrong = |argument, why| PyValueError::new_err(format!("{argument}: {why}"));
        let convention: Convention = convention.parse().map_err(|why| wrong("convention", why))?;
        let (placing, filter): (Placing, Filter) = (named("pattern", pattern)?, named("filter", filter)?);
        let one = Pattern::one_of(placing, filter).ok_or_else(|| {
            wrong("filter", format!("a regular grid has no {} filter, pattern='fibonacci' has", name_of(filter)))
        })?;
        let pattern = one.with_count(samples).map_err(|why| {
            let help = if placing == Placing::Grid { "; pattern='fibonacci' takes any number" } else { "" };
            wrong("samples", format!("{why}{help}"))
        })?;
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

/// What `name` stands for on the command line, too.
pub(crate) fn named<T: ValueEnum>(argument: &str, name: &str) -> PyResult<T> {
    T::from_str(name, false).map_err(|_| {
        let mut names: Vec<String> = T::value_variants().iter().cloned().map(name_of).collect();
        let last = names.pop().unwrap_or_default();
        PyValueError::new_err(format!("{argument}: expected {} or {last}, not '{name}'", names.join(", ")))
    })
}

/// The name on the command line.
pub(crate) fn name_of<T: ValueEnum>(value: T) -> String {
    value.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
}
