//! The scene file, read again whenever it changes.

use std::panic::catch_unwind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, SystemTime};

use serde::Serialize;

use super::desk::{Bell, lock};
use super::studio::words_of;
use crate::scene::{Scene, Severity, parse};

/// Time between two looks at the file.
const INTERVAL: Duration = Duration::from_millis(100);

/// Why the file is no scene that can be rendered.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Reading {
    /// Line of the first error, from 1; 0 where the file cannot be read.
    pub line: usize,
    /// The errors, as on the command line.
    pub text: String,
}

/// What is known of the scene file.
#[derive(Debug, Default)]
pub struct Stage {
    /// A scene that nobody has taken yet.
    pub fresh: Option<Scene>,
    /// What is wrong with the file as it is now.
    pub error: Option<Reading>,
    /// Grows with every reading.
    pub readings: u64,
}

/// A scene file that is watched.
#[derive(Debug)]
pub struct Watched {
    /// Where it is.
    pub path: PathBuf,
    /// What is known of it.
    pub stage: Mutex<Stage>,
}

impl Watched {
    /// A file that has been read as `scene`.
    pub fn new(path: &Path, scene: Scene) -> Self {
        let stage = Stage { fresh: Some(scene), error: None, readings: 1 };
        Self { path: path.to_owned(), stage: Mutex::new(stage) }
    }

    /// Reads the file again.
    fn read(&self) {
        let name = self.path.display().to_string();
        // Whatever is in the file, the next one is looked at.
        let result = catch_unwind(|| read(&name, &self.path)).unwrap_or_else(|panic| {
            Err(Reading { line: 0, text: format!("the scene {name} cannot be read: {}", words_of(&*panic)) })
        });
        let mut stage = lock(&self.stage);
        stage.readings += 1;
        match result {
            Ok(scene) => (stage.fresh, stage.error) = (Some(scene), None),
            Err(error) => stage.error = Some(error),
        }
    }
}

fn read(name: &str, path: &Path) -> Result<Scene, Reading> {
    let text = std::fs::read(path)
        .map_err(|error| Reading { line: 0, text: format!("cannot read the scene {name}: {error}") })?;
    let parsed = parse(name, &text);
    let line = parsed.diagnostics.iter().find(|diagnostic| diagnostic.severity == Severity::Error);
    let line = line.map_or(0, |diagnostic| diagnostic.line);
    let report = parsed.report(false);
    parsed.scene.ok_or(Reading { line, text: report })
}

/// Time of the last change and size: what a poll compares.
fn state(path: &Path) -> Option<(SystemTime, u64)> {
    let metadata = std::fs::metadata(path).ok()?;
    Some((metadata.modified().ok()?, metadata.len()))
}

/// Watches the file until `quit`, on a thread of its own.
///
/// # Errors
///
/// Where there is no thread.
pub fn watch(watched: Arc<Watched>, bell: Arc<Bell>, quit: Arc<AtomicBool>) -> std::io::Result<()> {
    let mut known = state(&watched.path);
    let look = move || {
        while !quit.load(Ordering::Relaxed) {
            std::thread::sleep(INTERVAL);
            let now = state(&watched.path);
            if now != known {
                known = now;
                watched.read();
                bell.ring();
            }
        }
    };
    std::thread::Builder::new().name("watch".into()).spawn(look).map(drop)
}
