//! What a scene file says: the model, the parser and its diagnostics.
//!
//! This module knows nothing of rendering; every number is kept as the `f64` that the text names.

mod check;
mod diagnostics;
mod foreign;
mod model;
mod parse;
mod write;

pub use check::{Invalid, SceneError};
pub(crate) use diagnostics::{Collector, Detail, Line, Location, Span, Topic, shown};
pub use diagnostics::{Diagnostic, Omitted, Severity};
pub use foreign::foreign_kind;
pub use model::{Light, MAX_RESOLUTION, Names, Scene, Sphere, Window, resolution};
pub(crate) use parse::is_statement;
pub(crate) use parse::{Fault, parse_number};
pub use parse::{Parsed, parse};
