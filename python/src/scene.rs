//! Scenes: from a text, from a file, from arrays.

use std::path::PathBuf;
use std::sync::Arc;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use trueray::errors::Invalid;
use trueray::{DVec3, Light, Sphere, Window};

use crate::arrays::Table;
use crate::errors::exception;
use crate::settings::{name_of, named};

/// Where the eye is, where it looks, and how the world is projected.
#[pyclass(frozen, module = "trueray._native")]
#[derive(Clone, Copy)]
pub(crate) struct View(pub(crate) trueray::View);

#[pymethods]
impl View {
    #[new]
    fn new(eye: [f64; 3], look_at: Option<[f64; 3]>, up: [f64; 3], projection: &str) -> PyResult<Self> {
        let projection = named("projection", projection)?;
        let view = trueray::View::new(eye.into(), look_at.map(DVec3::from), up.into());
        view.map(|view| Self(view.projected(projection))).map_err(|error| PyValueError::new_err(error.to_string()))
    }

    /// The picture's axes in the world: to the right, upwards, and against the direction of view.
    #[getter]
    fn axes(&self) -> [[f64; 3]; 3] {
        self.0.axes().map(|axis| axis.to_array())
    }
}

/// Spheres, lights and a window, and the eye that looks through it.
#[pyclass(frozen, module = "trueray._native")]
pub(crate) struct Scene {
    pub(crate) scene: Arc<trueray::Scene>,
    pub(crate) view: trueray::View,
}

impl Scene {
    fn of_file(scene: trueray::Scene) -> Self {
        Self { scene: Arc::new(scene), view: trueray::View::FILE }
    }
}

#[pymethods]
impl Scene {
    #[staticmethod]
    fn from_text(py: Python<'_>, text: &str, name: &str) -> PyResult<Self> {
        py.detach(|| trueray::Scene::from_text(name, text.as_bytes())).map(Self::of_file).map_err(exception)
    }

    #[staticmethod]
    fn from_file(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        py.detach(|| trueray::Scene::read(path)).map(Self::of_file).map_err(exception)
    }

    /// Of tables with a row for each sphere: `material` has the columns of the argument names after `colors`, one table each.
    #[staticmethod]
    #[pyo3(signature = (size, near, window, view, positions, radii, colors, material, lights, light_colors, background, ambient_light))]
    #[expect(clippy::too_many_arguments, reason = "it has one caller, which names them")]
    fn from_tables(
        size: [u32; 2],
        near: f64,
        window: [f64; 4],
        view: &View,
        positions: Table<'_>,
        radii: Table<'_>,
        colors: Table<'_>,
        material: [Table<'_>; 7],
        lights: Table<'_>,
        light_colors: Table<'_>,
        background: [f64; 3],
        ambient_light: [f64; 3],
    ) -> PyResult<Self> {
        let [left, right, bottom, top] = window;
        let window = Window { near, left, right, bottom, top };
        let (positions, radii, colors) = (positions.view(), radii.view(), colors.view());
        let material = material.each_ref().map(Table::view);
        let sphere = |row| {
            let [ka, kd, ks, kr, n, kt, eta] = material.each_ref().map(|column| column.number(row, 0));
            let (center, scale, color) = (positions.triple(row), radii.triple(row), colors.triple(row));
            Sphere { center, scale, color, ka, kd, ks, kr, n, kt, eta }
        };
        let (lights, light_colors) = (lights.view(), light_colors.view());
        let light = |row| Light { position: lights.triple(row), intensity: light_colors.triple(row) };
        let scene = trueray::Scene {
            spheres: (0..positions.rows()).map(sphere).collect(),
            lights: (0..lights.rows()).map(light).collect(),
            background: background.into(),
            ambient: ambient_light.into(),
            ..trueray::Scene::new(window, size[0], size[1])
        };
        scene.check().map_err(|invalid| PyValueError::new_err(format!("{}: {invalid}", argument(&invalid))))?;
        Ok(Self { scene: Arc::new(scene), view: view.0 })
    }

    fn seen_from(&self, view: &View) -> Self {
        Self { scene: Arc::clone(&self.scene), view: view.0 }
    }

    fn projected(&self, projection: &str) -> PyResult<Self> {
        let view = self.view.projected(named("projection", projection)?);
        Ok(Self { scene: Arc::clone(&self.scene), view })
    }

    #[getter]
    fn size(&self) -> (u32, u32) {
        (self.scene.width, self.scene.height)
    }

    #[getter]
    fn spheres(&self) -> usize {
        self.scene.spheres.len()
    }

    #[getter]
    fn lights(&self) -> usize {
        self.scene.lights.len()
    }

    #[getter]
    fn eye(&self) -> [f64; 3] {
        self.view.eye.to_array()
    }

    #[getter]
    fn projection(&self) -> String {
        name_of(self.view.projection())
    }

    fn text(&self, py: Python<'_>) -> String {
        py.detach(|| self.scene.to_string())
    }
}

/// The argument that a number of the scene came from.
fn argument(invalid: &Invalid) -> &'static str {
    let is_light = invalid.of.starts_with("light");
    match (invalid.of.as_str(), invalid.field) {
        ("the picture", _) => "size",
        ("NEAR", _) => "near",
        ("the window" | "LEFT" | "RIGHT" | "BOTTOM" | "TOP", _) => "window",
        ("BACK", _) => "background",
        ("AMBIENT", _) => "ambient_light",
        (_, "px" | "py" | "pz") if is_light => "lights",
        _ if is_light => "light_colors",
        (_, "px" | "py" | "pz") => "positions",
        (_, "sx" | "sy" | "sz") => "radii",
        (_, "Ka") => "ambient",
        (_, "Kd") => "diffuse",
        (_, "Ks") => "specular",
        (_, "Kr") => "reflection",
        (_, "n") => "exponent",
        (_, "Kt") => "transmission",
        (_, "eta") => "eta",
        _ => "colors",
    }
}
