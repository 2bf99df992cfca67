//! Frames on their way to their files.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::time::{Duration, Instant};

use super::{Args, frame_name};
use crate::cli::failure::{DEVICE_LOST, Failure, OK, OUTPUT, STOPPED};
use crate::cli::guard::Guard;
use crate::cli::linear::Film;
use crate::cli::output::{err, errln};
use crate::cli::progress::Progress;
use crate::cli::render::{say_cut, say_not_finite};
use crate::cli::stats::{Stats, peak_memory_mib};
use crate::engine::ms;
use crate::linear::Linear;
use crate::words::{count, visible};

/// What becomes of a frame, step by step.
pub(super) enum Step {
    /// Rows follow.
    Begin(Box<File>),
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
    file: Option<Box<File>>,
    progress: Progress,
    stats: Vec<Stats>,
    last: String,
    code: u8,
    stop: &'a AtomicBool,
    lost: &'a AtomicU32,
}

/// The file of a frame.
pub(super) struct File {
    pub(super) number: u32,
    pub(super) path: PathBuf,
    pub(super) writer: Film,
    /// What writing it has taken.
    pub(super) took: Duration,
}

impl<'a> Writer<'a> {
    /// Sets `stop` where further frames would fail as well, and `lost` to the number of a frame whose file has failed.
    pub(super) fn new(
        args: &'a Args,
        guard: Guard,
        name: &str,
        total: u32,
        (stop, lost): (&'a AtomicBool, &'a AtomicU32),
    ) -> Self {
        let progress = Progress::of_frames(args.progress_style(), name, total);
        let (name, file, stats, last) = (name.to_owned(), None, Vec::new(), String::new());
        let (done, written, there, code) = (0, 0, 0, OK);
        Self { args, guard, name, total, done, written, there, file, progress, stats, last, code, stop, lost }
    }

    pub(super) fn take(&mut self, step: Step) {
        match step {
            Step::Begin(file) => {
                let unwritten = self.guard.check_unwritten("it", &file.path);
                self.file = self.noted(file.number, unwritten).map(|()| file);
            }
            Step::Rows { rgb, linear } => {
                let Some(mut file) = self.file.take() else { return };
                let start = Instant::now();
                let written = file.writer.write(&rgb, &linear).map(drop);
                file.took += start.elapsed();
                self.file = self.noted(file.number, written).map(|()| file);
            }
            Step::End { stats, cut, start } => {
                let Some(file) = self.file.take() else { return };
                let File { number, path, writer, took } = *file;
                let _span = tracing::info_span!("finish file").entered();
                let finishing = Instant::now();
                if self.noted(number, writer.finish()).is_some() {
                    self.guard.written(&path);
                    self.end(*stats, cut, took + finishing.elapsed(), start);
                }
            }
            Step::Failed(failure) => {
                self.file = None;
                self.fail(&failure);
            }
            Step::There => {
                self.there += 1;
                self.step();
            }
        }
    }

    /// What there is; a failure of its file ends the frame, whose other rows nobody needs.
    fn noted<T, E: Into<Failure>>(&mut self, number: u32, result: Result<T, E>) -> Option<T> {
        let failed = |error: E| {
            self.lost.store(number, Ordering::Relaxed);
            self.fail(&error.into().of(&frame_name(number)));
        };
        result.map_err(failed).ok()
    }

    /// Says why there will be no such frame.
    fn fail(&mut self, failure: &Failure) {
        self.progress.pause(|| {
            self.args.progress.say_failed(failure);
            _ = failure.report();
        });
        // What was stopped is to be repeated, whatever else there was.
        self.code = if self.code == OK || failure.code == STOPPED { failure.code } else { self.code };
        if [DEVICE_LOST, OUTPUT, STOPPED].contains(&failure.code) {
            self.stop.store(true, Ordering::Relaxed);
        }
        self.step();
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
