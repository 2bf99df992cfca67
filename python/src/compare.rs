//! Two pictures, or a picture and its scene.

use std::path::PathBuf;

use numpy::PyReadonlyArray3;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use trueray::{Difference, Error, Explanation, Picture};

use crate::arrays;
use crate::errors::exception;
use crate::renderer::Renderer;
use crate::scene::Scene;
use crate::settings::Settings;

/// A picture as an array, or the name of its file.
#[derive(FromPyObject)]
pub(crate) enum Source<'py> {
    Array(PyReadonlyArray3<'py, u8>),
    File(PathBuf),
}

impl Source<'_> {
    fn read(&self) -> PyResult<Picture> {
        match self {
            Self::Array(array) => arrays::picture(array),
            Self::File(path) => Picture::read(path).map_err(exception),
        }
    }
}

/// The difference and the explanation as the command line's `--json` has them, and as text.
#[pyfunction]
#[pyo3(signature = (a, b, scene, renderer, settings, precision))]
pub(crate) fn compare(
    py: Python<'_>,
    a: Source<'_>,
    b: Option<Source<'_>>,
    scene: Option<&Scene>,
    renderer: Option<&Renderer>,
    settings: &Settings,
    precision: &str,
) -> PyResult<(String, Option<String>, String)> {
    let a = a.read()?;
    let b = b.map(|b| b.read()).transpose()?;
    let judge = renderer.map(|renderer| renderer.at(precision)).transpose()?;
    let judged = py.detach(|| {
        let Some((scene, judge)) = scene.zip(judge) else { return Ok((b, None)) };
        let settings = settings.seen(scene.view);
        let explanation = judge.explain(&a, &scene.scene, &settings)?;
        let expected = match b {
            Some(b) => b,
            None => trueray::Renderer::reference().render(&scene.scene, &settings)?,
        };
        Ok((Some(expected), Some(explanation)))
    });
    let (b, explanation): (Option<Picture>, Option<Explanation>) = judged.map_err(|error: Error| exception(error))?;
    let b = b.ok_or_else(|| PyValueError::new_err("b: expected a picture, since there is no scene"))?;
    let difference = py.detach(|| Difference::between(&a, &b)).map_err(exception)?;
    let mut report = difference.report("a", "b");
    report.extend(explanation.iter().map(Explanation::report));
    let json = |text: serde_json::Result<String>| text.map_err(|error| PyValueError::new_err(error.to_string()));
    let explanation = explanation.map(|explanation| json(serde_json::to_string(&explanation))).transpose()?;
    Ok((json(serde_json::to_string(&difference))?, explanation, report))
}
