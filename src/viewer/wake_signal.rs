//! What wakes the thread that renders.

use std::sync::{Condvar, Mutex, PoisonError};
use std::time::Duration;

use crate::threads::lock;

/// Wakes the thread that renders.
#[derive(Debug, Default)]
pub struct WakeSignal {
    raised: Mutex<bool>,
    changed: Condvar,
}

impl WakeSignal {
    /// There is something to do.
    pub fn raise(&self) {
        *lock(&self.raised) = true;
        self.changed.notify_all();
    }

    /// Waits until it is raised, unless it has been since the last time, or for `limit`.
    pub fn wait(&self, limit: Duration) {
        let waited = self.changed.wait_timeout_while(lock(&self.raised), limit, |raised| !*raised);
        *waited.unwrap_or_else(PoisonError::into_inner).0 = false;
    }
}
