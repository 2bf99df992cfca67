//! How long a search may take.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// A time that a search may take, from here on.
#[derive(Debug)]
pub(super) struct Limit {
    until: Option<Instant>,
    has_cut: AtomicBool,
}

impl Limit {
    /// Without a time, or with more than clocks have, the search runs to its end.
    pub(super) fn new(time: Option<Duration>) -> Self {
        Self { until: time.and_then(|time| Instant::now().checked_add(time)), has_cut: AtomicBool::new(false) }
    }

    /// Whether the time is over: whoever asks then leaves out some of the search.
    pub(super) fn is_over(&self) -> bool {
        let is_over = self.until.is_some_and(|until| Instant::now() >= until);
        if is_over {
            self.has_cut.store(true, Ordering::Relaxed);
        }
        is_over
    }

    /// Whether any of the search was left out.
    pub(super) fn has_cut(&self) -> bool {
        self.has_cut.load(Ordering::Relaxed)
    }
}
