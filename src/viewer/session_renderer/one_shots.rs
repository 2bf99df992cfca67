//! What a page asks for besides a picture: a pixel, a file, a measurement.

use super::coarse::coarse_engine;
use super::{Context, FRAME_MS, SessionRenderer};
use crate::engine::{Backend, Engine, Options};
use crate::film::encode_png;
use crate::gpu;
use crate::viewer::effect_cost::CostMeasurement;
use crate::viewer::messages::PageMessage;
use crate::viewer::patch::PICTURE_FILE;

impl SessionRenderer<'_> {
    /// Does what the page has asked for once.
    pub(super) fn run_one_shots(&mut self, context: &mut Context) {
        let finished = self.finished();
        let (pick, save) = self.session.with_one_shots(|one_shots| {
            let save = one_shots.save && finished;
            one_shots.save &= !finished;
            if std::mem::take(&mut one_shots.measure) {
                self.measurement = Some(CostMeasurement::default());
            }
            if let Some(why) = one_shots.refusal.take() {
                self.problem = Some(why);
                self.tell = true;
            }
            self.tell |= std::mem::take(&mut one_shots.unchanged);
            (one_shots.pick.take(), save)
        });
        if let Some(pixel) = pick {
            self.inspect(pixel, context);
        }
        if save {
            let (width, height) = self.canvas.size();
            match self.canvas.complete().map(|rgb| encode_png(width, height, rgb)) {
                Some(Ok(file)) => {
                    let mut message = [PICTURE_FILE, 0].map(u32::to_le_bytes).concat();
                    message.extend(file);
                    self.session.send_bytes(message);
                }
                Some(Err(error)) => (self.problem, self.tell) = (Some(error.to_string()), true),
                None => {}
            }
        }
    }

    /// Takes the next step of a measurement, if there is one.
    pub(super) fn measure(&mut self, context: &mut Context) -> Result<(), gpu::Error> {
        let (Some(mut measurement), Some(job)) = (self.measurement.take(), &self.job) else { return Ok(()) };
        let step = self.costs.step(job.size, 3.0 * FRAME_MS);
        let effects = measurement.variant(&job.effects);
        let backend = Backend::of(self.gpu, &job.selection);
        let how = (&job.settings, &effects);
        let (mut engine, (width, height)): (Engine, _) =
            coarse_engine(backend, context.shown(), how, job.framing(), step, &Options::default())?;
        let mut rgb = vec![0; width as usize * height as usize * 3];
        engine.rows(0, &mut rgb)?;
        let times = engine.times();
        if let Some(effects) = measurement.note(times.render_ms) {
            self.session.send(&PageMessage::Costs { effects });
        } else {
            self.measurement = Some(measurement);
        }
        Ok(())
    }
}
