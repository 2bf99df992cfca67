//! Judges the pixels of a renderer by the precision of its arithmetic.
//!
//! A renderer that rounds follows a ray within a thin cone around the exact one. At every decision that the cone does not leave
//! sure the path forks. A value is explained where one of these paths, traced to its end, gives it.

use glam::DVec3;

use super::decision::Decision;
use super::margin::Roundoff;
use super::paths::{Outcome, Paths};
use super::render::Reference;
use super::spread::{Gamut, Shade};
use super::sums::Sums;
use super::surfaces::Surfaces;
use crate::precision::Tier;

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
    /// Whether it counts every rounding, where many cancel in fact.
    is_strict: bool,
}

impl Judge {
    /// For the kernel of `tier`; where a device has no `f64`, [`Tier::Robust`] judges [`Tier::Double`].
    pub fn of(tier: Tier) -> Self {
        Self { tier, is_strict: false }
    }

    /// One who counts every rounding of the worst case: what it does not explain no rounding does, to the order of its bounds. It explains
    /// a few in a hundred of the pixels that small mistakes make wrong, too.
    #[must_use]
    pub fn strict(self) -> Self {
        Self { is_strict: true, ..self }
    }

    /// The tier whose rounding explains pixels.
    pub fn tier(&self) -> Tier {
        self.tier
    }

    /// Judges pictures of `reference`'s scene.
    pub fn trial<'a>(&self, reference: &'a Reference<f64>) -> Trial<'a> {
        let world = &reference.world;
        let roundoff = Roundoff::of(self.tier);
        let roundoff = if self.is_strict { roundoff.counted() } else { roundoff };
        Trial { reference, roundoff, surfaces: Surfaces::of(world), gamut: Gamut::of(world) }
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

/// What another renderer shows of a pixel.
#[derive(Debug, Clone, Copy)]
enum Value {
    Level([u8; 3]),
    Color(DVec3),
}

impl Trial<'_> {
    /// Whether rounding explains `level`, another renderer's 8-bit value of pixel (column `i`, row `j`).
    pub fn explain(&self, i: u32, j: u32, level: [u8; 3]) -> Finding {
        self.explain_value([i, j], Value::Level(level))
    }

    /// Whether rounding explains `color`, another renderer's unclamped colour of pixel (column `i`, row `j`).
    pub fn explain_color(&self, i: u32, j: u32, color: DVec3) -> Finding {
        self.explain_value([i, j], Value::Color(color))
    }

    /// How far rounding may move the colour of pixel (column `i`, row `j`) where it changes no decision: the width of an interval around
    /// it, in 8-bit levels, of the channels the greatest.
    pub fn width(&self, i: u32, j: u32) -> f64 {
        let primaries: Vec<_> = self.reference.primaries(i, j).collect();
        let width =
            |primary| Paths::new(self, primary).next().map_or(DVec3::ZERO, |own| own.shade.high - own.shade.low);
        let sum: DVec3 = primaries.iter().map(width).sum();
        sum.max_element() / primaries.len() as f64 * self.reference.quantize.scale()
    }

    fn explain_value(&self, [i, j]: [u32; 2], value: Value) -> Finding {
        let holds = |shade: &Shade| self.holds(shade, value);
        let primaries: Vec<_> = self.reference.primaries(i, j).collect();
        let mut samples: Vec<Paths> = primaries.iter().map(|primary| Paths::new(self, primary)).collect();
        let [sample] = &mut samples[..] else {
            return Sums::search(self, samples, holds);
        };
        match sample.find(|outcome| holds(&outcome.shade)) {
            Some(Outcome { flipped: Some(decision), .. }) => Finding::Explained(decision),
            // The paths are those of `f64`, which the reference does not always follow: `src/cpu/proof.rs`.
            Some(Outcome { open: Some(decision), shade, .. }) if !self.shows_reference(&shade, [i, j]) => {
                Finding::Explained(decision)
            }
            Some(_) => Finding::Explained(Decision::QuantisationStep),
            None if sample.is_exhausted() => Finding::Unexplained,
            None => Finding::Undecided,
        }
    }

    /// Whether the reference's own colour of a pixel is one of the shade.
    fn shows_reference(&self, shade: &Shade, [i, j]: [u32; 2]) -> bool {
        self.reference.color(i, j).is_none_or(|color| self.holds(shade, Value::Color(color)))
    }

    /// Whether the value is one of the shade.
    fn holds(&self, shade: &Shade, value: Value) -> bool {
        match value {
            Value::Level(level) => {
                let [low, high] = shade.levels(self.reference.quantize, self.roundoff);
                (0..3).all(|c| (low[c]..=high[c]).contains(&level[c]))
            }
            Value::Color(color) => (0..3).all(|c| (shade.low[c]..=shade.high[c]).contains(&color[c])),
        }
    }
}
