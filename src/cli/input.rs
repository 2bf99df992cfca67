//! Reading scene files for the subcommands.

use std::ffi::OsStr;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::color;
use super::failure::{Failure, SCENE};
use super::output::{err, errln};
use crate::scene::{Parsed, Scene, foreign_kind, parse};
use crate::words::visible;

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
}

impl Input {
    /// Reads the file at `path`, or standard input for `-`; errors in the scene stay in `parsed`.
    pub(super) fn read(path: &Path) -> Result<Self, Failure> {
        let _span = tracing::info_span!("read scene").entered();
        let start = Instant::now();
        let stdin = path == Path::new("-");
        let name = if stdin { "standard input".to_owned() } else { path.display().to_string() };
        let refused = |why: String| Failure::new(SCENE, format!("cannot read the scene {}: {why}", visible(&name)));
        if path.is_dir() {
            return Err(refused("that is a folder".into()));
        }
        let text = if stdin {
            let mut text = Vec::new();
            std::io::stdin().lock().read_to_end(&mut text).map(|_| text)
        } else {
            std::fs::read(path)
        };
        let text = text.map_err(|error| refused(error.to_string()))?;
        if let Some(kind) = foreign_kind(&text) {
            return Err(Failure::new(SCENE, format!("{}: this is {kind}, not a scene", visible(&name))));
        }
        let parsed = parse(&name, &text);
        Ok(Self { name, parsed, parse_time: start.elapsed(), path: (!stdin).then(|| path.to_owned()) })
    }

    /// Prints errors and warnings and returns the scene, if it can be rendered.
    pub(super) fn into_renderable(self, quiet: bool) -> Result<Loaded, Failure> {
        self.print_diagnostics(quiet);
        match self.parsed.scene {
            Some(scene) => Ok(Loaded { name: self.name, scene, parse_time: self.parse_time, path: self.path }),
            None => Err(Failure::new(SCENE, "")),
        }
    }

    /// Prints the parser's report to standard error; warnings only unless `quiet`.
    pub(super) fn print_diagnostics(&self, quiet: bool) {
        if self.parsed.errors > 0 || !quiet {
            err!("{}", self.parsed.report(color::is_on(&std::io::stderr())));
        }
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
    /// Reading and parsing.
    pub parse_time: Duration,
    path: Option<PathBuf>,
}

impl Loaded {
    /// Reads a scene that is to be rendered.
    pub(super) fn read(path: &Path, quiet: bool) -> Result<Self, Failure> {
        Input::read(path)?.into_renderable(quiet)
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
