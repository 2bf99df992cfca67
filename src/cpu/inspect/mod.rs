//! A look inside a pixel: what the tracer does, seen by its own witness.

mod margins;
mod record;
mod recorder;
mod units;

pub use record::{
    Blocker, HitRecord, LightRecord, Margin, PixelRecord, RayKind, RayRecord, SampleRecord, ShadowRecord, SnellRecord,
    TestRecord, Verdict,
};

use self::margins::{Distinct, Least};
use self::recorder::{Detail, Recorder};
use self::units::Units;
use super::decision::Decision;
use super::proof::Effort;
use super::render::{Levels, Reference, resolve};
use super::trace::trace;
use super::vec3::Vec3;
use crate::effects::Effects;
use crate::settings::Quantize;
use crate::viewed::ViewedScene;

/// More rays of a pixel than this make no table that anybody reads.
pub const MOST_RAYS: u64 = 20_000;

/// Looks into the pixels of a scene's reference.
#[derive(Debug)]
pub struct Inspector {
    reference: Reference<f64>,
    units: Units,
    distinct: Distinct,
    count: u32,
}

impl Inspector {
    /// Of `viewed` with `effects`.
    pub fn new(viewed: &ViewedScene, effects: &Effects) -> Self {
        let reference = Reference::new(viewed, effects);
        let distinct = Distinct::of(&reference.world);
        Self { units: Units::of(viewed), distinct, count: viewed.settings().pattern.count(), reference }
    }

    /// The reference.
    pub fn reference(&self) -> &Reference<f64> {
        &self.reference
    }

    /// Rays from surfaces to surfaces that the pixel takes: there may be so many that a record of them all does not fit in memory.
    pub fn rays(&self, i: u32, j: u32) -> u64 {
        let tally = self.reference.pixels(&[[i, j]], &mut [[0; 3]]);
        tally.map_or(0, |tally| tally.primary + tally.reflection)
    }

    /// All that there is to know of pixel (column `i`, row `j`); `None` where the picture has no such pixel.
    pub fn pixel(&self, i: u32, j: u32) -> Option<PixelRecord> {
        let (width, height) = self.reference.size();
        (i < width && j < height).then(|| self.record(i, j, Detail { tests: true, margins: true }))
    }

    /// The same of a pixel of the picture without its tests but for their number, and without margins unless they are asked for.
    pub(crate) fn brief(&self, i: u32, j: u32, margins: bool) -> PixelRecord {
        self.record(i, j, Detail { tests: false, margins })
    }

    fn record(&self, i: u32, j: u32, detail: Detail) -> PixelRecord {
        let world = &self.reference.world;
        let (mut samples, mut colors) = (Vec::new(), Vec::new());
        let mut effort = None;
        for primary in self.reference.primaries(i, j) {
            let mut recorder = Recorder::new(self.units, &self.distinct, detail, primary.sample);
            let color = match self.reference.open_decisions(&primary) {
                None => trace(world, &primary, &mut recorder),
                Some((mut decisions, took)) => {
                    effort = effort.max(Some(took));
                    trace(world, &primary, &mut (&mut decisions, &mut recorder))
                }
            };
            colors.push(color);
            samples.push(recorder.finish(color));
        }
        let color = resolve(colors.into_iter(), self.count);
        let mut least = Least::default();
        for (sample, record) in samples.iter().enumerate() {
            let all = record.rays.iter().flat_map(|ray| &ray.decisions);
            all.for_each(|&margin| least.add(Margin { sample: Some(sample), ..margin }));
        }
        // The background as it is in the file is rounded by nothing.
        let is_constant =
            matches!(&samples[..], [SampleRecord { rays, .. }] if matches!(&rays[..], [RayRecord { hit: None, .. }]));
        if !is_constant {
            least.add(step_margin(color, self.reference.quantize));
        }
        let Reference { quantize, .. } = self.reference;
        PixelRecord {
            samples,
            color: color.to_f64().to_array(),
            scaled: color.to_f64().to_array().map(|c| quantize.scale() * c.clamp(0.0, 1.0) + quantize.bias()),
            levels: Levels::new(quantize).levels(color),
            decisions: least.sorted(),
            more_bits: effort.is_some(),
            most_bits: effort > Some(Effort::DoubleDouble),
            undecided: effort == Some(Effort::Rule),
        }
    }
}

/// How far a colour is from the next quantisation step: of its channels the nearest.
fn step_margin(color: Vec3<f64>, quantize: Quantize) -> Margin {
    let of_channel = |c: f64| {
        let scaled = quantize.scale() * c + quantize.bias();
        let distance = |step: f64| (c - (step.clamp(1.0, 255.0) - quantize.bias()) / quantize.scale()).abs();
        distance(scaled.floor()).min(distance(scaled.ceil()))
    };
    let margin = color.to_f64().to_array().map(of_channel).into_iter().fold(f64::INFINITY, f64::min);
    Margin { decision: Decision::QuantisationStep, margin, sample: None, ray: None, sphere: None, light: None }
}
