//! A picture against its scene: which differing pixels does the reference explain?

use std::collections::BTreeMap;

use rayon::prelude::*;
use serde::Serialize;

use super::value as rgb;
use crate::cpu::{Decision, Finding, Judge, Reference};
use crate::film::Picture;
use crate::precision::Tier;

/// How many unexplained pixels are listed one by one.
const LISTED: usize = 20;
/// How many are judged again by who counts every rounding.
const JUDGED_AGAIN: usize = 1000;

/// Why the pixels of a picture differ from the reference.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Explanation {
    /// The tier whose rounding has explained them.
    pub judged_as: Tier,
    /// Pixels that differ.
    pub differing: u64,
    /// Differing pixels for each decision that explains them.
    pub explained: BTreeMap<Decision, u64>,
    /// Differing pixels that nothing explains: the verdict.
    pub unexplained: u64,
    /// Those of them for which rounding leaves more paths than are tried.
    pub undecided: u64,
    /// Of the first thousand of the unexplained, those that cannot be explained even if every rounding that there is adds up.
    pub proven: u64,
    /// How far rounding may move the colours of the explained pixels where it changes no decision; `None` where there is none.
    pub widths: Option<Widths>,
    /// The first of the unexplained, in reading order.
    pub listed: Vec<UnexplainedPixel>,
    /// Columns and rows of all of the unexplained.
    #[serde(skip)]
    pub places: Vec<[u32; 2]>,
}

/// Widths of colours, in 8-bit levels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Widths {
    /// That of the pixel in the middle.
    pub median: f64,
    /// The greatest.
    pub greatest: f64,
}

impl Widths {
    fn of(mut widths: Vec<f64>) -> Option<Self> {
        widths.sort_by(f64::total_cmp);
        Some(Self { median: *widths.get(widths.len() / 2)?, greatest: *widths.last()? })
    }
}

/// A pixel that no decision explains.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct UnexplainedPixel {
    /// Column.
    pub x: u32,
    /// Row.
    pub y: u32,
    /// The picture's value.
    pub value: [u8; 3],
    /// The reference's value.
    pub reference: [u8; 3],
}

impl Explanation {
    /// Judges every pixel in which `picture` differs from `expected`, the picture of `reference`.
    ///
    /// # Panics
    ///
    /// If the two pictures differ in size.
    pub fn of(picture: &Picture, expected: &Picture, reference: &Reference<f64>, judge: &Judge) -> Self {
        assert_eq!((picture.width(), picture.height()), (expected.width(), expected.height()), "sizes");
        let trial = judge.trial(reference);
        let width = picture.width();
        let pairs = picture.pixels().par_iter().zip(expected.pixels()).enumerate();
        let differing: Vec<_> = pairs
            .filter(|(_, (value, reference))| value != reference)
            .map(|(index, (&value, &expected))| {
                let (x, y) = ((index % width as usize) as u32, (index / width as usize) as u32);
                let finding = trial.explain(x, y, value);
                let width = matches!(finding, Finding::Explained(_)).then(|| trial.width(x, y));
                (finding, UnexplainedPixel { x, y, value, reference: expected }, width)
            })
            .collect();
        let mut explanation = Self {
            judged_as: judge.tier(),
            differing: differing.len() as u64,
            explained: BTreeMap::new(),
            unexplained: 0,
            undecided: 0,
            proven: 0,
            widths: None,
            listed: Vec::new(),
            places: Vec::new(),
        };
        let mut widths = Vec::new();
        for (finding, pixel, width) in differing {
            if let Finding::Explained(decision) = finding {
                *explanation.explained.entry(decision).or_default() += 1;
                widths.extend(width);
                continue;
            }
            explanation.unexplained += 1;
            explanation.places.push([pixel.x, pixel.y]);
            explanation.undecided += u64::from(finding == Finding::Undecided);
            if explanation.listed.len() < LISTED {
                explanation.listed.push(pixel);
            }
        }
        explanation.widths = Widths::of(widths);
        let strict = judge.strict().trial(reference);
        let is_proven = |&&[x, y]: &&[u32; 2]| strict.explain(x, y, picture.pixel(x, y)) == Finding::Unexplained;
        let again = &explanation.places[..explanation.places.len().min(JUDGED_AGAIN)];
        explanation.proven = again.par_iter().filter(is_proven).count() as u64;
        explanation
    }

    /// What the number of proven pixels is of.
    pub(crate) fn proven_in_words(&self) -> &'static str {
        if self.unexplained > JUDGED_AGAIN as u64 {
            "of the first 1000, which alone were tried, beyond all roundings that there are, added up"
        } else {
            "of them beyond all roundings that there are, added up"
        }
    }

    /// A table for people.
    pub fn report(&self) -> String {
        use std::fmt::Write as _;
        let mut text = format!("judged as         {}\ndiffering pixels  {}\n", self.judged_as, self.differing);
        for (decision, count) in &self.explained {
            let _ = writeln!(text, "  {count:>8}  {}", decision.name());
        }
        if let Some(Widths { median, greatest }) = self.widths {
            let _ = writeln!(
                text,
                "            within margins of {median:.1e} levels in the median, {greatest:.1e} at most"
            );
        }
        let _ = writeln!(text, "  {:>8}  unexplained", self.unexplained);
        if self.unexplained > 0 {
            let _ = writeln!(text, "  {:>8}  {}", self.proven, self.proven_in_words());
        }
        if self.undecided > 0 {
            let _ = writeln!(text, "  {:>8}  of them with more paths than are tried", self.undecided);
        }
        for UnexplainedPixel { x, y, value, reference } in &self.listed {
            let _ = writeln!(text, "            x {x}, y {y}: {}, reference {}", rgb(*value), rgb(*reference));
        }
        text
    }
}
