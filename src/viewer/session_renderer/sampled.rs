//! Pictures of which a part is sampled, and the rest of them once the eye rests.

use std::sync::Arc;
use std::time::Instant;

use super::pass::{FrameStats, Pass, PassEngine};
use super::{Context, FRAME_MS, SessionRenderer};
use crate::engine::{Backend, Times, ms, put_pixels};
use crate::gpu;
use crate::sampling::Samples;
use crate::viewer::messages::SampledPart;
use crate::viewer::sample_map_cache::PreviewMap;

impl<'g> SessionRenderer<'g> {
    /// Renders a slice of a picture that began with a part of its pixels: that part first, then the missing pixels of some rows.
    pub(super) fn render_sampled(&mut self, mut pass: Pass<'g>, context: &mut Context) -> Result<(), gpu::Error> {
        if pass.first {
            self.render_first_samples(&mut pass, context)?;
            self.pass = Some(pass);
            return Ok(());
        }
        let rows = self.rows_at_once(&pass);
        let PassEngine::Sampled(engine, map) = &mut pass.engine else { return Ok(()) };
        let start = Instant::now();
        let (width, height) = pass.size;
        let (first_row, row_bytes) = (pass.next_row, width as usize * 3);
        let missing = Samples::missing(pass.size, first_row, rows, &map.density);
        let mut colors = vec![[0; 3]; missing.len()];
        self.not_finite += engine.pixels(&missing, &mut colors)?;
        put_pixels(&missing, &colors, width, &mut pass.rgb);
        pass.next_row += rows;
        pass.took += start.elapsed();
        let rgb = &pass.rgb[first_row as usize * row_bytes..pass.next_row as usize * row_bytes];
        if let Some(patch) = self.canvas.rows(first_row, rgb) {
            self.session.send_bytes(patch.encode());
        }
        if pass.next_row == height {
            self.finish(&pass, context);
        } else {
            self.pass = Some(pass);
        }
        Ok(())
    }

    /// Renders the part that is shown at once.
    fn render_first_samples(&mut self, pass: &mut Pass, context: &mut Context) -> Result<(), gpu::Error> {
        let PassEngine::Sampled(engine, map) = &mut pass.engine else { return Ok(()) };
        let start = Instant::now();
        let samples = map.samples.pixels();
        let mut colors = vec![[0; 3]; samples.len()];
        self.not_finite += engine.pixels(samples, &mut colors)?;
        self.show_samples(map, &colors);
        pass.rgb = vec![0; pass.size.0 as usize * pass.size.1 as usize * 3];
        put_pixels(samples, &colors, pass.size.0, &mut pass.rgb);
        pass.took += start.elapsed();
        pass.first = false;

        let times = engine.times();
        let (rays, all) = (times.render_ms + times.read_back_ms, ms(pass.took) - times.compile_ms);
        // A large scene is shown by a part of it while the eye moves: its own pictures say nothing of those.
        if !self.moves_in_part(context) {
            self.maps.learn(samples.len(), rays, all);
        }
        self.costs.learn(self.costs.prepare_ms, rays, samples.len() as f64);
        self.note_sampled(map, ms(pass.took), times);
        self.send_state(context);
        Ok(())
    }

    /// While nothing else is to be done, makes a map for moving pictures to come.
    pub(super) fn prepare_map(&mut self) -> Result<(), gpu::Error> {
        let Some(job) = &self.job else { return Ok(()) };
        let size = job.size;
        let backend = Backend::of(self.gpu, &job.selection);
        let preview = self.session.preview();
        if let Some(density) = self.maps.missing(&preview, size) {
            self.maps.make(backend, density, size)?;
        }
        Ok(())
    }

    /// Whether the page shows all there is to show, and there is time to prepare moving pictures.
    pub(super) fn lacks_map(&self) -> bool {
        let Some(job) = &self.job else { return false };
        let moves_in_part = self.costs.measured && self.costs.step(job.size, FRAME_MS) > 1;
        moves_in_part
            && self.problem.is_none()
            && self.finished()
            && self.maps.missing(&self.session.preview(), job.size).is_some()
    }

    pub(super) fn show_samples(&mut self, map: &Arc<PreviewMap>, colors: &[[u8; 3]]) {
        if let Some(message) = self.maps.untold(map) {
            self.session.send_bytes(message);
        }
        self.canvas.hide();
        self.session.send_bytes(map.colors_message(colors));
    }

    pub(super) fn note_sampled(&mut self, map: &PreviewMap, frame_ms: f64, times: Times) {
        let sampled = Some(SampledPart { pixels: map.samples.pixels().len(), density: map.density });
        let not_finite = self.not_finite;
        self.shown = FrameStats { step: 1, samples: 1, sampled, frame_ms, times, not_finite };
    }
}
