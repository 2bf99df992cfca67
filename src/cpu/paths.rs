//! The paths that rounding may lead a sample on.

use std::collections::VecDeque;

use super::cone::Cone;
use super::decision::Decision;
use super::intersect::Primary;
use super::judge::Trial;
use super::spread::Shade;
use super::trace::trace;

/// Paths that are traced for a sample at the most.
const MAX_PATHS: usize = 1000;

/// One path that a sample may take.
#[derive(Debug, Clone, Copy)]
pub(super) struct Outcome {
    pub shade: Shade,
    /// The first decision that was taken otherwise.
    pub flipped: Option<Decision>,
    /// The first that could have been.
    pub open: Option<Decision>,
}

/// The paths that a sample may take, those with the fewest decisions taken otherwise first.
pub(super) struct Paths<'a> {
    trial: &'a Trial<'a>,
    primary: &'a Primary<'a, f64>,
    /// Scripts of [`Cone`]s that wait.
    scripts: VecDeque<Vec<u32>>,
    traced: usize,
}

impl<'a> Paths<'a> {
    pub(super) fn new(trial: &'a Trial<'a>, primary: &'a Primary<'a, f64>) -> Self {
        Self { trial, primary, scripts: VecDeque::from([Vec::new()]), traced: 0 }
    }

    /// Whether there is no path that has not been traced.
    pub(super) fn is_exhausted(&self) -> bool {
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
        let mut cone = Cone::new(self.trial, &script);
        let color = trace(&self.trial.reference.world, self.primary, &mut cone).to_f64();
        let (others, flipped, open) = (std::mem::take(&mut cone.others), cone.flipped, cone.open);
        let outcome = Outcome { shade: cone.into_spread().around(color), flipped, open };
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
