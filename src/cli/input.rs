//! Reading scene files for the subcommands.

use std::ffi::OsStr;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::color;
use super::failure::{Failure, SCENE, USAGE};
use super::output::{err, errln};
use super::particles::Reading;
use crate::import::{ColorScale, Format, Import, Lamps};
use crate::scene::{Parsed, Scene, foreign_kind, parse};
use crate::words::visible;

/// So much of a file tells its format.
const HEAD: u64 = 1 << 16;

/// Refuses standard input where it would be read twice.
pub(super) fn check_stdin(scenes: &[PathBuf]) -> Result<(), Failure> {
    if scenes.iter().filter(|path| *path == Path::new("-")).count() > 1 {
        return Err(Failure::new(USAGE, "only one of the scenes can be standard input"));
    }
    Ok(())
}

/// A file of which the beginning has been read.
pub(super) struct Opened {
    /// Its name as the user gave it.
    pub name: String,
    /// The format of the particles in it.
    pub format: Option<Format>,
    head: Vec<u8>,
    rest: Box<dyn Read>,
}

impl Opened {
    /// Opens the file at `path`, or standard input for `-`.
    pub(super) fn open(path: &Path) -> Result<Self, Failure> {
        let stdin = path == Path::new("-");
        let name = if stdin { "standard input".to_owned() } else { path.display().to_string() };
        if path.is_dir() {
            return Err(unreadable(&name, "that is a folder"));
        }
        let open = || -> std::io::Result<Box<dyn Read>> {
            if stdin {
                return Ok(Box::new(std::io::stdin().lock()));
            }
            Ok(Box::new(File::open(path)?))
        };
        let mut rest = open().map_err(|error| unreadable(&name, &error.to_string()))?;
        let mut head = Vec::new();
        let read = rest.by_ref().take(HEAD).read_to_end(&mut head);
        read.map_err(|error| unreadable(&name, &error.to_string()))?;
        let format = Format::of(&head);
        Ok(Self { name, format, head, rest })
    }

    /// All of the file.
    pub(super) fn into_reader(self) -> impl Read {
        std::io::Cursor::new(self.head).chain(self.rest)
    }

    /// All of the file at once.
    fn into_text(self) -> Result<Vec<u8>, Failure> {
        let Self { name, mut head, mut rest, .. } = self;
        rest.read_to_end(&mut head).map_err(|error| unreadable(&name, &error.to_string()))?;
        Ok(head)
    }
}

fn unreadable(name: &str, why: &str) -> Failure {
    Failure::new(SCENE, format!("cannot read the scene {}: {why}", visible(name)))
}

/// A scene file that has been read, with errors or without.
#[derive(Debug)]
pub(super) struct Input {
    /// Its name as the user gave it.
    pub name: String,
    /// What the parser found.
    pub parsed: Parsed,
    /// Reading and parsing.
    pub parse_time: Duration,
    path: Option<PathBuf>,
    lamps: Option<Lamps>,
    color_scale: Option<ColorScale>,
    notes: Vec<String>,
}

impl Input {
    /// Reads the file at `path`, or standard input for `-`; errors in the scene stay in `parsed`.
    pub(super) fn read(path: &Path, reading: &Reading) -> Result<Self, Failure> {
        let _span = tracing::info_span!("read scene").entered();
        let start = Instant::now();
        let opened = Opened::open(path)?;
        let name = opened.name.clone();
        let (parsed, lamps, color_scale, notes) = if let Some(format) = opened.format {
            if reading.options.view.is_parallel() {
                let help =
                    "help: trueray import writes a scene, whose window may be changed for --projection orthographic";
                return Err(Failure::new(
                    USAGE,
                    format!("{}: particles are framed for an eye\n  {help}", visible(&name)),
                ));
            }
            let imported = Import::new(&name, format, opened.into_reader(), reading.options.clone()).first();
            (imported.parsed, imported.lamps, imported.color_scale, imported.notes)
        } else {
            let text = opened.into_text()?;
            if let Some(kind) = foreign_kind(&text) {
                return Err(Failure::new(SCENE, format!("{}: this is {kind}, not a scene", visible(&name))));
            }
            if reading.is_for_particles {
                let message = "this holds no particles of a known format, to which options such as --radius apply";
                return Err(Failure::new(USAGE, format!("{}: {message}", visible(&name))));
            }
            (parse(&name, &text), None, None, Vec::new())
        };
        let path = (path != Path::new("-")).then(|| path.to_owned());
        Ok(Self { name, parsed, parse_time: start.elapsed(), path, lamps, color_scale, notes })
    }

    /// Prints errors and warnings and returns the scene, if it can be rendered.
    pub(super) fn into_renderable(self, quiet: bool) -> Result<Loaded, Failure> {
        self.print_diagnostics(quiet);
        match self.parsed.scene {
            Some(scene) => {
                let Self { name, parse_time, path, lamps, color_scale, .. } = self;
                Ok(Loaded { name, scene, lamps, color_scale, parse_time, path })
            }
            None => Err(Failure::new(SCENE, "")),
        }
    }

    /// Prints the parser's report to standard error; errors only if `quiet`.
    pub(super) fn print_diagnostics(&self, quiet: bool) {
        print_parsed(&self.parsed, &self.notes, &self.name, quiet);
    }
}

/// Prints what was found in a file to standard error; errors only if `quiet`.
pub(super) fn print_parsed(parsed: &Parsed, notes: &[String], name: &str, quiet: bool) {
    if parsed.errors > 0 || !quiet {
        err!("{}", parsed.report(color::is_on(&std::io::stderr())));
    }
    for note in notes.iter().filter(|_| !quiet) {
        errln!("trueray: {}: {note}", visible(name));
    }
}

/// Prints doubts about a scene to standard error.
pub(super) fn print_doubts(name: &str, doubts: &[String]) {
    for doubt in doubts {
        errln!("trueray: {}: warning: {doubt}", visible(name));
    }
}

/// A scene without errors.
#[derive(Debug)]
pub(super) struct Loaded {
    /// The file's name as the user gave it.
    pub name: String,
    pub scene: Scene,
    /// The lights of particles, which turn with the eye.
    pub lamps: Option<Lamps>,
    /// What the colours of particles stand for, where that is numbers.
    pub color_scale: Option<ColorScale>,
    /// Reading and parsing.
    pub parse_time: Duration,
    path: Option<PathBuf>,
}

impl Loaded {
    /// Reads a scene that is to be rendered.
    pub(super) fn read(path: &Path, reading: &Reading, quiet: bool) -> Result<Self, Failure> {
        Input::read(path, reading)?.into_renderable(quiet)
    }

    /// The file name that OUTPUT or, without one, the scene's own name gives.
    pub(super) fn output_name(&self) -> PathBuf {
        let own = || {
            let mut name = self.path.as_deref().and_then(Path::file_stem).unwrap_or(OsStr::new("trueray")).to_owned();
            name.push(".ppm");
            name.into()
        };
        self.scene.output.as_ref().map_or_else(own, PathBuf::from)
    }
}
