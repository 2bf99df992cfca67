//! What is told of a pixel: at once what the reference has, and once a thread beside the pictures has it what each tier of the device
//! shows, whose kernels may have to be compiled first.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use super::coarse::framed;
use super::reduced::MANY_SPHERES;
use super::{Context, SessionRenderer};
use crate::cpu::{Inspector, MOST_RAYS, picked};
use crate::effects::Effects;
use crate::gpu::{self, Gpu};
use crate::panics::message;
use crate::pixel::PixelReport;
use crate::report::Labels;
use crate::scene::Scene;
use crate::settings::Settings;
use crate::threads::lock;
use crate::viewer::messages::{PageMessage, PickedHit, PickedPixel, PixelTable};
use crate::viewer::wake_signal::WakeSignal;
use crate::words::count;

/// Tiers of a page's pixels: one thread at the most, however many pixels are asked for.
#[derive(Debug, Default)]
pub(super) struct Tiers {
    /// The pixel that the thread is at.
    running: Option<Arc<Work>>,
    /// The one that follows.
    next: Option<Inspection>,
}

/// What a thread has to say; or with what words it has panicked.
type Outcome = Result<Result<PixelReport, gpu::Error>, String>;

#[derive(Debug, Default)]
struct Work {
    outcome: Mutex<Option<Outcome>>,
    /// Nobody wants to know any more.
    given_up: AtomicBool,
}

/// A pixel whose tiers are still to come.
#[derive(Debug)]
struct Inspection {
    scene: Scene,
    settings: Settings,
    effects: Effects,
    inspector: Inspector,
    report: PixelReport,
}

impl Tiers {
    /// The view has changed.
    pub(super) fn give_up(&mut self) {
        self.next = None;
        if let Some(running) = &self.running {
            running.given_up.store(true, Ordering::Relaxed);
        }
    }

    /// Whether there is something to tell, or to begin.
    pub(super) fn has_work(&self) -> bool {
        match &self.running {
            Some(running) => lock(&running.outcome).is_some(),
            None => self.next.is_some(),
        }
    }

    /// What the thread has found, if it has ended and anybody wants to know.
    fn take(&mut self) -> Option<Outcome> {
        let outcome = lock(&self.running.as_ref()?.outcome).take()?;
        let running = self.running.take()?;
        (!running.given_up.load(Ordering::Relaxed)).then_some(outcome)
    }

    /// Begins with the next pixel where there is one, and no other in work.
    fn begin(&mut self, gpu: &Arc<Gpu>, wake: &Arc<WakeSignal>) {
        if self.running.is_some() {
            return;
        }
        let Some(inspection) = self.next.take() else { return };
        let work = Arc::new(Work::default());
        let (gpu, wake, its) = (Arc::clone(gpu), Arc::clone(wake), Arc::clone(&work));
        let run = move || {
            let outcome = catch_unwind(AssertUnwindSafe(|| inspection.with_tiers(&gpu, &its.given_up)));
            *lock(&its.outcome) = Some(outcome.map_err(|panic| message(&*panic).to_owned()));
            wake.raise();
        };
        if let Err(error) = std::thread::Builder::new().name("pixel".into()).spawn(run) {
            *lock(&work.outcome) = Some(Err(format!("the system gives no thread: {error}")));
        }
        self.running = Some(work);
    }
}

impl Inspection {
    fn with_tiers(mut self, gpu: &Gpu, given_up: &AtomicBool) -> Result<PixelReport, gpu::Error> {
        while let Some(tier) = self.report.next_tier(gpu)
            && !given_up.load(Ordering::Relaxed)
        {
            let viewed = self.scene.viewed(&self.settings);
            self.report.add_tier((gpu, tier), viewed, &self.effects, self.inspector.reference())?;
        }
        Ok(self.report)
    }
}

impl SessionRenderer<'_> {
    /// Tells what a pixel shows, of the newest view that is rendered.
    pub(super) fn inspect(&mut self, (x, y): (u32, u32), context: &mut Context) {
        self.tiers.give_up();
        let Some(job) = &self.job else { return };
        let (width, height) = job.size;
        if x >= width || y >= height {
            return;
        }
        let rgb = self.canvas.complete().map(|rgb| {
            let start = (y as usize * width as usize + x as usize) * 3;
            [rgb[start], rgb[start + 1], rgb[start + 2]]
        });
        let device = self.gpu.ok_or_else(|| "the CPU reference renders this page".to_owned());
        let (hit, looked) = framed(context.scene, job.framing(), |scene| {
            let viewed = scene.viewed(&job.settings);
            let look = || {
                if scene.spheres.len() > MANY_SPHERES {
                    return Err(format!("the scene has more than {MANY_SPHERES} spheres"));
                }
                let inspector = Inspector::new(&viewed, &job.effects);
                let rays = inspector.rays(x, y);
                let record = if rays > MOST_RAYS { None } else { inspector.pixel(x, y) };
                let record = record.ok_or_else(|| format!("the pixel has {}", count(rays, "ray")))?;
                let device = device.as_ref().copied();
                let report = PixelReport::new(context.scene_file, (&viewed, &job.effects), record, (x, y), device);
                let (settings, effects) = (job.settings, job.effects.clone());
                Ok(Inspection { scene: scene.clone(), settings, effects, inspector, report })
            };
            (picked(&viewed, x, y), look())
        });
        let names = &context.scene.sphere_names;
        let hit = hit.map(|hit| PickedHit {
            sphere: hit.sphere,
            name: names.get(hit.sphere),
            t: hit.t,
            position: hit.position.to_array(),
            inside: hit.inside,
        });
        let labels = Labels::of(context.scene, job.settings.specular);
        let waits = self.gpu.is_some();
        let table = looked.as_ref().ok().map(|looked| table(&looked.report, labels, waits));
        let no_table = looked.as_ref().err().cloned();
        self.session.send(&PageMessage::Pixel(PickedPixel { x, y, rgb, hit, table, no_table }));
        self.tiers.next = looked.ok().filter(|_| waits);
    }

    /// Tells the tiers of a pixel that are there, and begins with those that are not.
    pub(super) fn tell_tiers(&mut self, context: &Context) -> Result<(), gpu::Error> {
        if let (Some(outcome), Some(job)) = (self.tiers.take(), &self.job) {
            match outcome {
                Ok(report) => {
                    let report = report?;
                    let table = table(&report, Labels::of(context.scene, job.settings.specular), false);
                    self.session.send(&PageMessage::Tiers(table));
                }
                Err(why) => {
                    self.problem = Some(format!("the tiers of the pixel cannot be told: {why}"));
                    self.tell = true;
                }
            }
        }
        if let Some(gpu) = context.gpu {
            self.tiers.begin(gpu, context.wake);
        }
        Ok(())
    }
}

fn table<'a>(report: &'a PixelReport, labels: Labels, waits: bool) -> PixelTable<'a> {
    let record = report.record();
    PixelTable {
        text: report.text(labels),
        color: record.color,
        levels: record.levels,
        decisions: &record.decisions,
        beside: report.beside(),
        waits,
    }
}
