//! The files that `study` and `bench` write their measurements to.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::Value;

use super::failure::Failure;
use super::files::{save, save_report};
use super::guard::Guard;
use super::output::out;

/// Where measurements go besides the terminal.
#[derive(Debug, Clone, Args)]
pub(super) struct Reports {
    /// Write a report with plots, one HTML file that needs nothing else
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    report: Option<PathBuf>,
    /// Write everything that was measured and every run as CSV; `-` is standard output
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    csv: Option<PathBuf>,
    /// Write everything as JSON; `-` is standard output
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    json: Option<PathBuf>,
}

impl Reports {
    /// Refuses files that cannot be written, or that the run reads.
    pub(super) fn check(&self, guard: &mut Guard) -> Result<(), Failure> {
        guard.options([("--report", &self.report), ("--csv", &self.csv), ("--json", &self.json)])
    }

    /// Prints on standard output, unless data goes there.
    pub(super) fn show(&self, text: &str) {
        if ![&self.csv, &self.json].into_iter().flatten().any(|path| path == Path::new("-")) {
            out!("{text}");
        }
    }

    /// Writes what was asked for.
    pub(super) fn write(
        &self,
        html: impl FnOnce() -> String,
        csv: impl FnOnce() -> String,
        json: impl FnOnce() -> Value,
    ) -> Result<(), Failure> {
        if let Some(path) = &self.report {
            save(path, &html())?;
        }
        if let Some(path) = &self.csv {
            save(path, &csv())?;
        }
        if let Some(path) = &self.json {
            save_report(path, &json())?;
        }
        Ok(())
    }
}
