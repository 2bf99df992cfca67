//! Devices, and the pictures that they render.

use numpy::PyArray3;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use trueray::{Tier, Verify};

use crate::arrays::array;
use crate::errors::exception;
use crate::scene::Scene;
use crate::settings::Settings;

/// An open device, or the CPU reference.
#[pyclass(frozen, module = "trueray._native")]
pub(crate) struct Renderer(trueray::Renderer);

#[pymethods]
impl Renderer {
    #[new]
    fn new(py: Python<'_>, device: &str) -> PyResult<Self> {
        py.detach(|| trueray::Renderer::on(device)).map(Self).map_err(exception)
    }

    /// The device in words; none for the reference.
    #[getter]
    fn device(&self) -> Option<String> {
        self.0.device()
    }

    fn render<'py>(
        &self,
        py: Python<'py>,
        scene: &Scene,
        settings: &Settings,
        precision: &str,
        verify: Option<&str>,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let mut renderer = self.at(precision)?;
        if let Some(verify) = verify {
            let verify: Verify = verify.parse().map_err(|why| PyValueError::new_err(format!("verify: {why}")))?;
            renderer = renderer.with_verification(verify);
        }
        let settings = settings.seen(scene.view);
        let picture = py.detach(|| renderer.render(&scene.scene, &settings));
        array(py, picture.map_err(exception)?)
    }
}

impl Renderer {
    /// The same device with kernels of this precision.
    pub(crate) fn at(&self, precision: &str) -> PyResult<trueray::Renderer> {
        let renderer = self.0.clone();
        match precision {
            "auto" => Ok(renderer),
            "certified" => Ok(renderer.with_certification()),
            name => match Tier::ALL.into_iter().find(|tier| tier.name() == name) {
                Some(tier) => Ok(renderer.with_precision(tier)),
                None => Err(PyValueError::new_err(format!(
                    "precision: expected auto, {} or certified, not '{name}'",
                    Tier::ALL.map(Tier::name).join(", ")
                ))),
            },
        }
    }
}

/// The Vulkan devices, in words; the place of one in the list is a name for it.
#[pyfunction]
pub(crate) fn devices(py: Python<'_>) -> PyResult<Vec<String>> {
    py.detach(trueray::Renderer::devices).map_err(exception)
}
