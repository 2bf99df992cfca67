//! The stages of a picture.

use serde::Serialize;

use crate::engine::Times;
use crate::report::Sample;

/// Reads a time in ms.
type Read = fn(&Times) -> f64;

/// Name of a stage and where [`Times`] has it, in ms, in the order in which they happen.
pub const STAGES: [(&str, Read); 4] = [
    ("prepare", |times| times.prepare_ms),
    ("compile", |times| times.compile_ms),
    ("render", |times| times.render_ms),
    ("read back", |times| times.read_back_ms),
];

/// The times of one stage in all runs.
#[derive(Debug, Clone, Serialize)]
pub struct Stage {
    /// Its name.
    pub name: &'static str,
    /// Its times.
    pub times: Sample,
}

impl Stage {
    /// All stages, without a run.
    pub(super) fn all() -> Vec<Self> {
        STAGES.map(|(name, _)| Self { name, times: Sample::default() }).into()
    }
}
