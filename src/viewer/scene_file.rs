//! The scene file, read again whenever it changes.

use std::panic::catch_unwind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, SystemTime};

use serde::Serialize;

use super::wake_signal::WakeSignal;
use crate::import::{self, Format, Import, Imported, Lamps};
use crate::panics::message;
use crate::scene::{Scene, Severity, parse};
use crate::threads::lock;

/// Time between two looks at the file.
const INTERVAL: Duration = Duration::from_millis(100);

/// Why the file is no scene that can be rendered.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SceneError {
    /// Line of the first error, from 1; 0 where the file cannot be read.
    pub line: usize,
    /// The errors, as on the command line.
    pub text: String,
}

/// A scene as it was read.
#[derive(Debug)]
pub struct ReadScene {
    /// Its spheres, and the lights for the eye that was seen by last.
    pub scene: Scene,
    /// The lights of particles, which turn with the eye.
    pub lamps: Option<Lamps>,
}

impl From<Scene> for ReadScene {
    fn from(scene: Scene) -> Self {
        Self { scene, lamps: None }
    }
}

/// What is known of the scene file.
#[derive(Debug, Default)]
pub struct SceneSlot {
    /// A scene that nobody has taken yet.
    pub fresh: Option<ReadScene>,
    /// What is wrong with the file as it is now.
    pub error: Option<SceneError>,
    /// Grows with every time that it is read.
    pub revision: u64,
}

/// A scene file that is watched.
#[derive(Debug)]
pub struct SceneFile {
    /// Where it is.
    pub path: PathBuf,
    /// What is known of it.
    pub slot: Mutex<SceneSlot>,
    /// How its particles become spheres, where it is another program's.
    import: import::Options,
}

impl SceneFile {
    /// A file that has been read as `scene`; particles in it were imported like this.
    pub fn new(path: &Path, scene: ReadScene, import: import::Options) -> Self {
        let slot = SceneSlot { fresh: Some(scene), error: None, revision: 1 };
        Self { path: path.to_owned(), slot: Mutex::new(slot), import }
    }

    /// Reads the file again.
    fn read(&self) {
        let name = self.path.display().to_string();
        // Whatever is in the file, the next one is looked at.
        let result = catch_unwind(|| read(&name, &self.path, &self.import)).unwrap_or_else(|panic| {
            Err(SceneError { line: 0, text: format!("the scene {name} cannot be read: {}", message(&*panic)) })
        });
        let mut slot = lock(&self.slot);
        slot.revision += 1;
        match result {
            Ok(scene) => (slot.fresh, slot.error) = (Some(scene), None),
            Err(error) => slot.error = Some(error),
        }
    }
}

fn read(name: &str, path: &Path, import: &import::Options) -> Result<ReadScene, SceneError> {
    let text = std::fs::read(path)
        .map_err(|error| SceneError { line: 0, text: format!("cannot read the scene {name}: {error}") })?;
    let (parsed, lamps) = match Format::of(&text) {
        Some(format) => {
            let Imported { parsed, lamps, .. } = Import::new(name, format, &text[..], import.clone()).first();
            (parsed, lamps)
        }
        None => (parse(name, &text), None),
    };
    let line = parsed.diagnostics.iter().find(|diagnostic| diagnostic.severity == Severity::Error);
    let line = line.map_or(0, |diagnostic| diagnostic.line);
    let report = parsed.report(false);
    parsed.scene.map(|scene| ReadScene { scene, lamps }).ok_or(SceneError { line, text: report })
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
pub fn watch(file: Arc<SceneFile>, wake: Arc<WakeSignal>, quit: Arc<AtomicBool>) -> std::io::Result<()> {
    let mut known = state(&file.path);
    let look = move || {
        while !quit.load(Ordering::Relaxed) {
            std::thread::sleep(INTERVAL);
            let now = state(&file.path);
            if now != known {
                known = now;
                file.read();
                wake.raise();
            }
        }
    };
    std::thread::Builder::new().name("watch".into()).spawn(look).map(drop)
}
