//! What reports of measurements share: series of times, numbers for people, plots and CSV records.

pub(crate) mod csv;
pub(crate) mod number;
mod skipped;
pub(crate) mod svg;
mod timings;

pub use skipped::Skipped;
pub use timings::Timings;

/// The style sheet of the reports.
pub(crate) const STYLE: &str = include_str!("report.css");
