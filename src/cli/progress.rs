//! Progress on standard error.

use super::failure::Failure;
use super::output::errln;
use std::io::IsTerminal;
use std::time::{Duration, Instant};

use clap::ValueEnum;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;

use crate::words::visible;

/// How progress is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Style {
    /// A bar, where standard error is a terminal and it takes longer than a second
    Auto,
    /// A bar
    Bar,
    /// A line a second
    Lines,
    /// A JSON object a second, each in a line
    Json,
    /// Lines that Open Job Description's schedulers read: `openjd_progress`, `openjd_status`, `openjd_fail`
    Openjd,
    /// Nothing
    None,
}

/// What is done sooner shows no progress, but for the last event.
const PATIENCE: Duration = Duration::from_secs(1);
/// Time between two lines.
const INTERVAL: Duration = Duration::from_secs(1);
/// Steps of the bar.
const STEPS: f64 = 1000.0;

/// Shows how much of something is done.
pub(super) struct Progress {
    style: Style,
    name: String,
    /// Rows of the picture, where it is one.
    rows: Option<u32>,
    /// Frames, where these are many pictures.
    frames: Option<u32>,
    start: Instant,
    last_line: Instant,
    bar: Option<ProgressBar>,
}

/// A line of `json`.
#[derive(Serialize)]
struct Event<'a> {
    scene: &'a str,
    percent: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    rows_done: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    rows: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    frames_done: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    frames: Option<u32>,
    seconds: f64,
    seconds_left: Option<f64>,
    finished: bool,
}

impl Progress {
    /// Of something that is not a picture.
    pub(super) fn new(style: Style, name: &str) -> Self {
        let style = match style {
            Style::Auto if std::io::stderr().is_terminal() => Style::Bar,
            Style::Auto => Style::None,
            style => style,
        };
        let now = Instant::now();
        Self { style, name: name.to_owned(), rows: None, frames: None, start: now, last_line: now, bar: None }
    }

    /// Of a picture with so many rows.
    pub(super) fn of_rows(style: Style, name: &str, rows: u32) -> Self {
        let mut progress = Self::new(style, name);
        progress.rows = Some(rows);
        progress
    }

    /// Of so many frames.
    pub(super) fn of_frames(style: Style, name: &str, frames: u32) -> Self {
        let mut progress = Self::new(style, name);
        progress.frames = Some(frames);
        progress
    }

    /// `part` of the whole is done, 1 being all.
    pub(super) fn set(&mut self, part: f64) {
        if self.start.elapsed() < PATIENCE {
            return;
        }
        match self.style {
            Style::Bar => self.bar().set_position((part * STEPS) as u64),
            Style::Lines | Style::Json | Style::Openjd if self.last_line.elapsed() >= INTERVAL => {
                self.last_line = Instant::now();
                self.line(part, false);
            }
            _ => {}
        }
    }

    /// All is done: the last event says so.
    pub(super) fn finish(self) {
        self.line(1.0, true);
    }

    /// Prints something else without a bar in its way.
    pub(super) fn pause(&self, print: impl FnOnce()) {
        match &self.bar {
            Some(bar) => bar.suspend(print),
            None => print(),
        }
    }

    fn line(&self, part: f64, finished: bool) {
        let seconds = self.start.elapsed().as_secs_f64();
        let seconds_left = (part > 0.0).then(|| seconds * (1.0 / part - 1.0));
        let (name, percent) = (&self.name, part * 100.0);
        let done = |all: u32| (part * f64::from(all)).round() as u32;
        let frames = self.frames.map_or(String::new(), |frames| format!(" ({} of {frames} frames)", done(frames)));
        match (self.style, seconds_left) {
            (Style::Json, _) => {
                let tenths = |x: f64| (x * 10.0).round() / 10.0;
                let event = Event {
                    scene: name,
                    percent: tenths(percent),
                    rows_done: self.rows.map(done),
                    rows: self.rows,
                    frames_done: self.frames.map(done),
                    frames: self.frames,
                    seconds: tenths(seconds),
                    seconds_left: seconds_left.map(tenths),
                    finished,
                };
                errln!("{}", serde_json::json!(event));
            }
            (Style::Openjd, left) => {
                errln!("openjd_progress: {percent:.1}");
                match left {
                    _ if finished => errln!("openjd_status: {}: done in {seconds:.1} s", visible(name)),
                    Some(left) => errln!("openjd_status: {}: {left:.0} s left", visible(name)),
                    None => {}
                }
            }
            (Style::Lines, _) if finished => errln!("{name}: 100 %{frames}, done in {seconds:.1} s"),
            (Style::Lines, Some(left)) => errln!("{name}: {percent:.0} %{frames}, {left:.0} s left"),
            (Style::Lines, None) => errln!("{name}: 0 %{frames}"),
            _ => {}
        }
    }

    fn bar(&mut self) -> &ProgressBar {
        self.bar.get_or_insert_with(|| {
            let bar = ProgressBar::with_draw_target(Some(STEPS as u64), ProgressDrawTarget::stderr());
            let style = ProgressStyle::with_template("{msg} {wide_bar} {percent}% {eta}");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar.set_message(self.name.clone());
            bar.with_elapsed(self.start.elapsed())
        })
    }
}

impl Style {
    /// Says in its own way, where it has one, that the run has failed.
    pub(super) fn say_failed(self, failure: &Failure) {
        if self == Self::Openjd {
            match failure.message.lines().next() {
                Some(line) => errln!("openjd_fail: {}", visible(line)),
                // It is said already.
                None => errln!("openjd_fail: exit code {}, for the reasons above", failure.code),
            }
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
