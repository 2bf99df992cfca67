//! Some pixels of a device's picture beside the reference's.
//!
//! A driver may drop a command and say nothing. What a dispatch leaves out shows in its pixels' statuses; where it has calculated
//! with other numbers than it was given, only another calculation tells. So some pixels of each picture, which its scene chooses,
//! are calculated by the reference, too. Where they differ, rounding has to explain it.

use std::fmt;
use std::num::NonZero;
use std::str::FromStr;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::accel::{Acceleration, Cover};
use crate::area::Area;
use crate::cpu::{Finding, Judge, Reference, Shown};
use crate::effects::Effects;
use crate::gpu::Error;
use crate::linear::Linear;
use crate::random::Random;
use crate::scene::Scene;
use crate::viewed::ViewedScene;

/// How many pixels of a device's picture are held against the reference.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Verify {
    /// None.
    #[default]
    Nothing,
    /// So many: a few ms for each thousand spheres.
    Some(NonZero<u32>),
    /// All.
    All,
}

/// What is verified where nobody has said how much.
const USUAL: NonZero<u32> = NonZero::new(64).expect("it is not 0");
/// With more spheres, preparing the reference takes more than a hundredth of the time of a picture: 3 ms for 10,000 of them, but
/// 100 ms for 100,000.
const MAX_SPHERES: usize = 20_000;

impl Verify {
    /// What costs next to nothing for a picture of `scene`.
    pub fn usual(scene: &Scene) -> Self {
        if scene.spheres.len() > MAX_SPHERES { Self::Nothing } else { Self::Some(USUAL) }
    }
}

impl FromStr for Verify {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "all" => Ok(Self::All),
            "none" | "0" => Ok(Self::Nothing),
            _ => text.parse().map(Self::Some).map_err(|_| "expected a number of pixels, all or none".into()),
        }
    }
}

impl fmt::Display for Verify {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nothing => f.write_str("none"),
            Self::Some(count) => count.fmt(f),
            Self::All => f.write_str("all"),
        }
    }
}

/// The reference of a scene, and which pixels it looks at.
#[derive(Debug)]
pub(crate) struct Verifier {
    reference: Reference<f64>,
    /// `None` where rounding explains nothing.
    judge: Option<Judge>,
    /// In reading order; `None` for all.
    pixels: Option<Vec<[u32; 2]>>,
    verified: u64,
    took: Duration,
}

impl Verifier {
    /// For a picture by a renderer whose rounding `judge` knows and whose lists of spheres are `accel`; without a judge, nothing may
    /// differ.
    pub(crate) fn new(
        viewed: &ViewedScene,
        effects: &Effects,
        accel: Acceleration,
        judge: Option<Judge>,
        verify: Verify,
    ) -> Option<Self> {
        let start = Instant::now();
        let pixels = match verify {
            Verify::Nothing => return None,
            Verify::Some(count) => Some(chosen(viewed.in_file().0, &accel.screen.cover(), count.get())),
            Verify::All => None,
        };
        let reference = Reference::with_lists(viewed, effects, accel);
        Some(Self { reference, judge, pixels, verified: 0, took: start.elapsed() })
    }

    /// The reference.
    pub(crate) fn reference(&self) -> &Reference<f64> {
        &self.reference
    }

    /// How many pixels were held against the reference, and how long that has taken.
    pub(crate) fn cost(&self) -> (u64, Duration) {
        (self.verified, self.took)
    }

    /// Looks at those of the chosen pixels that are in these rows, and at their colours where there are any.
    pub(crate) fn rows(&mut self, first: u32, rgb: &[u8], linear: &[Linear]) -> Result<(), Error> {
        let Area { left, width, .. } = self.reference.area();
        let count = (rgb.len() / (width as usize * 3)) as u32;
        let rows = first..first + count;
        let here: Vec<[u32; 2]> = match &self.pixels {
            Some(pixels) => pixels.iter().copied().filter(|[_, y]| rows.contains(y)).collect(),
            None => rows.flat_map(|y| (left..left + width).map(move |x| [x, y])).collect(),
        };
        let levels = rgb.as_chunks::<3>().0;
        let at = |[x, y]: [u32; 2]| (y - first) as usize * width as usize + (x - left) as usize;
        self.compare(&here, |pixel| levels[at(pixel)])?;
        if linear.is_empty() { Ok(()) } else { self.compare_colors(&here, |pixel| linear[at(pixel)]) }
    }

    /// Whether rounding explains the colours of these pixels, which have the right levels, or explained ones.
    fn compare_colors(&mut self, pixels: &[[u32; 2]], color: impl Fn([u32; 2]) -> Linear + Sync) -> Result<(), Error> {
        let start = Instant::now();
        let (expected, _) = self.reference.all_of_pixels(pixels)?;
        let trial = self.judge.map(|judge| judge.trial(&self.reference));
        let quantize = self.reference.quantize();
        let is_wrong = |&(&[x, y], expected): &(&[u32; 2], &Shown)| {
            let Linear { color, coverage } = color([x, y]);
            let right = expected.linear;
            match &trial {
                // What is no number is said otherwise.
                Some(trial) => {
                    color.is_finite()
                        && color != right.color
                        && trial.explain_color(x, y, color) == Finding::Unexplained
                }
                None => quantize.levels16(color) != quantize.levels16(right.color) || coverage != right.coverage,
            }
        };
        let wrong = pixels.par_iter().zip(&expected).find_first(is_wrong);
        self.took += start.elapsed();
        wrong.map_or(Ok(()), |(&[x, y], expected)| {
            Err(Error::Wrong(format!(
                "the device's picture is wrong: rounding does not explain the colour of x {x}, y {y}: {}, and the reference has {}",
                color([x, y]).color,
                expected.linear.color
            )))
        })
    }

    /// Looks at as many of these pixels as are chosen of a picture.
    pub(crate) fn list(&mut self, pixels: &[[u32; 2]], colors: &[[u8; 3]]) -> Result<(), Error> {
        let most = self.pixels.as_ref().map_or(pixels.len(), Vec::len).max(1);
        let indices: Vec<usize> = (0..pixels.len()).step_by(pixels.len().div_ceil(most).max(1)).collect();
        let here: Vec<[u32; 2]> = indices.iter().map(|&index| pixels[index]).collect();
        let mut levels = indices.iter().map(|&index| colors[index]);
        self.compare(&here, |_| levels.next().unwrap_or_default())
    }

    /// `level` is asked for each of the pixels, in order.
    fn compare(&mut self, pixels: &[[u32; 2]], mut level: impl FnMut([u32; 2]) -> [u8; 3]) -> Result<(), Error> {
        let _span = tracing::info_span!("verify", pixels = pixels.len()).entered();
        let start = Instant::now();
        let mut expected = vec![[0; 3]; pixels.len()];
        self.reference.pixels(pixels, &mut expected)?;
        let pairs = pixels.iter().map(|&pixel| (pixel, level(pixel))).zip(&expected);
        let differing: Vec<_> = pairs.filter(|((_, level), expected)| level != *expected).collect();
        if !differing.is_empty() {
            let trial = self.judge.map(|judge| judge.trial(&self.reference));
            let wrong = |&&(([x, y], level), _): &&(([u32; 2], [u8; 3]), &[u8; 3])| {
                trial.as_ref().is_none_or(|trial| trial.explain(x, y, level) == Finding::Unexplained)
            };
            let count = differing.iter().filter(wrong).count();
            if let Some(&(([x, y], level), expected)) = differing.iter().find(wrong) {
                return Err(Error::Wrong(format!(
                    "the device's picture is wrong: of {} pixels that were calculated again, rounding does not explain {count}. The \
                     first is x {x}, y {y}: {level:?}, and the reference has {expected:?}",
                    pixels.len()
                )));
            }
        }
        self.verified += pixels.len() as u64;
        self.took += start.elapsed();
        Ok(())
    }
}

/// So many pixels of those that any sphere may cover, the same ones for the same scene, in reading order.
fn chosen(scene: &Scene, cover: &Cover, count: u32) -> Vec<[u32; 2]> {
    /// Tries for each, where most of the picture is background.
    const TRIES: u64 = 64;
    let numbers = scene.spheres.iter().take(64).flat_map(|sphere| sphere.center.to_array());
    let seed = numbers.fold(scene.spheres.len() as u64, |seed, x| {
        (seed.rotate_left(23) ^ x.to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15)
    });
    let Area { top, left, width, height } = cover.area();
    let mut random = Random::new(seed, u64::from(width) << 32 | u64::from(height));
    let mut at = || {
        let mut below = |side: u32| (random.bits() % u64::from(side)) as u32;
        [left + below(width), top + below(height)]
    };
    let mut pixels: Vec<[u32; 2]> = Vec::new();
    for _ in 0..TRIES * u64::from(count) {
        if pixels.len() == count as usize {
            break;
        }
        let pixel = at();
        if cover.has(pixel) {
            pixels.push(pixel);
        }
    }
    pixels.sort_unstable_by_key(|&[x, y]| [y, x]);
    pixels.dedup();
    pixels
}
