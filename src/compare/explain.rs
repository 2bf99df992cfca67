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

/// Why the pixels of a picture differ from the reference.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
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
    /// The first of the unexplained, in reading order.
    pub listed: Vec<UnexplainedPixel>,
    /// Columns and rows of all of the unexplained.
    #[serde(skip)]
    pub places: Vec<[u32; 2]>,
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
                (trial.explain(x, y, value), UnexplainedPixel { x, y, value, reference: expected })
            })
            .collect();
        let mut explanation = Self {
            judged_as: judge.tier(),
            differing: differing.len() as u64,
            explained: BTreeMap::new(),
            unexplained: 0,
            undecided: 0,
            listed: Vec::new(),
            places: Vec::new(),
        };
        for (finding, pixel) in differing {
            if let Finding::Explained(decision) = finding {
                *explanation.explained.entry(decision).or_default() += 1;
                continue;
            }
            explanation.unexplained += 1;
            explanation.places.push([pixel.x, pixel.y]);
            explanation.undecided += u64::from(finding == Finding::Undecided);
            if explanation.listed.len() < LISTED {
                explanation.listed.push(pixel);
            }
        }
        explanation
    }

    /// A table for people.
    pub fn report(&self) -> String {
        use std::fmt::Write as _;
        let mut text = format!("judged as         {}\ndiffering pixels  {}\n", self.judged_as, self.differing);
        for (decision, count) in &self.explained {
            let _ = writeln!(text, "  {count:>8}  {}", decision.name());
        }
        let _ = writeln!(text, "  {:>8}  unexplained", self.unexplained);
        if self.undecided > 0 {
            let _ = writeln!(text, "  {:>8}  of them with more paths than are tried", self.undecided);
        }
        for UnexplainedPixel { x, y, value, reference } in &self.listed {
            let _ = writeln!(text, "            x {x}, y {y}: {}, reference {}", rgb(*value), rgb(*reference));
        }
        text
    }
}
