//! Frames on their way to their files.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use glam::DVec3;

use super::{Args, frame_name};
use crate::cli::failure::{DEVICE_LOST, Failure, OK, OUTPUT, STOPPED};
use crate::cli::guard::Guard;
use crate::cli::linear::{Coding, Film};
use crate::cli::output::{err, errln};
use crate::cli::progress::Progress;
use crate::cli::render::{say_cut, say_not_finite};
use crate::cli::stats::{Stats, peak_memory_mib};
use crate::color_bar::ColorBar;
use crate::engine::ms;
use crate::film::{OutputError, Target};
use crate::linear::Linear;
use crate::settings::Quantize;
use crate::words::{count, visible};

/// What becomes of a frame, step by step.
pub(super) enum Step {
    /// Rows follow.
    Begin {
        number: u32,
        target: Target,
        coding: Coding,
        note: Option<String>,
        levels: (Quantize, DVec3),
        bar: Option<Box<ColorBar>>,
        size: (u32, u32),
    },
    /// 3 bytes a pixel, and colours where the file has them.
    Rows { rgb: Vec<u8>, linear: Vec<Linear> },
    /// The rows are complete; so many pixels the device could not do, and then began the preparation.
    End { stats: Box<Stats>, cut: u64, start: Instant },
    /// There will be no such frame.
    Failed(Failure),
    /// The file of a frame is there already.
    There,
}

/// Writes frame after frame.
pub(super) struct Writer<'a> {
    args: &'a Args,
    guard: Guard,
    name: String,
    total: u32,
    done: u32,
    written: u32,
    /// Frames whose files were there already.
    there: u32,
    /// Where the rows that come go; none where that has failed.
    file: Option<File>,
    progress: Progress,
    stats: Vec<Stats>,
    last: String,
    code: u8,
    stop: &'a AtomicBool,
}

/// The file of a frame.
struct File {
    number: u32,
    path: PathBuf,
    writer: Film,
    /// What writing it has taken.
    took: Duration,
}

impl<'a> Writer<'a> {
    /// Sets `stop` where further frames would fail as well.
    pub(super) fn new(args: &'a Args, guard: Guard, name: &str, total: u32, stop: &'a AtomicBool) -> Self {
        let progress = Progress::of_frames(args.progress_style(), name, total);
        let (name, file, stats, last) = (name.to_owned(), None, Vec::new(), String::new());
        Self { args, guard, name, total, done: 0, written: 0, there: 0, file, progress, stats, last, code: OK, stop }
    }

    pub(super) fn take(&mut self, step: Step) {
        match step {
            Step::Begin { number, target, coding, note, levels, bar, size } => {
                let film =
                    |target: &Target| Film::new(coding, target, size, note.as_deref(), levels, bar.map(|bar| *bar));
                let opened = self.open(number, &target, film);
                self.file = self.noted(opened.map_err(|failure| failure.of(&frame_name(number))));
            }
            Step::Rows { rgb, linear } => {
                let Some(File { number, path, mut writer, took }) = self.file.take() else { return };
                let start = Instant::now();
                let written = writer.write(&rgb, &linear).map(|_| writer);
                let written = written.map_err(|error| Failure::from(error).of(&frame_name(number)));
                let took = took + start.elapsed();
                self.file = self.noted(written).map(|writer| File { number, path, writer, took });
            }
            Step::End { stats, cut, start } => {
                let Some(File { number, path, writer, took }) = self.file.take() else { return };
                let _span = tracing::info_span!("finish file").entered();
                let finishing = Instant::now();
                let finished = writer.finish().map_err(|error| Failure::from(error).of(&frame_name(number)));
                if self.noted(finished).is_some() {
                    self.guard.written(&path);
                    self.end(*stats, cut, took + finishing.elapsed(), start);
                }
            }
            Step::Failed(failure) => {
                self.file = None;
                self.noted::<()>(Err(failure));
            }
            Step::There => {
                self.there += 1;
                self.step();
            }
        }
    }

    fn open(
        &self,
        number: u32,
        target: &Target,
        film: impl FnOnce(&Target) -> Result<Film, OutputError>,
    ) -> Result<File, Failure> {
        let (start, path) = (Instant::now(), target.argument().to_owned());
        self.guard.check_unwritten("it", &path)?;
        let writer = film(target)?;
        Ok(File { number, path, writer, took: start.elapsed() })
    }

    /// What there is; a failure is said and ends the frame.
    fn noted<T>(&mut self, result: Result<T, Failure>) -> Option<T> {
        let failure = match result {
            Ok(value) => return Some(value),
            Err(failure) => failure,
        };
        self.progress.pause(|| {
            self.args.progress.say_failed(&failure);
            _ = failure.report();
        });
        // What was stopped is to be repeated, whatever else there was.
        self.code = if self.code == OK || failure.code == STOPPED { failure.code } else { self.code };
        if [DEVICE_LOST, OUTPUT, STOPPED].contains(&failure.code) {
            self.stop.store(true, Ordering::Relaxed);
        }
        self.step();
        None
    }

    /// The file is there.
    fn end(&mut self, stats: Stats, cut: u64, write: Duration, start: Instant) {
        let total_ms = stats.parse_ms + stats.open_ms + ms(start.elapsed());
        let stats = Stats { write_ms: ms(write), total_ms, peak_memory_mib: peak_memory_mib(), ..stats };
        let name = format!("{}: {}", self.name, frame_name(stats.frame.unwrap_or_default()));
        self.progress.pause(|| {
            say_cut(&name, if self.args.quiet { 0 } else { cut }, &stats.device);
            say_not_finite(&name, stats.not_finite_pixels);
            if self.args.stats || self.args.verbose {
                errln!("{}: {}", frame_name(stats.frame.unwrap_or_default()), stats.summary());
                err!("{}", stats.table());
            }
        });
        self.last = format!("{} × {} on {}", stats.width, stats.height, stats.device);
        self.written += 1;
        if self.args.stats_json.is_some() {
            self.stats.push(stats);
        }
        self.step();
    }

    /// One frame more is done with.
    fn step(&mut self) {
        self.done += 1;
        self.progress.set(f64::from(self.done) / f64::from(self.total));
    }

    /// All frames are done with; says so and returns their statistics and the exit code.
    pub(super) fn finish(self, took: Duration) -> (Vec<Stats>, u8) {
        // What failed is not at 100 %.
        if self.code == OK {
            self.progress.finish();
        }
        if !self.args.quiet && self.there > 0 {
            errln!("{}: {} there already", visible(&self.name), count(self.there, "frame"));
        }
        if !self.args.quiet && self.written > 0 {
            let of_all = if self.written < self.total { format!(" of {}", self.total) } else { String::new() };
            let (name, written) = (visible(&self.name), count(self.written, "frame"));
            let (seconds, each) = (took.as_secs_f64(), ms(took) / f64::from(self.written));
            errln!("{name}: {written}{of_all}, {} in {seconds:.1} s, {each:.0} ms each", self.last);
        }
        (self.stats, self.code)
    }
}
