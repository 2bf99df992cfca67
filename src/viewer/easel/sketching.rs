//! Pictures of which a part is sampled, and the rest of them once the eye rests.

use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;

use super::{Easel, FRAME, Pass, Setting, Shown, Source, ms, with_size};
use crate::effects::Effects;
use crate::engine::{Backend, Engine, Pixels, Times};
use crate::gpu;
use crate::sampling::{Density, Samples};
use crate::scene::Scene;
use crate::settings::Settings;
use crate::viewer::sketch::Plan;

/// What the page shows a part of.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Sampled {
    /// Sampled pixels.
    pixels: usize,
    density: Density,
}

impl Sampled {
    fn of(plan: &Plan) -> Self {
        Self { pixels: plan.samples.pixels().len(), density: plan.density }
    }
}

impl<'g> Easel<'g> {
    /// Renders a slice of a picture that began with a part of its pixels: that part first, then the missing pixels of some rows.
    pub(super) fn paint_sketch(&mut self, mut pass: Pass<'g>, setting: &mut Setting) -> Result<(), gpu::Error> {
        if pass.first {
            self.show_sketch(&mut pass, setting)?;
            self.pass = Some(pass);
            return Ok(());
        }
        let rows = self.rows_at_once(&pass);
        let Source::Sketch(engine, plan) = &mut pass.source else { return Ok(()) };
        let start = Instant::now();
        let (width, height) = pass.size;
        let (first_row, row_bytes) = (pass.next_row, width as usize * 3);
        let missing = Samples::missing(pass.size, first_row, rows, &plan.density);
        let mut colors = vec![[0; 3]; missing.len()];
        self.not_finite += engine.pixels(&missing, &mut colors)?;
        place(&missing, &colors, width, &mut pass.rgb);
        pass.next_row += rows;
        pass.took += start.elapsed();
        let rgb = &pass.rgb[first_row as usize * row_bytes..pass.next_row as usize * row_bytes];
        if let Some(patch) = self.canvas.rows(first_row, rgb) {
            self.desk.send_bytes(patch.encode());
        }
        if pass.next_row == height {
            self.finish(&pass, setting);
        } else {
            self.pass = Some(pass);
        }
        Ok(())
    }

    /// Renders the part that is shown at once.
    fn show_sketch(&mut self, pass: &mut Pass, setting: &mut Setting) -> Result<(), gpu::Error> {
        let Source::Sketch(engine, plan) = &mut pass.source else { return Ok(()) };
        let start = Instant::now();
        let samples = plan.samples.pixels();
        let mut colors = vec![[0; 3]; samples.len()];
        self.not_finite += engine.pixels(samples, &mut colors)?;
        self.show_samples(plan, &colors);
        pass.rgb = vec![0; pass.size.0 as usize * pass.size.1 as usize * 3];
        place(samples, &colors, pass.size.0, &mut pass.rgb);
        pass.took += start.elapsed();
        pass.first = false;

        let times = engine.times();
        let (rays, all) = (times.render_ms + times.read_back_ms, ms(pass.took) - times.compile_ms);
        // A large scene is shown by a part of it while the eye moves: its own pictures say nothing of those.
        if setting.scene.spheres.len() <= super::MANY_SPHERES {
            self.sketcher.learn(samples.len(), rays, all);
        }
        self.pace.learn(self.pace.prepare, rays, samples.len() as f64);
        self.note_sketch(plan, ms(pass.took), times);
        self.send_state(setting);
        Ok(())
    }

    /// Shows a large scene by a part of its spheres, and a part of its pixels; whether there is a map for that.
    pub(super) fn preview_sketch(
        &mut self,
        backend: Backend<'g>,
        part: &mut Scene,
        settings: &Settings,
        effects: &Effects,
        size: (u32, u32),
    ) -> Result<bool, gpu::Error> {
        let attention = self.desk.attention();
        let Some(plan) = self.sketcher.plan(backend, &attention, size, [FRAME, self.pace.sample])? else {
            return Ok(false);
        };
        let start = Instant::now();
        let options = self.sketcher.options();
        let mut engine: Engine<Pixels> =
            with_size(part, size, |part| Engine::with(backend, part, settings, effects, &options))?;
        let samples = plan.samples.pixels();
        let mut colors = vec![[0; 3]; samples.len()];
        engine.pixels(samples, &mut colors)?;
        self.show_samples(&plan, &colors);
        let times = engine.times();
        let all = ms(start.elapsed()) - times.compile_ms;
        self.sketcher.learn(samples.len(), times.render_ms + times.read_back_ms, all);
        self.note_sketch(&plan, all, times);
        Ok(true)
    }

    /// While nothing else is to be done, makes a map for moving pictures to come.
    pub(super) fn prepare_sketch(&mut self) -> Result<(), gpu::Error> {
        let Some(subject) = &self.subject else { return Ok(()) };
        let (size, tier) = (subject.size, subject.selection.tier);
        let backend = self.gpu.map_or(Backend::Reference, |gpu| Backend::Device(gpu, tier));
        let attention = self.desk.attention();
        if let Some(density) = self.sketcher.missing(&attention, size) {
            self.sketcher.make(backend, density, size)?;
        }
        Ok(())
    }

    /// Whether the page shows all there is to show, and there is time to prepare moving pictures.
    pub(super) fn lacks_sketch(&self) -> bool {
        let Some(subject) = &self.subject else { return false };
        let moves_in_part = self.pace.measured && self.pace.step(subject.size, FRAME) > 1;
        moves_in_part
            && self.trouble.is_none()
            && self.finished()
            && self.sketcher.missing(&self.desk.attention(), subject.size).is_some()
    }

    fn show_samples(&mut self, plan: &Arc<Plan>, colors: &[[u8; 3]]) {
        if let Some(places) = self.sketcher.news_of(plan) {
            self.desk.send_bytes(places);
        }
        self.canvas.hide();
        self.desk.send_bytes(plan.picture(colors));
    }

    fn note_sketch(&mut self, plan: &Plan, frame: f64, times: Times) {
        let not_finite = self.not_finite;
        self.shown = Shown { step: 1, samples: 1, sampled: Some(Sampled::of(plan)), frame, times, not_finite };
    }
}

/// Puts colours to their places in rows of 3 bytes a pixel.
fn place(pixels: &[[u32; 2]], colors: &[[u8; 3]], width: u32, rgb: &mut [u8]) {
    let rgb = rgb.as_chunks_mut::<3>().0;
    for (&[x, y], color) in pixels.iter().zip(colors) {
        rgb[y as usize * width as usize + x as usize] = *color;
    }
}
