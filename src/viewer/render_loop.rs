//! The one thread that renders, for all pages in turn.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use super::cost_model::CostModel;
use super::messages::PageMessage;
use super::pose::FlightScale;
use super::scene_file::{ReadScene, SceneError, SceneFile};
use super::session::Session;
use super::session_renderer::{Context, SessionRenderer};
use super::view_state::ViewState;
use super::wake_signal::WakeSignal;
use crate::gpu::{self, Gpu};
use crate::kept::Kept;
use crate::panics::message;
use crate::threads::lock;

/// Pages at once.
pub const MAX_PAGES: usize = 16;
/// Pixels of all pages together; each is kept in 3 bytes.
const MAX_PIXELS: u64 = 1 << 27;
/// A page is given a picture of so many pixels even where others have used all.
const LEAST_PIXELS: u64 = 1 << 20;
/// Time between two attempts to open a device that was lost.
const RETRY: Duration = Duration::from_millis(500);

/// Opens the device; `None` is the CPU reference.
pub type Opener = dyn FnMut() -> Result<Option<Arc<Gpu>>, gpu::Error>;

/// The sessions of all pages, and what is rendered for them.
#[derive(Debug)]
pub struct RenderLoop {
    /// The scene file.
    pub scene_file: Arc<SceneFile>,
    /// Raised for every change that the thread should look at.
    pub wake: Arc<WakeSignal>,
    /// Ends the thread, and the watching.
    pub quit: Arc<AtomicBool>,
    start: ViewState,
    scale: Mutex<FlightScale>,
    sessions: Mutex<Vec<Arc<Session>>>,
    /// The page that is rendered for, and the version of its view.
    current: Mutex<Option<(Arc<Session>, u64)>>,
}

impl RenderLoop {
    /// For the scene of `scene_file`; pages start with the view `start`.
    pub fn new(scene_file: SceneFile, start: ViewState) -> Self {
        let scale = lock(&scene_file.slot)
            .fresh
            .as_ref()
            .map_or(FlightScale { distance: 1.0 }, |read| FlightScale::of(&read.scene));
        Self {
            scene_file: Arc::new(scene_file),
            wake: Arc::default(),
            quit: Arc::default(),
            start,
            scale: Mutex::new(scale),
            sessions: Mutex::default(),
            current: Mutex::default(),
        }
    }

    /// A session for a new page; none where there are too many.
    pub fn connect(&self) -> Option<Arc<Session>> {
        let mut sessions = lock(&self.sessions);
        sessions.retain(|session| !session.is_closed());
        if sessions.len() >= MAX_PAGES {
            return None;
        }
        let session = Arc::new(Session::new(self.start.clone(), *lock(&self.scale)));
        sessions.push(Arc::clone(&session));
        self.wake.raise();
        Some(session)
    }

    /// Renders until `quit`. Opens the device again where it was lost, or where anything on the way to a picture has panicked.
    pub fn run(&self, open: &mut Opener) {
        let Some(mut read) = lock(&self.scene_file.slot).fresh.take() else { return };
        let mut costs = CostModel::default();
        // Before the first page comes its kernels can be compiled.
        let warm_up = Arc::new(Session::new(self.start.clone(), *lock(&self.scale)));
        while !self.quit.load(Ordering::Relaxed) {
            let work = || self.work(open()?.as_ref(), &mut read, &mut costs, &warm_up);
            // All that was in the making goes with the device; what stays is complete at each step.
            match catch_unwind(AssertUnwindSafe(work)) {
                Ok(Ok(())) => {}
                Ok(Err(error)) => self.wait_for_device(&error.to_string()),
                Err(panic) => self.skip_view(message(&*panic)),
            }
        }
    }

    /// Tells all pages why there is no device, and waits before the next attempt.
    fn wait_for_device(&self, why: &str) {
        for session in lock(&self.sessions).iter().filter(|session| session.is_open()) {
            session.send(&PageMessage::Lost { why });
        }
        self.wake.wait(RETRY);
    }

    /// A panic is a fault of this program, and would come again with the same view: the page is told, and may ask for
    /// any other.
    fn skip_view(&self, why: &str) {
        let Some((session, version)) = lock(&self.current).take() else { return self.wait_for_device(why) };
        session.mark_failed(version);
        session.send(&PageMessage::Failed { why });
    }

    /// Renders until the device is lost, or `quit`.
    fn work(
        &self,
        shared: Option<&Arc<Gpu>>,
        read: &mut ReadScene,
        costs: &mut CostModel,
        warm_up: &Arc<Session>,
    ) -> Result<(), gpu::Error> {
        let gpu = shared.map(Arc::as_ref);
        let (mut error, mut kept) = (None, Kept::default());
        let mut revision = 0;
        let mut renderers: Vec<SessionRenderer> = Vec::new();
        if !warm_up.is_closed() {
            renderers.push(SessionRenderer::new(Arc::clone(warm_up), gpu, *costs));
        }
        while !self.quit.load(Ordering::Relaxed) {
            if self.reload_scene(read, &mut revision, &mut error, &mut renderers) {
                kept = Kept::default();
            }
            self.update_renderers(&mut renderers, warm_up, gpu, *costs);
            let busy = renderers.iter().filter(|renderer| renderer.has_work()).count();
            if busy == 0 {
                self.wake.wait(Duration::from_secs(1));
                continue;
            }
            let all: u64 = renderers.iter().map(SessionRenderer::pixels).sum();
            for renderer in renderers.iter_mut().filter(|renderer| renderer.has_work()) {
                let pixels = MAX_PIXELS.saturating_sub(all - renderer.pixels()).max(LEAST_PIXELS);
                let scene_file = self.scene_file.path.to_string_lossy();
                *lock(&self.current) = Some((Arc::clone(&renderer.session), renderer.session.version()));
                let result = renderer.advance(&mut Context {
                    scene: &mut read.scene,
                    lamps: read.lamps,
                    kept: &kept,
                    scene_file: &scene_file,
                    error: error.as_ref(),
                    gpu: shared,
                    wake: &self.wake,
                    busy,
                    pixels,
                });
                *lock(&self.current) = None;
                result?;
                *costs = renderer.costs;
            }
            // One picture is enough to warm up: its messages stay unread, so that it ends by itself.
            if warm_up.take().is_some() {
                warm_up.close();
            }
        }
        Ok(())
    }

    /// Whether there is another scene now.
    fn reload_scene(
        &self,
        read: &mut ReadScene,
        revision: &mut u64,
        error: &mut Option<SceneError>,
        renderers: &mut [SessionRenderer],
    ) -> bool {
        let mut slot = lock(&self.scene_file.slot);
        if slot.revision == *revision {
            return false;
        }
        *revision = slot.revision;
        error.clone_from(&slot.error);
        let fresh = slot.fresh.take();
        drop(slot);
        let replaced = fresh.is_some();
        if let Some(fresh) = fresh {
            *read = fresh;
            *lock(&self.scale) = FlightScale::of(&read.scene);
            lock(&self.sessions).iter().for_each(|session| session.clear_failure());
        }
        for renderer in renderers {
            renderer.session.set_scale(*lock(&self.scale));
            if replaced {
                renderer.session.clear_failure();
            }
            renderer.scene_changed(replaced);
        }
        replaced
    }

    /// One renderer for each session.
    fn update_renderers<'g>(
        &self,
        renderers: &mut Vec<SessionRenderer<'g>>,
        warm_up: &Arc<Session>,
        gpu: Option<&'g Gpu>,
        costs: CostModel,
    ) {
        let mut sessions = lock(&self.sessions);
        sessions.retain(|session| !session.is_closed());
        renderers.retain(|renderer| !renderer.session.is_closed());
        let has_one = |renderers: &[SessionRenderer], session: &Arc<Session>| {
            renderers.iter().any(|renderer| Arc::ptr_eq(&renderer.session, session))
        };
        for session in sessions.iter() {
            if !has_one(renderers, session) {
                warm_up.close();
                renderers.push(SessionRenderer::new(Arc::clone(session), gpu, costs));
            }
        }
    }
}
