//! Pictures of which not all pixels are sampled.

use std::collections::HashMap;
use std::time::{Duration, Instant};

use super::{Backend, Engine, ms};
use crate::cpu;
use crate::gpu::{self, DeviceKind, Gpu, Pixels, Reconstructor};
use crate::misuse::Misuse;
use crate::sampling::{Fill, Samples};

impl Engine<'_, Pixels> {
    /// Renders the pixels in these columns and rows: each has the value that it has in the full picture. Returns how many are not
    /// finite.
    ///
    /// # Errors
    ///
    /// [`gpu::Error::Misuse`] where a pixel is not of the picture, or there is not one colour for each.
    pub fn pixels(&mut self, pixels: &[[u32; 2]], colors: &mut [[u8; 3]]) -> Result<u64, gpu::Error> {
        match self {
            Self::Cpu(cpu) => cpu.timed(pixels.len(), |reference| reference.pixels(pixels, colors)),
            Self::Gpu(gpu) => {
                let rendered = gpu.renderer.pixels(pixels, colors)?;
                let mut places: HashMap<_, Vec<usize>> = HashMap::new();
                if !rendered.unsure.is_empty() || !rendered.cut.is_empty() {
                    pixels.iter().enumerate().for_each(|(place, &pixel)| places.entry(pixel).or_default().push(place));
                }
                let not_finite = gpu.decide(rendered, pixels.len(), |pixel, color, _| {
                    places.get(&pixel).into_iter().flatten().for_each(|&place| colors[place] = color);
                })?;
                gpu.verifier.as_mut().map_or(Ok(()), |verifier| verifier.list(pixels, colors))?;
                Ok(not_finite)
            }
        }
    }
}

/// Fills pixels without a sample.
#[derive(Debug)]
pub enum Filler<'a> {
    /// The CPU reference.
    Cpu,
    /// A Vulkan device.
    Gpu(Reconstructor<'a>),
}

impl<'a> Filler<'a> {
    /// Where `backend` renders.
    pub fn new(backend: Backend<'a>) -> Result<Self, gpu::Error> {
        backend.gpu().map_or(Ok(Self::Cpu), |gpu| Reconstructor::new(gpu).map(Self::Gpu))
    }

    /// Where it takes the least time for `backend`: a software device is slower at it than the CPU that it runs on. The bytes
    /// are the same.
    pub fn fastest(backend: Backend<'a>) -> Result<Self, gpu::Error> {
        let is_software = |gpu: &Gpu| gpu.device.info.kind == DeviceKind::Software;
        if backend.gpu().is_some_and(is_software) { Ok(Self::Cpu) } else { Self::new(backend) }
    }

    /// Where the nearest sample of each pixel lies, packed, pixels in reading order.
    pub fn nearest_samples(&self, samples: &Samples) -> Result<Vec<u32>, gpu::Error> {
        match self {
            Self::Cpu => Ok(cpu::nearest_samples(samples)),
            Self::Gpu(reconstructor) => reconstructor.nearest_samples(samples),
        }
    }

    /// The whole picture from `colors`, one for each of `samples`, 3 bytes a pixel.
    pub fn filled(&mut self, samples: &Samples, colors: &[[u8; 3]], fill: Fill) -> Result<Vec<u8>, gpu::Error> {
        match self {
            Self::Cpu => Ok(cpu::filled(samples, colors, fill)?),
            Self::Gpu(reconstructor) => reconstructor.filled(samples, colors, fill),
        }
    }
}

/// A picture of which a part was sampled.
#[derive(Debug, Clone)]
pub struct PartialPicture {
    /// All pixels, 3 bytes each.
    pub rgb: Vec<u8>,
    /// Sampled pixels that are not finite.
    pub not_finite: u64,
    /// Time of filling the others, in ms; compiling included.
    pub fill_ms: f64,
}

/// Renders `samples`, and fills the other pixels. `done` hears of the part that is rendered.
///
/// # Errors
///
/// [`gpu::Error::Misuse`] where they are samples of a picture of another size.
pub fn render_partial(
    engine: &mut Engine<Pixels>,
    backend: Backend,
    samples: &Samples,
    fill: Fill,
    mut done: impl FnMut(f64),
) -> Result<PartialPicture, gpu::Error> {
    const PIXELS_AT_ONCE: usize = 1 << 18;
    if samples.size() != engine.size() {
        return Err(Misuse::Samples { of: samples.size(), size: engine.size() }.into());
    }
    let mut colors = vec![[0; 3]; samples.pixels().len()];
    let mut not_finite = 0;
    let mut rendered = 0;
    for (pixels, colors) in samples.pixels().chunks(PIXELS_AT_ONCE).zip(colors.chunks_mut(PIXELS_AT_ONCE)) {
        not_finite += engine.pixels(pixels, colors)?;
        rendered += pixels.len();
        done(rendered as f64 / samples.pixels().len() as f64);
    }
    let start = Instant::now();
    let is_full = samples.pixels().len() as u64 == u64::from(samples.size().0) * u64::from(samples.size().1);
    let rgb = if is_full { whole(samples, &colors) } else { Filler::new(backend)?.filled(samples, &colors, fill)? };
    let fill_ms = if is_full { Duration::ZERO } else { start.elapsed() };
    Ok(PartialPicture { rgb, not_finite, fill_ms: ms(fill_ms) })
}

/// The picture of `colors`, one for each of `samples`; black elsewhere.
fn whole(samples: &Samples, colors: &[[u8; 3]]) -> Vec<u8> {
    let (width, height) = samples.size();
    let mut rgb = vec![0; width as usize * height as usize * 3];
    put_pixels(samples.pixels(), colors, width, &mut rgb);
    rgb
}

/// Puts the colours of pixels into a picture of 3 bytes a pixel.
pub(crate) fn put_pixels(pixels: &[[u32; 2]], colors: &[[u8; 3]], width: u32, rgb: &mut [u8]) {
    let rgb = rgb.as_chunks_mut::<3>().0;
    for (&[x, y], color) in pixels.iter().zip(colors) {
        rgb[y as usize * width as usize + x as usize] = *color;
    }
}
