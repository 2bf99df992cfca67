//! A request to end early, which renderers look at between dispatches, and rows of them on the CPU.

use std::sync::atomic::{AtomicBool, Ordering};

static ASKED: AtomicBool = AtomicBool::new(false);

/// Asks all renderers of this process to end.
pub(crate) fn ask() {
    ASKED.store(true, Ordering::Relaxed);
}

/// Whether they are to end.
pub(crate) fn is_asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}
