//! One interface to whatever renders: rows of a picture, band by band, in bounded memory.

mod certify;
mod partial;

use std::time::{Duration, Instant};

use serde::Serialize;

use crate::area::Area;
use crate::cpu::{Judge, Reference, Shown, Tally};
use crate::effects::Effects;
use crate::gpu::{self, Gpu, GpuRenderer, Rendered};
use crate::linear::Linear;
use crate::misuse::{Misuse, check_picture};
use crate::precision::{Selection, Tier};
use crate::stop;
use crate::tiles::TILE;
use crate::verify::{Verifier, Verify};
use crate::viewed::ViewedScene;

pub use crate::gpu::{Options, Output, Pixels, Rows};
pub use certify::Stages;
use certify::{Certifier, KeptScene, has_bound};
#[cfg(feature = "view")]
pub(crate) use partial::put_pixels;
pub use partial::{Filler, PartialPicture, render_partial};

/// Bytes of one band of rows at the most, unless a single row of tiles takes more.
const BAND_BYTES: usize = 16 << 20;
/// A band of colours takes so many times the memory.
const LINEAR_PART: usize = 16;
/// Pixels of the first band, whose time nobody knows.
const FIRST_BAND: usize = 1 << 19;
/// About how long a band takes, in ms: whoever waits sees it come.
const BAND_MS: f64 = 400.0;

/// Where the time of a picture went.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Times {
    /// From the scene to what the renderer reads, in ms.
    pub prepare_ms: f64,
    /// From shader text to a kernel that has run once, in ms.
    pub compile_ms: f64,
    /// The rays themselves, in ms.
    pub render_ms: f64,
    /// From the device's memory to rows, in ms.
    pub read_back_ms: f64,
    /// The longest dispatch, in ms; 0 on the CPU.
    pub longest_dispatch_ms: f64,
    /// Number of dispatches; 0 on the CPU.
    pub dispatches: u64,
}

/// How many rays a picture took.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Rays {
    /// Rays from the eye: one for each sample of each pixel, also where no sphere can be and a device needs none.
    pub primary: u64,
    /// Rays towards lights.
    pub shadow: u64,
    /// Reflected and refracted rays.
    pub reflection: u64,
}

/// What renders.
#[derive(Debug, Clone, Copy)]
pub enum Backend<'a> {
    /// The CPU reference.
    Reference,
    /// A Vulkan device with the kernel of a tier.
    Device(&'a Gpu, Tier),
    /// Likewise, and whatever it takes beside that kernel so that each pixel is what the reference has.
    Certified(&'a Gpu, Tier),
}

impl<'a> Backend<'a> {
    /// What is selected, on `gpu`; without one the reference.
    pub fn of(gpu: Option<&'a Gpu>, selection: &Selection) -> Self {
        let kind = if selection.certified { Self::Certified } else { Self::Device };
        gpu.map_or(Self::Reference, |gpu| kind(gpu, selection.tier))
    }

    /// The device, if there is one.
    pub fn gpu(&self) -> Option<&'a Gpu> {
        match self {
            Self::Reference => None,
            Self::Device(gpu, _) | Self::Certified(gpu, _) => Some(gpu),
        }
    }

    /// The judge of this renderer's pixels.
    pub fn judge(&self) -> Judge {
        match self {
            Self::Reference | Self::Certified(..) => Judge::of(Tier::Double),
            // Without f64 only the intersection is that of the tier: shading is in f32.
            Self::Device(gpu, Tier::Double) if !gpu.device.info.f64 => Judge::of(Tier::Robust),
            Self::Device(_, tier) => Judge::of(*tier),
        }
    }
}

/// How the device of a picture is called in messages.
pub(crate) fn device_name(gpu: Option<&Gpu>) -> String {
    gpu.map_or_else(|| "the CPU reference (f64)".to_owned(), |gpu| gpu.device.info.to_string())
}

/// A renderer with a scene: of [`Rows`] of its picture, or of lists of its [`Pixels`].
#[derive(Debug)]
pub enum Engine<'a, O = Rows> {
    /// The CPU reference.
    Cpu(Box<CpuEngine>),
    /// A Vulkan device.
    Gpu(Box<DeviceEngine<'a, O>>),
}

/// The CPU reference with its clock.
#[derive(Debug)]
pub struct CpuEngine {
    reference: Reference<f64>,
    is_linear: bool,
    prepare: Duration,
    render: Duration,
    tally: Tally,
    /// Pixels so far.
    pixels: u64,
}

impl CpuEngine {
    /// Notes what an action on so many pixels took and came to; returns how many are not finite.
    fn timed(
        &mut self,
        pixels: usize,
        action: impl FnOnce(&Reference<f64>) -> Result<Tally, Misuse>,
    ) -> Result<u64, gpu::Error> {
        let _span = tracing::info_span!("trace by the reference", pixels).entered();
        let start = Instant::now();
        let tally = action(&self.reference)?;
        if stop::is_asked() {
            return Err(gpu::Error::Stopped);
        }
        self.render += start.elapsed();
        self.tally = self.tally.plus(tally);
        self.pixels += pixels as u64;
        Ok(tally.not_finite)
    }
}

/// A device's renderer, and the reference for what its rounding cannot decide.
#[derive(Debug)]
pub struct DeviceEngine<'a, O> {
    renderer: GpuRenderer<'a, O>,
    prepare: Duration,
    verifier: Option<Verifier>,
    kept: Option<KeptScene>,
    /// Of a certified picture.
    certifier: Option<Certifier<'a>>,
    /// What the reference has taken to decide them.
    decided: Duration,
    /// Pixels that it has calculated.
    by_reference: u64,
    /// Those among them of which the device has cut loops short.
    cut: u64,
}

impl<O: Output> DeviceEngine<'_, O> {
    /// Decides what rounding could not and calculates what the device cannot, of so many pixels; `place` puts a pixel's levels where they
    /// belong, and its colour where there is one. Returns how many pixels are not finite.
    fn decide(
        &mut self,
        Rendered { mut not_finite, mut unsure, mut cut }: Rendered,
        pixels: usize,
        mut place: impl FnMut([u32; 2], [u8; 3], Option<Linear>),
    ) -> Result<u64, gpu::Error> {
        self.cut += cut.len() as u64;
        if let (Some(certifier), Some(kept)) = (&mut self.certifier, &self.kept) {
            certifier.stages.kernel += (pixels - unsure.len() - cut.len()) as u64;
            let left = certifier.render_again(kept, unsure, |pixel, levels| place(pixel, levels, None))?;
            not_finite += left.not_finite;
            unsure = left.unsure;
            cut.extend(left.cut);
        }
        if unsure.is_empty() && cut.is_empty() {
            return Ok(not_finite);
        }
        let _span = tracing::info_span!("decide by the reference", pixels = unsure.len() + cut.len()).entered();
        let start = Instant::now();
        let reference = match (&self.verifier, &self.kept) {
            (Some(verifier), _) => verifier.reference(),
            (None, Some(kept)) => kept.reference(),
            (None, None) if cut.is_empty() => return Ok(not_finite),
            (None, None) => return Err(self.renderer.too_few_turns(cut.len())),
        };
        unsure.extend(cut);
        self.by_reference += unsure.len() as u64;
        let (shown, tally) = reference.all_of_pixels(&unsure)?;
        if let Some(certifier) = &mut self.certifier {
            certifier.stages.reference += unsure.len() as u64;
            certifier.stages.more_bits += tally.more_bits;
            certifier.stages.most_bits += tally.most_bits;
            certifier.stages.undecided += tally.undecided;
        }
        unsure.into_iter().zip(shown).for_each(|(pixel, Shown { levels, linear })| place(pixel, levels, Some(linear)));
        self.decided += start.elapsed();
        Ok(not_finite + tally.not_finite)
    }
}

impl DeviceEngine<'_, Rows> {
    /// Decides what rounding could not of these rows, and verifies them; returns how many pixels are not finite. `linear` is empty where it
    /// is not wanted.
    fn decide_rows(
        &mut self,
        rendered: Rendered,
        first: u32,
        rgb: &mut [u8],
        linear: &mut [Linear],
    ) -> Result<u64, gpu::Error> {
        let Area { left, top, width, .. } = self.renderer.area();
        let pixels = rgb.as_chunks_mut::<3>().0;
        let not_finite = self.decide(rendered, pixels.len(), |[x, y], levels, color| {
            let at = (y - top - first) as usize * width as usize + (x - left) as usize;
            pixels[at] = levels;
            if let (Some(linear), Some(color)) = (linear.get_mut(at), color) {
                *linear = color;
            }
        })?;
        self.verifier.as_mut().map_or(Ok(()), |verifier| verifier.rows(top + first, rgb, linear))?;
        Ok(not_finite)
    }
}

impl<'a> Engine<'a> {
    /// Prepares rows of `viewed` for `backend`.
    pub fn new(backend: Backend<'a>, viewed: ViewedScene, effects: &Effects) -> Result<Self, gpu::Error> {
        Self::with(backend, viewed, effects, &Options::default())
    }

    /// Renders whole rows from row `first` of its part of the picture on; returns how many pixels are not finite.
    ///
    /// # Errors
    ///
    /// [`gpu::Error::Misuse`] where these are no rows of it.
    pub fn rows(&mut self, first: u32, rgb: &mut [u8]) -> Result<u64, gpu::Error> {
        match self {
            Self::Cpu(cpu) => cpu.timed(rgb.len() / 3, |reference| reference.rows(first, rgb)),
            Self::Gpu(gpu) => {
                let rendered = gpu.renderer.rows(first, rgb)?;
                gpu.decide_rows(rendered, first, rgb, &mut [])
            }
        }
    }

    /// Likewise, with the colours of the same pixels before they are quantised. Of a certified picture the levels of 16 bits that these
    /// colours have are the reference's, too.
    ///
    /// # Errors
    ///
    /// Also [`gpu::Error::Misuse`] where there is not one colour for each pixel, or the engine was not prepared with [`Options::linear`].
    pub fn linear_rows(&mut self, first: u32, rgb: &mut [u8], linear: &mut [Linear]) -> Result<u64, gpu::Error> {
        match self {
            Self::Cpu(cpu) => cpu.timed(rgb.len() / 3, |reference| reference.linear_rows(first, rgb, linear)),
            Self::Gpu(gpu) => {
                let rendered = gpu.renderer.linear_rows(first, rgb, linear)?;
                gpu.decide_rows(rendered, first, rgb, linear)
            }
        }
    }
}

impl<'a, O: Output> Engine<'a, O> {
    /// Prepares `viewed` for `backend`, with more than the pixels where that is wanted.
    pub fn with(
        backend: Backend<'a>,
        viewed: ViewedScene,
        effects: &Effects,
        options: &Options,
    ) -> Result<Self, gpu::Error> {
        Self::verified(backend, viewed, effects, options, Verify::Nothing)
    }

    /// Likewise; a device's pixels that `verify` chooses are calculated by the reference, too, and where rounding does not explain
    /// what it has, the picture is an error: [`gpu::Error::Wrong`].
    pub fn verified(
        backend: Backend<'a>,
        viewed: ViewedScene,
        effects: &Effects,
        options: &Options,
        verify: Verify,
    ) -> Result<Self, gpu::Error> {
        let _span = tracing::info_span!("prepare").entered();
        let start = Instant::now();
        // Colours in `f32` have no levels of 16 bits.
        let backend = match backend {
            Backend::Certified(gpu, _) if options.linear => Backend::Certified(gpu, Tier::Double),
            backend => backend,
        };
        let (gpu, tier) = match backend {
            Backend::Device(gpu, tier) => (gpu, tier),
            Backend::Certified(gpu, tier) if has_bound(gpu, tier, viewed.settings()) => (gpu, tier),
            Backend::Reference | Backend::Certified(..) => {
                check_picture(&viewed)?;
                let reference = Reference::new(&viewed, effects);
                return Ok(Self::Cpu(Box::new(CpuEngine {
                    reference,
                    is_linear: options.linear,
                    prepare: start.elapsed(),
                    render: Duration::ZERO,
                    tally: Tally::default(),
                    pixels: 0,
                })));
            }
        };
        let certified = matches!(backend, Backend::Certified(..));
        let options = &Options { certified, ..*options };
        let (renderer, mut lists) = if verify == Verify::Nothing && !certified {
            (GpuRenderer::with(gpu, &viewed, effects, tier, options)?, None)
        } else {
            let (renderer, lists) = GpuRenderer::with_lists(gpu, &viewed, effects, tier, options)?;
            (renderer, Some(lists))
        };
        // Of a certified picture rounding explains nothing.
        let judge = (!certified).then(|| backend.judge());
        let verifier = match verify {
            Verify::Nothing => None,
            verify => lists.take().and_then(|lists| Verifier::new(&viewed, effects, lists, judge, verify)),
        };
        let certifier = certified.then(|| Certifier::new(gpu, tier, viewed.settings()));
        let keeps = certified || renderer.tells_tangents() && verifier.is_none();
        let kept = keeps.then(|| KeptScene::new(viewed, effects, lists));
        let (prepare, decided, by_reference, cut) = (start.elapsed(), Duration::ZERO, 0, 0);
        let engine = DeviceEngine { renderer, prepare, verifier, kept, certifier, decided, by_reference, cut };
        Ok(Self::Gpu(Box::new(engine)))
    }

    /// The same where `double` renders the unsure pixels of a certified picture as soon as a band has so many: this changes no byte.
    #[must_use]
    pub fn with_double_from(mut self, pixels: usize) -> Self {
        if let Self::Gpu(gpu) = &mut self
            && let Some(certifier) = &mut gpu.certifier
        {
            certifier.double_from = pixels;
        }
        self
    }

    /// Whether it was prepared for colours before they are quantised.
    pub fn is_linear(&self) -> bool {
        match self {
            Self::Cpu(cpu) => cpu.is_linear,
            Self::Gpu(gpu) => gpu.renderer.is_linear(),
        }
    }

    /// The part of the picture that is rendered.
    pub fn area(&self) -> Area {
        match self {
            Self::Cpu(cpu) => cpu.reference.area(),
            Self::Gpu(gpu) => gpu.renderer.area(),
        }
    }

    /// Its width and height.
    pub fn size(&self) -> (u32, u32) {
        self.area().size()
    }

    /// Time of all dispatches by the device's own clock, in ms; `None` where it is not read or there is none.
    pub fn on_device_ms(&self) -> Option<f64> {
        match self {
            Self::Cpu(_) => None,
            Self::Gpu(gpu) => gpu.renderer.has_clock().then(|| ms(gpu.renderer.times().on_device)),
        }
    }

    /// Times so far.
    pub fn times(&self) -> Times {
        match self {
            Self::Cpu(cpu) => Times { prepare_ms: ms(cpu.prepare), render_ms: ms(cpu.render), ..Times::default() },
            Self::Gpu(gpu) => {
                let (mut times, mut prepare) = (gpu.renderer.times(), gpu.prepare);
                if let Some(certifier) = &gpu.certifier {
                    times = times.plus(certifier.times());
                    prepare += certifier.prepare;
                }
                Times {
                    prepare_ms: ms(prepare),
                    compile_ms: ms(times.compile),
                    render_ms: ms(times.render + gpu.decided),
                    read_back_ms: ms(times.read_back),
                    longest_dispatch_ms: ms(times.longest_dispatch),
                    dispatches: times.dispatches,
                }
            }
        }
    }

    /// How many pixels so far the reference has calculated in place of the device, which is unsure of them or has too few turns.
    pub fn by_reference(&self) -> u64 {
        match self {
            Self::Cpu(cpu) => cpu.pixels,
            Self::Gpu(gpu) => gpu.by_reference,
        }
    }

    /// How many pixels so far the reference has calculated in place of the device, whose loops have too few turns for them.
    pub fn cut(&self) -> u64 {
        match self {
            Self::Cpu(_) => 0,
            Self::Gpu(gpu) => gpu.cut,
        }
    }

    /// By which stages the pixels so far are the reference's; `None` where they are not certified. Those of the CPU reference always are.
    pub fn stages(&self) -> Option<Stages> {
        match self {
            Self::Cpu(cpu) => {
                let Tally { more_bits, most_bits, undecided, .. } = cpu.tally;
                Some(Stages { reference: cpu.pixels, more_bits, most_bits, undecided, ..Stages::default() })
            }
            Self::Gpu(gpu) => gpu.certifier.as_ref().map(|certifier| certifier.stages),
        }
    }

    /// How many pixels were held against the reference, and how long that has taken, in ms; `None` where none were to be.
    pub fn verification(&self) -> Option<(u64, f64)> {
        match self {
            Self::Cpu(_) => None,
            Self::Gpu(gpu) => gpu.verifier.as_ref().map(|verifier| {
                let (pixels, took) = verifier.cost();
                (pixels, ms(took))
            }),
        }
    }

    /// Rays so far; `None` where they are not counted. The CPU reference always counts them.
    pub fn rays(&self) -> Option<Rays> {
        match self {
            Self::Cpu(cpu) => {
                let Tally { primary, shadow, reflection, .. } = cpu.tally;
                Some(Rays { primary, shadow, reflection })
            }
            Self::Gpu(gpu) => {
                gpu.renderer.rays().map(|[primary, shadow, reflection]| Rays { primary, shadow, reflection })
            }
        }
    }
}

/// A band of rows on its way to the picture.
#[derive(Debug)]
pub struct Band<'a> {
    /// Its first row, counted from that of the part that is rendered.
    pub first: u32,
    /// Its rows, 3 bytes a pixel.
    pub rgb: &'a [u8],
    /// The colours of the same pixels before they are quantised, where the engine was prepared for them; otherwise empty.
    pub linear: &'a [Linear],
}

/// Renders a picture, or the engine's part of it, band by band; returns how many pixels are not finite.
pub fn render_bands<E: From<gpu::Error>>(
    engine: &mut Engine,
    mut sink: impl FnMut(Band) -> Result<(), E>,
) -> Result<u64, E> {
    let Area { top, width, height, .. } = engine.area();
    let row_bytes = width as usize * 3;
    // Bands are of whole tiles, so that none is rendered twice.
    let tiles = |bytes: usize| (bytes / (row_bytes * TILE as usize)).max(1) as u32;
    let is_linear = engine.is_linear();
    let most = tiles(if is_linear { BAND_BYTES / LINEAR_PART } else { BAND_BYTES });
    let mut now = tiles(FIRST_BAND * 3).min(most);
    let (mut rgb, mut linear) = (Vec::new(), Vec::new());
    let (mut first, mut not_finite) = (0, 0);
    while first < height {
        let above = (top + first) % TILE;
        let rows = (now.saturating_mul(TILE) - above).min(height - first);
        let (start, compile_ms) = (Instant::now(), engine.times().compile_ms);
        rgb.resize(row_bytes * rows as usize, 0);
        not_finite += if is_linear {
            linear.resize(rgb.len() / 3, Linear::default());
            engine.linear_rows(first, &mut rgb, &mut linear)?
        } else {
            engine.rows(first, &mut rgb)?
        };
        let took = ms(start.elapsed()) - (engine.times().compile_ms - compile_ms);
        sink(Band { first, rgb: &rgb, linear: &linear })?;
        first += rows;
        now = (f64::from(now) * (BAND_MS / took.max(1e-3)).min(2.0)).clamp(1.0, f64::from(most)) as u32;
    }
    Ok(not_finite)
}

/// Renders a whole picture into memory; returns it with the number of its pixels that are not finite.
pub fn render_picture(engine: &mut Engine) -> Result<(Vec<u8>, u64), gpu::Error> {
    let (width, height) = engine.size();
    let mut picture = Vec::with_capacity(width as usize * height as usize * 3);
    let not_finite = render_bands(engine, |band| {
        picture.extend_from_slice(band.rgb);
        Ok::<_, gpu::Error>(())
    })?;
    Ok((picture, not_finite))
}

pub(crate) fn ms(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}
