//! One page and the thread that renders for it: the newest view of the page, and the messages that it has not drawn yet.

use std::collections::VecDeque;
use std::sync::Mutex;

use tokio::sync::Notify;

use super::messages::{Numbered, PageMessage};
use super::pose::FlightScale;
use super::preview::PreviewOptions;
use super::requests::PageRequest;
use super::view_state::ViewState;
use crate::threads::lock;

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
    Text(String),
}

/// What one page asks for besides a picture; each once.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct OneShots {
    pub(super) pick: Option<(u32, u32)>,
    pub(super) save: bool,
    pub(super) measure: bool,
    /// Why the last request was refused.
    pub(super) refusal: Option<String>,
    /// A request for a view has changed nothing: no picture answers it.
    pub(super) unchanged: bool,
}

/// A mailbox between one page and the thread that renders. Its memory is bounded whatever the page sends or leaves unread.
#[derive(Debug)]
pub struct Session {
    state: Mutex<State>,
    enqueued: Notify,
}

#[derive(Debug)]
struct State {
    start: ViewState,
    view: ViewState,
    scale: FlightScale,
    preview: PreviewOptions,
    /// Grows with every change of the view.
    version: u64,
    /// Requests for a view so far, those included that have changed nothing.
    heard: u64,
    one_shots: OneShots,
    /// Number of the last message.
    number: u32,
    waiting: VecDeque<Outgoing>,
    /// Number and size of each message that is not acknowledged.
    unacknowledged: VecDeque<(u32, usize)>,
    closed: bool,
    /// The version of the view whose picture has failed.
    failed: Option<u64>,
}

impl Session {
    /// For a page that starts with this view.
    pub fn new(start: ViewState, scale: FlightScale) -> Self {
        let state = State {
            view: start.clone(),
            start,
            scale,
            preview: PreviewOptions::default(),
            version: 1,
            heard: 0,
            one_shots: OneShots::default(),
            number: 0,
            waiting: VecDeque::new(),
            unacknowledged: VecDeque::new(),
            closed: false,
            failed: None,
        };
        Self { state: Mutex::new(state), enqueued: Notify::new() }
    }

    /// Takes a request of the page.
    pub fn receive(&self, request: &PageRequest) {
        let mut state = lock(&self.state);
        let state = &mut *state;
        match request {
            PageRequest::Ack { through } => {
                // Numbers wrap around; so does their difference.
                let drawn = |number: u32| through.wrapping_sub(number) < 1 << 31;
                while state.unacknowledged.front().is_some_and(|&(number, _)| drawn(number)) {
                    state.unacknowledged.pop_front();
                }
            }
            PageRequest::Pick { x, y } => state.one_shots.pick = Some((*x, *y)),
            PageRequest::Save => state.one_shots.save = true,
            PageRequest::Measure => state.one_shots.measure = true,
            PageRequest::Gaze { .. } | PageRequest::Preview { .. } => {
                if let Err(why) = state.preview.apply(request) {
                    state.one_shots.refusal = Some(why);
                }
            }
            request => {
                let before = state.view.clone();
                if let Err(why) = state.view.apply(request, state.scale, &state.start) {
                    state.one_shots.refusal = Some(why);
                }
                let changed = state.view != before;
                state.version += u64::from(changed);
                state.heard += 1;
                state.one_shots.unchanged |= !changed;
            }
        }
    }

    /// The newest view with its version.
    pub fn view(&self) -> (u64, ViewState) {
        let state = lock(&self.state);
        (state.version, state.view.clone())
    }

    /// How moving pictures are sampled.
    pub fn preview(&self) -> PreviewOptions {
        lock(&self.state).preview
    }

    pub(super) fn version(&self) -> u64 {
        lock(&self.state).version
    }

    /// How many requests for a view have led to this version, if it is the newest.
    pub(super) fn heard_of(&self, version: u64) -> Option<u64> {
        let state = lock(&self.state);
        (state.version == version).then_some(state.heard)
    }

    /// The scene has changed.
    pub(super) fn set_scale(&self, scale: FlightScale) {
        lock(&self.state).scale = scale;
    }

    /// The picture of this view has failed: it is not tried again until the view changes, or the scene does.
    pub(super) fn mark_failed(&self, version: u64) {
        lock(&self.state).failed = Some(version);
    }

    /// What has failed may be tried again.
    pub(super) fn clear_failure(&self) {
        lock(&self.state).failed = None;
    }

    /// Whether the picture of the newest view has failed.
    pub(super) fn has_failed(&self) -> bool {
        let state = lock(&self.state);
        state.failed == Some(state.version)
    }

    /// Whether the page asks for anything besides a picture.
    pub(super) fn has_one_shots(&self) -> bool {
        lock(&self.state).one_shots != OneShots::default()
    }

    /// Changes what the page asks for besides a picture.
    pub(super) fn with_one_shots<T>(&self, change: impl FnOnce(&mut OneShots) -> T) -> T {
        change(&mut lock(&self.state).one_shots)
    }

    /// Whether the page has drawn enough of what it got to get more.
    pub fn is_open(&self) -> bool {
        let state = lock(&self.state);
        let bytes: usize = state.unacknowledged.iter().map(|(_, bytes)| bytes).sum();
        state.unacknowledged.len() < MAX_UNACKNOWLEDGED && bytes < MAX_UNACKNOWLEDGED_BYTES
    }

    /// Enqueues a binary message for the page, numbered in its second word.
    pub(super) fn send_bytes(&self, mut bytes: Vec<u8>) {
        let mut state = lock(&self.state);
        let number = state.next_number(bytes.len());
        bytes[4..8].copy_from_slice(&number.to_le_bytes());
        state.waiting.push_back(Outgoing::Bytes(bytes));
        self.enqueued.notify_one();
    }

    /// Enqueues a JSON message for the page, numbered.
    pub(super) fn send(&self, message: &PageMessage) {
        let mut state = lock(&self.state);
        let number = state.next_number(0);
        let text = serde_json::to_string(&Numbered { number, message }).expect("every key is text");
        state.waiting.push_back(Outgoing::Text(text));
        self.enqueued.notify_one();
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
            self.enqueued.notified().await;
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
