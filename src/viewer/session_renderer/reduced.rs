//! A large scene while the eye moves: the spheres that look largest, in a part of the pixels.

use std::time::Instant;

use rayon::prelude::*;

use super::coarse::{Framing, coarse_engine, fitted, framed};
use super::{Context, FRAME_MS, Plan, SessionRenderer};
use crate::effects::Effects;
use crate::engine::{Backend, Engine, Options, Pixels, ms};
use crate::gpu;
use crate::pattern::Pattern;
use crate::scene::{Names, Scene};
use crate::settings::Settings;
use crate::viewer::canvas::Canvas;
use crate::viewer::cost_model::CostModel;

/// A scene of more spheres is shown by a part of them while the eye moves, unless the device prepares all of them soon enough.
pub(super) const MANY_SPHERES: usize = 20_000;
/// How many of them then.
const REDUCED_SPHERES: usize = 10_000;

/// What is known of the reduced pictures of a page.
#[derive(Debug)]
pub(super) struct Reduced {
    /// The version of the view that the last one is of, and since when it is shown.
    pub(super) shown: Option<(u64, Instant)>,
    /// Time of a sample, in ms.
    sample_ms: f64,
}

impl Default for Reduced {
    fn default() -> Self {
        Self { shown: None, sample_ms: 1e-3 }
    }
}

impl<'g> SessionRenderer<'g> {
    /// Shows the spheres of a large scene that look largest, in few pixels: a picture to find the way by.
    pub(super) fn render_reduced(&mut self, context: &mut Context) -> Result<(), gpu::Error> {
        (self.pass, self.measurement, self.problem) = (None, None, None);
        let (version, view) = self.session.view();
        let settings = Settings { pattern: Pattern::ONE, ..view.settings() };
        context.light(&settings.view);
        let size = fitted(view.size(context.scene), context.pixels);
        let mut part = largest(context.scene, &settings, REDUCED_SPHERES);
        let Plan { effects, selection, problem } = Plan::of((&mut part, None), &settings, &view, self.gpu);
        if problem.is_some() {
            // The whole scene says why.
            self.reduced.shown = Some((version, Instant::now()));
            return Ok(());
        }
        let backend = Backend::of(self.gpu, &selection);
        if self.canvas.size() != size {
            self.canvas = Canvas::new(size);
        }
        if self.render_reduced_sampled(backend, &mut part, (&settings, &effects), (size, view.fov))? {
            self.reduced.shown = Some((version, Instant::now()));
            self.send_state(context);
            return Ok(());
        }
        let costs = CostModel { prepare_ms: 0.0, sample_ms: self.reduced.sample_ms, measured: true };
        let step = costs.step(size, FRAME_MS).max(2);
        let (mut engine, (width, height)): (Engine, _) = coarse_engine(
            backend,
            (&mut part, None),
            (&settings, &effects),
            (size, view.fov),
            step,
            &Options::default(),
        )?;
        let mut rgb = vec![0; width as usize * height as usize * 3];
        engine.rows(0, &mut rgb)?;
        self.reduced.sample_ms = engine.times().render_ms / (f64::from(width) * f64::from(height)).max(4096.0);
        self.session.send_bytes(self.canvas.coarse(step, rgb).encode());
        self.reduced.shown = Some((version, Instant::now()));
        Ok(())
    }

    /// Shows a large scene by a part of its spheres, and a part of its pixels; whether there is a map for that.
    fn render_reduced_sampled(
        &mut self,
        backend: Backend<'g>,
        part: &mut Scene,
        (settings, effects): (&Settings, &Effects),
        (size, fov): Framing,
    ) -> Result<bool, gpu::Error> {
        let preview = self.session.preview();
        let Some(map) = self.maps.choose(backend, &preview, size, [FRAME_MS, self.costs.sample_ms])? else {
            return Ok(false);
        };
        let start = Instant::now();
        let options = self.maps.options();
        let mut engine: Engine<Pixels> =
            framed(part, (size, fov), |part| Engine::with(backend, part.viewed(settings), effects, &options))?;
        let samples = map.samples.pixels();
        let mut colors = vec![[0; 3]; samples.len()];
        engine.pixels(samples, &mut colors)?;
        self.show_samples(&map, &colors);
        let times = engine.times();
        let all = ms(start.elapsed()) - times.compile_ms;
        self.maps.learn(samples.len(), times.render_ms + times.read_back_ms, all);
        self.note_sampled(&map, all, times);
        Ok(true)
    }
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
