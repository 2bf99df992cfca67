//! What lies between a page and the thread that renders: the page's newest wishes, and messages that it has not drawn yet.

use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use serde_json::Value;
use tokio::sync::Notify;

use super::attention::Attention;
use super::pose::Range;
use super::protocol::FromPage;
use super::wishes::Wishes;

/// Messages that a page may leave unacknowledged before it gets no more.
pub const MAX_UNACKNOWLEDGED: usize = 4;
/// The same in bytes.
const MAX_UNACKNOWLEDGED_BYTES: usize = 4 << 20;

/// A message to a page.
#[derive(Debug, Clone, PartialEq)]
pub enum Outgoing {
    /// A patch or a file.
    Bytes(Vec<u8>),
    /// JSON.
    Words(String),
}

/// Wakes the thread that renders.
#[derive(Debug, Default)]
pub struct Bell {
    rung: Mutex<bool>,
    sound: Condvar,
}

impl Bell {
    /// There is something to do.
    pub fn ring(&self) {
        *lock(&self.rung) = true;
        self.sound.notify_all();
    }

    /// Waits until the bell has rung since the last time, or for `limit`.
    pub fn wait(&self, limit: Duration) {
        let waited = self.sound.wait_timeout_while(lock(&self.rung), limit, |rung| !*rung);
        *waited.unwrap_or_else(PoisonError::into_inner).0 = false;
    }
}

/// Never poisoned in a way that matters: every change under these locks is complete at each step.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What one page wants besides a picture; each once.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Errands {
    pub(super) pick: Option<(u32, u32)>,
    pub(super) save: bool,
    pub(super) measure: bool,
    /// Why the last wish was refused.
    pub(super) refusal: Option<String>,
}

/// The meeting place of one page and the thread that renders. Its memory is bounded whatever the page sends or leaves unread.
#[derive(Debug)]
pub struct Desk {
    state: Mutex<State>,
    laid_down: Notify,
}

#[derive(Debug)]
struct State {
    start: Wishes,
    wishes: Wishes,
    range: Range,
    attention: Attention,
    /// Grows with every change of the wishes.
    version: u64,
    errands: Errands,
    /// Number of the last message.
    number: u32,
    waiting: VecDeque<Outgoing>,
    /// Number and size of each message that is not acknowledged.
    unacknowledged: VecDeque<(u32, usize)>,
    closed: bool,
    /// The version of the wishes whose picture has failed.
    failed: Option<u64>,
}

impl Desk {
    /// A desk for a page that starts with these wishes.
    pub fn new(start: Wishes, range: Range) -> Self {
        let state = State {
            wishes: start.clone(),
            start,
            range,
            attention: Attention::default(),
            version: 1,
            errands: Errands::default(),
            number: 0,
            waiting: VecDeque::new(),
            unacknowledged: VecDeque::new(),
            closed: false,
            failed: None,
        };
        Self { state: Mutex::new(state), laid_down: Notify::new() }
    }

    /// Takes a message from the page.
    pub fn receive(&self, message: &FromPage) {
        let mut state = lock(&self.state);
        let state = &mut *state;
        match message {
            FromPage::Ack { through } => {
                // Numbers wrap around; so does their difference.
                let drawn = |number: u32| through.wrapping_sub(number) < 1 << 31;
                while state.unacknowledged.front().is_some_and(|&(number, _)| drawn(number)) {
                    state.unacknowledged.pop_front();
                }
            }
            FromPage::Pick { x, y } => state.errands.pick = Some((*x, *y)),
            FromPage::Save => state.errands.save = true,
            FromPage::Measure => state.errands.measure = true,
            FromPage::Gaze { .. } | FromPage::Attend { .. } => {
                if let Err(why) = state.attention.heed(message) {
                    state.errands.refusal = Some(why);
                }
            }
            wish => {
                let before = state.wishes.clone();
                if let Err(why) = state.wishes.heed(wish, state.range, &state.start) {
                    state.errands.refusal = Some(why);
                }
                state.version += u64::from(state.wishes != before);
            }
        }
    }

    /// The newest wishes with their version.
    pub fn wishes(&self) -> (u64, Wishes) {
        let state = lock(&self.state);
        (state.version, state.wishes.clone())
    }

    /// How the page is looked at.
    pub fn attention(&self) -> Attention {
        lock(&self.state).attention
    }

    pub(super) fn version(&self) -> u64 {
        lock(&self.state).version
    }

    /// The scene has changed.
    pub(super) fn set_range(&self, range: Range) {
        lock(&self.state).range = range;
    }

    /// The picture of these wishes has failed: it is not tried again until they change, or the scene does.
    pub(super) fn give_up(&self, version: u64) {
        lock(&self.state).failed = Some(version);
    }

    /// What has failed may be tried again.
    pub(super) fn forgive(&self) {
        lock(&self.state).failed = None;
    }

    /// Whether the picture of the newest wishes has failed.
    pub(super) fn has_failed(&self) -> bool {
        let state = lock(&self.state);
        state.failed == Some(state.version)
    }

    /// Whether the page has any errand.
    pub(super) fn has_errands(&self) -> bool {
        lock(&self.state).errands != Errands::default()
    }

    /// Changes the errands.
    pub(super) fn with_errands<T>(&self, change: impl FnOnce(&mut Errands) -> T) -> T {
        change(&mut lock(&self.state).errands)
    }

    /// Whether the page has drawn enough of what it got to get more.
    pub fn is_open(&self) -> bool {
        let state = lock(&self.state);
        let bytes: usize = state.unacknowledged.iter().map(|(_, bytes)| bytes).sum();
        state.unacknowledged.len() < MAX_UNACKNOWLEDGED && bytes < MAX_UNACKNOWLEDGED_BYTES
    }

    /// Lays down a binary message for the page, numbered in its second word.
    pub(super) fn send_bytes(&self, mut bytes: Vec<u8>) {
        let mut state = lock(&self.state);
        let number = state.next_number(bytes.len());
        bytes[4..8].copy_from_slice(&number.to_le_bytes());
        state.waiting.push_back(Outgoing::Bytes(bytes));
        self.laid_down.notify_one();
    }

    /// Lays down a JSON object for the page, numbered.
    pub(super) fn send_words(&self, mut words: Value) {
        let mut state = lock(&self.state);
        let number = state.next_number(0);
        words["number"] = number.into();
        state.waiting.push_back(Outgoing::Words(words.to_string()));
        self.laid_down.notify_one();
    }

    /// The oldest message that is not on its way yet.
    pub fn take(&self) -> Option<Outgoing> {
        lock(&self.state).waiting.pop_front()
    }

    /// Waits for a message. Nothing is lost where the future is dropped.
    pub async fn taken(&self) -> Outgoing {
        loop {
            if let Some(message) = self.take() {
                return message;
            }
            self.laid_down.notified().await;
        }
    }

    /// The page has gone.
    pub fn close(&self) {
        let mut state = lock(&self.state);
        state.closed = true;
        state.waiting.clear();
    }

    /// Whether the page has gone.
    pub fn is_closed(&self) -> bool {
        lock(&self.state).closed
    }
}

impl State {
    fn next_number(&mut self, bytes: usize) -> u32 {
        self.number = self.number.wrapping_add(1);
        self.unacknowledged.push_back((self.number, bytes));
        self.number
    }
}
