//! Judges the pixels of a renderer by the precision of its arithmetic.
//!
//! A renderer that rounds follows a ray within a thin cone around the exact one. At every decision that the cone does not leave
//! sure the path forks. A value is explained where one of these paths, traced to its end, gives it.

use std::collections::VecDeque;

use glam::DVec3;

use super::cone::Cone;
use super::decision::Decision;
use super::margin::Roundoff;
use super::render::Reference;
use super::spread::{Gamut, Shade};
use super::surfaces::Surfaces;
use super::trace::trace;
use crate::precision::Tier;

/// Paths that are traced for a sample at the most.
const MAX_PATHS: usize = 1000;
/// Sums over the samples of a pixel that are tried at the most.
const MAX_SUMS: usize = 10_000;

/// What a judge says of a pixel that differs from the reference.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Finding {
    /// The first decision of the path, among those that rounding may take, which gives the value.
    Explained(Decision),
    /// No path gives it.
    Unexplained,
    /// None of those that were tried does, and there are more.
    Undecided,
}

/// Judges pictures by the precision of the arithmetic that they are made with.
#[derive(Debug, Clone, Copy)]
pub struct Judge {
    tier: Tier,
}

impl Judge {
    /// For the kernel of `tier`; where a device has no `f64`, [`Tier::Robust`] judges [`Tier::Double`].
    pub fn of(tier: Tier) -> Self {
        Self { tier }
    }

    /// The tier whose rounding explains pixels.
    pub fn tier(&self) -> Tier {
        self.tier
    }

    /// Judges pictures of `reference`'s scene.
    pub fn trial<'a>(&self, reference: &'a Reference<f64>) -> Trial<'a> {
        let world = &reference.world;
        Trial { reference, roundoff: Roundoff::of(self.tier), surfaces: Surfaces::of(world), gamut: Gamut::of(world) }
    }
}

/// A judge with a scene.
#[derive(Debug)]
pub struct Trial<'a> {
    pub(super) reference: &'a Reference<f64>,
    pub(super) roundoff: Roundoff,
    pub(super) surfaces: Surfaces,
    pub(super) gamut: Gamut,
}

/// One path that a sample may take.
#[derive(Debug, Clone, Copy)]
struct Outcome {
    shade: Shade,
    /// The first decision that was taken otherwise.
    flipped: Option<Decision>,
}

impl Trial<'_> {
    /// Whether rounding explains `level`, another renderer's 8-bit value of pixel (column `i`, row `j`).
    pub fn explain(&self, i: u32, j: u32, level: [u8; 3]) -> Finding {
        let count = self.reference.primaries(i, j).count();
        if count == 1 {
            let mut paths = Paths::new(self, i, j, 0);
            for outcome in paths.by_ref() {
                if is_within(level, outcome.shade.levels(self.reference.quantize, self.roundoff)) {
                    return Finding::Explained(outcome.flipped.unwrap_or(Decision::QuantisationStep));
                }
            }
            return if paths.is_exhausted() { Finding::Unexplained } else { Finding::Undecided };
        }
        let mut is_exhausted = true;
        let mut samples = Vec::with_capacity(count);
        for sample in 0..count {
            let mut paths = Paths::new(self, i, j, sample);
            let mut outcomes: Vec<Outcome> = Vec::new();
            for outcome in paths.by_ref() {
                if !outcomes.iter().any(|other| other.shade == outcome.shade) {
                    outcomes.push(outcome);
                }
            }
            is_exhausted &= paths.is_exhausted();
            samples.push(outcomes);
        }
        self.explain_mean(level, samples, is_exhausted)
    }

    /// Whether `level` is the mean of an outcome of each sample.
    fn explain_mean(&self, level: [u8; 3], samples: Vec<Vec<Outcome>>, is_exhausted: bool) -> Finding {
        let mut sums = Sums { trial: self, level, rest: Vec::new(), samples, tried: 0 };
        sums.prepare();
        match sums.search(0, DVec3::ZERO, DVec3::ZERO, None) {
            Some(decision) => Finding::Explained(decision),
            None if is_exhausted && sums.tried < MAX_SUMS => Finding::Unexplained,
            None => Finding::Undecided,
        }
    }
}

fn is_within(level: [u8; 3], [low, high]: [[u8; 3]; 2]) -> bool {
    (0..3).all(|c| (low[c]..=high[c]).contains(&level[c]))
}

/// The paths that a sample may take, those with the fewest decisions taken otherwise first.
struct Paths<'a> {
    trial: &'a Trial<'a>,
    pixel: [u32; 2],
    sample: usize,
    /// Scripts of [`Cone`]s that wait.
    scripts: VecDeque<Vec<u32>>,
    traced: usize,
}

impl<'a> Paths<'a> {
    fn new(trial: &'a Trial<'a>, i: u32, j: u32, sample: usize) -> Self {
        Self { trial, pixel: [i, j], sample, scripts: VecDeque::from([Vec::new()]), traced: 0 }
    }

    /// Whether there is no path that has not been traced.
    fn is_exhausted(&self) -> bool {
        self.scripts.is_empty()
    }
}

impl Iterator for Paths<'_> {
    type Item = Outcome;

    fn next(&mut self) -> Option<Outcome> {
        if self.traced == MAX_PATHS {
            return None;
        }
        let script = self.scripts.pop_front()?;
        self.traced += 1;
        let reference = self.trial.reference;
        let [i, j] = self.pixel;
        let primary = reference.primaries(i, j).nth(self.sample)?;
        let mut cone = Cone::new(self.trial, &script);
        let color = trace(&reference.world, &primary, &mut cone).to_f64();
        let (others, flipped) = (std::mem::take(&mut cone.others), cone.flipped);
        let outcome = Outcome { shade: cone.into_spread().around(color), flipped };
        for (place, &count) in others.iter().enumerate() {
            // More than are ever traced need not wait.
            let room = (MAX_PATHS + 1).saturating_sub(self.traced + self.scripts.len()) as u32;
            for other in 1..=count.min(room) {
                let mut script = script.clone();
                script.resize(script.len() + place, 0);
                script.push(other);
                self.scripts.push_back(script);
            }
        }
        Some(outcome)
    }
}

/// The search for outcomes of all samples whose mean is the value.
struct Sums<'a> {
    trial: &'a Trial<'a>,
    level: [u8; 3],
    samples: Vec<Vec<Outcome>>,
    /// From each sample on, the least and the greatest sum of the rest.
    rest: Vec<[DVec3; 2]>,
    tried: usize,
}

impl Sums<'_> {
    /// Those with a choice last, so that what is sure is summed once.
    fn prepare(&mut self) {
        self.samples.sort_by_key(Vec::len);
        self.rest = vec![[DVec3::ZERO; 2]; self.samples.len() + 1];
        for (index, outcomes) in self.samples.iter().enumerate().rev() {
            let low = outcomes.iter().map(|o| o.shade.low).fold(DVec3::INFINITY, DVec3::min);
            let high = outcomes.iter().map(|o| o.shade.high).fold(DVec3::NEG_INFINITY, DVec3::max);
            let [rest_low, rest_high] = self.rest[index + 1];
            self.rest[index] = [rest_low + low, rest_high + high];
        }
    }

    /// The first decision taken otherwise in a choice of outcomes, from sample `index` on, that gives the value.
    fn search(&mut self, index: usize, low: DVec3, high: DVec3, flipped: Option<Decision>) -> Option<Decision> {
        let [rest_low, rest_high] = self.rest[index];
        if self.tried >= MAX_SUMS || !self.holds(low + rest_low, high + rest_high) {
            return None;
        }
        if index == self.samples.len() {
            return Some(flipped.unwrap_or(Decision::QuantisationStep));
        }
        for choice in 0..self.samples[index].len() {
            self.tried += usize::from(self.samples[index].len() > 1);
            let Outcome { shade, flipped: own } = self.samples[index][choice];
            let found = self.search(index + 1, low + shade.low, high + shade.high, flipped.or(own));
            if found.is_some() {
                return found;
            }
        }
        None
    }

    /// Whether the mean of a sum between these may be the value.
    fn holds(&self, low: DVec3, high: DVec3) -> bool {
        let count = self.samples.len() as f64;
        let Trial { reference, roundoff, .. } = self.trial;
        let first = self.samples[0][0].shade;
        let is_constant = first.constant.is_some()
            && self.samples.iter().all(|outcomes| matches!(outcomes[..], [one] if one.shade == first));
        let shade = if is_constant {
            // The mean of equal colours is exact.
            first
        } else {
            // Each addition of a difference to the first sample rounds it and a sum that is no greater than that of all.
            let rounding = 2.0 * count * roundoff.shading;
            let (low, high) = (low / count, high / count);
            Shade { low: low - low.abs() * rounding, high: high + high.abs() * rounding, constant: None }
        };
        is_within(self.level, shade.levels(reference.quantize, *roundoff))
    }
}
