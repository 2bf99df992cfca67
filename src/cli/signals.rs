//! Signals that end the run: nothing half-written stays, measurements are not lost, and the shell sees which signal it was.

use std::sync::Mutex;

use crate::threads::lock;

/// Says what there is to say before the process ends; it runs on a thread of its own.
type LastWords = Box<dyn FnOnce() + Send>;

static LAST_WORDS: Mutex<Option<LastWords>> = Mutex::new(None);

/// Has `words` said if a signal ends the process from here on.
pub(super) fn say_last(words: impl FnOnce() + Send + 'static) {
    *lock(&LAST_WORDS) = Some(Box::new(words));
}

/// From here on there is nothing to say. Where it is being said, the process ends before this returns.
pub(super) fn say_nothing() {
    *lock(&LAST_WORDS) = None;
}

#[cfg(unix)]
pub(super) use unix::watch;

/// There are no such signals.
#[cfg(not(unix))]
pub(super) fn watch(_stops: bool) -> std::io::Result<()> {
    Ok(())
}

#[cfg(unix)]
mod unix {
    use std::io;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::thread;
    use std::time::Duration;

    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXCPU, SIGXFSZ};
    use signal_hook::flag;
    use signal_hook::iterator::Signals;
    use signal_hook::low_level::emulate_default_handler;

    use crate::cli::failure::STOPPED;

    /// What renders has so long to end by itself: a dispatch takes a fraction of it.
    const GRACE: Duration = Duration::from_secs(5);

    /// Starts the thread that waits for signals. Where the process `stops`, SIGTERM asks renderers to end, and its exit code is
    /// [`STOPPED`]: schedulers send it, and repeat what has been stopped.
    pub(in super::super) fn watch(stops: bool) -> io::Result<()> {
        // With a handler, whatever it does, a write beyond the limit of a file's size is an error, as on a full disk.
        flag::register(SIGXFSZ, Arc::default())?;
        let ignored = ignored();
        let ending = [SIGINT, SIGTERM, SIGHUP, SIGXCPU].into_iter().filter(|signal| ignored >> (signal - 1) & 1 == 0);
        let is_ending = Arc::new(AtomicBool::new(false));
        // Who asks twice does not wait.
        ending.clone().try_for_each(|signal| {
            flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(&is_ending)).map(|_| ())
        })?;
        let mut signals = Signals::new(ending)?;
        thread::Builder::new().name("signals".into()).spawn(move || {
            if let Some(signal) = signals.forever().next() {
                is_ending.store(true, Ordering::SeqCst);
                let mut words = super::lock(&super::LAST_WORDS);
                if let Some(words) = words.take() {
                    words();
                }
                if stops && signal == SIGTERM {
                    crate::stop::ask();
                    thread::sleep(GRACE);
                    crate::atomic::abandon_all();
                    std::process::exit(STOPPED.into());
                }
                crate::atomic::abandon_all();
                end(signal);
            }
        })?;
        Ok(())
    }

    /// Ends the process as the signal would have: shells tell that from an exit, and end their loops.
    fn end(signal: i32) -> ! {
        // The first process of a container is deaf to signals without a handler.
        if std::process::id() != 1 {
            let _ = emulate_default_handler(signal);
        }
        std::process::exit(128 + signal)
    }

    /// The signals that whoever started the process wants ignored, as `nohup` does, a bit each; only Linux tells.
    fn ignored() -> u64 {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
        mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
    }
}
