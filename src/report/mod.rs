//! What reports of measurements share: samples of times, numbers for people, plots and CSV records.

pub(crate) mod csv;
pub(crate) mod number;
mod sample;
pub(crate) mod svg;

pub use sample::Sample;

/// The style sheet of the reports.
pub(crate) const STYLE: &str = include_str!("report.css");
