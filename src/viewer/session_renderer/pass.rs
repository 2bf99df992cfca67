//! One picture on its way, slice by slice.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::coarse::coarse_engine;
use super::{Context, FRAME_MS, SLICE_MS, SessionRenderer};
use crate::engine::{Backend, Engine, Options, Pixels, Times, ms};
use crate::gpu;
use crate::pattern::Pattern;
use crate::settings::Settings;
use crate::tiles::TILE;
use crate::viewer::messages::SampledPart;
use crate::viewer::sample_map_cache::PreviewMap;

/// Bytes of a slice at the most, unless a single row of tiles takes more.
const MAX_SLICE_BYTES: usize = 2 << 20;

/// What renders a picture.
#[derive(Debug)]
pub(super) enum PassEngine<'g> {
    /// Row after row.
    Rows(Engine<'g>),
    /// First the pixels of a map, which are shown at once, and then the others.
    Sampled(Engine<'g, Pixels>, Arc<PreviewMap>),
}

impl PassEngine<'_> {
    fn times(&self) -> Times {
        match self {
            Self::Rows(engine) => engine.times(),
            Self::Sampled(engine, _) => engine.times(),
        }
    }
}

/// One picture on its way.
#[derive(Debug)]
pub(super) struct Pass<'g> {
    pub(super) engine: PassEngine<'g>,
    step: u32,
    pattern: Pattern,
    pub(super) size: (u32, u32),
    /// The first one of a view, which is shown at once and not given up for a newer view.
    pub(super) first: bool,
    pub(super) next_row: u32,
    /// Rows so far, where they are shown at once; all of the picture, as far as it is known, where a part is.
    pub(super) rgb: Vec<u8>,
    pub(super) took: Duration,
}

/// What the page is told of the picture that it shows.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct FrameStats {
    pub(super) step: u32,
    pub(super) samples: u32,
    /// Where not all pixels are sampled.
    pub(super) sampled: Option<SampledPart>,
    /// From the view to the picture, in ms.
    pub(super) frame_ms: f64,
    pub(super) times: Times,
    pub(super) not_finite: u64,
}

impl SessionRenderer<'_> {
    /// Prepares the next picture.
    pub(super) fn next_pass(&mut self, context: &mut Context) -> Result<(), gpu::Error> {
        let Some(job) = &mut self.job else { return Ok(()) };
        let Some((step, pattern)) = job.passes.pop() else { return Ok(()) };
        let start = Instant::now();
        let settings = Settings { pattern, ..job.settings };
        let backend = Backend::of(self.gpu, &job.selection);
        let (shown, how, whole) = (context.shown(), (&settings, &job.effects), job.framing());
        let (engine, size) = if let Some(map) = job.map.take() {
            let (engine, size) = coarse_engine(backend, shown, how, whole, step, &self.maps.options())?;
            (PassEngine::Sampled(engine, map), size)
        } else {
            let (engine, size) = coarse_engine(backend, shown, how, whole, step, &Options::default())?;
            (PassEngine::Rows(engine), size)
        };
        let took = start.elapsed() + Duration::from_secs_f64(job.took / 1e3);
        let first = job.took > 0.0;
        job.took = 0.0;
        self.not_finite = 0;
        self.pass = Some(Pass { engine, step, pattern, size, first, next_row: 0, rgb: Vec::new(), took });
        Ok(())
    }

    /// Renders a slice, and shows it.
    pub(super) fn render_slice(&mut self, context: &mut Context) -> Result<(), gpu::Error> {
        let Some(mut pass) = self.pass.take() else { return Ok(()) };
        let rows = self.rows_at_once(&pass);
        let PassEngine::Rows(engine) = &mut pass.engine else { return self.render_sampled(pass, context) };
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
                self.session.send_bytes(patch.encode());
            }
        } else if let Some(patch) = self.canvas.rows(first_row, &rgb) {
            self.session.send_bytes(patch.encode());
        }
        if done {
            self.finish(&pass, context);
        } else {
            self.pass = Some(pass);
        }
        Ok(())
    }

    /// How many rows the next slice has.
    pub(super) fn rows_at_once(&self, pass: &Pass) -> u32 {
        let (width, height) = pass.size;
        let whole = pass.first && self.costs.forecast(pass.size, 1) < 4.0 * FRAME_MS;
        let row_ms = self.costs.sample_ms * f64::from(pass.pattern.count()) * f64::from(width);
        let rows = if whole { height } else { (SLICE_MS / row_ms).min(1e9) as u32 };
        let rows = rows.min((MAX_SLICE_BYTES / (width as usize * 3)) as u32).next_multiple_of(TILE).max(TILE);
        rows.min(height - pass.next_row)
    }

    /// Learns from a picture that is complete, and tells the page.
    pub(super) fn finish(&mut self, pass: &Pass, context: &mut Context) {
        let times = pass.engine.times();
        let (width, height) = pass.size;
        let samples = f64::from(width) * f64::from(height) * f64::from(pass.pattern.count());
        let render = times.render_ms + times.read_back_ms;
        let frame_ms = ms(pass.took);
        let prepare = match pass.engine {
            PassEngine::Rows(_) => (frame_ms - render - times.compile_ms).max(0.0),
            PassEngine::Sampled(..) => self.costs.prepare_ms,
        };
        self.costs.learn(prepare, render, samples);
        let (&Pass { step, pattern, .. }, not_finite) = (pass, self.not_finite);
        self.shown = FrameStats { step, samples: pattern.count(), sampled: None, frame_ms, times, not_finite };
        self.send_state(context);
    }
}
