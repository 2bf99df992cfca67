//! Pixels of several samples: which paths of all of them have the value for their mean.

use glam::DVec3;

use super::decision::Decision;
use super::judge::{Finding, Trial};
use super::paths::{Outcome, Paths};
use super::spread::Shade;

/// Choices of paths that are tried at the most.
const MAX_TRIED: usize = 10_000;

/// Roundings of a mean beyond those of its sum, which is one of differences to the first sample: none of these is rounded by more than the
/// greatest sample is, and then follow a quotient and a sum.
const MEAN: f64 = 8.0;

/// The search for an outcome of each sample.
pub(super) struct Sums<'a, H> {
    trial: &'a Trial<'a>,
    /// Whether the value is one of a shade.
    holds: H,
    /// Those with a choice last, so that what is sure is summed once.
    samples: Vec<Vec<Outcome>>,
    /// From each sample on, the least and the greatest sum of the rest.
    rest: Vec<[DVec3; 2]>,
    /// The greatest size of any sample's colour.
    greatest: DVec3,
    tried: usize,
}

impl<'a, H: Fn(&Shade) -> bool> Sums<'a, H> {
    /// Whether a choice of paths explains the value that `holds` knows.
    pub(super) fn search(trial: &'a Trial<'a>, mut paths: Vec<Paths>, holds: H) -> Finding {
        let mut sums = Self { trial, holds, samples: Vec::new(), rest: Vec::new(), greatest: DVec3::ZERO, tried: 0 };
        // Mostly none has to be taken otherwise.
        let mut samples: Vec<Vec<Outcome>> = paths.iter_mut().map(|paths| paths.by_ref().take(1).collect()).collect();
        sums.set(samples.clone());
        if let Some(decision) = sums.explained(0, [DVec3::ZERO; 2], None) {
            return Finding::Explained(decision);
        }
        for (outcomes, paths) in samples.iter_mut().zip(&mut paths) {
            for outcome in paths {
                if !outcomes.iter().any(|other| other.shade == outcome.shade) {
                    outcomes.push(outcome);
                }
            }
        }
        sums.set(samples);
        match sums.explained(0, [DVec3::ZERO; 2], None) {
            Some(decision) => Finding::Explained(decision),
            None if sums.tried < MAX_TRIED && paths.iter().all(Paths::is_exhausted) => Finding::Unexplained,
            None => Finding::Undecided,
        }
    }

    fn set(&mut self, mut samples: Vec<Vec<Outcome>>) {
        samples.sort_by_key(Vec::len);
        self.rest = vec![[DVec3::ZERO; 2]; samples.len() + 1];
        for (index, outcomes) in samples.iter().enumerate().rev() {
            let low = outcomes.iter().map(|o| o.shade.low).fold(DVec3::INFINITY, DVec3::min);
            let high = outcomes.iter().map(|o| o.shade.high).fold(DVec3::NEG_INFINITY, DVec3::max);
            self.greatest = self.greatest.max(low.abs()).max(high.abs());
            let [rest_low, rest_high] = self.rest[index + 1];
            self.rest[index] = [rest_low + low, rest_high + high];
        }
        self.samples = samples;
    }

    /// The first decision taken otherwise in a choice of outcomes, from sample `index` on, that gives the value with a sum between
    /// these of the samples before.
    fn explained(&mut self, index: usize, [low, high]: [DVec3; 2], flipped: Option<Decision>) -> Option<Decision> {
        let [rest_low, rest_high] = self.rest[index];
        if self.tried >= MAX_TRIED || !self.may_hold(low + rest_low, high + rest_high) {
            return None;
        }
        let Some(outcomes) = self.samples.get(index).cloned() else {
            return Some(flipped.unwrap_or(Decision::QuantisationStep));
        };
        for Outcome { shade, flipped: own, .. } in &outcomes {
            self.tried += usize::from(outcomes.len() > 1);
            let found = self.explained(index + 1, [low + shade.low, high + shade.high], flipped.or(*own));
            if found.is_some() {
                return found;
            }
        }
        None
    }

    /// Whether the mean of a sum between these may be the value.
    fn may_hold(&self, low: DVec3, high: DVec3) -> bool {
        let first = self.samples[0][0].shade;
        let is_first = |outcomes: &Vec<Outcome>| matches!(outcomes[..], [one] if one.shade == first);
        if first.constant.is_some() && self.samples.iter().all(is_first) {
            // The mean of equal colours is exact.
            return (self.holds)(&first);
        }
        let count = self.samples.len() as f64;
        let rounding = self.greatest * ((count + MEAN) * self.trial.roundoff.shading);
        let shade = Shade { low: low / count - rounding, high: high / count + rounding, constant: None };
        (self.holds)(&shade)
    }
}
