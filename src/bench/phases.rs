//! The phases of a picture.

use serde::Serialize;

use crate::engine::Times;
use crate::report::Timings;

/// Reads a time in ms.
type Read = fn(&Times) -> f64;

/// Name of a phase and where [`Times`] has it, in ms, in the order in which they happen.
pub const PHASES: [(&str, Read); 4] = [
    ("prepare", |times| times.prepare_ms),
    ("compile", |times| times.compile_ms),
    ("render", |times| times.render_ms),
    ("read back", |times| times.read_back_ms),
];

/// The times of one phase in all runs.
#[derive(Debug, Clone, Serialize)]
pub struct Phase {
    /// Its name.
    pub name: &'static str,
    /// Its times.
    pub times: Timings,
}

impl Phase {
    /// All phases, without a run.
    pub(super) fn all() -> Vec<Self> {
        PHASES.map(|(name, _)| Self { name, times: Timings::default() }).into()
    }
}
