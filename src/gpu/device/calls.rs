//! Calls of a driver that have not returned yet, and how long a device may take.
//!
//! A driver can wait inside a call for what never comes; no time limit of ours reaches it there. Whoever may end the process looks
//! here now and then.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard};
use std::time::Duration;

use crate::threads::lock;

/// The environment variable that sets [`patience`], in seconds.
pub const PATIENCE: &str = "TRUERAY_PATIENCE";

/// A dispatch is sized to take a fraction of a second, and the first one is at the most so many seconds longer: whatever takes
/// longer than this will never end.
const USUAL: u64 = 120;

static SECONDS: AtomicU64 = AtomicU64::new(USUAL);
static NEXT: AtomicU64 = AtomicU64::new(0);
static OPEN: Mutex<BTreeSet<u64>> = Mutex::new(BTreeSet::new());

fn open() -> MutexGuard<'static, BTreeSet<u64>> {
    lock(&OPEN)
}

/// How long a device may take for one thing. Only time in which this process runs counts: one that is stopped waits for nothing.
pub fn patience() -> Duration {
    Duration::from_secs(SECONDS.load(Ordering::Relaxed))
}

/// Sets [`patience`] for all devices; below one second it is one.
pub fn set_patience(seconds: u64) {
    SECONDS.store(seconds.max(1), Ordering::Relaxed);
}

/// The number of the call that has been open for the longest time.
pub fn oldest() -> Option<u64> {
    open().first().copied()
}

/// A call that is open until this is dropped.
pub(crate) struct Call(u64);

impl Call {
    pub(crate) fn begin() -> Self {
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        open().insert(number);
        Self(number)
    }
}

impl Drop for Call {
    fn drop(&mut self) {
        open().remove(&self.0);
    }
}
