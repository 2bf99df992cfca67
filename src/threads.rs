//! Threads: as many as the system gives, and the calling one where it gives none.
//!
//! A system may refuse threads: limits of processes and containers, filters of system calls. Nothing here needs more than one.

use std::num::NonZero;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Sender, channel, sync_channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::{Builder, Scope, available_parallelism};

use rayon::{ThreadBuilder, ThreadPoolBuilder};

/// So many threads for each that the processor runs at once are asked for at the most.
const MOST: usize = 4;

/// Whether the pool is the main thread: another that left work to it would wait for ever.
static ALONE: AtomicBool = AtomicBool::new(false);

/// Makes the pool that all loops share; on the main thread, before any of them. Later calls do nothing.
pub(crate) fn make_pool() {
    let available = available_parallelism().map_or(1, NonZero::get);
    let asked = std::env::var("RAYON_NUM_THREADS").ok().and_then(|number| number.parse().ok());
    let mut workers = idle_threads(wanted(asked, available));
    // Where there is a pool already, there is nothing to do.
    let _ = if workers.is_empty() {
        ALONE.store(true, Ordering::Relaxed);
        ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global()
    } else {
        let count = workers.len();
        let hire = |worker: ThreadBuilder| {
            // A thread that waits takes it.
            workers.pop().and_then(|thread| thread.send(worker).ok()).ok_or(std::io::ErrorKind::Other.into())
        };
        ThreadPoolBuilder::new().num_threads(count).spawn_handler(hire).build_global()
    };
}

/// How many threads to ask for, where the user has asked for so many.
fn wanted(asked: Option<usize>, available: usize) -> usize {
    asked.filter(|&asked| asked > 0).unwrap_or(available).min(MOST * available)
}

/// Threads that wait for a worker of the pool; half of them go where the system refuses more, since drivers need some as well.
fn idle_threads(wanted: usize) -> Vec<Sender<ThreadBuilder>> {
    let mut threads = Vec::new();
    for _ in 0..wanted {
        let (sender, receiver) = channel::<ThreadBuilder>();
        let work = move || {
            if let Ok(worker) = receiver.recv() {
                worker.run();
            }
        };
        if Builder::new().name("worker".into()).spawn(work).is_err() {
            threads.truncate(threads.len().div_ceil(2));
            break;
        }
        threads.push(sender);
    }
    threads
}

/// What a mutex guards. None is poisoned in a way that matters: every change under a lock here is complete at each step.
pub(crate) fn lock<T: ?Sized>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Whether there is no thread beside the main one: then no other may wait for the pool.
pub(crate) fn is_alone() -> bool {
    ALONE.load(Ordering::Relaxed)
}

/// Whether the system refuses to start as many threads as a driver may want.
pub(crate) fn are_short() -> bool {
    // They end when the senders are dropped.
    let wanted = available_parallelism().map_or(1, NonZero::get) + 4;
    idle_threads(wanted).len() < wanted
}

/// Runs `there` on a thread of its own while `here` runs on this one; after it, where there is no thread to be had.
pub(crate) fn at_once<A: Send, B>(there: impl FnOnce() -> A + Send, here: impl FnOnce() -> B) -> (A, B) {
    let task = Mutex::new(Some(there));
    // Whoever takes it runs it: a thread that cannot be had leaves it where it is.
    let run = || {
        let task = lock(&task).take();
        task.map(|task| task())
    };
    std::thread::scope(|scope| {
        let thread = (!is_alone()).then(|| Builder::new().spawn_scoped(scope, run).ok()).flatten();
        let here = here();
        let there = match thread {
            Some(thread) => thread.join().unwrap_or_else(|panic| resume_unwind(panic)),
            None => run(),
        };
        (there.expect("it is run once"), here)
    })
}

/// Passes all that `first` makes through `second`, and what that hands on to `third`, in order. Each works on a thread of its own,
/// `second` on this one, and waits once it is an item ahead; for whom there is no thread, this one works.
pub(crate) fn in_stages<A: Send, B: Send>(
    first: impl FnMut() -> Option<A> + Send,
    mut second: impl FnMut(A, &mut dyn FnMut(B)),
    third: impl FnMut(B) + Send,
) {
    let (first, third) = (&Mutex::new(first), &Mutex::new(third));
    std::thread::scope(|scope| {
        let (to_second, from_first) = sync_channel(0);
        let (to_third, from_second) = sync_channel(1);
        let has_first = starts(scope, move || {
            let mut first = lock(first);
            while let Some(item) = first()
                && to_second.send(item).is_ok()
            {}
        });
        let has_third = starts(scope, move || from_second.into_iter().for_each(|item| lock(third)(item)));
        let next = || if has_first { from_first.recv().ok() } else { lock(first)() };
        let mut hand_on = |item| {
            if has_third {
                // Where the other thread has panicked, so does this one in the end.
                let _ = to_third.send(item);
            } else {
                lock(third)(item);
            }
        };
        while let Some(item) = next() {
            second(item, &mut hand_on);
        }
    });
}

/// Whether there is a thread for `work`.
fn starts<'scope>(scope: &'scope Scope<'scope, '_>, work: impl FnOnce() + Send + 'scope) -> bool {
    !is_alone() && Builder::new().spawn_scoped(scope, work).is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_beyond_reason_are_bounded() {
        assert_eq!([wanted(None, 2), wanted(Some(0), 2), wanted(Some(1), 2), wanted(Some(8), 2)], [2, 2, 1, 8]);
        assert_eq!(wanted(Some(100_000), 2), 8);
    }

    #[test]
    fn both_run_with_a_thread_or_without() {
        for alone in [false, true] {
            let before = ALONE.swap(alone, Ordering::Relaxed);
            let this = std::thread::current().id();
            let (there, here) = at_once(|| std::thread::current().id(), || std::thread::current().id());
            assert_eq!((there == this, here == this), (alone, true));
            ALONE.store(before, Ordering::Relaxed);
        }
    }

    #[test]
    fn a_panic_there_goes_on_here() {
        assert!(std::panic::catch_unwind(|| at_once(|| panic!("on purpose"), || ())).is_err());
    }

    #[test]
    fn stages_keep_the_order_with_threads_or_without() {
        for alone in [false, true] {
            let before = ALONE.swap(alone, Ordering::Relaxed);
            let (mut numbers, mut ends) = (1..=100, Vec::new());
            let twice = |number: i32, hand_on: &mut dyn FnMut(i32)| {
                hand_on(number);
                hand_on(-number);
            };
            in_stages(|| numbers.next(), twice, |number| ends.push(number));
            ALONE.store(before, Ordering::Relaxed);
            assert_eq!(ends, (1..=100).flat_map(|number| [number, -number]).collect::<Vec<_>>());
        }
    }
}
