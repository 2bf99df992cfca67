//! `--timeline`: when each step of a run began and ended, as a trace that Perfetto and Chromium open.
//!
//! Steps are spans of `tracing`, so a program that uses the library sees them with a subscriber of its own.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use tracing_chrome::{ChromeLayerBuilder, FlushGuard};
use tracing_subscriber::layer::SubscriberExt as _;
use tracing_subscriber::registry;

use super::failure::Failure;
use super::files::save;
use crate::threads::lock;

/// The steps of a run so far.
pub(super) struct Timeline {
    path: PathBuf,
    events: Events,
    guard: FlushGuard,
}

/// The text of the trace. It stays in memory until the run is over, since writing files is a step, too.
#[derive(Clone, Default)]
struct Events(Arc<Mutex<Vec<u8>>>);

impl Write for Events {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        lock(&self.0).write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Timeline {
    /// Notes steps from now on, for the file at `path`.
    pub(super) fn begin(path: &Path) -> Self {
        let events = Events::default();
        let (layer, guard) =
            ChromeLayerBuilder::new().writer(events.clone()).include_args(true).include_locations(false).build();
        // Nothing else of this program subscribes.
        let _ = tracing::subscriber::set_global_default(registry().with(layer));
        Self { path: path.to_owned(), events, guard }
    }

    /// Writes what happened until now.
    pub(super) fn write(self) -> Result<(), Failure> {
        drop(self.guard);
        let text = std::mem::take(&mut *lock(&self.events.0));
        save(&self.path, &String::from_utf8_lossy(&text))
    }
}
