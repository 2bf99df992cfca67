//! The one thread that renders, for all pages in turn.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use super::desk::{Bell, Desk, lock};
use super::easel::{Easel, Pace, Setting};
use super::pose::Range;
use super::watch::{Reading, Watched};
use super::wishes::Wishes;
use crate::gpu::{self, Gpu};
use crate::scene::Scene;

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

/// Where pages sit down and are rendered for.
#[derive(Debug)]
pub struct Studio {
    /// The scene file.
    pub watched: Arc<Watched>,
    /// Rung for every change that the thread should look at.
    pub bell: Arc<Bell>,
    /// Ends the thread, and the watching.
    pub quit: Arc<AtomicBool>,
    start: Wishes,
    range: Mutex<Range>,
    desks: Mutex<Vec<Arc<Desk>>>,
    /// The page that is rendered for, and the version of its wishes.
    turn: Mutex<Option<(Arc<Desk>, u64)>>,
}

impl Studio {
    /// For the scene of `watched`; pages start with the wishes `start`.
    pub fn new(watched: Watched, start: Wishes) -> Self {
        let range = lock(&watched.stage).fresh.as_ref().map_or(Range { distance: 1.0 }, Range::of);
        Self {
            watched: Arc::new(watched),
            bell: Arc::default(),
            quit: Arc::default(),
            start,
            range: Mutex::new(range),
            desks: Mutex::default(),
            turn: Mutex::default(),
        }
    }

    /// A desk for a new page; none where there are too many.
    pub fn sit_down(&self) -> Option<Arc<Desk>> {
        let mut desks = lock(&self.desks);
        desks.retain(|desk| !desk.is_closed());
        if desks.len() >= MAX_PAGES {
            return None;
        }
        let desk = Arc::new(Desk::new(self.start.clone(), *lock(&self.range)));
        desks.push(Arc::clone(&desk));
        self.bell.ring();
        Some(desk)
    }

    /// Renders until `quit`. Opens the device again where it was lost, or where anything on the way to a picture has panicked.
    pub fn run(&self, open: &mut Opener) {
        let Some(mut scene) = lock(&self.watched.stage).fresh.take() else { return };
        let mut pace = Pace::default();
        // Before the first page comes its kernels can be compiled.
        let rehearsal = Arc::new(Desk::new(self.start.clone(), *lock(&self.range)));
        while !self.quit.load(Ordering::Relaxed) {
            let work = || self.work(open()?.as_deref(), &mut scene, &mut pace, &rehearsal);
            // All that was in the making goes with the device; what stays is complete at each step.
            match catch_unwind(AssertUnwindSafe(work)) {
                Ok(Ok(())) => {}
                Ok(Err(error)) => self.wait_for_device(&error.to_string()),
                Err(panic) => self.give_up(words_of(&*panic)),
            }
        }
    }

    /// Tells all pages why there is no device, and waits before the next attempt.
    fn wait_for_device(&self, why: &str) {
        for desk in lock(&self.desks).iter().filter(|desk| desk.is_open()) {
            desk.send_words(serde_json::json!({ "is": "lost", "why": why }));
        }
        self.bell.wait(RETRY);
    }

    /// A panic is a fault of this program, and would come again with the same wishes: the page is told, and may wish anything else.
    fn give_up(&self, why: &str) {
        let Some((desk, version)) = lock(&self.turn).take() else { return self.wait_for_device(why) };
        desk.give_up(version);
        desk.send_words(serde_json::json!({ "is": "failed", "why": why }));
    }

    /// Renders until the device is lost, or `quit`.
    fn work(
        &self,
        gpu: Option<&Gpu>,
        scene: &mut Scene,
        pace: &mut Pace,
        rehearsal: &Arc<Desk>,
    ) -> Result<(), gpu::Error> {
        let mut error = None;
        let mut readings = 0;
        let mut easels: Vec<Easel> = Vec::new();
        if !rehearsal.is_closed() {
            easels.push(Easel::new(Arc::clone(rehearsal), gpu, *pace));
        }
        while !self.quit.load(Ordering::Relaxed) {
            self.look_at_scene(scene, &mut readings, &mut error, &mut easels);
            self.seat(&mut easels, rehearsal, gpu, *pace);
            let busy = easels.iter().filter(|easel| easel.wants_a_turn()).count();
            if busy == 0 {
                self.bell.wait(Duration::from_secs(1));
                continue;
            }
            let (pages, all) = (easels.len(), easels.iter().map(Easel::pixels).sum::<u64>());
            for easel in easels.iter_mut().filter(|easel| easel.wants_a_turn()) {
                let pixels = MAX_PIXELS.saturating_sub(all - easel.pixels()).max(LEAST_PIXELS);
                let scene_file = self.watched.path.to_string_lossy();
                *lock(&self.turn) = Some((Arc::clone(&easel.desk), easel.desk.version()));
                let turned = easel.turn(&mut Setting {
                    scene,
                    scene_file: &scene_file,
                    error: error.as_ref(),
                    busy,
                    pixels,
                    pages,
                });
                *lock(&self.turn) = None;
                turned?;
                *pace = easel.pace;
            }
            // One picture is enough of a rehearsal: its messages stay unread, so that it ends by itself.
            if rehearsal.take().is_some() {
                rehearsal.close();
            }
        }
        Ok(())
    }

    fn look_at_scene(&self, scene: &mut Scene, readings: &mut u64, error: &mut Option<Reading>, easels: &mut [Easel]) {
        let mut stage = lock(&self.watched.stage);
        if stage.readings == *readings {
            return;
        }
        *readings = stage.readings;
        error.clone_from(&stage.error);
        let fresh = stage.fresh.take();
        drop(stage);
        let replaced = fresh.is_some();
        if let Some(fresh) = fresh {
            *scene = fresh;
            *lock(&self.range) = Range::of(scene);
            lock(&self.desks).iter().for_each(|desk| desk.forgive());
        }
        for easel in easels {
            easel.desk.set_range(*lock(&self.range));
            if replaced {
                easel.desk.forgive();
            }
            easel.scene_changed(replaced);
        }
    }

    /// One easel for each desk.
    fn seat<'g>(&self, easels: &mut Vec<Easel<'g>>, rehearsal: &Arc<Desk>, gpu: Option<&'g Gpu>, pace: Pace) {
        let mut desks = lock(&self.desks);
        desks.retain(|desk| !desk.is_closed());
        easels.retain(|easel| !easel.desk.is_closed());
        let seated = |easels: &[Easel], desk: &Arc<Desk>| easels.iter().any(|easel| Arc::ptr_eq(&easel.desk, desk));
        for desk in desks.iter() {
            if !seated(easels, desk) {
                rehearsal.close();
                easels.push(Easel::new(Arc::clone(desk), gpu, pace));
            }
        }
    }
}

/// What a panic says.
pub(super) fn words_of(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("for a reason without words")
}
