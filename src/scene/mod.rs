//! What a scene file says: the model, the parser and its diagnostics.
//!
//! This module knows nothing of rendering; every number is kept as the `f64` that the text names.

mod check;
mod diagnostics;
mod foreign;
mod fov;
mod model;
mod parse;
mod write;

pub use check::{Invalid, SceneError};
pub(crate) use check::{OPPOSITE, are_edges};
pub(crate) use diagnostics::{Collector, Detail, Line, Location, Span, Topic, render as show_diagnostics, shown};
pub use diagnostics::{Diagnostic, Omitted, Severity};
pub use foreign::foreign_kind;
pub use fov::Fov;
pub use model::{Light, MAX_RESOLUTION, Names, Scene, Sphere, Window, resolution};
pub(crate) use parse::{Fault, first_line, is_statement, parse_number};
pub use parse::{Parsed, parse};
