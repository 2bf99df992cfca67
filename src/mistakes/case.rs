//! A picture that is to be explained, and how well a variant does so.

use rayon::prelude::*;

use super::variant::{Stage, Variant};
use crate::film::Picture;
use crate::random::Random;

/// Differences beyond this many levels count as this many: of a pixel of another body one cannot say how wrong it is.
const MOST_LEVELS: u32 = 60;

/// Pixels of both kinds.
#[derive(Debug, Clone)]
pub(super) struct Sample {
    pub differing: Vec<[u32; 2]>,
    pub equal: Vec<[u32; 2]>,
}

/// How well a variant explains a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Score {
    /// Pixels that differ from the variant, of the whole picture.
    pub left: f64,
    /// Sum of their differences in levels.
    pub error: f64,
}

/// A picture that is to be explained.
pub(super) struct Case<'a> {
    pub stage: Stage,
    pub theirs: &'a Picture,
    /// All pixels that count.
    pub all: Sample,
    /// Whether rounding is no excuse.
    pub exactly: bool,
}

impl Case<'_> {
    /// How many pixels are to be explained.
    pub(super) fn before(&self) -> u64 {
        self.all.differing.len() as u64
    }

    /// So many pixels of each kind at the most.
    pub(super) fn sample(&self, most: usize) -> Sample {
        let mut random = Random::new(most as u64, 0);
        let mut pick = |pixels: &[[u32; 2]]| -> Vec<[u32; 2]> {
            if pixels.len() <= most {
                return pixels.to_vec();
            }
            // One of each stretch, so that all parts of the picture are there.
            let stretch = pixels.len() as f64 / most as f64;
            let place = |k: usize| ((k as f64 + random.within(0.0, 1.0)) * stretch) as usize;
            (0..most).map(place).map(|index| pixels[index.min(pixels.len() - 1)]).collect()
        };
        Sample { differing: pick(&self.all.differing), equal: pick(&self.all.equal) }
    }

    /// How well `variant` explains the picture, by a sample of it.
    pub(super) fn score(&self, variant: &Variant, sample: &Sample) -> Score {
        let part = |pixels: &[[u32; 2]], of: usize| {
            let (mut left, mut error) = (0_u32, 0_u32);
            for &pixel in pixels {
                let off = self.off(variant, pixel);
                left += u32::from(off > 0);
                error += off;
            }
            let weight = of as f64 / pixels.len().max(1) as f64;
            (f64::from(left) * weight, f64::from(error) * weight)
        };
        let (left, error) = part(&sample.differing, self.all.differing.len());
        let (spoiled, spoiled_error) = part(&sample.equal, self.all.equal.len());
        Score { left: left + spoiled, error: error + spoiled_error }
    }

    /// Likewise, in parallel: for many pixels and few variants.
    pub(super) fn score_in_parallel(&self, variant: &Variant, sample: &Sample) -> Score {
        const CHUNK: usize = 512;
        let part = |pixels: &[[u32; 2]], of: usize| {
            let each = |chunk: &[[u32; 2]]| {
                chunk
                    .iter()
                    .map(|&pixel| self.off(variant, pixel))
                    .fold((0_u64, 0_u64), |(left, error), off| (left + u64::from(off > 0), error + u64::from(off)))
            };
            let (left, error) = pixels.par_chunks(CHUNK).map(each).reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
            let weight = of as f64 / pixels.len().max(1) as f64;
            (left as f64 * weight, error as f64 * weight)
        };
        let (left, error) = part(&sample.differing, self.all.differing.len());
        let (spoiled, spoiled_error) = part(&sample.equal, self.all.equal.len());
        Score { left: left + spoiled, error: error + spoiled_error }
    }

    /// By how many levels a pixel differs from the variant, all channels together; 0 where rounding explains it.
    pub(super) fn off(&self, variant: &Variant, pixel: [u32; 2]) -> u32 {
        let levels = self.theirs.pixel(pixel[0], pixel[1]);
        if variant.shows(&self.stage, pixel, levels, self.exactly) {
            return 0;
        }
        let shown = variant.levels(&self.stage, pixel);
        let off: u32 = (0..3).map(|c| u32::from(levels[c].abs_diff(shown[c]))).sum();
        off.clamp(1, MOST_LEVELS)
    }

    /// The level of a pixel of the picture that is to be explained.
    pub(super) fn levels(&self, pixel: [u32; 2]) -> [u8; 3] {
        self.theirs.pixel(pixel[0], pixel[1])
    }
}
