//! The part of the Python package that is compiled: arrays packed into scenes, and pictures handed over.
//!
//! Arguments are checked and broadcast in `package/trueray`, where numpy does it.

mod arrays;
mod compare;
mod errors;
mod renderer;
mod scene;
mod settings;

use pyo3::prelude::*;

#[pymodule]
mod _native {
    #[pymodule_export]
    use crate::compare::compare;
    #[pymodule_export]
    use crate::renderer::{Renderer, devices};
    #[pymodule_export]
    use crate::scene::{Scene, View};
    #[pymodule_export]
    use crate::settings::Settings;
}
