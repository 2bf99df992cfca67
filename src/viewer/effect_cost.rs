//! What each effect costs the picture at hand: rendered with it and without it in turn.

use serde::Serialize;

use crate::effects::{Effect, Effects};

/// Rounds of each effect; the first one is for compiling and does not count.
const ROUNDS: usize = 4;

/// What an effect costs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EffectTimes {
    /// Which.
    pub effect: Effect,
    /// Least time with it, in ms.
    pub with_ms: f64,
    /// Least time without it, in ms.
    pub without_ms: f64,
}

/// A measurement on its way: one picture a step.
#[derive(Debug, Default)]
pub(super) struct CostMeasurement {
    costs: Vec<EffectTimes>,
    /// Pictures of the effect at hand so far.
    pictures: usize,
}

impl CostMeasurement {
    fn effect(&self) -> Effect {
        Effect::ALL[self.costs.len().saturating_sub(usize::from(self.pictures > 0)).min(Effect::ALL.len() - 1)]
    }

    /// The effects of the next picture: those of the page, with one in it or not.
    pub(super) fn variant(&self, effects: &Effects) -> Effects {
        let (effect, on) = (self.effect(), self.pictures.is_multiple_of(2));
        let depth = match (effect, on) {
            (Effect::Reflections, true) => effects.depth.max(1),
            (Effect::Reflections, false) => 0,
            _ => effects.depth,
        };
        Effects { set: effects.set.with(effect, on), depth, ..effects.clone() }
    }

    /// Notes the time of the picture, in ms; after the last one of all the table.
    pub(super) fn note(&mut self, time: f64) -> Option<&[EffectTimes]> {
        let effect = self.effect();
        if self.pictures == 0 {
            self.costs.push(EffectTimes { effect, with_ms: f64::INFINITY, without_ms: f64::INFINITY });
        }
        if let Some(cost) = self.costs.last_mut().filter(|_| self.pictures >= 2) {
            let least = if self.pictures.is_multiple_of(2) { &mut cost.with_ms } else { &mut cost.without_ms };
            *least = least.min(time);
        }
        self.pictures = (self.pictures + 1) % (2 * ROUNDS);
        (self.pictures == 0 && self.costs.len() == Effect::ALL.len()).then_some(&self.costs)
    }
}
