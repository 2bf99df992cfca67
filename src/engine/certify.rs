//! Certified pictures: each pixel is what the reference has.
//!
//! The kernel of the picture says of which pixels it is unsure, by its bound of error. `double` renders these again, where they are
//! many; the reference calculates what is left.

use std::cell::{Cell, OnceCell};
use std::fmt;
use std::time::{Duration, Instant};

use serde::Serialize;

use crate::accel::Acceleration;
use crate::area::Area;
use crate::cpu::Reference;
use crate::effects::Effects;
use crate::gpu::{self, DeviceKind, DeviceTimes, Gpu, GpuRenderer, Options, Pixels, Rendered};
use crate::precision::Tier;
use crate::scene::Scene;
use crate::settings::Settings;
use crate::viewed::ViewedScene;
use crate::words::count;

/// How many pixels of a certified picture are right by which stage.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Stages {
    /// By the first kernel, which was sure of them; also those where no sphere can be.
    pub kernel: u64,
    /// By `double`, of the others.
    pub double: u64,
    /// By the CPU reference, of the others.
    pub reference: u64,
    /// Those of them for which the reference took more bits than `f64` has: double-double.
    pub more_bits: u64,
    /// Those of them for which it took still more: 237.
    pub most_bits: u64,
    /// Those of them with a decision that these leave open, too: it was taken for a tie where it lies all but on one.
    pub undecided: u64,
}

impl Stages {
    /// Where the first kernel was that of `tier`.
    pub fn in_words(&self, tier: Tier) -> String {
        let Self { kernel, double, reference, .. } = self;
        let more = if self.more_bits > 0 { format!(" ({})", self.decisions_in_words()) } else { String::new() };
        let again = if tier == Tier::Double { String::new() } else { format!("{double} by double, ") };
        format!("{kernel} pixels by {tier}, {again}{reference} by the CPU reference{more}")
    }

    /// What the reference's decisions took.
    pub fn decisions_in_words(&self) -> String {
        let Self { more_bits, most_bits, undecided, .. } = *self;
        format!(
            "{} needed double-double, {most_bits} of them 237 bits, {undecided} undecided",
            count(more_bits, "pixel")
        )
    }
}

/// A scene whose pixels may have to be calculated again, with the reference for that, once there is one to do.
pub(super) struct KeptScene {
    scene: Scene,
    settings: Settings,
    area: Area,
    effects: Effects,
    /// Lists of spheres that the reference may have.
    lists: Cell<Option<Acceleration>>,
    reference: OnceCell<Reference<f64>>,
}

impl KeptScene {
    /// With lists of another renderer of the scene, if there are any.
    pub(super) fn new(viewed: ViewedScene, effects: &Effects, lists: Option<Acceleration>) -> Self {
        let area = viewed.area();
        let (scene, settings) = viewed.into_file();
        let (scene, effects, lists) = (scene.clone(), effects.clone(), Cell::new(lists));
        Self { scene, settings, area, effects, lists, reference: OnceCell::new() }
    }

    fn viewed(&self) -> ViewedScene<'_> {
        self.scene.viewed(&self.settings).of_part(self.area)
    }

    pub(super) fn reference(&self) -> &Reference<f64> {
        self.reference.get_or_init(|| {
            let viewed = self.viewed();
            match self.lists.take() {
                Some(lists) => Reference::with_lists(&viewed, &self.effects, lists),
                None => Reference::new(&viewed, &self.effects),
            }
        })
    }
}

impl fmt::Debug for KeptScene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("KeptScene")
            .field("scene", &self.scene)
            .field("settings", &self.settings)
            .finish_non_exhaustive()
    }
}

/// Unsure pixels of a band from which on `double` renders them: it has to be prepared, and its kernels to be found, which the reference
/// does not need.
const DOUBLE_FROM: usize = 1 << 17;
/// Software devices run on the processor of the reference, which takes 0.80 to 0.96 of their time for these pixels: they lie apart, and
/// lanes wait for each other.
const NEVER: usize = usize::MAX;
/// Once it is ready, a part of them is enough.
const READY_PART: usize = 64;
/// Pixels that it renders at once: a longer list than any before would take new buffers and kernels.
const AT_ONCE: usize = DOUBLE_FROM;

/// Whether the kernel of a tier has a bound of its error for such a picture. Without `f64`, pairs of `f32` stand in for `double` up to
/// the roots alone; and no bound is kept for the mean of several samples.
pub(super) fn has_bound(gpu: &Gpu, tier: Tier, settings: &Settings) -> bool {
    let kernel = match tier {
        Tier::Fast => true,
        Tier::Robust => false,
        Tier::Double => gpu.device.info.f64,
    };
    kernel && settings.pattern.count() == 1
}

/// What a certified picture takes beside its first kernel.
#[derive(Debug)]
pub(super) struct Certifier<'a> {
    /// The device, unless its first kernel has been `double`, or `double` has no bound there.
    gpu: Option<&'a Gpu>,
    /// From how many unsure pixels of a band on it is worth it.
    pub(super) double_from: usize,
    /// `double`, once there are so many.
    double: Option<GpuRenderer<'a, Pixels>>,
    /// What it took to prepare it.
    pub(super) prepare: Duration,
    pub(super) stages: Stages,
}

impl<'a> Certifier<'a> {
    /// For a picture with these settings whose first kernel is that of `tier`.
    pub(super) fn new(gpu: &'a Gpu, tier: Tier, settings: &Settings) -> Self {
        let double_from = if gpu.device.info.kind == DeviceKind::Software { NEVER } else { DOUBLE_FROM };
        let gpu = Some(gpu).filter(|gpu| tier != Tier::Double && has_bound(gpu, Tier::Double, settings));
        Self { gpu, double_from, double: None, prepare: Duration::ZERO, stages: Stages::default() }
    }

    /// Times of `double`.
    pub(super) fn times(&self) -> DeviceTimes {
        self.double.as_ref().map(GpuRenderer::times).unwrap_or_default()
    }

    /// Renders `unsure` by `double`, if that is worth it, and has `place` put the colours of which it is sure to their places. What it
    /// returns is left.
    pub(super) fn render_again(
        &mut self,
        kept: &KeptScene,
        unsure: Vec<[u32; 2]>,
        mut place: impl FnMut([u32; 2], [u8; 3]),
    ) -> Result<Rendered, gpu::Error> {
        let least = if self.double.is_some() { self.double_from / READY_PART } else { self.double_from };
        let (true, Some(gpu)) = (unsure.len() >= least.max(1), self.gpu) else {
            return Ok(Rendered { unsure, ..Rendered::default() });
        };
        let double = match &mut self.double {
            Some(double) => double,
            none => match prepared(gpu, kept, &mut self.prepare) {
                Ok(double) => none.insert(double),
                // The device cannot hold the scene twice.
                Err(error) if error.is_refusal() => {
                    self.gpu = None;
                    return Ok(Rendered { unsure, ..Rendered::default() });
                }
                Err(error) => return Err(error),
            },
        };
        let mut left = Rendered::default();
        let mut colors = vec![[0; 3]; unsure.len().min(AT_ONCE)];
        for pixels in unsure.chunks(AT_ONCE) {
            let colors = &mut colors[..pixels.len()];
            left.add(double.pixels(pixels, colors)?);
            // What is left gets its colour later.
            pixels.iter().zip(colors).for_each(|(&pixel, color)| place(pixel, *color));
        }
        self.stages.double += (unsure.len() - left.unsure.len() - left.cut.len()) as u64;
        Ok(left)
    }
}

/// `double` for pixels of `kept`; what that takes is added to `took`.
fn prepared<'a>(gpu: &'a Gpu, kept: &KeptScene, took: &mut Duration) -> Result<GpuRenderer<'a, Pixels>, gpu::Error> {
    let _span = tracing::info_span!("prepare double").entered();
    let start = Instant::now();
    let options = Options { certified: true, ..Options::default() };
    let double = GpuRenderer::with(gpu, &kept.viewed(), &kept.effects, Tier::Double, &options);
    *took += start.elapsed();
    double
}
