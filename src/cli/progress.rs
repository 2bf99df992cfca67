//! Progress on standard error.

use super::output::errln;
use std::io::IsTerminal;
use std::time::{Duration, Instant};

use clap::ValueEnum;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// How progress is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Style {
    /// A bar, where standard error is a terminal and rendering lasts
    Auto,
    /// A bar
    Bar,
    /// A line now and then
    Lines,
    /// A JSON object a line now and then
    Json,
    /// Nothing
    None,
}

/// Pictures that are done sooner show no progress.
const PATIENCE: Duration = Duration::from_secs(1);
/// Time between two lines.
const INTERVAL: Duration = Duration::from_secs(1);

/// Shows how many rows of a picture are done.
pub(super) struct Progress {
    style: Style,
    name: String,
    rows: u32,
    start: Instant,
    last_line: Instant,
    bar: Option<ProgressBar>,
}

impl Progress {
    pub(super) fn new(style: Style, name: &str, rows: u32) -> Self {
        let style = match style {
            Style::Auto if std::io::stderr().is_terminal() => Style::Bar,
            Style::Auto => Style::None,
            style => style,
        };
        let now = Instant::now();
        Self { style, name: name.to_owned(), rows, start: now, last_line: now, bar: None }
    }

    /// `done` rows are done.
    pub(super) fn set(&mut self, done: u32) {
        if self.start.elapsed() < PATIENCE {
            return;
        }
        match self.style {
            Style::Bar => self.bar().set_position(u64::from(done)),
            Style::Lines | Style::Json if self.last_line.elapsed() >= INTERVAL => {
                self.last_line = Instant::now();
                let (name, rows) = (&self.name, self.rows);
                if self.style == Style::Json {
                    errln!("{}", serde_json::json!({ "scene": name, "rows_done": done, "rows": rows }));
                } else {
                    errln!("{name}: {done} of {rows} rows");
                }
            }
            _ => {}
        }
    }

    fn bar(&mut self) -> &ProgressBar {
        self.bar.get_or_insert_with(|| {
            let bar = ProgressBar::with_draw_target(Some(u64::from(self.rows)), ProgressDrawTarget::stderr());
            let style = ProgressStyle::with_template("{msg} {wide_bar} {percent}% {eta}");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar.set_message(self.name.clone());
            bar
        })
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
