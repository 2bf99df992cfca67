//! Renders for one page: a coarse picture first, then finer ones, then the very picture that `trueray render` gives.

mod coarse;
mod inspection;
mod one_shots;
mod pass;
mod reduced;
mod sampled;
mod state;

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::canvas::Canvas;
use super::cost_model::CostModel;
use super::effect_cost::CostMeasurement;
use super::sample_map_cache::{PreviewMap, SampleMapCache};
use super::scene_file::SceneError;
use super::session::Session;
use super::view_state::ViewState;
use super::wake_signal::WakeSignal;
use crate::effects::Effects;
use crate::engine::{Backend, ms};
use crate::gpu::{self, Gpu};
use crate::import::Lamps;
use crate::kept::Kept;
use crate::limits;
use crate::pattern::Pattern;
use crate::precision::{Selection, Tier};
use crate::scene::Scene;
use crate::settings::Settings;
use crate::view::View;
use coarse::{Framing, Shown, fitted, framed};
use inspection::Tiers;
use pass::{FrameStats, Pass};
use reduced::{MANY_SPHERES, Reduced};

/// A frame should take no longer while the eye moves, in ms, so that 30 of them fit into a second with their way to the page.
const FRAME_MS: f64 = 26.0;
/// A slice of a finer picture should take about this long: so long may new input wait.
const SLICE_MS: f64 = 20.0;
/// A picture that takes longer shows a coarser one first.
const COARSE_FIRST_MS: f64 = 200.0;
/// The eye is at rest when the view has not changed for so long: then all of a large scene is prepared, which takes its time.
const REST: Duration = Duration::from_millis(250);

/// What every picture of a page has in common until its view changes.
#[derive(Debug, Clone)]
struct Job {
    version: u64,
    view: ViewState,
    settings: Settings,
    effects: Effects,
    selection: Selection,
    size: (u32, u32),
    /// Coarse steps and samples (on each side of a pixel) of the pictures to come, last one first.
    passes: Vec<(u32, Pattern)>,
    /// What of the first of them is shown at once, where it is not all.
    map: Option<Arc<PreviewMap>>,
    /// Time that all this took, in ms; counted with the first picture.
    took: f64,
}

impl Job {
    /// How its pictures are framed.
    fn framing(&self) -> Framing {
        (self.size, self.view.fov)
    }
}

/// What is decided before a picture is rendered.
struct Plan {
    effects: Effects,
    selection: Selection,
    /// Why there can be no picture.
    problem: Option<String>,
}

impl Plan {
    /// For a scene as `view` asks for it.
    fn of((scene, kept): Shown, settings: &Settings, view: &ViewState, gpu: Option<&Gpu>) -> Self {
        let size = (scene.width, scene.height);
        let framing = view.fov.and_then(|fov| Scene::new(fov.window(scene.window.near, size), 1, 1).check().err());
        framed(scene, (size, view.fov), |scene| {
            let viewed = scene.viewed_by(settings, kept);
            let effects = Effects::requested(&viewed, &view.effects);
            let selection = Selection::of(&viewed, &effects, view.precision, gpu.map_or(&Tier::ALL[..], Gpu::ladder));
            let refused = || effects.too_deep(scene).or_else(|| limits::problem(&viewed, &effects));
            let problem = framing.map(|error| format!("--fov: {error}")).or_else(refused);
            Self { effects, selection, problem }
        })
    }
}

/// A page's picture and what it takes to render it.
#[derive(Debug)]
pub(super) struct SessionRenderer<'g> {
    pub(super) session: Arc<Session>,
    gpu: Option<&'g Gpu>,
    canvas: Canvas,
    pub(super) costs: CostModel,
    job: Option<Job>,
    pass: Option<Pass<'g>>,
    maps: SampleMapCache<'g>,
    shown: FrameStats,
    not_finite: u64,
    measurement: Option<CostMeasurement>,
    /// Of the pixel that the page is told of.
    tiers: Tiers,
    reduced: Reduced,
    /// Why there is no picture of the newest view, or what was refused.
    problem: Option<String>,
    /// Requests for a view that the picture at hand answers.
    heard: u64,
    /// Whether the page is to be told its state, even if no picture is finished.
    tell: bool,
}

/// What the pages have in common.
#[derive(Debug)]
pub(super) struct Context<'s> {
    pub(super) scene: &'s mut Scene,
    /// The lights of particles, which turn with the eye.
    pub(super) lamps: Option<Lamps>,
    /// What its pictures leave to the next eye.
    pub(super) kept: &'s Kept,
    pub(super) scene_file: &'s str,
    pub(super) error: Option<&'s SceneError>,
    /// What renders, for whoever does so beside the pictures.
    pub(super) gpu: Option<&'s Arc<Gpu>>,
    /// Raised for what is done beside the pictures.
    pub(super) wake: &'s Arc<WakeSignal>,
    /// Pages that have work.
    pub(super) busy: usize,
    /// Pixels that the page may have.
    pub(super) pixels: u64,
}

impl Context<'_> {
    /// Turns the lights of particles with this eye, as `trueray render` does.
    fn light(&mut self, view: &View) {
        if let Some(lamps) = self.lamps {
            self.scene.lights = lamps.seen_by(view);
        }
    }

    /// The scene, with what its pictures leave to the next eye.
    fn shown(&mut self) -> Shown<'_> {
        (self.scene, Some(self.kept))
    }
}

impl<'g> SessionRenderer<'g> {
    pub(super) fn new(session: Arc<Session>, gpu: Option<&'g Gpu>, costs: CostModel) -> Self {
        Self {
            session,
            gpu,
            canvas: Canvas::new((1, 1)),
            costs,
            job: None,
            pass: None,
            maps: SampleMapCache::default(),
            shown: FrameStats::default(),
            not_finite: 0,
            measurement: None,
            tiers: Tiers::default(),
            reduced: Reduced::default(),
            problem: None,
            heard: 0,
            tell: true,
        }
    }

    /// The scene has changed, or what is known of its file.
    pub(super) fn scene_changed(&mut self, replaced: bool) {
        self.tell = true;
        if replaced {
            (self.job, self.pass, self.measurement, self.reduced.shown) = (None, None, None, None);
            self.tiers.give_up();
        }
    }

    /// Pixels that this page keeps.
    pub(super) fn pixels(&self) -> u64 {
        u64::from(self.canvas.size().0) * u64::from(self.canvas.size().1)
    }

    fn is_outdated(&self) -> bool {
        self.job.as_ref().is_none_or(|job| job.version != self.session.version())
    }

    /// Whether there is something to do now.
    pub(super) fn has_work(&self) -> bool {
        let unfinished = || self.pass.is_some() || self.job.as_ref().is_some_and(|job| !job.passes.is_empty());
        let asked = || self.measurement.is_some() || self.tiers.has_work();
        let wanted = self.is_outdated() || unfinished() || self.tell || asked() || self.lacks_map();
        (wanted || self.session.has_one_shots())
            && self.session.is_open()
            && !self.session.is_closed()
            && !self.session.has_failed()
    }

    /// Does a little: some tens of milliseconds, unless kernels are compiled. Only a lost device is an error.
    pub(super) fn advance(&mut self, context: &mut Context) -> Result<(), gpu::Error> {
        match self.try_advance(context) {
            Err(error) if error.is_refusal() || matches!(error, gpu::Error::Misuse(_)) => {
                self.problem = Some(error.to_string());
                (self.pass, self.measurement) = (None, None);
                if let Some(job) = &mut self.job {
                    job.passes.clear();
                }
                self.send_state(context);
                Ok(())
            }
            result => result,
        }
    }

    fn try_advance(&mut self, context: &mut Context) -> Result<(), gpu::Error> {
        let is_large = self.moves_in_part(context);
        if self.is_outdated() && (is_large || !self.pass.as_ref().is_some_and(|pass| pass.first)) {
            match self.reduced.shown {
                _ if !is_large => self.start_job(context)?,
                Some((version, since)) if version == self.session.version() => {
                    if since.elapsed() >= REST {
                        self.start_job(context)?;
                    } else {
                        std::thread::sleep(Duration::from_millis(2));
                    }
                }
                _ => return self.render_reduced(context),
            }
        }
        if let Some(job) = &self.job {
            context.light(&job.settings.view);
        }
        self.run_one_shots(context);
        if is_large && self.is_outdated() {
            return Ok(());
        }
        if self.session.is_open() {
            self.tell_tiers(context)?;
        }
        if self.pass.is_none() {
            self.next_pass(context)?;
        }
        if self.pass.is_some() {
            return self.render_slice(context);
        }
        if self.tell && self.session.is_open() {
            self.send_state(context);
        }
        if self.problem.is_some() {
            return Ok(());
        }
        if self.lacks_map() && self.session.is_open() {
            return self.prepare_map();
        }
        self.measure(context)
    }

    /// Whether a part of the spheres is shown while the eye moves: there are many, and to prepare all of them has taken too long.
    fn moves_in_part(&self, context: &Context) -> bool {
        let is_soon = self.costs.measured && self.costs.prepare_ms <= FRAME_MS;
        context.scene.spheres.len() > MANY_SPHERES && !is_soon
    }

    /// Plans the pictures of the newest view.
    fn start_job(&mut self, context: &mut Context) -> Result<(), gpu::Error> {
        let start = Instant::now();
        let (version, view) = self.session.view();
        let settings = view.settings();
        context.light(&settings.view);
        let asked = view.size(context.scene);
        let size = fitted(asked, context.pixels);
        let Plan { effects, selection, problem } = Plan::of(context.shown(), &settings, &view, self.gpu);
        if self.canvas.size() != size {
            self.canvas = Canvas::new(size);
        }
        let limit = FRAME_MS / context.busy.max(1) as f64;
        let mut passes = vec![(1, settings.pattern)];
        if settings.pattern.count() > 1 {
            passes.push((1, Pattern::ONE));
        }
        let mut step = self.costs.step(size, limit);
        let mut map = None;
        // Before anything is measured a coarse picture is there first.
        if step > 1 && self.costs.measured {
            let backend = Backend::of(self.gpu, &selection);
            map = self.maps.choose(backend, &self.session.preview(), size, [limit, self.costs.sample_ms])?;
        }
        if map.is_some() {
            step = 1;
        }
        let mut coarse = Vec::new();
        while step > 1 {
            coarse.push((step, Pattern::ONE));
            // Each step takes a fraction of the time of the next.
            let worth_it = self.costs.forecast(size, 1) > COARSE_FIRST_MS && self.costs.prepare_ms < SLICE_MS;
            step = if worth_it { (step / 4).max(1) } else { 1 };
        }
        passes.extend(coarse.into_iter().rev());
        if problem.is_some() {
            // The last picture stays.
            passes.clear();
            self.tell = true;
        }
        let took = ms(start.elapsed());
        self.job = Some(Job { version, view, settings, effects, selection, size, passes, map, took });
        (self.pass, self.measurement, self.problem) = (None, None, problem);
        self.tiers.give_up();
        Ok(())
    }

    /// Whether the page shows the picture that `trueray render` gives.
    fn finished(&self) -> bool {
        let all = self.job.as_ref().is_some_and(|job| job.passes.is_empty());
        all && self.pass.is_none() && self.canvas.complete().is_some() && !self.is_outdated()
    }
}
