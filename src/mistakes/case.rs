//! A picture that is to be explained, and how well a variant does so.

use rayon::prelude::*;

use super::limit::Limit;
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
    /// How long the search may take.
    pub limit: Limit,
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

    /// How well `variant` explains the picture, by a sample of it; `None` where the time is over before that is known.
    pub(super) fn score(&self, variant: &Variant, sample: &Sample) -> Option<Score> {
        self.weighed(sample, |pixels| self.sum(variant, pixels, true))
    }

    /// Likewise, in parallel: for many pixels and few variants.
    pub(super) fn score_in_parallel(&self, variant: &Variant, sample: &Sample) -> Option<Score> {
        const CHUNK: usize = 512;
        let sum = |pixels: &[[u32; 2]]| {
            let chunks = pixels.par_chunks(CHUNK).map(|chunk| self.sum(variant, chunk, true));
            chunks.try_reduce(|| (0, 0), |a, b| Some((a.0 + b.0, a.1 + b.1)))
        };
        self.weighed(sample, sum)
    }

    /// Likewise by very few pixels, whether the time is over or not.
    pub(super) fn rough_score(&self, variant: &Variant) -> Option<Score> {
        const FEW: usize = 40;
        self.weighed(&self.sample(FEW), |pixels| self.sum(variant, pixels, false))
    }

    /// The sum of all differences by a sample, infinite where the time is over.
    pub(super) fn error(&self, variant: &Variant, sample: &Sample) -> f64 {
        self.score(variant, sample).map_or(f64::INFINITY, |score| score.error)
    }

    /// The score of the whole picture, of which a sample has these sums.
    fn weighed(&self, sample: &Sample, sum: impl Fn(&[[u32; 2]]) -> Option<(u64, u64)>) -> Option<Score> {
        let part = |pixels: &[[u32; 2]], of: usize| {
            let (left, error) = sum(pixels)?;
            let weight = of as f64 / pixels.len().max(1) as f64;
            Some((left as f64 * weight, error as f64 * weight))
        };
        let (left, error) = part(&sample.differing, self.all.differing.len())?;
        let (spoiled, spoiled_error) = part(&sample.equal, self.all.equal.len())?;
        Some(Score { left: left + spoiled, error: error + spoiled_error })
    }

    /// How many of the pixels differ from the variant, and by how many levels.
    fn sum(&self, variant: &Variant, pixels: &[[u32; 2]], is_limited: bool) -> Option<(u64, u64)> {
        // Looking at the clock takes a tenth of a pixel's time.
        const BETWEEN_LOOKS: usize = 8;
        let (mut left, mut error) = (0, 0);
        for few in pixels.chunks(BETWEEN_LOOKS) {
            if is_limited && self.limit.is_over() {
                return None;
            }
            for &pixel in few {
                let off = u64::from(self.off(variant, pixel));
                left += u64::from(off > 0);
                error += off;
            }
        }
        Some((left, error))
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
