//! The picture of one page on its way: coarse first, then finer, then the very picture that `trueray render` gives.

mod sketching;

use std::sync::Arc;
use std::time::{Duration, Instant};

use rayon::prelude::*;
use serde_json::json;

use super::canvas::Canvas;
use super::desk::Desk;
use super::measure::Measurement;
use super::protocol::PICTURE_FILE;
use super::sketch::{Plan, Sketcher};
use super::wishes::Wishes;
use crate::cpu::seen_through;
use crate::effects::Effects;
use crate::engine::{Backend, Engine, Options, Output, Pixels, Times};
use crate::film::encode_png;
use crate::gpu;
use crate::gpu::Gpu;
use crate::limits;
use crate::precision::{Selection, Tier};
use crate::scene::{Names, Scene, Window};
use crate::settings::Settings;
use crate::tiles::TILE;
use sketching::Sampled;

/// A frame should take no longer while the eye moves, so that 30 of them fit into a second with their way to the page.
const FRAME: f64 = 26.0;
/// A slice of a finer picture should take about this long, in ms: so long may new input wait.
const SLICE: f64 = 20.0;
/// A picture that takes longer, in ms, shows a coarser one first.
const PATIENCE: f64 = 200.0;
/// Greatest step of a coarse picture.
const MAX_STEP: u32 = 64;
/// Bytes of a slice at the most, unless a single row of tiles takes more.
const MAX_SLICE_BYTES: usize = 2 << 20;
/// Pixels of a page's picture on each side at the most: browsers show no larger ones everywhere.
const GREATEST_SIDE: u32 = 8192;

/// A scene of more spheres is shown by a part of them while the eye moves.
const MANY_SPHERES: usize = 20_000;
/// So many then.
const PREVIEW_SPHERES: usize = 10_000;
/// The eye is at rest when nothing was wished for so long: then all of a large scene is prepared, which takes its time.
const REST: Duration = Duration::from_millis(250);

/// Measured speed of pictures like the last ones.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pace {
    /// From wishes to a renderer, in ms.
    prepare: f64,
    /// A sample, in ms.
    sample: f64,
    /// Whether these are measured at all.
    measured: bool,
}

impl Default for Pace {
    /// Before anything is measured the first picture is a coarse one.
    fn default() -> Self {
        Self { prepare: 2.0, sample: 2e-3, measured: false }
    }
}

impl Pace {
    fn learn(&mut self, prepare: f64, render: f64, samples: f64) {
        let known = self.measured;
        let mean = |old: f64, new: f64| match known {
            false => new,
            true if new > old => new.midpoint(old),
            true => old.mul_add(0.7, new * 0.3),
        };
        self.prepare = mean(self.prepare, prepare);
        // Few samples say more of the way to the device and back than of themselves.
        if samples >= 4096.0 {
            self.sample = mean(self.sample, render / samples);
            self.measured = true;
        }
    }

    /// Time of a picture with this step, in ms.
    pub(super) fn forecast(&self, size: (u32, u32), step: u32) -> f64 {
        self.prepare + self.sample * f64::from(size.0.div_ceil(step)) * f64::from(size.1.div_ceil(step))
    }

    /// The least step whose picture takes no longer than `limit`, in ms.
    pub(super) fn step(&self, size: (u32, u32), limit: f64) -> u32 {
        // What is spent on preparing cannot be saved.
        let limit = limit.max(self.prepare + 8.0);
        (1..MAX_STEP).find(|&step| self.forecast(size, step) <= limit).unwrap_or(MAX_STEP)
    }
}

/// What every picture of a page has in common until the page wishes another.
#[derive(Debug, Clone)]
struct Subject {
    version: u64,
    wishes: Wishes,
    settings: Settings,
    effects: Effects,
    selection: Selection,
    size: (u32, u32),
    /// Steps and samples of the pictures to come, last one first.
    to_come: Vec<(u32, u32)>,
    /// What of the first of them is shown at once, where it is not all.
    plan: Option<Arc<Plan>>,
    /// Time that all this took, in ms; counted with the first picture.
    took: f64,
}

/// What renders a picture.
#[derive(Debug)]
enum Source<'g> {
    /// Row after row.
    Rows(Engine<'g>),
    /// First the pixels of a plan, which are shown at once, and then the others.
    Sketch(Engine<'g, Pixels>, Arc<Plan>),
}

impl Source<'_> {
    fn times(&self) -> Times {
        match self {
            Self::Rows(engine) => engine.times(),
            Self::Sketch(engine, _) => engine.times(),
        }
    }
}

/// One picture on its way.
#[derive(Debug)]
struct Pass<'g> {
    source: Source<'g>,
    step: u32,
    samples: u32,
    size: (u32, u32),
    /// The first one after a wish, which is shown at once and not given up for a newer wish.
    first: bool,
    next_row: u32,
    /// Rows so far, where they are shown at once; all of the picture, as far as it is known, where a part is.
    rgb: Vec<u8>,
    took: Duration,
}

/// The times that the page shows, in ms.
#[derive(Debug, Clone, Copy, Default)]
struct Shown {
    step: u32,
    samples: u32,
    /// Where not all pixels are sampled.
    sampled: Option<Sampled>,
    frame: f64,
    times: Times,
    not_finite: u64,
}

/// A page's picture and what it takes to paint it.
#[derive(Debug)]
pub(super) struct Easel<'g> {
    pub(super) desk: Arc<Desk>,
    gpu: Option<&'g Gpu>,
    canvas: Canvas,
    pub(super) pace: Pace,
    subject: Option<Subject>,
    pass: Option<Pass<'g>>,
    sketcher: Sketcher<'g>,
    shown: Shown,
    not_finite: u64,
    measurement: Option<Measurement>,
    /// The wishes that a part of a large scene is shown for, since when, and the time of a sample, in ms.
    preview: Option<(u64, Instant)>,
    preview_sample: f64,
    /// Why there is no picture of the newest wish.
    trouble: Option<String>,
    /// Words about the scene and the device that the page has not been told.
    tell: bool,
}

/// What pages are told beside their pictures.
#[derive(Debug)]
pub(super) struct Setting<'s> {
    pub(super) scene: &'s mut Scene,
    pub(super) scene_file: &'s str,
    pub(super) error: Option<&'s super::watch::Reading>,
    /// Pages that want something.
    pub(super) busy: usize,
    /// Pixels that a page may have.
    pub(super) pixels: u64,
    pub(super) pages: usize,
}

impl<'g> Easel<'g> {
    pub(super) fn new(desk: Arc<Desk>, gpu: Option<&'g Gpu>, pace: Pace) -> Self {
        Self {
            desk,
            gpu,
            canvas: Canvas::new((1, 1)),
            pace,
            subject: None,
            pass: None,
            sketcher: Sketcher::default(),
            shown: Shown::default(),
            not_finite: 0,
            measurement: None,
            preview: None,
            preview_sample: 1e-3,
            trouble: None,
            tell: true,
        }
    }

    /// The scene has changed, or what is known of its file.
    pub(super) fn scene_changed(&mut self, replaced: bool) {
        self.tell = true;
        if replaced {
            (self.subject, self.pass, self.measurement, self.preview) = (None, None, None, None);
        }
    }

    /// Pixels that this page keeps.
    pub(super) fn pixels(&self) -> u64 {
        u64::from(self.canvas.size().0) * u64::from(self.canvas.size().1)
    }

    fn is_behind(&self) -> bool {
        self.subject.as_ref().is_none_or(|subject| subject.version != self.desk.version())
    }

    /// Whether there is something to do now.
    pub(super) fn wants_a_turn(&self) -> bool {
        let unfinished = || self.pass.is_some() || self.subject.as_ref().is_some_and(|s| !s.to_come.is_empty());
        let wanted = self.is_behind() || unfinished() || self.tell || self.measurement.is_some() || self.lacks_sketch();
        (wanted || self.desk.has_errands()) && self.desk.is_open() && !self.desk.is_closed() && !self.desk.has_failed()
    }

    /// Does a little: some tens of milliseconds, unless kernels are compiled. Only a lost device is an error.
    pub(super) fn turn(&mut self, setting: &mut Setting) -> Result<(), gpu::Error> {
        match self.try_turn(setting) {
            Err(error) if error.is_refusal() || matches!(error, gpu::Error::Misuse(_)) => {
                self.trouble = Some(error.to_string());
                (self.pass, self.measurement) = (None, None);
                if let Some(subject) = &mut self.subject {
                    subject.to_come.clear();
                }
                self.send_state(setting);
                Ok(())
            }
            result => result,
        }
    }

    fn try_turn(&mut self, setting: &mut Setting) -> Result<(), gpu::Error> {
        let previews = setting.scene.spheres.len() > MANY_SPHERES;
        if self.is_behind() && (previews || !self.pass.as_ref().is_some_and(|pass| pass.first)) {
            match self.preview {
                _ if !previews => self.begin(setting)?,
                Some((version, since)) if version == self.desk.version() => {
                    if since.elapsed() >= REST {
                        self.begin(setting)?;
                    } else {
                        std::thread::sleep(Duration::from_millis(2));
                    }
                }
                _ => return self.paint_preview(setting),
            }
        }
        if previews && self.is_behind() {
            self.run_errands(setting);
            return Ok(());
        }
        self.run_errands(setting);
        if self.pass.is_none() {
            self.next_pass(setting)?;
        }
        if self.pass.is_some() {
            return self.paint(setting);
        }
        if self.tell && self.desk.is_open() {
            self.send_state(setting);
        }
        if self.trouble.is_some() {
            return Ok(());
        }
        if self.lacks_sketch() && self.desk.is_open() {
            return self.prepare_sketch();
        }
        self.measure(setting)
    }

    /// Shows the spheres of a large scene that look largest, in few pixels: a picture to find the way by.
    fn paint_preview(&mut self, setting: &mut Setting) -> Result<(), gpu::Error> {
        (self.pass, self.measurement, self.trouble) = (None, None, None);
        let (version, wishes) = self.desk.wishes();
        let settings = Settings { samples: 1, ..wishes.settings() };
        let size = fitted(wishes.size(setting.scene), setting.pixels);
        let mut part = largest(setting.scene, &settings, PREVIEW_SPHERES);
        let effects = Effects::requested(&part, &settings, &wishes.effects);
        if effects.too_deep(&part).or_else(|| limits::problem(&part, &settings, &effects)).is_some() {
            // The whole scene says why.
            self.preview = Some((version, Instant::now()));
            return Ok(());
        }
        let ladder = self.gpu.map_or(&Tier::ALL[..], Gpu::ladder);
        let tier = Selection::of(&part, &settings, &effects, wishes.precision, ladder).tier;
        let backend = self.gpu.map_or(Backend::Reference, |gpu| Backend::Device(gpu, tier));
        if self.canvas.size() != size {
            self.canvas = Canvas::new(size);
        }
        if self.preview_sketch(backend, &mut part, &settings, &effects, size)? {
            self.preview = Some((version, Instant::now()));
            self.send_state(setting);
            return Ok(());
        }
        let pace = Pace { prepare: 0.0, sample: self.preview_sample, measured: true };
        let step = pace.step(size, FRAME).max(2);
        let subject = (&settings, &effects);
        let (mut engine, (width, height)): (Engine, _) =
            coarse_engine(backend, &mut part, subject, size, step, &Options::default())?;
        let mut rgb = vec![0; width as usize * height as usize * 3];
        engine.rows(0, &mut rgb)?;
        self.preview_sample = engine.times().render_ms / (f64::from(width) * f64::from(height)).max(4096.0);
        self.desk.send_bytes(self.canvas.coarse(step, rgb).encode());
        self.preview = Some((version, Instant::now()));
        Ok(())
    }

    /// Looks at the newest wishes.
    fn begin(&mut self, setting: &mut Setting) -> Result<(), gpu::Error> {
        let start = Instant::now();
        let (version, wishes) = self.desk.wishes();
        let settings = wishes.settings();
        let asked = wishes.size(setting.scene);
        let size = fitted(asked, setting.pixels);
        let effects = Effects::requested(setting.scene, &settings, &wishes.effects);
        let ladder = self.gpu.map_or(&Tier::ALL[..], Gpu::ladder);
        let selection = Selection::of(setting.scene, &settings, &effects, wishes.precision, ladder);
        if self.canvas.size() != size {
            self.canvas = Canvas::new(size);
        }
        let limit = FRAME / setting.busy.max(1) as f64;
        let samples = settings.samples;
        let mut to_come = vec![(1, samples)];
        if samples > 1 {
            to_come.push((1, 1));
        }
        let mut step = self.pace.step(size, limit);
        let mut plan = None;
        // Before anything is measured a coarse picture is there first.
        if step > 1 && self.pace.measured {
            let backend = self.gpu.map_or(Backend::Reference, |gpu| Backend::Device(gpu, selection.tier));
            plan = self.sketcher.plan(backend, &self.desk.attention(), size, [limit, self.pace.sample])?;
        }
        if plan.is_some() {
            step = 1;
        }
        let mut coarse = Vec::new();
        while step > 1 {
            coarse.push((step, 1));
            // Each step takes a fraction of the time of the next.
            let worth_it = self.pace.forecast(size, 1) > PATIENCE && self.pace.prepare < SLICE;
            step = if worth_it { (step / 4).max(1) } else { 1 };
        }
        to_come.extend(coarse.into_iter().rev());
        let trouble = effects.too_deep(setting.scene).or_else(|| limits::problem(setting.scene, &settings, &effects));
        if trouble.is_some() {
            // The last picture stays.
            to_come.clear();
            self.tell = true;
        }
        let took = ms(start.elapsed());
        self.subject = Some(Subject { version, wishes, settings, effects, selection, size, to_come, plan, took });
        (self.pass, self.measurement, self.trouble) = (None, None, trouble);
        Ok(())
    }

    /// Prepares the next picture.
    fn next_pass(&mut self, setting: &mut Setting) -> Result<(), gpu::Error> {
        let Some(subject) = &mut self.subject else { return Ok(()) };
        let Some((step, samples)) = subject.to_come.pop() else { return Ok(()) };
        let start = Instant::now();
        let settings = Settings { samples, ..subject.settings };
        let backend = self.gpu.map_or(Backend::Reference, |gpu| Backend::Device(gpu, subject.selection.tier));
        let (scene, how, whole) = (&mut *setting.scene, (&settings, &subject.effects), subject.size);
        let (source, size) = if let Some(plan) = subject.plan.take() {
            let (engine, size) = coarse_engine(backend, scene, how, whole, step, &self.sketcher.options())?;
            (Source::Sketch(engine, plan), size)
        } else {
            let (engine, size) = coarse_engine(backend, scene, how, whole, step, &Options::default())?;
            (Source::Rows(engine), size)
        };
        let took = start.elapsed() + Duration::from_secs_f64(subject.took / 1e3);
        let first = subject.took > 0.0;
        subject.took = 0.0;
        self.not_finite = 0;
        self.pass = Some(Pass { source, step, samples, size, first, next_row: 0, rgb: Vec::new(), took });
        Ok(())
    }

    /// Renders a slice, and shows it.
    fn paint(&mut self, setting: &mut Setting) -> Result<(), gpu::Error> {
        let Some(mut pass) = self.pass.take() else { return Ok(()) };
        let rows = self.rows_at_once(&pass);
        let Source::Rows(engine) = &mut pass.source else { return self.paint_sketch(pass, setting) };
        let start = Instant::now();
        let (width, height) = pass.size;
        let row_bytes = width as usize * 3;
        let mut rgb = vec![0; row_bytes * rows as usize];
        self.not_finite += engine.rows(pass.next_row, &mut rgb)?;
        let first_row = pass.next_row;
        pass.next_row += rows;
        pass.took += start.elapsed();

        let done = pass.next_row == height;
        if pass.step > 1 {
            pass.rgb.append(&mut rgb);
            if done {
                let patch = self.canvas.coarse(pass.step, std::mem::take(&mut pass.rgb));
                self.desk.send_bytes(patch.encode());
            }
        } else if let Some(patch) = self.canvas.rows(first_row, &rgb) {
            self.desk.send_bytes(patch.encode());
        }
        if done {
            self.finish(&pass, setting);
        } else {
            self.pass = Some(pass);
        }
        Ok(())
    }

    /// How many rows the next slice has.
    fn rows_at_once(&self, pass: &Pass) -> u32 {
        let (width, height) = pass.size;
        let whole = pass.first && self.pace.forecast(pass.size, 1) < 4.0 * FRAME;
        let row_ms = self.pace.sample * f64::from(pass.samples * pass.samples) * f64::from(width);
        let rows = if whole { height } else { (SLICE / row_ms).min(1e9) as u32 };
        let rows = rows.min((MAX_SLICE_BYTES / (width as usize * 3)) as u32).next_multiple_of(TILE).max(TILE);
        rows.min(height - pass.next_row)
    }

    /// Learns from a picture that is complete, and tells the page.
    fn finish(&mut self, pass: &Pass, setting: &mut Setting) {
        let times = pass.source.times();
        let (width, height) = pass.size;
        let samples = f64::from(width) * f64::from(height) * f64::from(pass.samples * pass.samples);
        let render = times.render_ms + times.read_back_ms;
        let frame = ms(pass.took);
        let prepare = match pass.source {
            Source::Rows(_) => (frame - render - times.compile_ms).max(0.0),
            Source::Sketch(..) => self.pace.prepare,
        };
        self.pace.learn(prepare, render, samples);
        let Pass { step, samples, .. } = *pass;
        self.shown = Shown { step, samples, sampled: None, frame, times, not_finite: self.not_finite };
        self.send_state(setting);
    }

    /// What the page asked for besides a picture.
    fn run_errands(&mut self, setting: &mut Setting) {
        let finished = self.finished();
        let (pick, save) = self.desk.with_errands(|errands| {
            let save = errands.save && finished;
            errands.save &= !finished;
            if std::mem::take(&mut errands.measure) {
                self.measurement = Some(Measurement::default());
            }
            if let Some(why) = errands.refusal.take() {
                self.trouble = Some(why);
                self.tell = true;
            }
            (errands.pick.take(), save)
        });
        if let Some(pixel) = pick {
            self.send_pixel(pixel, setting);
        }
        if save {
            let (width, height) = self.canvas.size();
            match self.canvas.complete().map(|rgb| encode_png(width, height, rgb)) {
                Some(Ok(file)) => {
                    let mut message = [PICTURE_FILE, 0].map(u32::to_le_bytes).concat();
                    message.extend(file);
                    self.desk.send_bytes(message);
                }
                Some(Err(error)) => (self.trouble, self.tell) = (Some(error.to_string()), true),
                None => {}
            }
        }
    }

    /// Whether the page shows the picture that `trueray render` gives.
    fn finished(&self) -> bool {
        let all = self.subject.as_ref().is_some_and(|subject| subject.to_come.is_empty());
        all && self.pass.is_none() && self.canvas.complete().is_some() && !self.is_behind()
    }

    fn send_pixel(&self, (x, y): (u32, u32), setting: &mut Setting) {
        let Some(subject) = &self.subject else { return };
        let (width, height) = subject.size;
        if x >= width || y >= height {
            return;
        }
        let rgb = self.canvas.complete().map(|rgb| {
            let start = (y as usize * width as usize + x as usize) * 3;
            [rgb[start], rgb[start + 1], rgb[start + 2]]
        });
        let hit = with_size(setting.scene, subject.size, |scene| seen_through(scene, &subject.settings, x, y));
        let hit = hit.map(|hit| {
            let name = setting.scene.sphere_names.get(hit.sphere);
            json!({ "sphere": hit.sphere, "name": name, "t": hit.t, "position": hit.position.to_array(),
                "inside": hit.inside })
        });
        self.desk.send_words(json!({ "is": "pixel", "x": x, "y": y, "rgb": rgb, "hit": hit }));
    }

    /// Takes the next step of a measurement, if there is one.
    fn measure(&mut self, setting: &mut Setting) -> Result<(), gpu::Error> {
        let (Some(mut measurement), Some(subject)) = (self.measurement.take(), &self.subject) else { return Ok(()) };
        let step = self.pace.step(subject.size, 3.0 * FRAME);
        let effects = measurement.variant(&subject.effects);
        let backend = self.gpu.map_or(Backend::Reference, |gpu| Backend::Device(gpu, subject.selection.tier));
        let how = (&subject.settings, &effects);
        let (mut engine, (width, height)): (Engine, _) =
            coarse_engine(backend, setting.scene, how, subject.size, step, &Options::default())?;
        let mut rgb = vec![0; width as usize * height as usize * 3];
        engine.rows(0, &mut rgb)?;
        let times = engine.times();
        if let Some(table) = measurement.note(times.render_ms) {
            self.desk.send_words(json!({ "is": "costs", "effects": table, "size": [width, height] }));
        } else {
            self.measurement = Some(measurement);
        }
        Ok(())
    }

    /// Tells the page all numbers.
    fn send_state(&mut self, setting: &mut Setting) {
        self.tell = false;
        let Some(subject) = &self.subject else { return };
        let Subject { wishes, settings, effects, selection, size, .. } = subject;
        let scene = &*setting.scene;
        let scene_size = (scene.width, scene.height);
        let shrunk = *size != wishes.size(scene);
        let options = wishes.options((*size != scene_size).then_some(*size));
        let Shown { step, samples, sampled, frame, times, not_finite } = self.shown;
        let pose = wishes.pose.map(|pose| json!([pose.eye.to_array(), pose.look_at.to_array(), pose.up.to_array()]));
        self.desk.send_words(json!({
            "is": "state",
            "version": subject.version,
            "finished": self.finished(),
            "size": size, "shrunk": shrunk,
            "step": step, "samples": samples * samples, "sampled": sampled, "attention": self.desk.attention(),
            "frame_ms": frame, "times": times, "not_finite": not_finite,
            "device": self.gpu.map_or_else(|| "the CPU reference (f64)".to_owned(), |gpu| gpu.device.info.to_string()),
            "effects": effects.rows, "depth": effects.depth,
            "tier": selection.tier, "tier_reason": selection.reason,
            "wishes": {
                "effects": wishes.effects.to_string(), "precision": wishes.precision.to_string(),
                "max_depth": settings.max_depth, "spp": settings.samples * settings.samples, "settings": settings,
                "res": wishes.res.map_or_else(String::new, |(width, height)| format!("{width}x{height}")),
            },
            "eye": settings.view.eye.to_array(), "pose": pose,
            "options": options,
            "scene": { "file": setting.scene_file, "spheres": scene.spheres.len(), "lights": scene.lights.len(),
                "size": scene_size },
            "error": setting.error,
            "trouble": self.trouble,
            "pages": setting.pages,
        }));
    }
}

/// A renderer whose pixels are every `step`-th column and row of the picture of `size`, with the size that it renders.
fn coarse_engine<'g, O: Output>(
    backend: Backend<'g>,
    scene: &mut Scene,
    (settings, effects): (&Settings, &Effects),
    size: (u32, u32),
    step: u32,
    options: &Options,
) -> Result<(Engine<'g, O>, (u32, u32)), gpu::Error> {
    with_size(scene, size, |scene| {
        let (width, height) = (size.0.div_ceil(step), size.1.div_ceil(step));
        // The window reaches as far as its pixels, which may be beyond the picture. Its own size may be beyond numbers.
        let end = |from: f64, to: f64, count: u32, whole: u32| {
            let part = f64::from(count * step) / f64::from(whole);
            (from * (1.0 - part) + to * part).clamp(f64::MIN, f64::MAX)
        };
        if step > 1 {
            let window = scene.window;
            scene.window.right = end(window.left, window.right, width, size.0);
            scene.window.bottom = end(window.top, window.bottom, height, size.1);
        }
        (scene.width, scene.height) = (width, height);
        Ok((Engine::with(backend, scene, settings, effects, options)?, (width, height)))
    })
}

/// `scene` with so many of its spheres: those that look largest from the eye. They stay in the order of the file.
fn largest(scene: &Scene, settings: &Settings, count: usize) -> Scene {
    let eye = settings.view.eye;
    let [_, _, back] = settings.view.axes();
    let apparent = |index: &u32| {
        let sphere = &scene.spheres[*index as usize];
        let radius = sphere.scale.abs().max_element();
        let way = sphere.center - eye;
        // What lies behind the eye is not seen, only mirrored.
        let seen = way.dot(back) - radius < 0.0;
        if seen { (radius * radius / way.length_squared().max(f64::MIN_POSITIVE)) as f32 } else { 0.0 }
    };
    let mut order: Vec<(f32, u32)> =
        (0..scene.spheres.len() as u32).into_par_iter().map(|index| (apparent(&index), index)).collect();
    if count < order.len() {
        order.select_nth_unstable_by(count, |a, b| b.0.total_cmp(&a.0));
        order.truncate(count);
    }
    order.sort_unstable_by_key(|&(_, index)| index);
    let mut names = Names::default();
    for &(_, index) in &order {
        names.push(scene.sphere_names.get(index as usize));
    }
    Scene {
        spheres: order.iter().map(|&(_, index)| scene.spheres[index as usize]).collect(),
        sphere_names: names,
        lights: scene.lights.clone(),
        light_names: scene.light_names.clone(),
        output: None,
        ..*scene
    }
}

/// Lets `action` see the scene with this size of its picture, and change that and the window; however it ends, the scene has its
/// own again. A scene may be too large to be copied for that.
fn with_size<T>(scene: &mut Scene, size: (u32, u32), action: impl FnOnce(&mut Scene) -> T) -> T {
    struct Lent<'s>(&'s mut Scene, (u32, u32), Window);
    impl Drop for Lent<'_> {
        fn drop(&mut self) {
            (self.0.width, self.0.height) = self.1;
            self.0.window = self.2;
        }
    }
    let (own, window) = ((scene.width, scene.height), scene.window);
    let lent = Lent(scene, own, window);
    (lent.0.width, lent.0.height) = size;
    action(lent.0)
}

/// `size`, halved until a page can show and keep it.
fn fitted(size: (u32, u32), pixels: u64) -> (u32, u32) {
    let (mut width, mut height) = (size.0.max(1), size.1.max(1));
    while width.max(height) > GREATEST_SIDE || u64::from(width) * u64::from(height) > pixels {
        if width.max(height) == 1 {
            break;
        }
        (width, height) = (width.div_ceil(2), height.div_ceil(2));
    }
    (width, height)
}

fn ms(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}
